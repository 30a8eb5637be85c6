//! What the model of authors says, seen in the results: shares within their intervals, the same faults for every policy.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use socrates_stats::{Z_95, wilson};

use crate::draws::At;
use crate::plots::expected;
use crate::results::{CellResult, play, units};
use crate::spec::Spec;

/// A specification of these values.
pub(crate) fn spec(values: Value) -> Spec {
    let spec: Spec = serde_json::from_value(values).unwrap();
    crate::checked(spec).unwrap()
}

/// Every cell with its attempts.
pub(crate) fn played(spec: &Spec) -> Vec<(CellResult, Vec<crate::AttemptRow>)> {
    let cells = spec.cells();
    let mut results: Vec<_> = cells.iter().map(|cell| (CellResult::of(cell.clone()), Vec::new())).collect();
    for unit in units(spec, &cells) {
        let made = play(spec, &cells[unit.cell], unit.batch, &socrates_orchestrator::step);
        let attempts = results[unit.cell].0.add(made);
        results[unit.cell].1.extend(attempts);
    }
    for (result, _) in &results {
        assert!(result.safety.is_clean(), "{:?} {:?}", result.cell, result.safety);
    }
    results
}

/// The paper's four shares: with structure three questions, without one.
fn paper(scenarios: u32, policies: &[&str], tries: &[u32], correlation: f64) -> Spec {
    let workload = |name: &str, first_cut: f64, structured: bool| {
        let asks = if structured {
            json!({ "proposal": 0.06, "paths": 0.34, "behaviors": 0.6 })
        } else {
            json!({ "proposal": 1.0 })
        };
        json!({ "name": name, "first_cut": first_cut, "asks": asks })
    };
    let workloads = [
        workload("structured-guided", 0.73, true),
        workload("structured-unguided", 0.55, true),
        workload("naive-guided", 0.30, false),
        workload("naive-unguided", 0.10, false),
    ];
    spec(json!({
        "title": "laws", "scenarios": scenarios, "policies": policies, "tries": tries, "workload": workloads,
        "model": { "correlation": correlation },
    }))
}

#[test]
fn the_first_cut_is_what_the_workload_says() {
    for (result, _) in played(&paper(2_000, &["none"], &[1], 0.2)) {
        let figures = result.figures();
        let said = result.cell.workload.first_cut;
        assert!(figures.first_cut.low <= said && said <= figures.first_cut.high, "{said}: {:?}", figures.first_cut);
        assert_eq!(figures.successes, figures.first_cuts, "asked once, the first answer counts");
    }
}

#[test]
fn blind_tries_follow_the_law_of_independence_without_correlation_and_fall_below_it_with_some() {
    let mut below = 0;
    for correlation in [0.0, 0.4] {
        for (result, _) in played(&paper(800, &["immediate"], &[1, 2, 4], correlation)) {
            let (cell, figures) = (&result.cell, result.figures());
            let said = expected(&cell.workload, correlation, cell.tries);
            // Three standard errors: one false alarm in 370 cells, and the same draws every time.
            let around = wilson(figures.successes, result.scenarios.len(), 3.0).unwrap();
            assert!(around.low <= said && said <= around.high, "{correlation} {cell:?} {said}: {around:?}");
            below += usize::from(correlation > 0.0 && expected(&cell.workload, 0.0, cell.tries) > figures.success.high);
        }
    }
    assert_eq!(below, 8, "of the cells with more than one try, each is below what independent tries would give");
    let naive = &paper(1, &["none"], &[1], 0.0).workload[2];
    assert!((expected(naive, 0.0, 5) - (1.0 - 0.7_f64.powi(5))).abs() < 1e-12, "one question: 1 - (1 - p)^k");
}

#[test]
fn feedback_mends_as_often_as_the_model_says() {
    let of = |fix: f64| {
        let spec = spec(json!({
            "title": "feedback", "scenarios": 1_500, "policies": ["none", "feedback"], "tries": [2],
            "workload": [{ "name": "one", "first_cut": 0.5, "asks": { "proposal": 1.0 } }],
            "model": { "fix_if_named": fix, "collateral": 0.0 },
        }));
        let results = played(&spec);
        let figures = results[1].0.figures();
        (results[1].0.beside(&results[0].0).unwrap(), figures)
    };
    let (pairing, figures) = of(0.0);
    assert_eq!((pairing.only_first, pairing.only_this), (0, 0), "what is never mended fails again");
    assert_eq!(figures.successes, figures.first_cuts);
    let (_, figures) = of(1.0);
    assert_eq!(figures.successes, 1_500);
    let (pairing, figures) = of(0.7);
    let said = 0.5 + 0.5 * 0.7;
    let around = wilson(figures.successes, 1_500, Z_95).unwrap();
    assert!(around.low <= said && said <= around.high, "{around:?}");
    assert!(pairing.only_first == 0 && pairing.p < 1e-6 && pairing.difference.low > 0.25, "{pairing:?}");
}

#[test]
fn a_violation_that_no_check_finds_ends_as_contradicted() {
    let spec = spec(json!({
        "title": "unseen", "scenarios": 600, "policies": ["ladder"], "tries": [4],
        "workload": [{ "name": "one", "first_cut": 0.5 }], "model": { "found": 0.0 },
    }));
    let (result, _) = &played(&spec)[0];
    let figures = result.figures();
    assert_eq!(figures.successes, figures.first_cuts, "nobody is asked again");
    let contradicted = result.scenarios.iter().filter(|row| row.end.is_some_and(|end| end.name() == "contradicted"));
    assert_eq!(contradicted.count() + figures.successes, 600);
}

