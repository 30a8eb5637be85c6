//! `proposal ✔ 3 ms   paths ✔ 11 ms (1 retry: G-MEET)   …`: what the stages of a scenario did, in one line.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;
use socrates_model::job::{Item, JobKey, Stage};
use socrates_model::wire::{JobStatus, ScenarioStatus};
use socrates_model::{Fault, JobState, ScenarioEnd, Verdict};

use crate::history::PastJob;
use crate::words::plural;

/// What is known of one job: all of it out of the store, or the newest revision out of an answer on the bus.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StageJob {
    /// Stage.
    pub(crate) stage: Stage,
    /// Which of the stage, such as `reference-1`.
    pub(crate) item: Item,
    /// Revision.
    pub(crate) revision: u32,
    /// State in lower case.
    pub(crate) state: JobState,
    /// Attempts so far; 0 where its result was known already.
    pub(crate) attempts: u32,
    /// Working time of all of them, ms.
    pub(crate) wall_ms: u64,
    /// Characters that the author of the running attempt has written so far; 0 where none writes.
    pub(crate) characters: u64,
    /// Codes of the faults for which it was done again.
    pub(crate) codes: Vec<&'static str>,
    /// Remark of its result.
    pub(crate) remark: String,
    /// The stage that a scoring job sends back.
    pub(crate) blames: Option<Stage>,
}

impl From<&PastJob> for StageJob {
    fn from(job: &PastJob) -> Self {
        let faults = job.sent_back.iter().chain(job.attempts.iter().flat_map(|attempt| &attempt.faults));
        Self {
            stage: job.key.stage,
            item: job.key.item.clone(),
            revision: job.key.revision,
            state: job.state,
            attempts: u32::try_from(job.attempts.len()).unwrap_or(u32::MAX),
            wall_ms: job.attempts.iter().map(|attempt| attempt.wall_ms).sum(),
            characters: 0,
            codes: faults.map(|fault| fault.code.code()).collect(),
            remark: job.remark.clone(),
            blames: job.blames,
        }
    }
}

impl From<&JobStatus> for StageJob {
    fn from(job: &JobStatus) -> Self {
        Self {
            stage: job.key.stage,
            item: job.key.item.clone(),
            revision: job.key.revision,
            state: job.state,
            attempts: job.attempts,
            wall_ms: job.wall_ms,
            characters: job.characters,
            codes: job.faults.iter().map(|fault| fault.code.code()).collect(),
            remark: job.remark.clone(),
            blames: None,
        }
    }
}

/// The line of a scenario as the store tells of it; `result` is how it ended, none while it goes on.
pub(crate) fn line(past: &[PastJob], result: Option<ScenarioEnd>) -> String {
    of(&past.iter().map(StageJob::from).collect::<Vec<_>>(), result)
}

/// The line of a scenario as an answer on the bus tells of it.
pub(crate) fn line_of(status: &ScenarioStatus) -> String {
    of(&status.jobs.iter().map(StageJob::from).collect::<Vec<_>>(), status.result)
}

/// The line of a finished bundle as its provenance tells of it; empty where it has none.
pub(crate) fn line_of_bundle(dir: &Path, verdict: Verdict) -> String {
    let text = crate::bundle::file(dir, crate::layout::PROVENANCE.path).unwrap_or_default();
    let provenance: Value = serde_json::from_slice(&text).unwrap_or_default();
    let jobs = provenance.get("jobs").and_then(Value::as_array).into_iter().flatten();
    of(&jobs.filter_map(told).collect::<Vec<_>>(), Some(ScenarioEnd::Judged(verdict)))
}

