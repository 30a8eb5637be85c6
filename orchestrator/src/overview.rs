//! Overview: batches, stages, workers and the newest failures, for lists and tables.

use std::collections::BTreeMap;

use socrates_model::job::Stage;
use socrates_model::wire::{BatchStatus, Failed, Limits, Part, Priority, StageStatus, Table, WorkerStatus};

use crate::circuit::Allows;
use crate::pace::Pacer;
use crate::state::{Job, Millis, ScenarioEnd, State, Worker};

/// Bytes that the list of batches may take in a reply, estimated.
pub(crate) const BATCH_BYTES: usize = 14 * 1024;
/// Bytes that the workers of a table may take, estimated.
const WORKER_BYTES: usize = 26 * 1024;
/// Characters of the name of a machine that are told.
const HOST_CHARS: usize = 64;
/// Failures in a table at most, and characters of the text of each.
const FAILURES: usize = 12;
const FAULT_CHARS: usize = 200;
/// Paused batches that are told, at most, and bytes of the name of each.
const PAUSED: usize = 20;
const NAME_BYTES: usize = 200;
/// Batches whose shares are told by name, at most.
const SHARES: usize = 32;
/// Ready jobs of a stage that are looked at for the one that has waited the longest, oldest scenarios first.
const LOOKED_AT: usize = 1_000;

/// Every stage, in pipeline order.
const STAGES: [Stage; 6] =
    [Stage::Proposal, Stage::Review, Stage::Paths, Stage::Behaviors, Stage::Simulation, Stage::Scoring];

fn count(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

/// Every batch, in the order in which they were submitted.
fn every(state: &State, now: Millis) -> Vec<BatchStatus> {
    let mut order: Vec<&str> = Vec::new();
    let mut found: BTreeMap<&str, BatchStatus> = BTreeMap::new();
    for scenario in state.by_order.values().filter_map(|id| state.scenarios.get(id)) {
        let name = scenario.batch.as_str();
        let batch = found.entry(name).or_insert_with(|| {
            order.push(name);
            let own = state.batches.get(name).cloned().unwrap_or_default();
            BatchStatus {
                name: name.to_owned(),
                paused: state.paused.contains(name) || state.paused.contains(""),
                since_ms: scenario.since_ms,
                limits: own.limits,
                taken: if own.limits.are_none() { Limits::default() } else { own.taken() },
                over: own.over,
                priority: scenario.priority,
                pace: state.paces.get(name).map_or_else(|| Pacer::default().told(now), |pacer| pacer.told(now)),
                ..BatchStatus::default()
            }
        });
        batch.total += 1;
        batch.done += u32::from(scenario.end.is_some());
        batch.failed += u32::from(scenario.end == Some(ScenarioEnd::Failed));
        batch.canceled += u32::from(scenario.end == Some(ScenarioEnd::Canceled));
    }
    for queue in state.queues.values() {
        let Some(batch) = found.get_mut(queue.batch.as_str()) else { continue };
        let (unmade, left) = (queue.unmade(), queue.left_out);
        batch.unmade += unmade;
        batch.total += unmade + left;
        batch.done += left;
        match queue.left_as {
            ScenarioEnd::Canceled => batch.canceled += left,
            ScenarioEnd::Failed | ScenarioEnd::Judged(_) => batch.failed += left,
        }
    }
    for id in running(state) {
        let batch = state.scenarios.get(id).and_then(|scenario| found.get_mut(scenario.batch.as_str()));
        if let Some(batch) = batch {
            batch.running += 1;
        }
    }
    order.into_iter().filter_map(|name| found.remove(name)).collect()
}

/// The batches in the order in which they were submitted, the newest where not all fit, and how many do not.
pub(crate) fn batches(state: &State, now: Millis) -> (Vec<BatchStatus>, u32) {
    let all = every(state, now);
    let total = all.len();
    let mut listed: Vec<BatchStatus> = Vec::new();
    let mut room = BATCH_BYTES;
    for batch in all.into_iter().rev() {
        let size = 240 + batch.name.len() + batch.over.len();
        if size > room {
            break;
        }
        room -= size;
        listed.push(batch);
    }
    listed.reverse();
    set_ends(state, &mut listed);
    let left = total - listed.len();
    (listed, count(left))
}

/// Says of batches that are done when the last of it ended.
fn set_ends(state: &State, batches: &mut [BatchStatus]) {
    let is_done = |batch: &&mut BatchStatus| batch.done == batch.total;
    let mut done: BTreeMap<String, &mut BatchStatus> =
        batches.iter_mut().filter(is_done).map(|batch| (batch.name.clone(), batch)).collect();
    if done.is_empty() {
        return;
    }
    for scenario in state.scenarios.values() {
        let Some(batch) = done.get_mut(&scenario.batch) else { continue };
        // What was made last of a scenario is what ended it.
        let last = scenario.jobs.last().and_then(|key| state.jobs.get(key)).map_or(0, |job| job.since_ms);
        batch.ended_ms = batch.ended_ms.max(last);
    }
}

/// How a batch stands beside others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Share {
    /// Name of the batch, at most 200 bytes of it; empty for all that are not listed.
    pub name: String,
    /// How urgent it is.
    pub priority: Priority,
    /// Scenarios that have not ended.
    pub open: u32,
    /// Scenarios of which a worker holds a job.
    pub running: u32,
}

