//! Runs that test where and when people meet the robot.

use std::collections::BTreeMap;

use socrates_model::{EventKind, Recording, Relation};

use crate::fixture::{Cast, Liner, carve, location, setup};
use crate::run::Engine;
use crate::setup::Setup;

/// Two halls' worth of corridors: a ring around a block, with a tail at each side.
fn ring() -> socrates_model::Location {
    let free = [(0.2, 10.7, 24.0, 13.3), (10.7, 10.7, 13.3, 20.0), (20.7, 10.7, 23.3, 20.0), (10.7, 17.4, 23.3, 20.0)];
    location(
        carve(30.0, 24.0, &free),
        &[
            ("w", 2.0, 12.0),
            ("w2", 7.0, 12.0),
            ("m", 12.0, 12.0),
            ("e", 22.0, 12.0),
            ("ne", 22.0, 18.7),
            ("nw", 12.0, 18.7),
        ],
        &[("w", "w2"), ("w2", "m"), ("m", "e"), ("e", "ne"), ("ne", "nw"), ("nw", "m")],
    )
}

fn run(made: Setup) -> Recording {
    let mut driver = Liner::of(&made);
    Engine::new(made).unwrap().run(Some(&mut driver), &mut |_, _| {})
}

/// Encounters as they happened: human, node, gap.
fn met(recording: &Recording) -> Vec<(u32, String, f64)> {
    recording
        .events
        .iter()
        .filter_map(|event| {
            if let EventKind::Encounter { human, node, gap_s, .. } = &event.kind {
                Some((human.number(), node.to_string(), *gap_s))
            } else {
                None
            }
        })
        .collect()
}

#[test]
fn the_gap_that_was_achieved_is_reported_once_for_each_encounter() {
    for seed in 1..=6 {
        let cast = [
            Cast(Relation::Frontal, &["e", "m", "w2", "w"], vec![]),
            Cast(Relation::Crossing, &["ne", "nw", "m", "e"], vec![]),
        ];
        let made = setup(ring(), &["w", "w2", "m", "e"], &cast, &[(1, "w2"), (2, "m")]);
        let recording = run(Setup { seed, ..made });
        let found: BTreeMap<u32, (String, f64)> =
            met(&recording).into_iter().map(|(human, node, gap)| (human, (node, gap))).collect();
        assert_eq!(met(&recording).len(), 2, "seed {seed}: {:?}", met(&recording));
        assert_eq!((found[&1].0.as_str(), found[&2].0.as_str()), ("w2", "m"), "seed {seed}");
        for (_, gap) in found.values() {
            assert!(gap.abs() <= 2.5, "seed {seed}: {found:?}");
        }
    }
}

#[test]
fn at_a_node_that_the_robot_visits_twice_people_meet_it_at_one_of_its_visits() {
    // The robot comes over `m`, round the block and over `m` again.
    let way = ["w", "w2", "m", "e", "ne", "nw", "m", "w2"];
    for seed in 1..=4 {
        let cast = [Cast(Relation::Frontal, &["e", "m", "w2", "w"], vec![])];
        let made = setup(ring(), &way, &cast, &[(1, "m")]);
        let recording = run(Setup { seed, duration_s: Some(120.0), ..made });
        let met = met(&recording);
        assert!(
            met.iter().any(|(human, node, gap)| (*human, node.as_str()) == (1, "m") && gap.abs() <= 2.5),
            "{met:?}"
        );
    }
}

#[test]
fn a_human_who_visits_a_node_twice_meets_the_robot_there() {
    let way = ["m", "e", "ne", "nw", "m", "w2"];
    for seed in 1..=4 {
        let cast = [Cast(Relation::Crossing, &way, vec![])];
        let made = setup(ring(), &["w", "w2", "m", "e"], &cast, &[(1, "m")]);
        let recording = run(Setup { seed, duration_s: Some(120.0), ..made });
        let met = met(&recording);
        assert!(met.iter().any(|(_, _, gap)| gap.abs() <= 4.0), "seed {seed}: {met:?}");
    }
}
