//! Status: how things stand, for clients, in pages that fit a message.

use std::collections::BTreeMap;

use socrates_model::ScenarioId;
use socrates_model::job::JobKey;
use socrates_model::wire::{JobStatus, ScenarioStatus, StatusAsk, StatusReply};

use crate::overview;
use crate::pace::Pacer;
use crate::policy::Policy;
use crate::recover::Snapshot;
use crate::state::{Job, Millis, Scenario, ScenarioEnd, State};
use crate::why;

/// Scenario lines in one reply at most.
const LINES: usize = 200;
/// Jobs in one line at most.
const LINE_JOBS: usize = 24;
/// Bytes of a reply at most, estimated; the envelope and the names of fields take the rest.
const BYTES: usize = 40 * 1024;
/// Faults shown for a job at most, and characters of each message.
const FAULTS: usize = 6;
const FAULT_CHARS: usize = 300;

/// Answers a status question at time `now`, ms. Lines come in order of submission; ask again from `from` plus the number of lines
/// until there are none. The first lines and the table come with the list of batches; from [`u32::MAX`] on there are none of them.
///
/// A scenario with many runs takes several lines under the same id, each with a part of its jobs. Where jobs or the table were asked for,
/// they come instead of lines.
#[must_use]
pub fn status(state: &State, ask: &StatusAsk, now: Millis) -> StatusReply {
    let chosen = || {
        let ids = state.by_order.values().filter_map(|id| state.scenarios.get(id));
        ids.filter(|scenario| ask.batch.is_empty() || scenario.batch == ask.batch)
    };
    let (total, done) = if ask.batch.is_empty() {
        state.counts()
    } else {
        let (unmade, left) = state.unmade(|queue| queue.batch == ask.batch);
        let made = (unmade + left, left);
        chosen().fold(made, |(total, done), scenario| (total + 1, done + usize::from(scenario.end.is_some())))
    };
    let mut results: BTreeMap<ScenarioEnd, u32> = BTreeMap::new();
    for end in chosen().filter_map(|scenario| scenario.end) {
        *results.entry(end).or_default() += 1;
    }
    for queue in
        state.queues.values().filter(|one| one.left_out > 0 && (ask.batch.is_empty() || one.batch == ask.batch))
    {
        *results.entry(queue.left_as).or_default() += queue.left_out;
    }
    let is_of = |id: &&ScenarioId| {
        ask.batch.is_empty() || state.scenarios.get(*id).is_some_and(|scenario| scenario.batch == ask.batch)
    };
    let running = overview::running(state).into_iter().filter(is_of).count();
    let mut workers: BTreeMap<String, u32> = BTreeMap::new();
    for worker in state.workers.values().filter(|worker| overview::is_alive(state, worker, now)) {
        for stage in &worker.hello.stages {
            *workers.entry(stage.name().to_owned()).or_default() += 1;
        }
    }
    let with_lines = ask.job.is_none() && !ask.table && ask.from < u32::MAX;
    let (batches, batches_left) =
        if ask.from == 0 && ask.job.is_none() { overview::batches(state, now) } else { (Vec::new(), 0) };
    let mut scenarios: Vec<ScenarioStatus> = Vec::new();
    let mut room = if batches.is_empty() { BYTES } else { BYTES - overview::BATCH_BYTES };
    let mut skip = usize::try_from(ask.from).unwrap_or(usize::MAX);
    'page: for scenario in chosen().filter(|_| with_lines) {
        let newest = newest(state, scenario);
        let lines = newest.len().div_ceil(LINE_JOBS).max(1);
        if skip >= lines {
            skip -= lines;
            continue;
        }
        for part in std::mem::take(&mut skip)..lines {
            let jobs = newest.iter().skip(part * LINE_JOBS).take(LINE_JOBS);
            let (line, size) = line(state, scenario, jobs);
            if scenarios.len() >= LINES || (size > room && !scenarios.is_empty()) {
                break 'page;
            }
            room = room.saturating_sub(size);
            scenarios.push(line);
        }
    }
    let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    StatusReply {
        total: count(total),
        done: count(done),
        running: count(running),
        results,
        // Only the shell knows when it began.
        serving_ms: 0,
        done_before: 0,
        workers,
        scenarios,
        pace: Some(match state.paces.get(&ask.batch) {
            Some(own) if !ask.batch.is_empty() => own.told(now),
            Some(_) | None if ask.batch.is_empty() => state.pace.told(now),
            Some(_) | None => Pacer::default().told(now),
        }),
        batches,
        batches_left,
        paused: overview::paused(state),
        whys: ask.job.as_ref().map(|job| why::whys(state, job, now)),
        table: ask.table.then(|| overview::table(state, now)),
    }
}