/// A job of a provenance.
fn told(job: &Value) -> Option<StageJob> {
    let key: JobKey = serde_json::from_value(job.get("job")?.clone()).ok()?;
    let list = |value: &Value, name: &str| value.get(name).and_then(Value::as_array).cloned().unwrap_or_default();
    let attempts = list(job, "attempts");
    let faults = list(job, "sent_back").into_iter().chain(attempts.iter().flat_map(|attempt| list(attempt, "faults")));
    let remark = attempts.last().and_then(|attempt| attempt.get("remark")?.as_str());
    Some(StageJob {
        stage: key.stage,
        item: key.item,
        revision: key.revision,
        state: serde_json::from_value(job.get("state")?.clone()).ok()?,
        attempts: u32::try_from(attempts.len()).unwrap_or(u32::MAX),
        wall_ms: attempts.iter().filter_map(|attempt| attempt.get("wall_ms")?.as_u64()).sum(),
        characters: 0,
        codes: faults.filter_map(|fault| Some(serde_json::from_value::<Fault>(fault).ok()?.code.code())).collect(),
        remark: remark.unwrap_or_default().to_owned(),
        blames: None,
    })
}

fn of(jobs: &[StageJob], result: Option<ScenarioEnd>) -> String {
    // A verdict that is not the wanted one stands at the stage that found it, and at the one that it sends back.
    let missed = result.and_then(ScenarioEnd::verdict).filter(|verdict| *verdict != Verdict::Realised);
    let newest = jobs.iter().filter(|job| job.stage == Stage::Scoring).max_by_key(|job| job.revision);
    let blamed = newest.and_then(|job| job.blames).filter(|_| missed.is_some());
    let parts = Stage::WORKERS.into_iter().filter_map(|stage| {
        let mut own: Vec<&StageJob> = jobs.iter().filter(|job| job.stage == stage).collect();
        own.sort_by_key(|job| job.revision);
        let found = missed.filter(|_| stage == Stage::Scoring);
        part(stage, &own, found.is_some() || blamed == Some(stage), found)
    });
    parts.collect::<Vec<_>>().join("   ")
}

/// One stage; nothing where it has no job that counts.
fn part(stage: Stage, jobs: &[&StageJob], wrong: bool, verdict: Option<Verdict>) -> Option<String> {
    // Of each item the newest job that nothing newer made needless.
    let counts = jobs.iter().filter(|job| job.state != JobState::Superseded);
    let last: BTreeMap<&Item, &&StageJob> = counts.map(|job| (&job.item, job)).collect();
    let one = last.values().max_by_key(|job| job.revision)?;
    let ended = |job: &StageJob| matches!(job.state, JobState::Failed | JobState::Dead | JobState::Canceled);
    let attempts: u32 = jobs.iter().map(|job| job.attempts).sum();
    // A stage that nothing came to has no fault of its own.
    let unreached = attempts == 0 && last.values().all(|job| ended(job));
    let mark = if unreached {
        "–"
    } else if wrong || last.values().any(|job| ended(job)) {
        "✘"
    } else if last.values().all(|job| job.state == JobState::Succeeded) {
        "✔"
    } else {
        "…"
    };
    let ms: u64 = jobs.iter().map(|job| job.wall_ms).sum();
    // Of several jobs of the stage, what all of them have heard.
    let written: u64 = last.values().map(|job| job.characters).sum();
    let took = match (attempts, one.state) {
        _ if written > 0 => plural(usize::try_from(written).unwrap_or(usize::MAX), "character"),
        (0, JobState::Succeeded) => "known".to_owned(),
        (0, _) if unreached => "not reached".to_owned(),
        (0, _) => "waiting".to_owned(),
        _ => format!("{ms} ms"),
    };
    let what = if stage == Stage::Simulation && !one.remark.is_empty() && attempts > 0 {
        format!("{} in {took}", one.remark)
    } else {
        took
    };
    let verdict = verdict.map_or_else(String::new, |verdict| format!(": {verdict}"));
    Some(format!("{stage} {mark} {what}{verdict}{}", again(jobs, attempts)))
}

