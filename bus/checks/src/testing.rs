//! A small map and a good scenario on it, for the tests of this crate.

use std::collections::BTreeMap;

use socrates_model::{
    Action, Cell, Clause, ClauseRole, Door, DoorKind, DoorOpens, Encounter, FORMAT, Fact, FactKind, Fault, GraphEdge,
    GraphNode, Grid, HumanId, HumanProposal, Location, NodeId, Paths, PlaceClass, Point, Pose, Predicate, Proposal,
    Reading, Relation, RobotProposal, Rule, SceneGraph, Trigger,
};

pub(crate) fn node(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

pub(crate) fn nodes(texts: &[&str]) -> Vec<NodeId> {
    texts.iter().map(|text| node(text)).collect()
}

pub(crate) fn codes(faults: &[Fault]) -> Vec<String> {
    faults.iter().map(|fault| fault.code.to_string()).collect()
}

pub(crate) fn hard_codes(faults: &[Fault]) -> Vec<String> {
    codes(&socrates_model::fault::hard(faults))
}

/// Four corridors of 3 m steps that meet in `n_center`; west has three nodes, the others two.
pub(crate) fn plus_map() -> Location {
    let at = |id: &str, x: f64, y: f64| GraphNode { id: node(id), kind: "CORRIDOR".into(), at: Point::new(x, y) };
    let way = |a: &str, b: &str| GraphEdge { from: node(a), to: node(b), kind: "PASSAGEWAY".into(), via: Vec::new() };
    let nodes = vec![
        at("n_center", 0., 0.),
        at("w_1", -3., 0.),
        at("w_2", -6., 0.),
        at("w_3", -9., 0.),
        at("e_1", 3., 0.),
        at("e_2", 6., 0.),
        at("n_1", 0., 3.),
        at("n_2", 0., 6.),
        at("s_1", 0., -3.),
        at("s_2", 0., -6.),
    ];
    let edges = vec![
        way("n_center", "w_1"),
        way("w_1", "w_2"),
        way("w_2", "w_3"),
        way("n_center", "e_1"),
        way("e_1", "e_2"),
        way("n_center", "n_1"),
        way("n_1", "n_2"),
        way("n_center", "s_1"),
        way("s_1", "s_2"),
    ];
    let mut nodes = nodes;
    nodes[3].kind = "EXIT".into();
    Location {
        format: FORMAT,
        name: "plus".into(),
        description: "Four corridors".into(),
        grid: Grid {
            width: 50,
            height: 50,
            resolution_m: 0.5,
            origin: Pose::new(-12.5, -12.5, 0.0),
            cells: vec![Cell::Free; 2500],
        },
        graph: SceneGraph::new(nodes, edges),
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

/// The same map with a room of two nodes behind a door north of `n_1`.
pub(crate) fn room_map() -> Location {
    let mut location = plus_map();
    location.graph = location.graph.edited(|nodes, edges| {
        for (id, x) in [("room_a", 3.0), ("room_b", 1.5)] {
            nodes.push(GraphNode { id: node(id), kind: "ROOM".into(), at: Point::new(x, 3.0) });
        }
        for (a, b) in [("room_a", "room_b"), ("room_b", "n_1")] {
            edges.push(GraphEdge { from: node(a), to: node(b), kind: "DOOR".into(), via: Vec::new() });
        }
    });
    location.doors.push(Door {
        id: "room".into(),
        kind: DoorKind::Room,
        from: Point::new(0.8, 2.5),
        to: Point::new(0.8, 3.5),
        opens: DoorOpens::Near(1.5),
        hold_s: 5.0,
        inside: nodes(&["room_a", "room_b"]),
    });
    location
}

fn clause(id: &str, source: &str, predicate: Predicate) -> Clause {
    Clause { id: id.into(), text: id.into(), role: ClauseRole::Setup, must: true, source: source.into(), predicate }
}

/// Two people cross the robot's way at an intersection; the first stops and looks.
pub(crate) fn crossing_proposal() -> Proposal {
    let human = |number: u32, rules: Vec<Rule>| HumanProposal {
        id: HumanId::new(number),
        role: "employee".into(),
        behavior: "crosses the corridor and walks on".into(),
        relation: Relation::Crossing,
        side: None,
        facing: None,
        rules,
        group: None,
        speed_mps: None,
        start: None,
        goal: None,
    };
    let look =
        Rule { when: vec![Trigger::RobotVisible(4.0)], act: Action::LookAtRobot, for_s: Some(3.0), ..Rule::default() };
    let (first, second) = (HumanId::new(1), HumanId::new(2));
    Proposal {
        format: FORMAT,
        title: "Crossing".into(),
        description: "Two employees cross the robot's way at an intersection.".into(),
        pattern: "intersection_crossing".into(),
        place: PlaceClass::Intersection,
        humans: vec![human(1, vec![look.clone()]), human(2, Vec::new())],
        groups: Vec::new(),
        robot: RobotProposal {
            task: "deliver mail".into(),
            start: None,
            goal: None,
            script: Vec::new(),
            expected_behavior: "It slows down and lets them pass.".into(),
        },
        expected_events: vec![
            clause("c1", "", Predicate::Humans { count: 2 }),
            clause("c2", "f2", Predicate::Looks { human: first, for_s: 2.0 }),
            clause("c3", "f3", Predicate::EncounterAt { place: PlaceClass::Intersection, nodes: vec![], human: None }),
            clause("c4", "", Predicate::Meets { human: second, within_m: 2.5 }),
        ],
        not_understood: Vec::new(),
        notes: Vec::new(),
        author: "test".into(),
    }
}

/// The reading that the good proposal answers.
pub(crate) fn reading_of(proposal: &Proposal) -> Reading {
    let first = &proposal.humans[0];
    let fact = |id: &str, kind: FactKind| Fact { id: id.into(), quote: format!("words of {id}"), kind };
    Reading {
        format: FORMAT,
        facts: vec![
            fact("f1", FactKind::Humans(2)),
            fact("f2", FactKind::Reacts { human: first.id, rule: first.rules[0].clone() }),
            fact("f3", FactKind::Place(proposal.place)),
            fact("f4", FactKind::Relates { human: first.id, relation: first.relation }),
            fact("f5", FactKind::RobotTask("deliver mail".into())),
        ],
        ..Reading::default()
    }
}

/// Paths that make the good proposal happen.
pub(crate) fn crossing_paths() -> Paths {
    let meet = |number: u32| Encounter { human: HumanId::new(number), node: node("n_center") };
    Paths {
        format: FORMAT,
        robot: nodes(&["w_2", "w_1", "n_center", "e_1", "e_2"]),
        humans: BTreeMap::from([
            (HumanId::new(1), nodes(&["n_2", "n_1", "n_center", "s_1"])),
            (HumanId::new(2), nodes(&["s_2", "s_1", "n_center", "n_1"])),
        ]),
        encounters: vec![meet(1), meet(2)],
        reasoning: String::new(),
        author: "test".into(),
    }
}