/// How the scenarios of a store's rows stand, each with all of its jobs and in order of submission: what [`status`] says in pages.
#[must_use]
pub fn standing(snapshot: Snapshot) -> Vec<ScenarioStatus> {
    let state = State::restore(snapshot, Policy::default(), 0);
    let scenarios = state.by_order.values().filter_map(|id| state.scenarios.get(id));
    scenarios.map(|scenario| line(&state, scenario, newest(&state, scenario).iter()).0).collect()
}

/// The jobs that stand in the plan of the revision that counts.
fn newest<'a>(state: &'a State, scenario: &'a Scenario) -> Vec<&'a JobKey> {
    let revision = scenario.settled.unwrap_or(scenario.revision);
    let stands = |key: &&JobKey| state.place(&key.scenario, key.stage, &key.item, revision) == Some(*key);
    scenario.jobs.iter().filter(stands).collect()
}

/// One line and about how many bytes it takes.
fn line<'a>(state: &State, scenario: &Scenario, jobs: impl Iterator<Item = &'a &'a JobKey>) -> (ScenarioStatus, usize) {
    let mut jobs: Vec<JobStatus> = jobs.filter_map(|key| state.jobs.get(*key)).map(job_status).collect();
    let size = |jobs: &[JobStatus]| 120 + jobs.iter().map(weight).sum::<usize>();
    if size(&jobs) > BYTES {
        // Rather without reasons than not at all; the store has them.
        jobs.iter_mut().for_each(|job| job.faults.clear());
    }
    let size = size(&jobs);
    let line =
        ScenarioStatus { id: scenario.spec.id.clone(), done: scenario.end.is_some(), result: scenario.end, jobs };
    (line, size)
}

fn job_status(job: &Job) -> JobStatus {
    let last = job.attempts.last();
    let failed = job.attempts.iter().rev().find(|attempt| !attempt.faults.is_empty());
    let faults = failed.map(|attempt| attempt.faults.iter().take(FAULTS).cloned().collect()).unwrap_or_default();
    let shorten = |fault: socrates_model::Fault| fault.shortened(FAULT_CHARS, FAULT_CHARS);
    let faults: Vec<_> = Vec::into_iter(faults).map(shorten).collect();
    let (remark, wall_ms, artifacts) = match &job.result {
        Some(result) => (result.remark.clone(), result.wall_ms, result.artifacts.clone()),
        None => (job.reason.clone(), last.map_or(0, |attempt| attempt.wall_ms), Vec::new()),
    };
    JobStatus {
        key: job.key.clone(),
        state: job.state,
        attempts: last.map_or(0, |attempt| attempt.number),
        wall_ms,
        characters: job.current().map_or(0, |attempt| attempt.characters),
        remark,
        faults,
        artifacts,
    }
}

/// About how many bytes a line takes on the bus.
fn weight(job: &JobStatus) -> usize {
    let faults: usize = job.faults.iter().map(|fault| 110 + fault.text_bytes()).sum();
    let artifacts: usize = job.artifacts.iter().map(|a| 140 + a.role.name().len() + a.media.len()).sum();
    220 + job.key.scenario.as_str().len() + job.key.item.to_string().len() + job.remark.len() + faults + artifacts
}
