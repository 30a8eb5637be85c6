//! What came of the trials, as a page and as tables.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use super::spec::{Arm, Plan};
use super::trial::Trial;

/// Two-sided 95 %.
const Z: f64 = 1.959_964;

/// The measures in the order of the columns.
type Measure = (&'static str, fn(&Trial) -> bool);
const MEASURES: [Measure; 4] = [
    ("right at first", |trial| trial.first),
    ("after repair", |trial| trial.repaired),
    ("asked again", |trial| trial.written),
    ("realised", |trial| trial.realised == Some(true)),
];

/// `7/10 (70 %, 40 to 89 %)`.
fn share(count: usize, of: usize) -> String {
    match socrates_stats::wilson(count, of, Z) {
        Ok(interval) => {
            #[expect(clippy::cast_precision_loss, reason = "counts of trials are small")]
            let mid = count as f64 / of as f64;
            format!(
                "{count}/{of} ({:.0} %, {:.0} to {:.0} %)",
                mid * 100.0,
                interval.low * 100.0,
                interval.high * 100.0
            )
        }
        Err(_none) => "none".to_owned(),
    }
}

fn of_arm<'a>(trials: &'a [Trial], arm: &'a Arm) -> impl Iterator<Item = &'a Trial> {
    trials.iter().filter(move |trial| trial.arm == arm.name)
}

/// The page.
pub(super) fn page(plan: &Plan, trials: &[Trial]) -> String {
    let mut text = format!(
        "# {}\n\n{} requests, {} trials, seed {}; at most {} asks per stage. Intervals are Wilson's, 95 %.\n\n",
        plan.title,
        plan.cases.len(),
        trials.len(),
        plan.seed,
        plan.attempts
    );
    if plan.arms.iter().any(Arm::is_injected) {
        text.push_str(
            "**Arms marked † are injected faults, not a model's.** Never compare them with a model on one axis.\n\n",
        );
    }
    if plan.arms.iter().any(|arm| arm.author == "offline") {
        text.push_str(
            "The offline author writes by rules. Its shares say how well requests and checks fit together, not how well a model authors.\n\n",
        );
    }
    for (guided, title) in [(true, "Guided requests"), (false, "Unguided requests")] {
        let some: Vec<Trial> = trials.iter().filter(|trial| trial.guided == guided).cloned().collect();
        if !some.is_empty() {
            text.push_str(&format!("## {title}\n\n{}\n", table(plan, &some)));
        }
    }
    text.push_str(&format!("## Arms against the first one, all requests\n\n{}\n", pairs(plan, trials)));
    text.push_str(&format!("## Faults found, per stage\n\n{}\n", found(plan, trials)));
    text
}

fn marked(arm: &Arm) -> String {
    format!("{}{}", arm.name, if arm.is_injected() { " †" } else { "" })
}

fn table(plan: &Plan, trials: &[Trial]) -> String {
    let heads: Vec<&str> = MEASURES.iter().map(|(name, _)| *name).collect();
    let mut text = format!("| arm | {} | asks | tokens per success | s per success |\n", heads.join(" | "));
    text.push_str(&format!("|---|{}---|---|---|\n", "---|".repeat(heads.len())));
    for arm in &plan.arms {
        let own: Vec<&Trial> = of_arm(trials, arm).collect();
        let cells: Vec<String> = MEASURES
            .iter()
            .map(|(name, holds)| {
                if *name == "realised" && !plan.simulate {
                    return "not simulated".to_owned();
                }
                share(own.iter().filter(|trial| holds(trial)).count(), own.len())
            })
            .collect();
        let good = own.iter().filter(|trial| trial.realised.unwrap_or(trial.written)).count();
        let tokens: u64 = own.iter().map(|trial| trial.tokens.0 + trial.tokens.1).sum();
        let secs: f64 = own.iter().map(|trial| trial.secs).sum();
        let asks: u32 = own.iter().map(|trial| trial.asks).sum();
        #[expect(clippy::cast_precision_loss, reason = "sums of tokens stay far below 2^53")]
        let per = |sum: f64| if good == 0 { "none".to_owned() } else { format!("{:.3}", sum / good as f64) };
        #[expect(clippy::cast_precision_loss, reason = "sums of tokens stay far below 2^53")]
        let tokens = if tokens == 0 { "0".to_owned() } else { per(tokens as f64) };
        text.push_str(&format!("| {} | {} | {asks} | {tokens} | {} |\n", marked(arm), cells.join(" | "), per(secs)));
    }
    text
}

/// Success of a trial: realised, or written where nothing was simulated.
fn success(trial: &Trial) -> bool {
    trial.realised.unwrap_or(trial.written)
}

/// Each arm against the first, on the same requests and seeds: McNemar's exact test on the pairs that differ.
fn pairs(plan: &Plan, trials: &[Trial]) -> String {
    let Some((first, others)) = plan.arms.split_first() else { return String::new() };
    let key = |trial: &Trial| (trial.case.clone(), trial.repeat);
    let base: BTreeMap<_, bool> = of_arm(trials, first).map(|trial| (key(trial), success(trial))).collect();
    let mut text =
        String::from("| arm | only the first succeeds | only this one | p (McNemar, exact) |\n|---|---|---|---|\n");
    for arm in others {
        let (mut lost, mut won) = (0_u32, 0_u32);
        for trial in of_arm(trials, arm) {
            match (base.get(&key(trial)), success(trial)) {
                (Some(true), false) => lost += 1,
                (Some(false), true) => won += 1,
                (Some(_) | None, _) => {}
            }
        }
        let p = mcnemar(lost, won);
        let p = if p < 0.001 { "below 0.001".to_owned() } else { format!("{p:.3}") };
        text.push_str(&format!("| {} | {lost} | {won} | {p} |\n", marked(arm)));
    }
    text
}

/// The exact two-sided p of McNemar's test: a fair coin falls so unevenly among the pairs that differ.
fn mcnemar(lost: u32, won: u32) -> f64 {
    let n = lost + won;
    let mut term = 0.5_f64.powi(i32::try_from(n).unwrap_or(i32::MAX));
    let mut tail = 0.0;
    for k in 0..=lost.min(won) {
        tail += term;
        term *= f64::from(n - k) / f64::from(k + 1);
    }
    (2.0 * tail).min(1.0)
}

fn found(plan: &Plan, trials: &[Trial]) -> String {
    let mut text = String::from("| arm | stage | fault | found |\n|---|---|---|---|\n");
    let mut any = false;
    for arm in &plan.arms {
        let mut counts: BTreeMap<(String, &str), usize> = BTreeMap::new();
        for fault in of_arm(trials, arm).flat_map(|trial| &trial.faults) {
            *counts.entry((fault.stage.name().to_owned(), fault.code.code())).or_default() += 1;
        }
        for ((stage, code), count) in counts {
            any = true;
            text.push_str(&format!("| {} | {stage} | {code} | {count} |\n", marked(arm)));
        }
    }
    if any { text } else { "None.\n".to_owned() }
}

/// One line per trial.
pub(super) fn trials(trials: &[Trial]) -> String {
    let mut text = String::from(
        "request,guided,repeat,arm,right_at_first,after_repair,asked_again,realised,asks,tokens_in,tokens_out,injected,faults\n",
    );
    for trial in trials {
        let codes: BTreeSet<&str> = trial.faults.iter().map(|fault| fault.code.code()).collect();
        let realised = trial.realised.map_or_else(String::new, |realised| realised.to_string());
        text.push_str(&format!(
            "{},{},{},{},{},{},{},{realised},{},{},{},{},{}\n",
            quoted(&trial.case),
            trial.guided,
            trial.repeat + 1,
            quoted(&trial.arm),
            trial.first,
            trial.repaired,
            trial.written,
            trial.asks,
            trial.tokens.0,
            trial.tokens.1,
            trial.injected,
            codes.into_iter().collect::<Vec<_>>().join(" ")
        ));
    }
    text
}

/// One line per fault that was found.
pub(super) fn faults(trials: &[Trial]) -> String {
    let mut text = String::from("request,repeat,arm,stage,attempt,fault\n");
    for trial in trials {
        for fault in &trial.faults {
            text.push_str(&format!(
                "{},{},{},{},{},{}\n",
                quoted(&trial.case),
                trial.repeat + 1,
                quoted(&trial.arm),
                fault.stage,
                fault.attempt,
                fault.code
            ));
        }
    }
    text
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// The arms for programs.
pub(super) fn rows(plan: &Plan, trials: &[Trial]) -> Vec<Value> {
    plan.arms
        .iter()
        .map(|arm| {
            let own: Vec<&Trial> = of_arm(trials, arm).collect();
            let mut row =
                json!({"arm": arm.name, "author": arm.author, "injected": arm.is_injected(), "trials": own.len()});
            for (name, holds) in MEASURES {
                if let Some(members) = row.as_object_mut() {
                    let count = own.iter().filter(|trial| holds(trial)).count();
                    members.insert(name.replace(' ', "_"), json!(count));
                }
            }
            row
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mcnemar_is_that_of_the_textbook() {
        // 2 · P(at most 1 of 10 heads) = 2 · 11/1024.
        assert!((mcnemar(1, 9) - 22.0 / 1024.0).abs() < 1e-12);
        assert!((mcnemar(0, 0) - 1.0).abs() < 1e-12 && (mcnemar(5, 5) - 1.0).abs() < 1e-12);
        assert!((mcnemar(0, 5) - 2.0 / 32.0).abs() < 1e-12);
    }

    #[test]
    fn shares_come_with_their_intervals() {
        assert_eq!(share(73, 100), "73/100 (73 %, 64 to 81 %)");
        assert_eq!(share(0, 0), "none");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
