//! Runs in aisles where two get past each other only if one makes room.

use socrates_model::{AgentId, EventKind, Recording, Relation};

use crate::fixture::{Cast, Liner, carve, location, setup};
use crate::run::Engine;
use crate::setup::Setup;

/// An aisle of this width along x, with wider places around x = 9 and x = 20.
fn aisle(width_m: f64, bays: bool) -> socrates_model::Location {
    let (low, high) = (3.0 - width_m / 2.0, 3.0 + width_m / 2.0);
    let mut free = vec![(0.1, low, 29.9, high)];
    if bays {
        free.extend([(8.2, 1.2, 9.8, 4.8), (19.2, 1.2, 20.8, 4.8)]);
    }
    location(
        carve(30.0, 6.0, &free),
        &[("a", 2.0, 3.0), ("b", 9.0, 3.0), ("c", 14.5, 3.0), ("d", 20.0, 3.0), ("e", 28.0, 3.0)],
        &[("a", "b"), ("b", "c"), ("c", "d"), ("d", "e")],
    )
}

const THERE: &[&str] = &["a", "b", "c", "d", "e"];
const BACK: &[&str] = &["e", "d", "c", "b", "a"];

fn alone(made: Setup) -> Recording {
    Engine::new(Setup { planner: "none".parse().unwrap(), duration_s: Some(70.0), ..made })
        .unwrap()
        .run(None, &mut |_, _| {})
}

fn ends(recording: &Recording) -> Vec<f64> {
    let count = u32::try_from(recording.header.agents.len()).unwrap();
    (1..=count).map(|n| recording.track(AgentId::from_number(n)).last().unwrap().x).collect()
}

#[test]
fn two_people_get_past_each_other_in_an_aisle() {
    for (width_m, bays) in [(1.4, true), (1.2, true), (2.0, false)] {
        for seed in 1..=4 {
            let cast = [Cast(Relation::Frontal, THERE, vec![]), Cast(Relation::Frontal, BACK, vec![])];
            let made = setup(aisle(width_m, bays), &["a", "b"], &cast, &[]);
            let recording = alone(Setup { seed, ..made });
            let ends = ends(&recording);
            assert!(ends[0] > 27.0 && ends[1] < 3.0, "{width_m} m, bays {bays}, seed {seed}: {ends:?}");
            let stuck = recording.events.iter().any(|event| matches!(event.kind, EventKind::Stuck { .. }));
            assert!(!stuck, "{width_m} m, bays {bays}, seed {seed}");
        }
    }
}

#[test]
fn three_against_two_get_past_each_other_in_an_aisle() {
    for seed in 1..=4 {
        let cast: Vec<Cast<'_>> = [THERE, &THERE[1..], &BACK[1..], BACK, &THERE[2..]]
            .into_iter()
            .map(|way| Cast(Relation::Frontal, way, vec![]))
            .collect();
        let recording = alone(Setup { seed, ..setup(aisle(1.4, true), &["a", "b"], &cast, &[]) });
        let ends = ends(&recording);
        assert!([0, 1, 4].iter().all(|i| ends[*i] > 24.0), "seed {seed}: {ends:?}");
        assert!([2, 3].iter().all(|i| ends[*i] < 6.0), "seed {seed}: {ends:?}");
    }
}

#[test]
fn a_person_without_a_rule_lets_the_robot_through_in_an_aisle() {
    for seed in 1..=4 {
        let cast = [Cast(Relation::Frontal, BACK, vec![])];
        let made = setup(aisle(1.4, true), THERE, &cast, &[(1, "c")]);
        let mut driver = Liner::of(&made);
        let recording =
            Engine::new(Setup { seed, duration_s: Some(90.0), ..made }).unwrap().run(Some(&mut driver), &mut |_, _| {});
        assert!(recording.events.iter().any(|event| event.kind == EventKind::RobotArrived), "seed {seed}");
        assert!(recording.track(AgentId::from_number(1)).last().unwrap().x < 3.0, "seed {seed}");
    }
}
