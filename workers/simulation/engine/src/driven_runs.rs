//! Whole runs in which a person is driven from outside.

use std::collections::BTreeMap;

use socrates_model::recording::DRIVEN_LEAF;
use socrates_model::{
    AgentId, Command, EventKind, Gesture, HumanId, Keeper, Observation, Point, Recording, Relation, RobotDriver, Vector,
};

use crate::drive::Drivers;
use crate::fixture::{Cast, Liner, hall, location, setup};
use crate::gait::{A_MAX, TURN_WALKING, V_MAX};
use crate::models::HumanModel;
use crate::run::Engine;
use crate::setup::Setup;

const ONE: HumanId = HumanId::new(1);

/// A robot from west to east, somebody who would come toward it, and somebody who stands in the north.
fn made() -> Setup {
    let nodes = [("w", 2.0, 6.0), ("c", 10.0, 6.0), ("e", 18.0, 6.0), ("n", 10.0, 11.0)];
    let place = location(hall(20.0, 12.0), &nodes, &[("w", "c"), ("c", "e"), ("n", "c")]);
    let cast = [Cast(Relation::Frontal, &["e", "c", "w"], vec![]), Cast(Relation::Static, &["n"], vec![])];
    Setup { duration_s: Some(12.0), ..setup(place, &["w", "c", "e"], &cast, &[(1, "c")]) }
}

/// A person's driver: a function of what is seen, and everything that was seen.
struct Person<F> {
    act: F,
    steps: Vec<f64>,
    gone_after: usize,
}

impl<F: FnMut(&Observation<'_>) -> Command> RobotDriver for Person<F> {
    fn rate_hz(&self) -> f64 {
        10.0
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        self.steps.push(seen.time.secs());
        (self.act)(seen)
    }

    fn is_gone(&self) -> bool {
        self.steps.len() > self.gone_after
    }
}

fn person<F: FnMut(&Observation<'_>) -> Command>(act: F) -> Person<F> {
    Person { act, steps: Vec::new(), gone_after: usize::MAX }
}

/// The run with a driver for the first person; the robot drives along its line.
fn run(made: Setup, driver: &mut dyn RobotDriver) -> Recording {
    let mut robot = Liner::of(&made);
    let models = BTreeMap::from([(ONE, HumanModel::Driven)]);
    let engine = Engine::new(made).unwrap().with_models(&models).unwrap();
    let mut keeper = Keeper::default();
    let mut drivers = Drivers { robot: Some(&mut robot), ..Drivers::default() };
    drivers.people.insert(ONE, driver);
    engine.play(drivers, &mut keeper);
    keeper.recording().unwrap()
}

/// The command that leads to a point, as fast as this.
fn to(seen: &Observation<'_>, goal: Point, mps: f64) -> Command {
    let way = goal - seen.pose.point();
    let way = way * (mps.min(2.0 * way.norm()) / way.norm().max(1e-9));
    let (sin, cos) = seen.pose.yaw.sin_cos();
    Command { v: cos * way.x + sin * way.y, vy: cos * way.y - sin * way.x, ..Command::default() }
}

fn at(recording: &Recording, tick: usize, agent: usize) -> Point {
    recording.tick(tick)[agent].point()
}

#[test]
fn somebody_who_is_driven_goes_where_their_driver_says_and_the_same_again() {
    let spot = Point::new(14.0, 9.5);
    let mut driver = person(|seen| to(seen, spot, 1.2));
    let recording = run(made(), &mut driver);
    let last = recording.ticks() - 1;
    assert!((at(&recording, last, 1) - spot).norm() < 0.05, "{:?}", at(&recording, last, 1));
    assert_eq!(driver.steps.len(), 121, "ten times a second");
    assert_eq!(run(made(), &mut person(|seen| to(seen, spot, 1.2))).hash(), recording.hash());
    // By themselves they come toward the robot.
    let own = crate::fixture::run(made());
    assert!((at(&own, last, 1) - spot).norm() > 3.0);
    let leaf = recording.header.leaves.iter().position(|leaf| leaf == DRIVEN_LEAF).unwrap();
    assert!((0..=last).all(|tick| usize::from(recording.tick(tick)[1].leaf()) == leaf));
    assert!((0..=last).all(|tick| usize::from(recording.tick(tick)[2].leaf()) != leaf));
    let leaves =
        recording.events.iter().filter(|event| matches!(&event.kind, EventKind::Leaf { human, .. } if *human == ONE));
    assert_eq!(leaves.count(), 1, "no tree of theirs runs");
    assert_eq!(own.header.leaves.iter().position(|leaf| leaf == DRIVEN_LEAF), None);
}

