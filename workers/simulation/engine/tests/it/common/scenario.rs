//! Scenarios on the shipped locations, and what is wrong with a run of one.

use std::collections::BTreeMap;

use socrates_engine::{Engine, Setup};
use socrates_model::request::Waypoints;
use socrates_model::rule::RobotRule;
use socrates_model::{
    Behaviors, Encounter, EventKind, GroupId, GroupProposal, HumanBehavior, HumanId, HumanProposal, Location, NodeId,
    Paths, PlaceClass, Point, Proposal, Recording, Relation, RobotModel, RobotProposal, Rule, RunId,
};
use socrates_planners::{Mission, make};

/// One human: relation, path, rules.
#[derive(Debug, Clone)]
pub struct Cast(pub Relation, pub Vec<NodeId>, pub Vec<Rule>);

/// A location of the repository.
pub fn place(name: &str) -> Location {
    socrates_maps::shipped::load(name).unwrap()
}

/// A setup without groups; `meet` holds the encounter node of each human in turn.
pub fn scenario(
    location: &Location,
    robot: Vec<NodeId>,
    cast: Vec<Cast>,
    meet: &[Option<NodeId>],
    script: Vec<RobotRule>,
    standing: bool,
) -> Setup {
    let mut humans = Vec::new();
    let mut ways = BTreeMap::new();
    let mut trees = BTreeMap::new();
    let mut encounters = Vec::new();
    for (place, Cast(relation, path, rules)) in cast.into_iter().enumerate() {
        let human = HumanId::new(u32::try_from(place).unwrap() + 1);
        let tree = socrates_bt::compile(human, &rules).unwrap();
        trees.insert(human, HumanBehavior { tree, description: String::new() });
        ways.insert(human, path);
        if let Some(node) = meet.get(place).cloned().flatten() {
            encounters.push(Encounter { human, node });
        }
        humans.push(HumanProposal {
            id: human,
            role: "person".into(),
            behavior: String::new(),
            relation,
            side: None,
            facing: None,
            rules,
            group: standing.then_some(GroupId(1)),
            speed_mps: None,
            start: None,
            goal: None,
        });
    }
    let members: Vec<HumanId> = humans.iter().map(|human| human.id).collect();
    let robot_proposal =
        RobotProposal { task: "go".into(), start: None, goal: None, script, expected_behavior: String::new() };
    let proposal = Proposal {
        format: 1,
        title: String::new(),
        description: String::new(),
        pattern: "free".into(),
        place: PlaceClass::Corridor,
        humans,
        groups: if standing { vec![GroupProposal { id: GroupId(1), members, standing: true }] } else { vec![] },
        robot: robot_proposal,
        expected_events: vec![],
        not_understood: vec![],
        notes: vec![],
        author: "test".into(),
    };
    Setup {
        location: location.clone(),
        proposal,
        paths: Paths { format: 1, robot, humans: ways, encounters, reasoning: String::new(), author: "test".into() },
        behaviors: Behaviors { format: 1, humans: trees, author: "test".into() },
        planner: "reference".parse().unwrap(),
        seed: 1,
        run: RunId::new("test").unwrap(),
        duration_s: None,
        robot: RobotModel::default(),
        waypoints: Waypoints::Via,
    }
}

/// Runs a setup with a planner of the catalog.
pub fn run(mut setup: Setup, planner: &str) -> Recording {
    setup.planner = planner.parse().unwrap();
    let graph = &setup.location.graph;
    let spot = |node: &NodeId| graph.node(node).map(|node| node.at);
    let mut mission = Mission {
        robot: setup.robot,
        grid: setup.location.grid.clone(),
        field: std::sync::Arc::new(socrates_maps::DistanceField::new(&setup.location.grid)),
        doors: setup.location.doors.clone(),
        route: graph.polyline(&setup.paths.robot),
        waypoints: match (setup.waypoints, setup.paths.robot.as_slice()) {
            (Waypoints::Ends, [first, .., last]) => [first, last].into_iter().filter_map(spot).collect::<Vec<Point>>(),
            (_, nodes) => nodes.iter().filter_map(spot).collect(),
        },
        script: setup.proposal.robot.script.clone(),
        groups: Vec::new(),
        seed: 1,
        encounters: setup
            .paths
            .encounters
            .iter()
            .rev()
            .filter_map(|meet| Some((meet.human, spot(&meet.node)?)))
            .collect(),
    };
    let engine = Engine::new(setup).unwrap();
    mission.field = engine.floor().field().clone();
    let mut driver = make(planner, &mission).unwrap();
    match driver.as_mut() {
        Some(driver) => engine.run(Some(driver.as_mut()), &mut |_, _| {}),
        None => engine.run(None, &mut |_, _| {}),
    }
}

