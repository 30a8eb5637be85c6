//! The readable report of an evaluation, in Markdown.

use std::collections::BTreeMap;

use socrates_model::job::Stage;
use socrates_stats::{Z_95, mcnemar, wilson};

use super::outcome::Outcome;
use super::spec::{Arm, Case, Spec};

/// Width of a bar, characters.
const BAR: usize = 20;
/// Whether a scenario counts.
type Is = fn(&Outcome) -> bool;
/// What is counted as a success, step by step.
const STEPS: [(&str, Is); 6] = [
    ("first answer right", |outcome| outcome.first_pass),
    ("after safe repair", |outcome| outcome.after_repair),
    ("after asking again", |outcome| outcome.after_asking),
    ("first run as asked", |outcome| outcome.first_run),
    ("realised without any feedback", Outcome::unaided),
    ("realised in the end", |outcome| outcome.realised),
];

/// An arm with its outcomes, in the order of the cases.
pub(super) type Done<'a> = (&'a Arm, Vec<Outcome>);

/// The whole report.
pub(super) fn markdown(spec: &Spec, cases: &[Case], arms: &[Done<'_>]) -> String {
    let mut out = format!("# {}\n\n", spec.title);
    let per_arm = cases.len();
    let guided = cases.iter().filter(|case| case.guided).count();
    line(
        &mut out,
        &format!(
            "{per_arm} scenarios an arm ({guided} guided, {} unguided) at {}; seed {}, the same scenarios and draws in every arm.\n",
            per_arm - guided,
            spec.locations.join(", "),
            spec.seed
        ),
    );
    if arms.iter().any(|(arm, _)| arm.faults.is_some() || arm.faults_unguided.is_some()) {
        out.push_str("> **Injected faults, not a model's.** Arms marked * measure what the checks and the asking again are worth;\n> they say nothing about any language model and do not belong on one axis with one.\n\n");
    }
    for (arm, _) in arms {
        line(&mut out, &format!("- **{}**{}: author `{}`. {}", arm.name, star(arm), arm.author, arm.about));
    }
    for (name, wanted) in [("Guided", Some(true)), ("Unguided", Some(false)), ("All", None)] {
        let of = |case: &Case| wanted.is_none_or(|wanted| case.guided == wanted);
        if cases.iter().any(of) && (wanted.is_none() || guided != 0 && guided != per_arm) {
            line(&mut out, &format!("\n## {name}\n\n{}", table(cases, arms, &of)));
        }
    }
    out.push_str(&pairs(cases, arms));
    out.push_str(&costs(arms));
    out.push_str(&faults(arms));
    out
}

fn line(out: &mut String, text: &str) {
    out.push_str(text);
    out.push('\n');
}

fn star(arm: &Arm) -> &'static str {
    if arm.faults.is_some() || arm.faults_unguided.is_some() { "*" } else { "" }
}

