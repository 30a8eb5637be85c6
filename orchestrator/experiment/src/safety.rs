//! Nothing is lost and nothing done twice, whatever strikes; and an orchestrator that breaks this is found out.

use std::sync::atomic::{AtomicU32, Ordering};

use serde_json::json;
use socrates_orchestrator::{Effect, Event, Row, State, step};

use crate::kind::Kind;
use crate::laws::{played, spec};
use crate::ledger::Safety;
use crate::results::play;
use crate::spec::Spec;

#[test]
fn every_kind_of_fault_strikes_and_nothing_is_lost_or_doubled() {
    for kind in Kind::ALL {
        let spec = spec(json!({
            "title": "struck", "scenarios": 150, "policies": ["ladder"], "tries": [8],
            "workload": [{ "name": "plain" }], "fault": [{ "kinds": [kind], "rates": [0.15] }],
            "times_ms": { "retry_after": 700 },
        }));
        // `played` looks at the safety of every cell.
        let (result, attempts) = &played(&spec)[0];
        assert!(result.scenarios.iter().all(|row| row.end.is_some()), "{kind:?}");
        let struck = result.recoveries.iter().filter(|(of, _)| of == kind).count();
        assert!(struck > 20, "{kind:?} struck {struck} times and was recovered from");
        let jobs: u64 = result.scenarios.iter().map(|row| row.jobs).sum();
        assert!(attempts.len() as u64 >= jobs, "{kind:?}");
        assert!(result.figures().successes > 140, "{kind:?}: eight tries are enough for nearly all");
    }
}

#[test]
fn a_lost_worker_costs_its_grace_and_a_cut_one_its_lease() {
    let of = |kind: Kind| {
        let spec = spec(json!({
            "title": "lost", "scenarios": 200, "policies": ["jitter"], "tries": [8],
            "fault": [{ "kinds": [kind], "rates": [0.05] }],
            "durations": { "simulation": { "fixed": 40_000 } },
            "workers": { "proposal": 256, "paths": 256, "behaviors": 256, "simulation": 256, "scoring": 64 },
            "times_ms": { "cut": 60_000 },
        }));
        played(&spec)[0].0.figures().recovery_s.unwrap()
    };
    let [median, _, p99] = of(Kind::WorkerKill);
    assert!((2.1..2.5).contains(&median) && p99 < 16.0, "token 0.1 s and grace 2 s: {median} s, {p99} s");
    let [median, _, p99] = of(Kind::Partition);
    // Its last beat may be a while ago, and what is done sooner than the lease ends comes in when the cut is over.
    assert!((12.0..17.0).contains(&median) && p99 <= 63.0, "lease 15 s: {median} s, {p99} s");
}

fn small() -> Spec {
    spec(json!({
        "title": "broken", "scenarios": 60, "policies": ["jitter"], "tries": [4],
        "fault": [{ "kinds": ["worker_kill", "orchestrator_kill"], "rates": [0.05] }],
    }))
}

/// The safety of a batch whose orchestrator has its effects changed by `spoil`, which is told how many results there were before.
fn with(spoil: impl Fn(&mut Vec<Effect>, u32) + Sync) -> Safety {
    let spec = small();
    let results = AtomicU32::new(0);
    let broken = |state: &mut State, event: Event, now: u64| {
        let mut effects = step(state, event, now);
        let there = effects.iter().filter(|effect| is_result(effect)).count();
        let before = results.fetch_add(u32::try_from(there).unwrap(), Ordering::Relaxed);
        if there > 0 {
            spoil(&mut effects, before);
        }
        effects
    };
    play(&spec, &spec.cells()[0], 0, &broken).safety
}

fn is_result(effect: &Effect) -> bool {
    matches!(effect, Effect::Save(Row::Result(..)))
}

#[test]
fn an_orchestrator_that_keeps_its_word_is_clean() {
    assert_eq!(with(|_, _| ()), Safety::default());
}

#[test]
fn a_result_that_is_acknowledged_and_not_saved_is_lost() {
    let safety = with(|effects, before| {
        if before == 100 {
            effects.retain(|effect| !is_result(effect));
        }
    });
    assert!(safety.lost > 0, "{safety:?}");
    assert!(safety.complaints > 0 && safety.first.starts_with("I"), "the checker sees it in the rows: {safety:?}");
}

#[test]
fn a_scenario_whose_end_is_not_saved_is_lost() {
    let safety = with(|effects, before| {
        if before > 200 {
            effects.retain(|effect| !matches!(effect, Effect::Save(Row::Scenario(_))));
        }
    });
    assert!(safety.lost > 0, "{safety:?}");
}

#[test]
fn a_result_that_is_written_twice_is_doubled() {
    let safety = with(|effects, before| {
        if before == 100 {
            let again: Vec<Effect> = effects.iter().filter(|effect| is_result(effect)).cloned().collect();
            effects.splice(0..0, again);
        }
    });
    assert_eq!(safety.doubled, 1, "{safety:?}");
}