/// Outcomes by attempt.
fn outcomes(attempts: &[crate::AttemptRow]) -> BTreeMap<At, &'static str> {
    attempts.iter().map(|row| (row.at, row.outcome)).collect()
}

#[test]
fn every_policy_meets_the_same_faults() {
    let spec = spec(json!({
        "title": "paired", "scenarios": 300, "policies": ["none", "immediate", "fixed", "exponential", "jitter"], "tries": [5],
        "workload": [{ "name": "hard", "first_cut": 0.6 }],
        "fault": [
            { "kinds": ["llm_error", "overload", "malformed"], "rates": [0.2] },
            { "kinds": ["worker_kill"], "rates": [0.1, 0.3] },
        ],
    }));
    let results = played(&spec);
    let mut compared = 0;
    for (result, attempts) in &results {
        let (one, first) = (outcomes(attempts), outcomes(&results[result.cell.base].1));
        for (at, outcome) in &one {
            if let Some(other) = first.get(at) {
                assert_eq!(outcome, other, "{at:?} {}", result.cell.policy.name);
                compared += 1;
            }
        }
    }
    assert!(compared > 5_000, "{compared} attempts are compared");
    // What dies at a rate dies at every higher one.
    let died = |rate: f64| {
        let (_, attempts) = results
            .iter()
            .find(|(result, _)| result.cell.policy.name == "jitter" && (result.cell.rate - rate).abs() < 1e-9)
            .unwrap();
        outcomes(attempts)
    };
    let (few, many) = (died(0.1), died(0.3));
    assert!(few.iter().all(|(at, outcome)| *outcome != "killed" || many.get(at).is_none_or(|other| other == outcome)));
    assert!(few.values().filter(|outcome| **outcome == "killed").count() > 50);
}

#[test]
fn the_same_specification_gives_the_same_result_in_any_order() {
    let spec = spec(json!({
        "title": "twice", "scenarios": 120, "batch": 40, "policies": ["ladder"], "tries": [4],
        "workload": [{ "name": "hard", "first_cut": 0.4 }],
        "fault": [{ "kinds": ["worker_kill", "orchestrator_kill", "slow_store", "llm_error"], "rates": [0.1] }],
    }));
    let cells = spec.cells();
    let all = units(&spec, &cells);
    assert_eq!(all.len(), 3);
    let of = |unit: &crate::Unit| play(&spec, &cells[unit.cell], unit.batch, &socrates_orchestrator::step);
    let forth: Vec<_> = all.iter().map(of).collect();
    let mut back: Vec<_> = all.iter().rev().map(of).collect();
    back.reverse();
    assert_eq!(forth, back);
    assert_ne!(forth[0].attempts, forth[1].attempts);
    let other = Spec { seed: 2, ..spec.clone() };
    assert_ne!(
        play(&other, &cells[0], 0, &socrates_orchestrator::step),
        forth[0],
        "another seed is another experiment"
    );
}

#[test]
fn pauses_are_those_of_the_policy() {
    let spec = spec(json!({
        "title": "pauses", "scenarios": 200, "policies": ["immediate", "fixed"], "tries": [8],
        "fault": [{ "kinds": ["llm_error"], "rates": [0.3] }],
        "workers": { "proposal": 64, "paths": 64, "behaviors": 64, "simulation": 64, "scoring": 64 },
    }));
    let results = played(&spec);
    let median = |number: usize| results[number].0.figures().recovery_s.unwrap()[0];
    assert!(median(0) < 0.5, "tried again at once: {} s", median(0));
    assert!((2.0..2.5).contains(&median(1)), "after two seconds: {} s", median(1));
}

#[test]
fn faults_of_a_window_strike_within_it_alone() {
    let spec = spec(json!({
        "title": "window", "scenarios": 200, "policies": ["exponential"], "tries": [8],
        "fault": [{ "kinds": ["llm_error"], "rates": [1.0], "from_ms": 30_000, "to_ms": 60_000 }],
    }));
    let (_, attempts) = &played(&spec)[0];
    let authored = attempts.iter().filter(|row| crate::spec::AUTHORED.contains(&row.at.stage));
    let mut struck = 0;
    for row in authored {
        let within = (30_000..60_000).contains(&row.begun_ms);
        assert_eq!(row.outcome == "error", within, "{row:?}");
        struck += usize::from(within);
    }
    assert!(struck > 20, "{struck} attempts were struck");
}

#[test]
fn a_stage_that_rests_spends_fewer_tries_in_an_outage() {
    let spec = spec(json!({
        "title": "rest", "scenarios": 200, "policies": ["immediate", "resting"], "tries": [8],
        "policy": { "resting": { "like": "immediate", "circuit_percent": 20, "circuit_ms": 10_000 } },
        "fault": [{ "kinds": ["llm_error"], "rates": [1.0], "from_ms": 30_000, "to_ms": 60_000 }],
    }));
    let results = played(&spec);
    let struck = |number: usize| results[number].1.iter().filter(|row| row.outcome == "error").count();
    let realised = |number: usize| results[number].0.figures().successes;
    assert!(struck(1) * 3 < struck(0), "{} attempts failed, {} with rests", struck(0), struck(1));
    assert!(realised(1) > realised(0), "{} realised, {} with rests", realised(0), realised(1));
}