/// Batches that are not done, the newest `SHARES` of them, so that no figure grows with the work; the others together under an empty
/// name. No two have the same name and priority.
#[must_use]
pub fn shares(state: &State, now: Millis) -> Vec<Share> {
    let open: Vec<BatchStatus> = every(state, now).into_iter().filter(|batch| batch.done < batch.total).collect();
    let others = open.len().saturating_sub(SHARES);
    let mut shares: BTreeMap<(String, Priority), (u32, u32)> = BTreeMap::new();
    for (at, batch) in open.into_iter().enumerate() {
        let listed = (shortened(&batch.name, NAME_BYTES), batch.priority);
        let key = if at < others { (String::new(), Priority::Normal) } else { listed };
        let sum = shares.entry(key).or_default();
        *sum = (sum.0.saturating_add(batch.total - batch.done), sum.1.saturating_add(batch.running));
    }
    let share = |((name, priority), (open, running))| Share { name, priority, open, running };
    shares.into_iter().map(share).collect()
}

fn shortened(name: &str, bytes: usize) -> String {
    let end = (0..=bytes.min(name.len())).rev().find(|at| name.is_char_boundary(*at)).unwrap_or(0);
    name.split_at(end).0.to_owned()
}

/// How the circuit of a stage may stand.
pub const CIRCUITS: [&str; 3] = ["closed", "open", "trying"];

/// How the circuit of a stage stands, one of [`CIRCUITS`]: jobs are handed out, none are, or a single one is tried.
#[must_use]
pub fn circuit(state: &State, stage: Stage, now: Millis) -> &'static str {
    match state.circuits.get(&stage).map(|circuit| circuit.allows(now)) {
        None | Some(Allows::All) => "closed",
        Some(Allows::NoneUntil(_)) => "open",
        Some(Allows::One) => "trying",
    }
}

/// Scenarios of which a worker holds a job, once each.
pub(crate) fn running(state: &State) -> std::collections::BTreeSet<&socrates_model::ScenarioId> {
    state.workers.values().flat_map(|worker| &worker.held).map(|key| &key.scenario).collect()
}

/// What clients hold back.
pub(crate) fn paused(state: &State) -> Vec<Part> {
    let part = |batch: &String| if batch.is_empty() { Part::All } else { Part::Batch(batch.clone()) };
    // A reply holds only a part of them.
    let batches = state.paused.iter().filter(|batch| batch.len() <= NAME_BYTES).take(PAUSED).map(part);
    batches.chain(state.paused_stages.iter().map(|stage| Part::Stage(*stage))).collect()
}