#[test]
fn nobody_is_driven_faster_than_people_are_nor_through_walls_or_bodies() {
    for (told, heading) in [
        (Command { v: 1e300, vy: f64::NAN, omega: 1e300, ..Command::default() }, "turning"),
        (Command { v: 50.0, ..Command::default() }, "ahead"),
        (Command { vy: -50.0, ..Command::default() }, "aside"),
    ] {
        let recording = run(made(), &mut person(|_| told));
        let mut before = (0.0, 0.0);
        for tick in 0..recording.ticks() {
            let states = recording.tick(tick);
            let (speed, omega) = (states[1].speed(), states[1].omega);
            assert!(speed <= V_MAX + 1e-9 && omega <= TURN_WALKING + 1e-9, "{heading}: {speed} {omega}");
            assert!(speed - before.0 <= A_MAX * 0.01 + 1e-9 && omega - before.1 <= 0.5 + 1e-9, "{heading}");
            before = (speed, omega);
            let inside = |value: f64, most: f64| value > 0.1 + 0.28 - 0.02 && value < most - 0.1 - 0.28 + 0.02;
            assert!(inside(states[1].x, 20.0) && inside(states[1].y, 12.0), "{heading}: {:?}", states[1].point());
            for other in [0, 2] {
                let reach = recording.header.agents[other].radius_m + 0.28;
                assert!((states[1].point() - states[other].point()).norm() > reach - 0.02, "{heading} at {tick}");
            }
        }
        assert!(before.0.is_finite());
    }
    // Straight at the robot: they touch, and neither gets through.
    let recording = run(made(), &mut person(|seen| to(seen, seen.robot.unwrap().at, 1.5)));
    let touched = recording.events.iter().any(|event| {
        matches!(&event.kind, EventKind::Contact { a, b, .. } if [*a, *b].contains(&AgentId::Robot) && [*a, *b].contains(&ONE.into()))
    });
    assert!(touched);
}

#[test]
fn a_driver_sees_the_robot_and_others_where_the_person_looks_and_not_the_person() {
    let mut seen_at = Vec::new();
    // They stand for 1 s, then turn round on the spot.
    let mut driver = person(|seen: &Observation<'_>| {
        let robot = seen.robot.unwrap();
        seen_at.push((seen.pose.yaw, robot.in_sight, robot.at - seen.pose.point()));
        assert_eq!(seen.everybody.call_count(), [HumanId::new(2)]);
        assert!(seen.people.iter().all(|other| other.id == HumanId::new(2)));
        let ahead = (seen.lidar)()[0];
        assert!(ahead > 1.0, "their own body is not in their scan: {ahead}");
        Command { omega: if seen.time.secs() < 1.0 { 0.0 } else { 1.0 }, waiting: true, ..Command::default() }
    });
    run(Setup { duration_s: Some(8.0), ..made() }, &mut driver);
    for (yaw, in_sight, way) in &seen_at {
        let off = socrates_model::geometry::wrap_angle(way.y.atan2(way.x) - yaw).abs().to_degrees();
        if (off - 100.0).abs() > 2.0 {
            assert_eq!(*in_sight, off < 100.0, "{off}");
        }
    }
    assert!(seen_at.iter().any(|(_, in_sight, _)| *in_sight) && seen_at.iter().any(|(_, in_sight, _)| !in_sight));
}

/// Who is everywhere, by a call.
trait CallCount {
    fn call_count(&self) -> Vec<HumanId>;
}

impl CallCount for &dyn Fn() -> Vec<socrates_model::SeenPerson> {
    fn call_count(&self) -> Vec<HumanId> {
        self().iter().map(|person| person.id).collect()
    }
}

#[test]
fn a_gesture_of_a_driven_person_is_told_held_for_two_seconds_and_seen_by_the_robot() {
    let mut driver = person(|seen: &Observation<'_>| {
        let gesture = ((2.95..3.05).contains(&seen.time.secs())).then_some(Gesture::Wait);
        Command { gesture, waiting: true, ..Command::default() }
    });
    let recording = run(made(), &mut driver);
    let mut told = Vec::new();
    for event in &recording.events {
        if let EventKind::Gesture { agent: AgentId::Human(ONE), gesture, .. } = &event.kind {
            told.push((event.time.secs(), *gesture));
        }
    }
    assert_eq!(told, [(3.0, Some(Gesture::Wait)), (5.0, None)]);
    assert_eq!(recording.tick(400)[1].gesture(), Some(Gesture::Wait));
}

#[test]
fn a_driver_that_is_gone_ends_the_run() {
    let mut driver = Person { gone_after: 30, ..person(|_| Command::default()) };
    let recording = run(made(), &mut driver);
    assert_eq!(recording.ticks(), 301);
    let end = recording.events.last().unwrap();
    assert!(matches!(&end.kind, EventKind::End { reason } if reason == "driver"), "{end:?}");
}

#[test]
fn somebody_who_stands_on_purpose_does_not_hold_up_the_end_of_a_run() {
    let end = |waiting| {
        let stands = move |seen: &Observation<'_>| match seen.time.secs() < 2.0 {
            true => to(seen, Point::new(18.0, 3.0), 1.5),
            false => Command { waiting, ..Command::default() },
        };
        let recording = run(Setup { duration_s: None, ..made() }, &mut person(stands));
        recording.events.last().unwrap().time.secs()
    };
    let (waits, stands) = (end(true), end(false));
    assert!(waits + 5.0 < stands, "{waits} {stands}");
}

#[test]
fn somebody_who_is_to_be_driven_and_has_no_driver_stands() {
    let models = BTreeMap::from([(ONE, HumanModel::Driven)]);
    let engine = Engine::new(made()).unwrap().with_models(&models).unwrap();
    let recording = engine.run(None, &mut |_, _| {});
    let moved: Vector = at(&recording, recording.ticks() - 1, 1) - at(&recording, 0, 1);
    assert!(moved.norm() < 1e-9);
    let nobody = BTreeMap::from([(HumanId::new(7), HumanModel::Driven)]);
    let faults = Engine::new(made()).unwrap().with_models(&nobody).unwrap_err();
    assert!(faults[0].message.to_string().contains("human_7 is not in the proposal; it has human_1, human_2"));
}
