//! The workload CROSS-n as a scenario: a hall with walls, n people on straight ways to and fro, each with a tree.

use std::collections::BTreeMap;

use socrates_engine::Setup;
use socrates_model::request::Waypoints;
use socrates_model::{
    Action, Behaviors, Cell, GraphEdge, GraphNode, Grid, HumanBehavior, HumanId, HumanProposal, Location, NodeId,
    Paths, PlaceClass, Point, Pose, Proposal, Relation, RobotModel, RobotProposal, Rule, RunId, SceneGraph, Trigger,
};

use super::scene::cross;

const RES: f64 = 0.1;
/// How often everybody goes to the other side: more than a bench lasts.
const TURNS: usize = 20;

fn grid(side: f64, segments: &[(Point, Point)]) -> Grid {
    let cells = (side / RES).ceil() as usize + 2;
    let mut grid = Grid {
        width: cells,
        height: cells,
        resolution_m: RES,
        origin: Pose::new(-RES, -RES, 0.0),
        cells: vec![Cell::Free; cells * cells],
    };
    for row in 0..cells {
        for column in 0..cells {
            let at = grid.center_of(column, row);
            let outside = at.x < 0.0 || at.y < 0.0 || at.x > side || at.y > side;
            let wall = segments.iter().any(|(from, to)| {
                socrates_model::geometry::nearest_on_segment(&at, from, to).0 < 0.5 * RES
                    && (from.y - to.y).abs() < 1e-9
            });
            if outside || wall && at.y > RES && at.y < side - RES {
                grid.cells[row * cells + column] = Cell::Occupied;
            }
        }
    }
    grid
}

/// Rules like those of somebody curious: two conditions, two reactions, then the way.
fn rules() -> Vec<Rule> {
    let rule = |when, act, for_s| Rule { when, act, gesture: None, for_s, latched: false, ..Rule::default() };
    vec![
        rule(vec![Trigger::RobotVisible(1.5), Trigger::RobotMoving], Action::LookAtRobot, Some(1.0)),
        rule(vec![Trigger::RobotBlocking(1.2)], Action::GiveWay, Some(2.0)),
    ]
}

/// The scenario with `n` people; it lasts `secs`.
pub fn crowd(n: u32, secs: f64) -> Setup {
    let (scene, side) = cross(n);
    let mut nodes = Vec::new();
    let mut edges = Vec::new();
    let mut node = |name: String, at: Point| {
        let id = NodeId::new(&name).unwrap();
        nodes.push(GraphNode { id: id.clone(), kind: "OPEN".into(), at });
        id
    };
    let (near, far) = (node("r0".into(), Point::new(1.0, 1.0)), node("r1".into(), Point::new(side - 1.0, side - 1.0)));
    edges.push((near.clone(), far.clone()));
    let mut humans = Vec::new();
    let mut ways = BTreeMap::new();
    let mut trees = BTreeMap::new();
    for (place, disc) in scene.discs.iter().enumerate() {
        let id = HumanId::new(u32::try_from(place).unwrap() + 1);
        let at = disc.center;
        let other = |value: f64| if value < side / 2.0 { side - 1.0 } else { 1.0 };
        let goal = if place % 2 == 0 { Point::new(other(at.x), at.y) } else { Point::new(at.x, other(at.y)) };
        let (a, b) = (node(format!("s{id}"), at), node(format!("g{id}"), goal));
        edges.push((a.clone(), b.clone()));
        ways.insert(id, (0..TURNS).map(|turn| if turn % 2 == 0 { a.clone() } else { b.clone() }).collect());
        let tree = socrates_bt::compile(id, &rules()).unwrap();
        trees.insert(id, HumanBehavior { tree, description: String::new() });
        humans.push(HumanProposal {
            id,
            role: "person".into(),
            behavior: String::new(),
            relation: Relation::Crossing,
            side: None,
            facing: None,
            rules: rules(),
            group: None,
            speed_mps: None,
            start: None,
            goal: None,
        });
    }
    let edges = edges.into_iter().map(|(from, to)| GraphEdge { from, to, kind: "OPEN".into(), via: vec![] }).collect();
    let robot =
        RobotProposal { task: "go".into(), start: None, goal: None, script: vec![], expected_behavior: String::new() };
    Setup {
        location: Location {
            format: 1,
            name: "hall".into(),
            description: String::new(),
            grid: grid(side, &scene.segments),
            graph: SceneGraph::new(nodes, edges),
            doors: vec![],
            names: Vec::new(),
            warnings: vec![],
        },
        proposal: Proposal {
            format: 1,
            title: String::new(),
            description: String::new(),
            pattern: "free".into(),
            place: PlaceClass::OpenArea,
            humans,
            groups: vec![],
            robot,
            expected_events: vec![],
            not_understood: vec![],
            notes: vec![],
            author: "test".into(),
        },
        paths: Paths {
            format: 1,
            robot: vec![near, far],
            humans: ways,
            encounters: vec![],
            reasoning: String::new(),
            author: "test".into(),
        },
        behaviors: Behaviors { format: 1, humans: trees, author: "test".into() },
        planner: "line".parse().unwrap(),
        seed: 1,
        run: RunId::new("cross").unwrap(),
        duration_s: Some(secs),
        robot: RobotModel::default(),
        waypoints: Waypoints::Ends,
    }
}
