//! Small locations and scenarios for tests.

use std::collections::BTreeMap;

use socrates_model::request::Waypoints;
use socrates_model::{
    Action, Behaviors, Cell, Command, Encounter, GraphEdge, GraphNode, Grid, GroupId, GroupProposal, HumanBehavior,
    HumanId, HumanProposal, Location, NodeId, Observation, Paths, PlaceClass, Point, Polyline, Pose, Proposal,
    Recording, Relation, RobotDriver, RobotModel, RobotProposal, Rule, RunId, SceneGraph,
};

use crate::run::Engine;
use crate::setup::Setup;

pub(crate) const RES: f64 = 0.1;

/// An empty hall with walls round it; the lower left corner is (0, 0).
pub(crate) fn hall(width_m: f64, height_m: f64) -> Grid {
    carve(width_m, height_m, &[(0.1, 0.1, width_m - 0.1, height_m - 0.1)])
}

/// Solid, with these free rectangles (x0, y0, x1, y1).
pub(crate) fn carve(width_m: f64, height_m: f64, free: &[(f64, f64, f64, f64)]) -> Grid {
    let (width, height) = ((width_m / RES).round() as usize, (height_m / RES).round() as usize);
    let mut grid = Grid {
        width,
        height,
        resolution_m: RES,
        origin: Pose::new(0.0, 0.0, 0.0),
        cells: vec![Cell::Occupied; width * height],
    };
    for row in 0..height {
        for column in 0..width {
            let at = grid.center_of(column, row);
            if free.iter().any(|(x0, y0, x1, y1)| at.x > *x0 && at.x < *x1 && at.y > *y0 && at.y < *y1) {
                grid.cells[row * width + column] = Cell::Free;
            }
        }
    }
    grid
}

pub(crate) fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

pub(crate) fn location(grid: Grid, nodes: &[(&str, f64, f64)], edges: &[(&str, &str)]) -> Location {
    let nodes = nodes
        .iter()
        .map(|(name, x, y)| GraphNode { id: id(name), kind: "CORRIDOR".into(), at: Point::new(*x, *y) })
        .collect();
    let edges =
        edges.iter().map(|(a, b)| GraphEdge { from: id(a), to: id(b), kind: "CORRIDOR".into(), via: vec![] }).collect();
    Location {
        format: 1,
        name: "test".into(),
        description: String::new(),
        grid,
        graph: SceneGraph::new(nodes, edges),
        doors: vec![],
        names: Vec::new(),
        warnings: vec![],
    }
}

/// A human of the scenario: relation, path, rules.
pub(crate) struct Cast<'a>(pub(crate) Relation, pub(crate) &'a [&'a str], pub(crate) Vec<Rule>);

/// A setup over these humans; encounters as `(human number, node)`.
pub(crate) fn setup(location: Location, robot: &[&str], cast: &[Cast<'_>], meet: &[(u32, &str)]) -> Setup {
    let ids = |names: &[&str]| names.iter().map(|name| id(name)).collect::<Vec<NodeId>>();
    let mut humans = Vec::new();
    let mut ways = BTreeMap::new();
    let mut trees = BTreeMap::new();
    for (number, Cast(relation, path, rules)) in (1_u32..).zip(cast) {
        let human = HumanId::new(number);
        humans.push(HumanProposal {
            id: human,
            role: "person".into(),
            behavior: String::new(),
            relation: *relation,
            side: None,
            facing: None,
            rules: rules.clone(),
            group: None,
            speed_mps: None,
            start: None,
            goal: None,
        });
        ways.insert(human, ids(path));
        let tree = socrates_bt::compile(human, rules).unwrap();
        trees.insert(human, HumanBehavior { tree, description: String::new() });
    }
    let robot_proposal =
        RobotProposal { task: "go".into(), start: None, goal: None, script: vec![], expected_behavior: String::new() };
    Setup {
        location,
        proposal: Proposal {
            format: 1,
            title: String::new(),
            description: String::new(),
            pattern: "free".into(),
            place: PlaceClass::Corridor,
            humans,
            groups: vec![],
            robot: robot_proposal,
            expected_events: vec![],
            not_understood: vec![],
            notes: vec![],
            author: "test".into(),
        },
        paths: Paths {
            format: 1,
            robot: ids(robot),
            humans: ways,
            encounters: meet
                .iter()
                .map(|(number, node)| Encounter { human: HumanId::new(*number), node: id(node) })
                .collect(),
            reasoning: String::new(),
            author: "test".into(),
        },
        behaviors: Behaviors { format: 1, humans: trees, author: "test".into() },
        planner: "line".parse().unwrap(),
        seed: 1,
        run: RunId::new("test").unwrap(),
        duration_s: None,
        robot: RobotModel::default(),
        waypoints: Waypoints::Via,
    }
}

/// All of them walk as one group.
pub(crate) fn grouped(mut made: Setup) -> Setup {
    let group = GroupId(1);
    for human in &mut made.proposal.humans {
        human.group = Some(group);
    }
    let members = made.proposal.humans.iter().map(|human| human.id).collect();
    made.proposal.groups.push(GroupProposal { id: group, members, standing: false });
    made
}

/// The run beside a robot that drives along its line.
pub(crate) fn run(made: Setup) -> Recording {
    let mut driver = Liner::of(&made);
    Engine::new(made).unwrap().run(Some(&mut driver), &mut |_, _| {})
}

pub(crate) fn rule(when: socrates_model::Trigger, act: Action) -> Rule {
    Rule { when: vec![when], act, gesture: None, for_s: None, latched: false, ..Rule::default() }
}

/// Drives along a line and stops for whoever is close ahead.
pub(crate) struct Liner {
    pub(crate) way: Polyline,
    pub(crate) s: f64,
}

impl Liner {
    pub(crate) fn of(setup: &Setup) -> Self {
        Self { way: Polyline::new(&setup.location.graph.polyline(&setup.paths.robot)), s: 0.0 }
    }
}

impl RobotDriver for Liner {
    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let at = seen.pose.point();
        self.s = self.way.project_within(&at, self.s, self.s + 2.0).0;
        let target = self.way.point(self.s + 0.6);
        let bearing = libm::atan2(target.y - at.y, target.x - at.x);
        let turn = socrates_model::geometry::wrap_angle(bearing - seen.pose.yaw);
        let blocked = seen.people.iter().any(|person| {
            let way = person.at - at;
            way.norm() < 0.95
                && socrates_model::geometry::wrap_angle(libm::atan2(way.y, way.x) - seen.pose.yaw).abs() < 0.9
        });
        let left = self.way.length_m() - self.s;
        let v = if blocked || left < 0.1 { 0.0 } else { 0.8 * (1.0 - turn.abs()).max(0.0) };
        Command { v, omega: 2.0 * turn, waiting: blocked, ..Command::default() }
    }
}
