//! Runs of how everybody starts and ends: apart, at rest, and by whatever way the robot comes.

use socrates_model::{AgentId, AgentState, EventKind, FaultCode, Point, Polyline, Recording, Relation};

use crate::fixture::{Cast, Liner, carve, grouped, hall, location, run, setup};
use crate::run::Engine;
use crate::setup::Setup;

const NODES: [(&str, f64, f64); 4] = [("a", 2.0, 2.0), ("b", 2.0, 14.0), ("c", 24.0, 14.0), ("d", 24.0, 2.0)];
const EDGES: [(&str, &str); 3] = [("a", "b"), ("b", "c"), ("c", "d")];

fn told(recording: &Recording, kind: &EventKind) -> bool {
    recording.events.iter().any(|event| event.kind == *kind)
}

fn track(recording: &Recording, agent: AgentId) -> Vec<AgentState> {
    recording.track(agent).cloned().collect()
}

#[test]
fn a_robot_turns_back_before_a_person_who_stands_at_a_dead_end_of_its_way() {
    let nodes = [("a", 2.0, 4.0), ("b", 10.0, 4.0), ("end", 10.0, 12.0), ("c", 18.0, 4.0)];
    let place = location(
        carve(20.0, 14.0, &[(1.0, 3.0, 19.0, 5.0), (9.0, 3.0, 11.0, 13.0)]),
        &nodes,
        &[("a", "b"), ("b", "end"), ("b", "c")],
    );
    let robot = ["a", "b", "end", "b", "c"];
    let made = setup(place.clone(), &robot, &[Cast(Relation::Static, &["end"], vec![])], &[(1, "end")]);
    let (way, marks) = crate::intended_way(&made);
    let farthest = way.points().iter().map(|point| point.y).fold(0.0, f64::max);
    assert!((farthest - 10.8).abs() < 1e-9, "{farthest}");
    assert!((way.length_m() - (32.0 - 2.0 * 1.2)).abs() < 1e-9 && (marks[2].1 - 14.8).abs() < 1e-9, "{marks:?}");
    let alone = setup(place, &robot, &[Cast(Relation::Static, &["c"], vec![])], &[(1, "c")]);
    assert!((crate::intended_way(&alone).0.length_m() - 32.0).abs() < 1e-9);
}

#[test]
fn a_robot_that_goes_another_way_than_the_intended_one_arrives_and_is_not_stuck() {
    let made = setup(location(hall(28.0, 16.0), &NODES, &EDGES), &["a", "b", "c", "d"], &[], &[]);
    // Straight along the lower wall, where the intended way leads round by the upper one.
    let mut driver = Liner { way: Polyline::new(&[Point::new(2.0, 2.0), Point::new(24.0, 2.0)]), s: 0.0 };
    let recording = Engine::new(made).unwrap().run(Some(&mut driver), &mut |_, _| {});
    assert!(told(&recording, &EventKind::RobotArrived));
    assert!(!told(&recording, &EventKind::Stuck { agent: AgentId::Robot }));
}

#[test]
fn a_robot_that_circles_on_the_spot_is_stuck() {
    let made = setup(location(hall(28.0, 16.0), &NODES, &EDGES), &["a", "b", "c", "d"], &[], &[]);
    let circle: Vec<Point> = (0..400)
        .map(|step| {
            let (sin, cos) = libm::sincos(f64::from(step) * 0.25);
            Point::new(6.0 + sin, 6.0 - cos)
        })
        .collect();
    let mut driver = Liner { way: Polyline::new(&circle), s: 0.0 };
    let recording = Engine::new(made).unwrap().run(Some(&mut driver), &mut |_, _| {});
    assert!(told(&recording, &EventKind::Stuck { agent: AgentId::Robot }));
}

#[test]
fn a_group_and_those_who_walk_to_the_robots_goal_end_beside_it_and_beside_each_other() {
    for seed in 1..=4 {
        let made = setup(
            location(hall(28.0, 16.0), &NODES, &EDGES),
            &["a", "b", "c"],
            &[Cast(Relation::Crossing, &["d", "c"], vec![]), Cast(Relation::Crossing, &["d", "c"], vec![])],
            &[],
        );
        for made in [made.clone(), grouped(made)] {
            let recording = run(Setup { seed, ..made });
            let last = recording.tick(recording.ticks() - 1);
            for (place, human) in last.iter().enumerate().skip(1) {
                let off_m = (human.point() - Point::new(24.0, 14.0)).norm();
                assert!(off_m > 0.63, "seed {seed}: {} ends {off_m:.2} m from the goal", human.agent_id());
                for other in last.iter().skip(place + 1) {
                    let apart_m = (human.point() - other.point()).norm();
                    assert!(apart_m > 0.6, "seed {seed}: two end {apart_m:.2} m apart");
                }
            }
        }
    }
}

#[test]
fn a_group_at_its_end_stands_and_turns_to_nothing() {
    for seed in 1..=4 {
        let cast = || Cast(Relation::Frontal, &["c", "b"], vec![]);
        let made = setup(location(hall(28.0, 16.0), &NODES, &EDGES), &["b", "c"], &[cast(), cast(), cast()], &[]);
        let recording = run(Setup { seed, duration_s: Some(45.0), ..grouped(made) });
        for number in 0..=3 {
            let agent = AgentId::from_number(number);
            let states = track(&recording, agent);
            let late: Vec<&AgentState> = states.iter().skip(4000).collect();
            assert!(late.len() > 400, "the run is too short");
            let walked_m: f64 = late.windows(2).map(|pair| (pair[1].point() - pair[0].point()).norm()).sum();
            let turned: f64 = late.iter().map(|state| state.omega.abs() * 0.01).sum();
            assert!(walked_m < 0.01 && turned < 0.05, "seed {seed}: {agent} goes {walked_m:.3} m, turns {turned:.2}");
        }
    }
}

#[test]
fn for_whom_there_is_no_room_is_a_fault_and_who_finds_some_farther_off_starts_there() {
    // A closet with a node for everybody, and the same with an open door to a hall.
    let shut = carve(20.0, 8.0, &[(1.0, 1.0, 3.0, 3.0), (6.0, 1.0, 19.0, 7.0)]);
    let open = carve(20.0, 8.0, &[(1.0, 1.0, 3.0, 3.0), (3.0, 1.4, 6.0, 2.6), (6.0, 1.0, 19.0, 7.0)]);
    let nodes = [("in", 2.0, 2.0), ("a", 8.0, 4.0), ("b", 17.0, 4.0)];
    let crowd: Vec<Cast<'_>> = (0..14).map(|_| Cast(Relation::Static, &["in"][..], vec![])).collect();
    let made = |grid| setup(location(grid, &nodes, &[("a", "b"), ("in", "a")]), &["a", "b"], &crowd, &[]);
    let faults = Engine::new(made(shut)).err().unwrap();
    assert!(faults.iter().all(|fault| fault.code == FaultCode::GColl), "{faults:?}");
    let text = faults[0].message.to_string();
    assert!(text.contains("`in` at (2.0, 2.0)") && text.contains("0.56 m"), "{text}");
    let recording = run(Setup { duration_s: Some(1.0), ..made(open) });
    let first = recording.tick(0);
    for (place, one) in first.iter().enumerate() {
        for other in first.iter().skip(place + 1) {
            let apart_m = (one.point() - other.point()).norm();
            assert!(apart_m > 0.6, "{} and {} start {apart_m:.2} m apart", one.agent_id(), other.agent_id());
        }
    }
}
