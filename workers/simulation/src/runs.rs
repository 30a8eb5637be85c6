//! Whole runs on the shipped locations with the reference robot: an elevator, a group, the same setup twice.

use std::collections::BTreeMap;

use crate::{Summary, setup, simulate};
use socrates_engine::Setup;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{
    Action, Behaviors, Encounter, EventKind, GroupId, GroupProposal, HumanBehavior, HumanId, HumanProposal, Location,
    NodeId, Paths, PlaceClass, Proposal, Recording, Relation, RobotProposal, Rule, RunId, Trigger,
};

/// One human: relation, path, rules.
struct Cast(Relation, Vec<NodeId>, Vec<Rule>);

fn scenario(
    location: &Location,
    robot: Vec<NodeId>,
    cast: Vec<Cast>,
    meet: &[NodeId],
    script: Vec<RobotRule>,
    standing: bool,
) -> Setup {
    let mut humans = Vec::new();
    let mut ways = BTreeMap::new();
    let mut trees = BTreeMap::new();
    let mut encounters = Vec::new();
    for (number, (Cast(relation, path, rules), node)) in (1_u32..).zip(cast.into_iter().zip(meet)) {
        let id = HumanId::new(number);
        let tree = socrates_bt::compile(id, &rules).unwrap();
        trees.insert(id, HumanBehavior { tree, description: String::new() });
        ways.insert(id, path);
        encounters.push(Encounter { human: id, node: node.clone() });
        humans.push(HumanProposal {
            id,
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
    let proposal = Proposal {
        format: 1,
        title: String::new(),
        description: String::new(),
        pattern: "free".into(),
        place: PlaceClass::Corridor,
        humans,
        groups: if standing { vec![GroupProposal { id: GroupId(1), members, standing: true }] } else { vec![] },
        robot: RobotProposal { task: "go".into(), start: None, goal: None, script, expected_behavior: String::new() },
        expected_events: vec![],
        not_understood: vec![],
        notes: vec![],
        author: "test".into(),
    };
    let paths = Paths { format: 1, robot, humans: ways, encounters, reasoning: String::new(), author: "test".into() };
    let behaviors = Behaviors { format: 1, humans: trees, author: "test".into() };
    setup(location.clone(), proposal, paths, behaviors, None, RunId::new("test").unwrap(), 1)
}

/// Everything that is wrong with a run, in words.
fn troubles(recording: &Recording, met: usize, loose_s: f64) -> Vec<String> {
    let summary = Summary::of(recording);
    let mut found = Vec::new();
    if summary.robot_arrived_s.is_none() {
        let last = recording.tick(recording.ticks() - 1)[0];
        found.push(format!("not arrived ({}), robot ends at {:.1} {:.1}", summary.end, last.x, last.y));
    }
    if summary.encounter_gaps_s.len() != met {
        found.push(format!("met {} of {met}", summary.encounter_gaps_s.len()));
    }
    for (human, gap) in &summary.encounter_gaps_s {
        if gap.abs() > loose_s {
            found.push(format!("{human} gap {gap:.1}"));
        }
    }
    for event in &recording.events {
        match &event.kind {
            EventKind::Contact { a, b, depth_m } => {
                found.push(format!("contact {a} {b} {depth_m:.3} at {}", event.time))
            }
            EventKind::Stuck { agent } => found.push(format!("{agent} stuck at {}", event.time)),
            EventKind::Gesture { .. }
            | EventKind::Leaf { .. }
            | EventKind::StepEnded { .. }
            | EventKind::Sees { .. }
            | EventKind::Encounter { .. }
            | EventKind::WallContact { .. }
            | EventKind::Door { .. }
            | EventKind::Node { .. }
            | EventKind::RobotArrived
            | EventKind::End { .. } => {}
        }
    }
    let radii: Vec<f64> = recording.header.agents.iter().map(|agent| agent.radius_m).collect();
    let mut worst: f64 = 0.0;
    for tick in 0..recording.ticks() {
        let states = recording.tick(tick);
        for (i, a) in states.iter().enumerate() {
            worst = worst.max(a.speed() - 2.0);
            for (j, b) in states.iter().enumerate().skip(i + 1) {
                worst = worst.max(radii[i] + radii[j] - (a.point() - b.point()).norm());
            }
        }
    }
    if worst > 0.02 {
        found.push(format!("overlap or speed by {worst:.3}"));
    }
    found
}

/// Ways of the robot of 10 to 25 m between every few nodes.
fn ways(location: &Location, every: usize) -> Vec<Vec<NodeId>> {
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

/// The first way of the office, on which somebody comes toward the robot.
pub(crate) fn one_frontal() -> Setup {
    let location = socrates_maps::shipped::load("office").unwrap();
    let way = ways(&location, 37).swap_remove(0);
    let (_, cast, node) = relations(&location, &way).swap_remove(0);
    scenario(&location, way, cast, &[node], vec![], false)
}

fn relations(location: &Location, way: &[NodeId]) -> Vec<(&'static str, Vec<Cast>, NodeId)> {
    let mut all = Vec::new();
    let middle = way[way.len() / 2].clone();
    let back: Vec<NodeId> = way.iter().rev().cloned().collect();
    all.push(("frontal", vec![Cast(Relation::Frontal, back, vec![])], middle.clone()));
    all.push(("behind", vec![Cast(Relation::Behind, way.to_vec(), vec![])], middle.clone()));
    all.push(("ahead", vec![Cast(Relation::Ahead, way[1..].to_vec(), vec![])], middle.clone()));
    all.push(("static", vec![Cast(Relation::Static, vec![middle.clone()], vec![])], middle));
    for place in 1..way.len() - 1 {
        let around: Vec<NodeId> =
            location.graph.neighbors(&way[place]).iter().filter(|id| !way.contains(id)).cloned().collect();
        if let Some(side) = around.first() {
            let onward = around.get(1).cloned().unwrap_or_else(|| way[place + 1].clone());
            let mut path = vec![side.clone(), way[place].clone(), onward];
            if let Some(far) =
                location.graph.neighbors(side).iter().find(|id| **id != way[place] && !way.contains(id)).cloned()
            {
                path.insert(0, far);
            }
            all.push(("crossing", vec![Cast(Relation::Crossing, path, vec![])], way[place].clone()));
            break;
        }
    }
    all
}

fn startled() -> Rule {
    Rule {
        when: vec![Trigger::RobotVisible(6.0)],
        act: Action::LookAtRobot,
        gesture: None,
        for_s: Some(8.0),
        latched: true,
        ..Rule::default()
    }
}

#[test]
fn in_the_hospital_two_leave_the_car_one_stays_and_the_robot_enters_last() {
    let location = socrates_maps::shipped::load("hospital").unwrap();
    let doors: Vec<_> = location.doors.iter().filter(|door| door.kind == socrates_model::DoorKind::Elevator).collect();
    assert!(!doors.is_empty());
    for door in doors {
        let inside = door.inside.clone();
        let entry = inside
            .iter()
            .find(|id| location.graph.neighbors(id).iter().any(|other| !inside.contains(other)))
            .unwrap()
            .clone();
        let deep = inside.iter().find(|id| **id != entry).cloned().unwrap_or_else(|| entry.clone());
        let far = location
            .graph
            .nodes()
            .iter()
            .filter(|node| location.door_of(&node.id).is_none())
            .filter_map(|node| {
                let way = location.graph.shortest(&node.id, &entry)?;
                let length = location.graph.length_m(&way);
                (10.0..20.0).contains(&length).then_some(way)
            })
            .next()
            .unwrap();
        let out: Vec<NodeId> = far.iter().rev().cloned().collect();
        let lobby = out[1].clone();
        let aside: Vec<NodeId> =
            location.graph.neighbors(&lobby).iter().filter(|id| location.door_of(id).is_none()).cloned().collect();
        let exit = |k: usize| {
            let mut path = vec![entry.clone(), lobby.clone()];
            path.extend(aside.get(k % aside.len()).cloned());
            if k.is_multiple_of(aside.len()) && deep != entry {
                path.insert(0, deep.clone());
            }
            path
        };
        let cast = vec![
            Cast(Relation::Leaving, exit(0), vec![]),
            Cast(Relation::Leaving, exit(1), vec![]),
            Cast(Relation::Staying, vec![deep.clone()], vec![startled()]),
        ];
        let wait = RobotRule { when: RobotWhen::Start, act: RobotDo::WaitForLeavers };
        let made = scenario(&location, far, cast, &[lobby.clone(), lobby, entry], vec![wait], false);
        let recording = simulate(made, &"reference".parse().unwrap()).unwrap();
        for event in &recording.events {
            println!("{} {:?}", event.time, event.kind);
        }
        let (inner, depth) = (location.graph.node(&deep).unwrap().at, |tick: usize, place: usize| {
            door.depth_m(&recording.tick(tick)[place].point(), &location.graph.node(&deep).unwrap().at)
        });
        assert!(door.depth_m(&inner, &inner) > 0.0);
        let last = recording.ticks() - 1;
        assert!((1..=3).all(|place| depth(0, place) > 0.28));
        assert!(
            depth(last, 1) < -1.5 && depth(last, 2) < -1.5,
            "leavers end {} and {}",
            depth(last, 1),
            depth(last, 2)
        );
        assert!((0..=last).all(|tick| depth(tick, 3) > 0.0), "the third stays");
        let crosses = |place: usize| {
            (0..=last).rev().find(|tick| (depth(*tick, place) > 0.0) != (depth(last, place) > 0.0)).unwrap_or(0)
        };
        let (first, second, robot) = (crosses(1).min(crosses(2)), crosses(1).max(crosses(2)), crosses(0));
        assert!(depth(last, 0) > 0.0, "the robot ends in the car");
        assert!(robot > second, "leavers out at ticks {first} and {second}, the robot in at {robot}");
        assert!((50..=500).contains(&(second - first)), "one after the other: {first} {second}");
        assert!(
            troubles(&recording, 3, 9.0)
                .iter()
                .all(|trouble| !trouble.contains("contact") && !trouble.contains("overlap")),
            "{:?}",
            troubles(&recording, 3, 9.0)
        );
    }
}

#[test]
fn the_same_setup_gives_the_same_hash_and_an_unknown_planner_the_list() {
    let location = socrates_maps::shipped::load("office").unwrap();
    let way = ways(&location, 37).remove(0);
    let make = || {
        let (_, cast, node) = relations(&location, &way).remove(0);
        scenario(&location, way.clone(), cast, &[node], vec![], false)
    };
    let hash = simulate(make(), &"reference".parse().unwrap()).unwrap().hash();
    assert_eq!(hash, simulate(make(), &"reference".parse().unwrap()).unwrap().hash());
    assert_ne!(hash, simulate(make(), &"reactive".parse().unwrap()).unwrap().hash());
    assert_eq!(simulate(make(), &"none".parse().unwrap()).unwrap().header.agents.len(), 1);
    let faults = simulate(make(), &"nav9".parse().unwrap()).unwrap_err();
    assert!(faults[0].message.to_string().contains(&socrates_planners::names().join(", ")));
}

#[test]
fn a_group_of_four_is_passed_without_going_through_it() {
    let location = socrates_maps::shipped::load("warehouse").unwrap();
    let graph = &location.graph;
    let mut tried = 0;
    for way in ways(&location, 3) {
        let Some(node) = way[1..way.len() - 1].iter().find(|id| graph.node_is(id, PlaceClass::OpenArea)) else {
            continue;
        };
        let cast = (0..4).map(|_| Cast(Relation::Static, vec![node.clone()], vec![])).collect();
        let meet = vec![node.clone(); 4];
        let made = scenario(&location, way.clone(), cast, &meet, vec![], true);
        let recording = simulate(made, &"reference".parse().unwrap()).unwrap();
        let found: Vec<String> = troubles(&recording, 4, 1.5)
            .into_iter()
            .filter(|trouble| !trouble.contains("gap") && !trouble.contains("met"))
            .collect();
        println!("{} → {} at {node}: {found:?}", way[0], way[way.len() - 1]);
        let start = recording.tick(0);
        for state in &start[1..] {
            let nearest = start[1..]
                .iter()
                .filter(|o| o.agent != state.agent)
                .map(|o| (o.point() - state.point()).norm())
                .fold(9.0, f64::min);
            assert!((0.8..=1.4).contains(&nearest));
        }
        assert!(found.is_empty(), "{found:?}");
        tried += 1;
        if tried == 6 {
            break;
        }
    }
    assert!(tried > 0, "no way through open floor");
}
