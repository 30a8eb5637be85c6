//! Batches and what is held back, a line each.

use std::time::Duration;

#[cfg(test)]
use socrates_model::wire::Limits;
use socrates_model::wire::{BatchStatus, Part, Priority};

use crate::progress::span;

/// What is held back, in words.
pub(crate) fn part_words(part: &Part) -> String {
    match part {
        Part::All => "everything".to_owned(),
        Part::Batch(name) => format!("batch `{name}`"),
        Part::Stage(stage) => format!("stage {stage}"),
    }
}

/// What is held back, and the batches: a line each, where there is something to say. Ages are told at the wall time `now_ms`.
pub(super) fn lines(paused: &[Part], batches: &[BatchStatus], left: u32, now_ms: u64) -> Vec<String> {
    let mut lines = Vec::new();
    if !paused.is_empty() {
        let parts: Vec<String> = paused.iter().map(part_words).collect();
        lines.push(format!("paused     {} · `socrates cluster resume` lets it go on", parts.join(" · ")));
    }
    if left > 0 {
        lines.push(format!("batches    {left} earlier ones are not listed"));
    }
    lines.extend(batches.iter().map(|batch| line(batch, now_ms)));
    lines
}

fn line(batch: &BatchStatus, now_ms: u64) -> String {
    let BatchStatus { name, total, done, failed, canceled, running, paused, since_ms, ended_ms, unmade, over, .. } =
        batch;
    let open = total.saturating_sub(*done);
    let mut words = format!("batch      {name:<28} {done} done · {open} open · {failed} failed");
    for (count, word) in [(*canceled, "given up"), (*running, "running"), (*unmade, "not made yet")] {
        if count > 0 {
            words.push_str(&format!(" · {count} {word}"));
        }
    }
    if *paused {
        words.push_str(" · paused");
    }
    if batch.priority != Priority::Normal {
        words.push_str(&format!(" · priority {}", batch.priority.name()));
    }
    let time = |ms: u64| span(Duration::from_millis(ms).as_secs_f64());
    let known = |from: u64, to: u64| to.checked_sub(from).filter(|_| from > 0).map(time);
    match (known(*since_ms, *ended_ms), known(*since_ms, now_ms)) {
        // A batch that is done took its time; what comes after is no part of it.
        (Some(took), _) => {
            let ago = known(*ended_ms, now_ms).map_or_else(String::new, |ago| format!(", {ago} ago"));
            words.push_str(&format!(" · done in {took}{ago}"));
        }
        (None, Some(age)) => words.push_str(&format!(" · since {age}")),
        (None, None) => {}
    }
    for (taken, limit) in budgets(batch) {
        words.push_str(&format!(" · {taken} of {limit}"));
    }
    if !over.is_empty() {
        words.push_str(&format!("\n           nothing more of it is begun: {over}"));
    }
    words
}

/// What a batch has taken of what it may take, in words, where it has limits.
fn budgets(batch: &BatchStatus) -> Vec<(String, String)> {
    let (taken, limits) = (batch.taken, batch.limits);
    let time = |ms: u64| span(Duration::from_millis(ms).as_secs_f64());
    let cents = |money: u64| format!("{} cents", money / 10_000);
    let tokens = |tokens: u64| format!("{tokens} tokens");
    [
        (limits.deadline_ms > 0, time(taken.deadline_ms), time(limits.deadline_ms)),
        (limits.tokens > 0, taken.tokens.to_string(), tokens(limits.tokens)),
        (limits.money > 0, (taken.money / 10_000).to_string(), cents(limits.money)),
    ]
    .into_iter()
    .filter(|(set, ..)| *set)
    .map(|(_, taken, limit)| (taken, limit))
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_have_a_line_each_and_what_is_paused_is_said() {
        let batch = |name: &str, paused: bool, since_ms: u64| BatchStatus {
            name: name.to_owned(),
            total: 5,
            done: 2,
            failed: 1,
            running: 1,
            paused,
            since_ms,
            ..BatchStatus::default()
        };
        let batches = [batch("night", true, 0), batch("day", false, 1_000)];
        let paused = [Part::Batch("night".to_owned()), Part::Stage(socrates_model::job::Stage::Paths)];
        assert_eq!(
            lines(&paused, &batches, 3, 61_000),
            [
                "paused     batch `night` · stage paths · `socrates cluster resume` lets it go on",
                "batches    3 earlier ones are not listed",
                "batch      night                        2 done · 3 open · 1 failed · 1 running · paused",
                "batch      day                          2 done · 3 open · 1 failed · 1 running · since 1 min 0 s",
            ]
        );
        assert!(lines(&[], &[], 0, 0).is_empty());
        let long = BatchStatus {
            unmade: 900,
            limits: Limits { deadline_ms: 7_200_000, tokens: 5_000, money: 3_000_000 },
            taken: Limits { deadline_ms: 60_000, tokens: 5_100, money: 20_000 },
            over: "the batch spent 5100 tokens".to_owned(),
            ..batch("long", false, 0)
        };
        assert_eq!(
            line(&long, 0),
            "batch      long                         2 done · 3 open · 1 failed · 1 running · 900 not made yet · 1 min 0 s of 2 h 0 min · \
             5100 of 5000 tokens · 2 of 300 cents\n           nothing more of it is begun: the batch spent 5100 tokens"
        );
        let done = BatchStatus { ended_ms: 31_000, priority: Priority::Bulk, ..batch("day", false, 1_000) };
        assert_eq!(
            lines(&[], &[done], 0, 91_000),
            [
                "batch      day                          2 done · 3 open · 1 failed · 1 running · priority bulk · done in 30 s, 1 min 0 s ago"
            ]
        );
    }
}