/// Whether a worker was heard of in the length of a lease.
pub(crate) fn is_alive(state: &State, worker: &Worker, now: Millis) -> bool {
    now.saturating_sub(worker.seen) < state.policy.lease_ms
}

/// The table of stages and workers at time `now`, ms.
pub(crate) fn table(state: &State, now: Millis) -> Table {
    let mut workers: Vec<WorkerStatus> = Vec::new();
    // One that has beaten since this orchestrator began, but did not say yet who it is, is introduced within a beat.
    let known = |worker: &&Worker| is_alive(state, worker, now) && !worker.hello.stages.is_empty();
    let alive = || state.workers.values().filter(known);
    let mut room = WORKER_BYTES;
    for worker in alive() {
        let status = WorkerStatus {
            instance: worker.hello.instance.chars().take(NAME_BYTES).collect(),
            host: worker.hello.host.chars().take(HOST_CHARS).collect(),
            pid: worker.hello.pid,
            stages: worker.hello.stages.clone(),
            holds: count(worker.held.len()),
            first: worker.held.first().cloned(),
            seen_ms: now.saturating_sub(worker.seen),
            draining: worker.draining,
        };
        let first =
            status.first.as_ref().map_or(0, |key| 80 + key.scenario.as_str().len() + key.item.to_string().len());
        let size = 130 + status.instance.len() + status.host.len() + 12 * status.stages.len() + first;
        if size > room {
            break;
        }
        room -= size;
        workers.push(status);
    }
    Table {
        epoch: state.epoch,
        stages: STAGES.into_iter().map(|stage| stage_status(state, stage, now)).collect(),
        workers_left: count(alive().count() - workers.len()),
        workers,
        failures: failures(state, now),
        tokens: state.tally.tokens.clone(),
    }
}

fn stage_status(state: &State, stage: Stage, now: Millis) -> StageStatus {
    let own = state.tally.jobs.iter().filter(|((of, _), count)| *of == stage && **count > 0);
    StageStatus {
        stage,
        states: own.map(|((_, state), count)| (*state, *count)).collect(),
        paused: state.paused.contains("") || state.paused_stages.contains(&stage),
        p50_ms: state.tally.median_ms(stage),
        waited_ms: waited_ms(state, stage, now),
    }
}

/// How long the job of a stage has waited for a worker that has waited the longest, ms, among the first in line.
#[must_use]
pub fn waited_ms(state: &State, stage: Stage, now: Millis) -> Option<u64> {
    let ready = state.ready.get(&stage)?.iter().take(LOOKED_AT);
    ready.filter_map(|(_, _, _, key)| state.jobs.get(key)).map(|job| now.saturating_sub(job.ready)).max()
}

/// Workers that beat by stage: idle, busy and draining ones.
#[must_use]
pub fn workers(state: &State, now: Millis) -> BTreeMap<(Stage, &'static str), u64> {
    let mut counts: BTreeMap<(Stage, &'static str), u64> = BTreeMap::new();
    for worker in state.workers.values().filter(|worker| is_alive(state, worker, now)) {
        let how = match (worker.draining, worker.held.is_empty()) {
            (true, _) => "draining",
            (false, true) => "idle",
            (false, false) => "busy",
        };
        for stage in &worker.hello.stages {
            *counts.entry((*stage, how)).or_default() += 1;
        }
    }
    counts
}

fn failures(state: &State, now: Millis) -> Vec<Failed> {
    let one = |(key, number, at): &(socrates_model::job::JobKey, u32, Millis)| {
        let attempts = |job: &Job| job.attempts.iter().find(|attempt| attempt.number == *number).cloned();
        let attempt = state.jobs.get(key).and_then(attempts)?;
        let fault = attempt.faults.into_iter().next().map(|fault| fault.shortened(FAULT_CHARS, FAULT_CHARS));
        Some(Failed {
            key: key.clone(),
            attempt: *number,
            class: attempt.class,
            fault,
            ago_ms: now.saturating_sub(*at),
        })
    };
    state.tally.failures().filter_map(one).take(FAILURES).collect()
}
