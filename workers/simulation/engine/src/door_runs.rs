//! Whole runs with doors: opened by time, by who comes, by events; seen by everybody; told when they change.

use socrates_model::{
    Action, AgentId, Command, Door, DoorKind, DoorOpens, EventKind, Gesture, Observation, Point, Recording, Relation,
    RobotDriver, Rule, Trigger,
};

use crate::fixture::{Cast, Liner, carve, location, setup};
use crate::run::Engine;
use crate::setup::Setup;

/// A corridor along x with a door across it at x = 10.
fn corridor(opens: DoorOpens, rules: Vec<Rule>) -> Setup {
    let mut place = location(
        carve(20.0, 3.0, &[(0.1, 0.4, 19.9, 2.6)]),
        &[("a", 2.0, 1.5), ("b", 7.0, 1.5), ("c", 13.0, 1.5), ("d", 18.0, 1.5)],
        &[("a", "b"), ("b", "c"), ("c", "d")],
    );
    place.doors.push(Door {
        id: "gate".into(),
        kind: DoorKind::Room,
        from: Point::new(10.0, 0.3),
        to: Point::new(10.0, 2.7),
        opens,
        hold_s: 3.0,
        inside: vec![],
    });
    let cast = [Cast(Relation::Frontal, &["d", "c", "b"], rules)];
    Setup { duration_s: Some(25.0), ..setup(place, &["a", "b"], &cast, &[]) }
}

/// A driver that keeps what it saw of the first door at each call: whether open, and how far along x the beams along the corridor go.
struct Looker {
    liner: Liner,
    seen: Vec<(f64, bool, f64)>,
}

impl RobotDriver for Looker {
    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let scan = (seen.lidar)();
        let along = |beam: usize| (seen.pose.yaw + (beam as f64).to_radians()).cos();
        let hits =
            (0..scan.len()).filter(|beam| along(*beam) > 0.985).map(|beam| seen.pose.x + scan[beam] * along(beam));
        self.seen.push((seen.time.secs(), seen.doors[0].open, hits.fold(0.0, f64::max)));
        self.liner.drive(seen)
    }
}

fn run(made: Setup) -> (Recording, Vec<(f64, bool, f64)>) {
    let mut driver = Looker { liner: Liner::of(&made), seen: Vec::new() };
    let recording = Engine::new(made).unwrap().run(Some(&mut driver), &mut |_, _| {});
    (recording, driver.seen)
}

/// Times at which the door opens and closes, s.
fn changes(recording: &Recording) -> Vec<(f64, bool)> {
    let door = |event: &socrates_model::Event| {
        if let EventKind::Door { open, .. } = &event.kind { Some((event.time.secs(), *open)) } else { None }
    };
    recording.events.iter().filter_map(door).collect()
}

/// Nobody is on the door line while it is shut, and it is seen by sight, lidar and planner alike.
fn everybody_agrees(recording: &Recording, seen: &[(f64, bool, f64)]) {
    let changes = changes(recording);
    let open_at = |now: f64| changes.iter().rev().find(|(at, _)| *at <= now + 1e-9).is_some_and(|(_, open)| *open);
    let human = AgentId::from_number(1);
    for state in recording.track(human) {
        let now = state.tick as f64 * 0.01;
        if !open_at(now) {
            assert!((state.x - 10.0).abs() > 0.27, "in the shut door at {now}");
        }
    }
    for (now, open, hit) in seen {
        assert_eq!(*open, open_at(*now), "at {now}");
        assert!(*open || *hit < 10.001, "the beam ends at {hit} behind the shut door at {now}");
    }
    let seen_at = recording.events.iter().find(|event| matches!(event.kind, EventKind::Sees { .. }));
    assert!(seen_at.is_none_or(|event| open_at(event.time.secs())), "seen through the shut door");
}

#[test]
fn who_waits_before_a_door_goes_in_once_it_is_open_and_everybody_is_out() {
    let mut made = corridor(DoorOpens::RobotNear(4.0), vec![]);
    made.location.doors[0].inside = vec![crate::fixture::id("c"), crate::fixture::id("d")];
    let place = made.location.clone();
    let cast = [Cast(Relation::Static, &["b", "c", "d"], vec![]), Cast(Relation::Leaving, &["c", "b", "a"], vec![])];
    made = Setup { duration_s: Some(40.0), ..setup(place, &["a", "b"], &cast, &[(1, "b")]) };
    let (recording, _) = run(made);
    let opened = changes(&recording).first().map(|(at, _)| *at).unwrap();
    let crosses = |number: u32, inward: bool| {
        let mut states = recording.track(AgentId::from_number(number));
        states.find(|state| if inward { state.x > 10.0 } else { state.x < 10.0 }).map(|s| s.tick as f64 * 0.01)
    };
    let (into, out) = (crosses(1, true).unwrap(), crosses(2, false).unwrap());
    assert!(opened < out && out < into, "open at {opened}, out at {out}, in at {into}");
}