/// ` (2 retries: G-MEET, D-NOTRIG)`, or nothing.
fn again(jobs: &[&StageJob], attempts: u32) -> String {
    let begun: BTreeSet<&Item> = jobs.iter().filter(|job| job.attempts > 0).map(|job| &job.item).collect();
    let retries = attempts.saturating_sub(u32::try_from(begun.len()).unwrap_or(u32::MAX));
    if retries == 0 {
        return String::new();
    }
    let mut codes: Vec<&str> = Vec::new();
    for code in jobs.iter().flat_map(|job| &job.codes) {
        if !codes.contains(code) {
            codes.push(code);
        }
    }
    let count = if retries == 1 { "1 retry".to_owned() } else { plural(retries as usize, "retrie") };
    format!(" ({count}{}{})", if codes.is_empty() { "" } else { ": " }, codes.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(stage: Stage, revision: u32, attempts: u32, wall_ms: u64) -> StageJob {
        StageJob {
            stage,
            item: Item::Whole,
            revision,
            state: JobState::Succeeded,
            attempts,
            wall_ms,
            characters: 0,
            codes: Vec::new(),
            remark: String::new(),
            blames: None,
        }
    }

    /// Two revisions of the behaviors; the second simulation was the same as the first, so its result was known.
    fn repaired() -> Vec<StageJob> {
        let sent = |revision| StageJob { codes: vec!["D-NOTRIG"], ..job(Stage::Behaviors, revision, 1, 4) };
        let old = |job: StageJob| StageJob { state: JobState::Superseded, ..job };
        let run = StageJob { remark: "62.8 s simulated".to_owned(), ..job(Stage::Simulation, 0, 1, 400) };
        let judged = StageJob { blames: Some(Stage::Behaviors), ..job(Stage::Scoring, 1, 1, 9) };
        vec![
            job(Stage::Proposal, 0, 1, 3),
            StageJob { codes: vec!["G-MEET"], ..job(Stage::Paths, 0, 2, 11) },
            old(job(Stage::Behaviors, 0, 1, 5)),
            sent(1),
            old(run.clone()),
            StageJob { revision: 1, attempts: 0, wall_ms: 0, ..run },
            judged,
        ]
    }

    #[test]
    fn times_are_those_of_all_attempts_and_revisions() {
        let line = of(&repaired(), Some(ScenarioEnd::Judged(Verdict::Realised)));
        assert_eq!(
            line,
            "proposal ✔ 3 ms   paths ✔ 11 ms (1 retry: G-MEET)   behaviors ✔ 9 ms (1 retry: D-NOTRIG)   \
             simulation ✔ 62.8 s simulated in 400 ms   scoring ✔ 9 ms"
        );
    }

    #[test]
    fn a_verdict_that_was_not_wanted_marks_the_stage_that_found_it_and_the_one_sent_back() {
        let line = of(&repaired(), Some(ScenarioEnd::Judged(Verdict::Contradicted)));
        assert!(line.contains("behaviors ✘ 9 ms (1 retry: D-NOTRIG)"), "{line}");
        assert!(line.ends_with("scoring ✘ 9 ms: contradicted"), "{line}");
        assert!(line.contains("proposal ✔") && line.contains("paths ✔") && line.contains("simulation ✔"), "{line}");
    }

    #[test]
    fn what_was_known_took_no_time_and_what_failed_is_marked() {
        let known = of(&[job(Stage::Proposal, 0, 0, 0)], Some(ScenarioEnd::Judged(Verdict::Realised)));
        assert_eq!(known, "proposal ✔ known");
        let failed = StageJob { state: JobState::Failed, ..job(Stage::Paths, 0, 4, 12) };
        assert_eq!(of(&[failed], Some(ScenarioEnd::Failed)), "paths ✘ 12 ms (3 retries)");
        let dead = StageJob { state: JobState::Dead, ..job(Stage::Simulation, 0, 0, 0) };
        assert_eq!(of(&[dead], Some(ScenarioEnd::Failed)), "simulation – not reached");
        let writes = StageJob { state: JobState::Leased, characters: 1240, ..job(Stage::Paths, 0, 2, 0) };
        assert_eq!(of(&[writes], None), "paths … 1240 characters (1 retry)");
        let waiting = StageJob { state: JobState::Ready, ..job(Stage::Simulation, 0, 0, 0) };
        assert_eq!(of(&[waiting], None), "simulation … waiting");
        let item = |item: &str, state: JobState| StageJob {
            item: item.parse().unwrap(),
            state,
            ..job(Stage::Scoring, 0, 1, 2)
        };
        let several = [item("reference-1", JobState::Succeeded), item("reference-2", JobState::Leased)];
        assert_eq!(of(&several, None), "scoring … 4 ms");
    }
}