fn table(cases: &[Case], arms: &[Done<'_>], of: &dyn Fn(&Case) -> bool) -> String {
    let mut out = String::from("| arm | ");
    out.push_str(&STEPS.map(|(name, _)| name).join(" | "));
    out.push_str(" | |\n|---|");
    out.push_str(&"---|".repeat(STEPS.len() + 1));
    out.push('\n');
    for (arm, outcomes) in arms {
        let chosen: Vec<&Outcome> =
            cases.iter().zip(outcomes).filter(|(case, _)| of(case)).map(|(_, outcome)| outcome).collect();
        let count = |is: Is| chosen.iter().filter(|outcome| is(outcome)).count();
        let cells = STEPS.map(|(_, is)| share(count(is), chosen.len()));
        let bar = bar(count(|outcome| outcome.realised), chosen.len());
        line(&mut out, &format!("| {}{} | {} | `{bar}` |", arm.name, star(arm), cells.join(" | ")));
    }
    out.push_str("\nIn brackets the Wilson interval at 95 %.");
    out
}

/// `46/100 = 46 % (37–56)`.
fn share(count: usize, of: usize) -> String {
    let percent = |share: f64| format!("{:.0}", 100.0 * share);
    match wilson(count, of, Z_95) {
        Ok(found) => {
            format!("{count}/{of} = {} % ({}–{})", percent(found.estimate), percent(found.low), percent(found.high))
        }
        Err(_none) => "none".to_owned(),
    }
}

fn bar(count: usize, of: usize) -> String {
    let full = (2 * BAR * count + of).checked_div(2 * of).unwrap_or(0).min(BAR);
    format!("{}{}", "█".repeat(full), "·".repeat(BAR - full))
}

/// Every arm against the first, scenario by scenario.
fn pairs(cases: &[Case], arms: &[Done<'_>]) -> String {
    let Some(((base, first), others)) = arms.split_first().filter(|(_, others)| !others.is_empty()) else {
        return String::new();
    };
    let mut out = format!(
        "\n## Scenario by scenario against `{}`\n\n| arm | both realised | only `{}` | only the arm | neither | McNemar p |\n|---|---|---|---|---|---|\n",
        base.name, base.name
    );
    for (arm, outcomes) in others {
        let mut counts = [0_usize; 4];
        for ((_, a), b) in cases.iter().zip(first).zip(outcomes) {
            let place = match (a.realised, b.realised) {
                (true, true) => 0,
                (true, false) => 1,
                (false, true) => 2,
                (false, false) => 3,
            };
            counts.iter_mut().skip(place).take(1).for_each(|count| *count += 1);
        }
        let [both, only_first, only_arm, neither] = counts;
        let p = mcnemar(only_first, only_arm);
        let p = if p < 1e-4 { "< 0.0001".to_owned() } else { format!("{p:.4}") };
        line(&mut out, &format!("| {} | {both} | {only_first} | {only_arm} | {neither} | {p} |", arm.name));
    }
    out
}

fn costs(arms: &[Done<'_>]) -> String {
    let mut out = String::from(
        "\n## What it takes\n\n| arm | questions a scenario | paths by the solver | sent back after a run | tokens per realised scenario (in / out) | author's time per realised scenario |\n|---|---|---|---|---|---|\n",
    );
    for (arm, outcomes) in arms {
        let realised = outcomes.iter().filter(|outcome| outcome.realised).count();
        let sum = |of: &dyn Fn(&Outcome) -> u64| outcomes.iter().map(of).sum::<u64>();
        let each = |total: u64| match (total, u64::try_from(realised)) {
            (0, _) => "0".to_owned(),
            (_, Ok(0) | Err(_)) => "none realised".to_owned(),
            (total, Ok(count)) => (total / count).to_string(),
        };
        let asks = sum(&|outcome| outcome.asks as u64);
        line(
            &mut out,
            &format!(
                "| {} | {:.2} | {} | {} | {} / {} | {} ms |",
                arm.name,
                per(asks, outcomes.len()),
                sum(&|outcome| outcome.by_solver as u64),
                sum(&|outcome| outcome.sent_back as u64),
                each(sum(&|outcome| outcome.tokens.0)),
                each(sum(&|outcome| outcome.tokens.1)),
                each(sum(&|outcome| outcome.author_ms)),
            ),
        );
    }
    out
}

#[expect(clippy::cast_precision_loss, reason = "counts of questions and scenarios")]
fn per(sum: u64, of: usize) -> f64 {
    sum as f64 / of.max(1) as f64
}

/// What was put in and found again, and what answers were refused for.
fn faults(arms: &[Done<'_>]) -> String {
    let mut injected: BTreeMap<(Stage, &str), (usize, usize)> = BTreeMap::new();
    let mut found: BTreeMap<(Stage, &str), Vec<usize>> = BTreeMap::new();
    let (mut clean, mut in_clean) = (0, 0);
    for (place, (_, outcomes)) in arms.iter().enumerate() {
        for outcome in outcomes {
            (clean, in_clean) = (clean + outcome.clean, in_clean + outcome.in_clean);
            for ((stage, code), (count, seen)) in &outcome.injected {
                let entry = injected.entry((*stage, code)).or_default();
                (entry.0, entry.1) = (entry.0 + count, entry.1 + seen);
            }
            for ((stage, code), count) in &outcome.found {
                let row = found.entry((*stage, code)).or_insert_with(|| vec![0; arms.len()]);
                row.iter_mut().skip(place).take(1).for_each(|cell| *cell += count);
            }
        }
    }
    let mut out = String::new();
    if !injected.is_empty() {
        out.push_str("\n## Faults put in, and answers with them that the checks did not let through\n\n| stage | fault | put in | noticed |\n|---|---|---|---|\n");
        for ((stage, code), (count, seen)) in &injected {
            line(&mut out, &format!("| {stage} | {code} | {count} | {} |", share(*seen, *count)));
        }
        line(&mut out, &format!("\nOf the {clean} answers into which nothing was put {in_clean} were refused."));
    }
    if !found.is_empty() {
        let names: Vec<&str> = arms.iter().map(|(arm, _)| arm.name.as_str()).collect();
        line(
            &mut out,
            &format!(
                "\n## Why answers were refused\n\n| stage | code | {} |\n|---|---|{}",
                names.join(" | "),
                "---|".repeat(names.len())
            ),
        );
        for ((stage, code), counts) in &found {
            let cells: Vec<String> = counts.iter().map(ToString::to_string).collect();
            line(&mut out, &format!("| {stage} | {code} | {} |", cells.join(" | ")));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_report_counts_pairs_and_marks_injected_faults() {
        let spec = Spec::load(Path::new("paper")).unwrap();
        let cases: Vec<Case> = spec.cases().into_iter().take(10).collect();
        let outcome = |realised: bool| Outcome { realised, after_asking: realised, asks: 3, ..Outcome::default() };
        let arms: Vec<Done<'_>> = vec![
            (&spec.arms[0], (0..10).map(|place| outcome(place < 3)).collect()),
            (&spec.arms[4], (0..10).map(|place| outcome(place != 0)).collect()),
        ];
        let text = markdown(&spec, &cases, &arms);
        assert!(text.contains("Injected faults, not a model's"));
        assert!(text.contains("| asked once* |") && text.contains("| no faults |"), "{text}");
        assert!(text.contains("3/10 = 30 % (11–60)") && text.contains("9/10 = 90 %"), "{text}");
        // Both 2, only the first 1, only the other 7, neither 0: 2 (1 + 8) / 2^8.
        assert!(text.contains("| no faults | 2 | 1 | 7 | 0 | 0.0703 |"), "{text}");
        assert_eq!(bar(1, 2), "██████████··········");
        assert_eq!((bar(0, 0).chars().count(), share(0, 0)), (BAR, "none".to_owned()));
    }
}