#[test]
fn a_door_opens_at_its_time_and_closes_when_nobody_is_near() {
    let (recording, seen) = run(corridor(DoorOpens::AtTimes(vec![8.0]), vec![]));
    everybody_agrees(&recording, &seen);
    let changes = changes(&recording);
    assert_eq!(changes.len(), 2, "{changes:?}");
    assert!((changes[0].0 - 8.0).abs() < 0.011 && changes[0].1 && !changes[1].1);
    let last = recording.track(AgentId::from_number(1)).last().unwrap();
    assert!(last.x < 9.0, "goes through once it is open, ends at {}", last.x);
    assert!(seen.iter().any(|(_, open, hit)| *open && *hit > 10.5), "the open door lets beams through");
}

#[test]
fn a_door_opens_for_whoever_comes_near_and_not_for_the_robot_of_another() {
    let (recording, seen) = run(corridor(DoorOpens::Near(1.5), vec![]));
    everybody_agrees(&recording, &seen);
    let opened = changes(&recording)[0].0;
    let at = recording.track(AgentId::from_number(1)).nth((opened * 100.0).round() as usize).unwrap();
    assert!((at.x - 10.0).abs() < 1.6 && at.x > 10.0, "opened for somebody at {}", at.x);
    let (recording, seen) = run(corridor(DoorOpens::RobotNear(1.5), vec![]));
    everybody_agrees(&recording, &seen);
    assert!(changes(&recording).is_empty() && recording.track(AgentId::from_number(1)).last().unwrap().x > 10.2);
}

#[test]
fn a_gesture_of_somebody_at_the_door_opens_it_and_the_same_far_away_does_not() {
    let says = |secs: f64| Rule {
        when: vec![Trigger::AfterSecs(secs)],
        act: Action::StandStill,
        gesture: Some(Gesture::Proceed),
        for_s: Some(1.0),
        latched: true,
        ..Rule::default()
    };
    let (recording, seen) = run(corridor(DoorOpens::OnEvent("PROCEED".into()), vec![says(8.0)]));
    everybody_agrees(&recording, &seen);
    let told = recording.events.iter().find(|event| matches!(event.kind, EventKind::Gesture { .. })).unwrap();
    let opened = changes(&recording)[0];
    assert!((opened.0 - told.time.secs() - 0.01).abs() < 1e-9 && opened.1, "{opened:?} after {}", told.time);
    // In its first second it is still 8 m away.
    let (recording, _) = run(corridor(DoorOpens::OnEvent("PROCEED".into()), vec![says(0.5)]));
    assert!(changes(&recording).is_empty());
}

#[test]
fn a_node_that_is_reached_and_another_door_open_doors_without_a_spot() {
    let mut made = corridor(DoorOpens::OnEvent("node b".into()), vec![]);
    let mut second = made.location.doors[0].clone();
    second.id = "far".into();
    (second.from.x, second.to.x) = (16.0, 16.0);
    second.opens = DoorOpens::OnEvent("door gate opens".into());
    made.location.doors.push(second);
    let (recording, _) = run(made);
    let opened: Vec<&str> = recording
        .events
        .iter()
        .filter_map(
            |event| {
                if let EventKind::Door { door, open: true } = &event.kind { Some(door.as_str()) } else { None }
            },
        )
        .collect();
    assert_eq!(opened, ["gate", "far"]);
}

#[test]
fn a_door_that_never_opens_holds_and_one_that_always_stands_open_is_no_door() {
    let (recording, seen) = run(corridor(DoorOpens::Never, vec![]));
    everybody_agrees(&recording, &seen);
    assert!(recording.track(AgentId::from_number(1)).all(|state| state.x > 10.2));
    let (recording, _) = run(corridor(DoorOpens::Always, vec![]));
    assert!(changes(&recording).is_empty());
    assert!(recording.track(AgentId::from_number(1)).last().unwrap().x < 9.0);
}
