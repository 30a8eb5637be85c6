//! What was planted in simulated answers is found, and what was not is not.

use socrates_study::analyze::{Declared, analyze};
use socrates_study::read::{Pseudonyms, own};
use socrates_study::simulate::{Truth, simulate};

use crate::design;

const NAMES: Pseudonyms = Pseudonyms { key: [7; 32] };

fn truth(effects: [f64; 3], careless: usize) -> Truth {
    let effects = effects.to_vec();
    Truth { people: 60, effects, order: 0.0, between: 1.63, within: 0.5, careless, skipped: 0.02, seed: 11 }
}

#[test]
fn planted_effects_and_planted_cheaters_are_named() {
    let design = design();
    let simulated = simulate(&design, &truth([0.0, 0.0, 1.6], 6));
    let ratings = own(&simulated.own(), "a.jsonl", &design, NAMES).unwrap();
    let results = analyze(&ratings, &design, Declared::Before);
    let mut cheaters: Vec<String> = simulated.careless().iter().map(|id| NAMES.of(id)).collect();
    cheaters.sort();
    assert_eq!(cheaters.len(), 6);
    assert_eq!(results.excluded.keys().cloned().collect::<Vec<_>>(), cheaters, "these and nobody else");
    let rules = results.excluded.values().next().unwrap();
    assert_eq!(rules, &["failed-checks", "left-early", "too-fast", "straight-lines"]);
    for dimension in ["psi.RB", "psi.AB", "vega2020.navigation"] {
        let of: Vec<(&str, &str)> = results
            .findings
            .iter()
            .filter(|finding| finding.dimension == dimension)
            .map(|finding| (finding.higher.as_str(), finding.lower.as_str()))
            .collect();
        assert_eq!(of, [("can", "mppi"), ("can", "ha")], "{dimension}");
    }
    assert!(results.findings.iter().all(|finding| finding.declared == (finding.dimension == "psi.AB")));
    let cell = results.cells.iter().find(|cell| cell.dimension == "vega2020.navigation").unwrap();
    assert!(
        !cell.validated && cell.alpha.as_ref().unwrap().0 > 0.6,
        "reversed items are turned round: {:?}",
        cell.alpha
    );
    // Means of items have dozens of different values, and people lie far from the middle: the model is fitted all the same.
    assert!(results.cells.iter().all(|cell| cell.ordinal.is_ok()), "{:?}", results.cells);
    let never = analyze(&ratings, &design, Declared::Never);
    assert!(never.cells.iter().all(|cell| !cell.declared), "what was not registered is exploratory");
}

#[test]
fn where_nothing_was_planted_one_study_in_twenty_finds_something() {
    let mut design = design();
    design.resamples = 200;
    let mut alarms = 0;
    for seed in 0..12 {
        let simulated = simulate(&design, &Truth { seed, ..truth([0.0; 3], 0) });
        let ratings = own(&simulated.own(), "a.jsonl", &design, NAMES).unwrap();
        let results = analyze(&ratings, &design, Declared::Never);
        assert!(results.excluded.is_empty(), "nobody cheats");
        alarms += usize::from(!results.findings.is_empty());
        if seed == 0 {
            assert_eq!(analyze(&ratings, &design, Declared::Never), results, "same answers, same figures");
        }
    }
    // Binomial of 12 studies at 5 %: more than 3 in 1 of 450.
    assert!(alarms <= 3, "{alarms} of 12 studies");
}
