//! Runs that test where and when people meet the robot.

use std::collections::BTreeMap;

use socrates_model::{Action, EventKind, Recording, Relation, Rule, Trigger};

use crate::fixture::{Cast, carve, grouped, location, run, setup};
use crate::setup::Setup;
use crate::tests::corridor;

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

/// Encounters with their number: human, number, node, gap.
fn numbered(recording: &Recording) -> Vec<(u32, u32, String, f64)> {
    let of = |kind: &EventKind| {
        if let EventKind::Encounter { human, node, gap_s, nth } = kind {
            Some((human.number(), *nth, node.to_string(), *gap_s))
        } else {
            None
        }
    };
    recording.events.iter().filter_map(|event| of(&event.kind)).collect()
}

#[test]
fn somebody_who_goes_round_the_block_meets_the_robot_twice() {
    for seed in 1..=6 {
        // The robot straight on, the person towards it, round the block to the north, and onto its way again.
        let cast = [Cast(Relation::Frontal, &["e", "m", "nw", "ne", "e"], vec![])];
        let made = setup(ring(), &["w", "w2", "m", "e", "ne"], &cast, &[(1, "m"), (1, "e")]);
        let recording = run(Setup { seed, ..made });
        let met = numbered(&recording);
        assert_eq!(met.len(), 2, "seed {seed}: {met:?}");
        assert_eq!((met[0].1, met[0].2.as_str()), (1, "m"), "seed {seed}: {met:?}");
        assert_eq!((met[1].1, met[1].2.as_str()), (2, "e"), "seed {seed}: {met:?}");
        assert!(met.iter().all(|(.., gap)| gap.abs() <= 4.0), "seed {seed}: {met:?}");
    }
}

#[test]
fn at_a_revisited_node_the_second_encounter_is_that_of_the_second_visit() {
    // The robot comes over `m`, round the block, and over `m` again; the person goes to and fro in the west meanwhile.
    let way = ["w2", "m", "e", "ne", "nw", "m", "w2"];
    let west = ["e", "m", "w2", "w", "w2", "w", "w2", "m", "e"];
    for seed in 1..=4 {
        let cast = [Cast(Relation::Frontal, &west, vec![])];
        let made = setup(ring(), &way, &cast, &[(1, "m"), (1, "m")]);
        let recording = run(Setup { seed, duration_s: Some(120.0), ..made });
        let met = numbered(&recording);
        let nodes: Vec<(u32, &str)> = met.iter().map(|(_, nth, node, _)| (*nth, node.as_str())).collect();
        assert_eq!(nodes, [(1, "m"), (2, "m")], "seed {seed}: {met:?}");
        assert!(met.iter().all(|(.., gap)| gap.abs() <= 4.0), "seed {seed}: {met:?}");
        let time = |nth: usize| {
            recording
                .events
                .iter()
                .filter(|event| matches!(event.kind, EventKind::Encounter { .. }))
                .nth(nth)
                .unwrap()
                .time
                .secs()
        };
        assert!(time(1) - time(0) > 15.0, "seed {seed}: the second is one of its own");
    }
}

#[test]
fn who_stands_where_the_robot_comes_by_twice_is_met_twice() {
    let cast = [Cast(Relation::Static, &["m"], vec![])];
    let made = setup(ring(), &["w", "w2", "m", "e", "ne", "nw", "m", "w2"], &cast, &[(1, "m"), (1, "m")]);
    let met = numbered(&run(Setup { duration_s: Some(120.0), ..made }));
    assert_eq!(met.iter().map(|(_, nth, ..)| *nth).collect::<Vec<_>>(), [1, 2], "{met:?}");
}

#[test]
fn an_encounter_that_is_missed_leaves_the_next_one_its_own() {
    // Far too late for the first: it starts beyond the block.
    let cast = [Cast(Relation::Leaving, &["ne", "nw", "ne", "nw", "m", "nw", "ne", "e", "ne"], vec![])];
    let made = setup(ring(), &["w2", "m", "e", "ne"], &cast, &[(1, "m"), (1, "e")]);
    let met = numbered(&run(Setup { duration_s: Some(90.0), ..made }));
    assert!(met.iter().all(|(_, nth, ..)| *nth == 2), "{met:?}");
}

#[test]
fn a_group_meets_the_robot_twice_together() {
    for seed in 1..=3 {
        let way = ["e", "m", "nw", "ne", "e"];
        let cast = [Cast(Relation::Frontal, &way, vec![]), Cast(Relation::Frontal, &way, vec![])];
        let meet = [(1, "m"), (2, "m"), (1, "e"), (2, "e")];
        let made = grouped(setup(ring(), &["w", "w2", "m", "e", "ne"], &cast, &meet));
        let met = numbered(&run(Setup { seed, ..made }));
        assert_eq!(met.len(), 4, "seed {seed}: {met:?}");
        // Round the block takes the fastest walk there is: the whole group is a little late for the second.
        let within = |nth: u32| if nth == 1 { 4.0 } else { 7.0 };
        assert!(met.iter().all(|(_, nth, _, gap)| gap.abs() <= within(*nth)), "seed {seed}: {met:?}");
    }
}

#[test]
fn a_look_at_the_first_meeting_does_not_spoil_the_second() {
    use socrates_model::{Action, Rule, Trigger};
    for seed in 1..=4 {
        let look = Rule {
            when: vec![Trigger::RobotNear(3.0)],
            act: Action::LookAtRobot,
            gesture: None,
            for_s: Some(5.0),
            latched: true,
            ..Rule::default()
        };
        let cast = [Cast(Relation::Frontal, &["e", "m", "nw", "ne", "e"], vec![look])];
        let made = setup(ring(), &["w", "w2", "m", "e", "ne"], &cast, &[(1, "m"), (1, "e")]);
        let met = numbered(&run(Setup { seed, ..made }));
        assert_eq!(met.len(), 2, "seed {seed}: {met:?}");
        assert!(met[1].3.abs() <= 4.0, "seed {seed}: {met:?}");
    }
}

#[test]
fn whoever_is_met_next_waits_while_somebody_else_holds_the_robot_up() {
    let me = socrates_model::HumanId::new(1);
    let step = |number, when: Trigger, act| Rule {
        when: vec![when],
        act,
        latched: true,
        step: Some(number),
        ..Rule::default()
    };
    for seed in 1..=4 {
        let rules = vec![
            Rule { for_s: Some(25.0), ..step(1, Trigger::RobotNear(2.0), Action::Block) },
            Rule { until: vec![Trigger::RobotPassed], ..step(2, Trigger::Did(me, 1), Action::GiveWay) },
        ];
        let cast =
            [Cast(Relation::Static, &["b"], rules), Cast(Relation::Frontal, &["e", "d", "c", "b", "a"], Vec::new())];
        let made = setup(corridor(), &["a", "b", "c", "d", "e"], &cast, &[(1, "b"), (2, "d")]);
        let met = met(&run(Setup { seed, ..made }));
        let next = met.iter().find(|(human, ..)| *human == 2).unwrap_or_else(|| panic!("seed {seed}: {met:?}"));
        assert!(next.2.abs() <= 2.5, "seed {seed}: {met:?}");
    }
}