/// Ways of the robot of 10 to 25 m between every few nodes.
pub fn ways(location: &Location, every: usize) -> Vec<Vec<NodeId>> {
    let nodes = location.graph.nodes();
    let outside = |id: &NodeId| location.door_of(id).is_none();
    let mut found = Vec::new();
    for (i, a) in nodes.iter().enumerate() {
        for (j, b) in nodes.iter().enumerate() {
            if i == j || (i * 31 + j * 17) % every != 0 || !outside(&a.id) || !outside(&b.id) {
                continue;
            }
            let Some(way) = location.graph.shortest(&a.id, &b.id) else { continue };
            if (10.0..25.0).contains(&location.graph.length_m(&way)) && way.len() >= 4 {
                found.push(way);
            }
        }
    }
    found
}

/// One human of each relation for a way of the robot, with the node of the encounter.
pub fn relations(location: &Location, way: &[NodeId]) -> Vec<(&'static str, Cast, NodeId)> {
    let mut all = Vec::new();
    let middle = way[way.len() / 2].clone();
    let back: Vec<NodeId> = way.iter().rev().cloned().collect();
    all.push(("frontal", Cast(Relation::Frontal, back, vec![]), middle.clone()));
    all.push(("behind", Cast(Relation::Behind, way.to_vec(), vec![]), middle.clone()));
    all.push(("ahead", Cast(Relation::Ahead, way[1..].to_vec(), vec![]), middle.clone()));
    all.push(("static", Cast(Relation::Static, vec![middle.clone()], vec![]), middle));
    let graph = &location.graph;
    for place in 1..way.len() - 1 {
        let around: Vec<NodeId> = graph.neighbors(&way[place]).iter().filter(|id| !way.contains(id)).cloned().collect();
        if let Some(side) = around.first() {
            let onward = around.get(1).cloned().unwrap_or_else(|| way[place + 1].clone());
            let mut path = vec![side.clone(), way[place].clone(), onward];
            let farther = graph.neighbors(side).iter().find(|id| **id != way[place] && !way.contains(id)).cloned();
            path.splice(0..0, farther);
            all.push(("crossing", Cast(Relation::Crossing, path, vec![]), way[place].clone()));
            break;
        }
    }
    all
}

/// What is known of a run.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// Everything that is wrong with it, in words.
    pub troubles: Vec<String>,
    /// Gaps of the encounters, s.
    pub gaps: Vec<f64>,
    /// Smallest gap between the robot and a person, surface to surface, m.
    pub closest_m: f64,
    /// Deepest overlap of two agents, m.
    pub overlap_m: f64,
}

/// Looks through a recording in which `met` encounters should happen within `loose_s`.
pub fn look_through(recording: &Recording, met: usize, loose_s: f64) -> Findings {
    let mut found = Findings { closest_m: f64::INFINITY, ..Findings::default() };
    let last = recording.tick(recording.ticks() - 1);
    if !recording.events.iter().any(|event| event.kind == EventKind::RobotArrived) {
        found.troubles.push(format!("not arrived, robot ends at {:.1} {:.1}", last[0].x, last[0].y));
    }
    for event in &recording.events {
        match &event.kind {
            EventKind::Contact { a, b, depth_m } => {
                found.troubles.push(format!("contact {a} {b} {depth_m:.3} at {}", event.time));
            }
            EventKind::Stuck { agent } => found.troubles.push(format!("{agent} stuck at {}", event.time)),
            EventKind::Encounter { human, gap_s, .. } => {
                found.gaps.push(*gap_s);
                if gap_s.abs() > loose_s {
                    found.troubles.push(format!("{human} gap {gap_s:.1}"));
                }
            }
            EventKind::Gesture { .. }
            | EventKind::StepEnded { .. }
            | EventKind::Leaf { .. }
            | EventKind::Sees { .. }
            | EventKind::WallContact { .. }
            | EventKind::Door { .. }
            | EventKind::Node { .. }
            | EventKind::RobotArrived
            | EventKind::End { .. } => {}
        }
    }
    if found.gaps.len() != met {
        found.troubles.push(format!("met {} of {met}", found.gaps.len()));
    }
    let radii: Vec<f64> = recording.header.agents.iter().map(|agent| agent.radius_m).collect();
    let robot = recording.header.agents.first().is_some_and(|agent| agent.role == "robot");
    for tick in 0..recording.ticks() {
        let states = recording.tick(tick);
        for (i, a) in states.iter().enumerate() {
            for (j, b) in states.iter().enumerate().skip(i + 1) {
                let gap = (a.point() - b.point()).norm() - radii[i] - radii[j];
                found.overlap_m = found.overlap_m.max(-gap);
                if robot && i == 0 {
                    found.closest_m = found.closest_m.min(gap);
                }
            }
        }
    }
    if found.overlap_m > 0.02 {
        found.troubles.push(format!("overlap by {:.3}", found.overlap_m));
    }
    found
}
