//! Small maps and proposals of our own.

use socrates_model::{
    Cell, Door, FORMAT, GraphEdge, GraphNode, Grid, HumanId, HumanProposal, Location, NodeId, PlaceClass, Point, Pose,
    Proposal, Relation, RobotProposal, SceneGraph,
};

pub(crate) fn node(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

/// A map of floor from rectangles `[x, y, width, height]` in m, in cells of 0.1 m on `size` m.
pub(crate) fn map(
    size: [f64; 2],
    floor: &[[f64; 4]],
    nodes: &[(&str, &str, f64, f64)],
    edges: &[(&str, &str)],
) -> Location {
    let [width, height] = size.map(|m| (m * 10.0).round() as usize);
    let mut cells = vec![Cell::Occupied; width * height];
    for row in 0..height {
        for column in 0..width {
            let (x, y) = ((column as f64 + 0.5) / 10.0, (height as f64 - row as f64 - 0.5) / 10.0);
            if floor.iter().any(|[left, low, wide, high]| x > *left && x < left + wide && y > *low && y < low + high) {
                cells[row * width + column] = Cell::Free;
            }
        }
    }
    let nodes =
        nodes.iter().map(|(id, kind, x, y)| GraphNode { id: node(id), kind: (*kind).into(), at: Point::new(*x, *y) });
    let edge =
        |(a, b): &(&str, &str)| GraphEdge { from: node(a), to: node(b), kind: "PASSAGEWAY".into(), via: Vec::new() };
    Location {
        format: FORMAT,
        name: "small".into(),
        description: "A small map".into(),
        grid: Grid { width, height, resolution_m: 0.1, origin: Pose::new(0.0, 0.0, 0.0), cells },
        graph: SceneGraph::new(nodes.collect(), edges.iter().map(edge).collect()),
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

/// A corridor round a block of 24 m by 12 m: `b0` to `b6` below, `t0` to `t6` above, `l` and `r` at the sides, an intersection
/// with arms to both sides in the middle of the upper side, and one with an arm downwards in the middle of the lower.
pub(crate) fn block(lower: &str) -> Location {
    let mut nodes: Vec<(String, String, f64, f64)> = Vec::new();
    for k in 0..7 {
        let (own, x) = (if k == 3 { lower } else { "CORRIDOR" }, 2.0 + 4.0 * f64::from(k));
        nodes.push((format!("b{k}"), own.to_owned(), x, 6.0));
        nodes.push((format!("t{k}"), if k == 3 { "INTERSECTION" } else { "CORRIDOR" }.to_owned(), x, 18.0));
    }
    nodes.push(("l".into(), "CORRIDOR".into(), 2.0, 12.0));
    nodes.push(("r".into(), "CORRIDOR".into(), 26.0, 12.0));
    nodes.push(("d".into(), "CORRIDOR".into(), 14.0, 2.0));
    nodes.push(("u".into(), "CORRIDOR".into(), 14.0, 22.0));
    let nodes: Vec<(&str, &str, f64, f64)> =
        nodes.iter().map(|(id, kind, x, y)| (id.as_str(), kind.as_str(), *x, *y)).collect();
    let mut edges: Vec<(String, String)> = Vec::new();
    for k in 0..6 {
        edges.push((format!("b{k}"), format!("b{}", k + 1)));
        edges.push((format!("t{k}"), format!("t{}", k + 1)));
    }
    for (a, b) in [("b0", "l"), ("l", "t0"), ("b6", "r"), ("r", "t6"), ("b3", "d"), ("t3", "u")] {
        edges.push((a.into(), b.into()));
    }
    let edges: Vec<(&str, &str)> = edges.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let floor = [
        [0.5, 4.5, 27.0, 3.0],
        [0.5, 16.5, 27.0, 3.0],
        [0.5, 4.5, 3.0, 15.0],
        [24.5, 4.5, 3.0, 15.0],
        [12.5, 0.5, 3.0, 5.0],
        [12.5, 18.0, 3.0, 5.5],
    ];
    map([28.0, 24.0], &floor, &nodes, &edges)
}

/// A straight corridor of 24 m and a width, with nodes `c0` to `c6` every 4 m.
pub(crate) fn corridor(width_m: f64) -> Location {
    let names: Vec<String> = (0..7).map(|k| format!("c{k}")).collect();
    let nodes: Vec<(&str, &str, f64, f64)> =
        names.iter().enumerate().map(|(k, id)| (id.as_str(), "CORRIDOR", 2.0 + 4.0 * k as f64, 3.0)).collect();
    let edges: Vec<(&str, &str)> = names.windows(2).map(|pair| (pair[0].as_str(), pair[1].as_str())).collect();
    map([28.0, 6.0], &[[0.5, 3.0 - width_m / 2.0, 27.0, width_m]], &nodes, &edges)
}

/// A door of a map, from a point to a point.
pub(crate) fn door(value: serde_json::Value) -> Door {
    serde_json::from_value(value).unwrap()
}

/// A proposal with these people at a class of place.
pub(crate) fn proposal(place: PlaceClass, relations: &[Relation]) -> Proposal {
    let human = |(number, relation): (u32, &Relation)| HumanProposal {
        id: HumanId::new(number),
        role: "visitor".into(),
        behavior: "does something".into(),
        relation: *relation,
        side: None,
        facing: None,
        rules: Vec::new(),
        group: None,
        speed_mps: None,
        start: None,
        goal: None,
    };
    Proposal {
        format: FORMAT,
        title: "small".into(),
        description: "small".into(),
        pattern: "free".into(),
        place,
        humans: (1..).zip(relations).map(human).collect(),
        groups: Vec::new(),
        robot: RobotProposal {
            task: "drive".into(),
            start: None,
            goal: None,
            script: Vec::new(),
            expected_behavior: "drives".into(),
        },
        expected_events: Vec::new(),
        not_understood: Vec::new(),
        notes: Vec::new(),
        author: "test".into(),
    }
}
