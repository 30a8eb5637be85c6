//! Whole runs in which people walk by different models.

use std::collections::BTreeMap;

use socrates_crowd::orca::OrcaSettings;
use socrates_crowd::tracks::{Track, Tracks};
use socrates_model::{FaultCode, HumanId, Recording, Relation};

use crate::fixture::{Cast, Liner, carve, location, setup};
use crate::models::HumanModel;
use crate::run::Engine;
use crate::setup::Setup;

fn hall() -> Setup {
    let place = location(
        carve(20.0, 12.0, &[(0.1, 0.1, 19.9, 11.9)]),
        &[("w", 2.0, 6.0), ("e", 18.0, 6.0), ("n", 10.0, 11.0), ("s", 10.0, 1.0), ("c", 10.0, 6.0)],
        &[("w", "c"), ("c", "e"), ("n", "c"), ("c", "s")],
    );
    let cast = [
        Cast(Relation::Frontal, &["e", "c", "w"], vec![]),
        Cast(Relation::Crossing, &["n", "c", "s"], vec![]),
        Cast(Relation::Crossing, &["s", "c", "n"], vec![]),
    ];
    Setup { duration_s: Some(25.0), ..setup(place, &["w", "c", "e"], &cast, &[]) }
}

/// Crosses the hall from (4, 2) to (16, 10) between 3 s and 13 s.
fn track() -> Track {
    let rows: Vec<String> = (0..=10)
        .map(|step| format!("{},9,{},{}", 3 + step, 4.0 + 1.2 * f64::from(step), 2.0 + 0.8 * f64::from(step)))
        .collect();
    Tracks::read(&format!("t,id,x,y\n{}\n", rows.join("\n"))).unwrap().get(9).unwrap().clone()
}

fn mixed() -> BTreeMap<HumanId, HumanModel> {
    BTreeMap::from([
        (HumanId::new(1), HumanModel::SocialForces),
        (HumanId::new(2), HumanModel::Orca(OrcaSettings::default())),
        (HumanId::new(3), HumanModel::Orca(OrcaSettings::default())),
        (HumanId::new(4), HumanModel::Recorded(track())),
    ])
}

fn run(models: &BTreeMap<HumanId, HumanModel>) -> Recording {
    let made = hall();
    let mut driver = Liner::of(&made);
    Engine::new(made).unwrap().with_models(models).unwrap().run(Some(&mut driver), &mut |_, _| {})
}

#[test]
fn three_models_share_a_run_and_everybody_feels_everybody() {
    let recording = run(&mixed());
    assert_eq!(recording.hash(), run(&mixed()).hash());
    assert_ne!(recording.hash(), run(&BTreeMap::new()).hash());
    assert_eq!(recording.header.agents.len(), 5);
    let leaf = |name: &str| recording.header.leaves.iter().position(|leaf| leaf == name).unwrap();
    let radii: Vec<f64> = recording.header.agents.iter().map(|agent| agent.radius_m).collect();
    for tick in 0..recording.ticks() {
        let states = recording.tick(tick);
        let now = tick as f64 * 0.01;
        let there = (3.0..=13.0).contains(&now);
        assert_eq!(usize::from(states[4].leaf()), leaf(if there { "track" } else { "absent" }), "at {now}");
        if there {
            let gone = (now - 3.0).min(10.0);
            let off = (states[4].x - 4.0 - 1.2 * gone).hypot(states[4].y - 2.0 - 0.8 * gone);
            assert!(off < 1e-9, "{off} m off the record at {now}");
        }
        let seen = if there { 5 } else { 4 };
        for (i, a) in states.iter().enumerate().take(seen) {
            assert!(a.x.is_finite() && a.speed() < 2.0);
            for (j, b) in states.iter().enumerate().take(seen).skip(i + 1) {
                let gap = (a.point() - b.point()).norm() - radii[i] - radii[j];
                // A recorded person does not stop for anybody, and appears where it was recorded.
                assert!(gap > -0.02, "{} and {} overlap by {gap} at {now}", a.agent_id(), b.agent_id());
            }
        }
    }
    let last = recording.tick(recording.ticks() - 1);
    for (place, (x, y)) in [(1, (2.0, 6.0)), (2, (10.0, 1.0)), (3, (10.0, 11.0))] {
        let left = (last[place].x - x).hypot(last[place].y - y);
        assert!(left < 1.2, "{} ends {left} m from its goal", last[place].agent_id());
    }
}

#[test]
fn models_for_the_wrong_people_are_refused_all_at_once() {
    let bad = OrcaSettings { horizon_s: -1.0, ..OrcaSettings::default() };
    let models = BTreeMap::from([
        (HumanId::new(1), HumanModel::Recorded(track())),
        (HumanId::new(2), HumanModel::Orca(bad)),
        (HumanId::new(7), HumanModel::SocialForces),
    ]);
    let faults = Engine::new(hall()).unwrap().with_models(&models).unwrap_err();
    let codes: Vec<FaultCode> = faults.iter().map(|fault| fault.code).collect();
    assert_eq!(codes, [FaultCode::BAgents, FaultCode::BRange, FaultCode::BAgents]);
    assert!(
        faults[1].message.to_string().contains("horizon_s") && faults[2].message.to_string().contains("human_3"),
        "{faults:?}"
    );
}
