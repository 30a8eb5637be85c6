//! Why: what keeps a job where it is. The same rules as those by which jobs are handed out, asked of one job.

use std::collections::BTreeSet;

use socrates_model::job::JobKey;
use socrates_model::wire::{JobAsk, JobWhy, Part, Wait};

use crate::bucket::server_of;
use crate::circuit::Allows;
use crate::overview::is_alive;
use crate::pipeline;
use crate::policy::Policy;
use crate::recover::Snapshot;
use crate::state::{Job, JobState, Millis, State, Worker};

/// Jobs in one reply at most, those that have not ended first.
const JOBS: usize = 100;
/// Jobs that one waits for that are named, at most.
const PARENTS: usize = 6;
/// Characters of a reason, at most.
const REASON_CHARS: usize = 200;

/// Why these jobs stand where they do at time `now`, ms.
pub(crate) fn whys(state: &State, ask: &JobAsk, now: Millis) -> Vec<JobWhy> {
    told(state, ask, now, true)
}

/// The same of the rows of a store that nobody serves.
#[must_use]
pub fn whys_of_rows(rows: Snapshot, ask: &JobAsk) -> Vec<JobWhy> {
    told(&State::restore(rows, Policy::default(), 0), ask, 0, false)
}

fn told(state: &State, ask: &JobAsk, now: Millis, served: bool) -> Vec<JobWhy> {
    let Some(scenario) = state.scenarios.get(&ask.scenario) else { return Vec::new() };
    let revision = scenario.settled.unwrap_or(scenario.revision);
    let stands = |key: &&JobKey| {
        ask.revision.is_some() || state.place(&key.scenario, key.stage, &key.item, revision) == Some(*key)
    };
    let mut jobs: Vec<&Job> = scenario
        .jobs
        .iter()
        .filter(|key| ask.means(key))
        .filter(stands)
        .filter_map(|key| state.jobs.get(key))
        .collect();
    jobs.sort_by_key(|job| job.state.is_terminal());
    jobs.truncate(JOBS);
    jobs.sort_by_key(|job| (job.key.stage, &job.key.item, job.key.revision));
    let why = |job: &&Job| JobWhy { key: job.key.clone(), state: job.state, why: why(state, job, now, served) };
    jobs.iter().map(why).collect()
}

fn why(state: &State, job: &Job, now: Millis, served: bool) -> Vec<Wait> {
    let mut found = Vec::new();
    if !job.state.is_terminal() {
        found.extend((!served).then_some(Wait::Unserved));
    }
    match job.state {
        JobState::Blocked => {
            found.extend(pauses(state, job));
            let parents: BTreeSet<&JobKey> = job.sources.values().collect();
            let open = parents.into_iter().filter_map(|key| state.jobs.get(key)).filter(|job| !job.state.is_terminal());
            found.extend(open.take(PARENTS).map(|job| Wait::Parent { key: job.key.clone(), state: job.state }));
        }
        JobState::Ready => {
            found.extend(pauses(state, job));
            // What is held back stands in no line.
            let held_back = !found.is_empty();
            if served {
                found.extend(limits(state, job, now));
                found.extend((!held_back).then(|| line(state, job, now)));
            }
        }
        JobState::Delayed => {
            found.extend(pauses(state, job));
            let in_ms = job.due.map_or(job.delay_ms, |due| due.saturating_sub(now));
            found.push(Wait::Backoff { in_ms, after: shortened(&job.reason) });
        }
        JobState::Leased | JobState::Canceling => found.extend(held(state, job, now)),
        JobState::Succeeded => found.push(Wait::Ended(String::new())),
        JobState::Failed | JobState::Dead | JobState::Canceled | JobState::Superseded => {
            found.push(Wait::Ended(shortened(&job.reason)));
        }
    }
    found
}

fn shortened(reason: &str) -> String {
    reason.chars().take(REASON_CHARS).collect()
}

fn pauses(state: &State, job: &Job) -> Vec<Wait> {
    let batch = state.scenarios.get(&job.key.scenario).map(|scenario| scenario.batch.as_str()).unwrap_or_default();
    let all = state.paused.contains("").then_some(Part::All);
    let own = (!batch.is_empty() && state.paused.contains(batch)).then(|| Part::Batch(batch.to_owned()));
    let stage = state.paused_stages.contains(&job.key.stage).then_some(Part::Stage(job.key.stage));
    [all, own, stage].into_iter().flatten().map(Wait::Paused).collect()
}

/// Limits that a ready job waits for beside a free worker.
fn limits(state: &State, job: &Job, now: Millis) -> Vec<Wait> {
    let mut found = Vec::new();
    let stage = job.key.stage;
    if pipeline::is_authored(stage) && state.authoring >= state.author_slots {
        found.push(Wait::Slots { most: state.author_slots });
    }
    if let Some(Allows::NoneUntil(until)) = state.circuits.get(&stage).map(|circuit| circuit.allows(now)) {
        found.push(Wait::Rests { in_ms: until.saturating_sub(now) });
    }
    let server = server_of(&job.spec);
    if let Some((server, bucket)) = server.and_then(|server| Some((server, state.servers.get(server)?))) {
        let from = bucket.from(now, (0, 0), bucket.typical(stage));
        if from > now {
            found.push(Wait::Rate { server: server.to_owned(), in_ms: from - now });
        }
    }
    let begins = state.scenarios.get(&job.key.scenario).is_some_and(|one| !one.started && !one.spec.review);
    let most = state.most_begun();
    if begins && state.under_way >= most {
        found.push(Wait::Begun { most: u32::try_from(most).unwrap_or(u32::MAX) });
    }
    let twin = job.idem_key.filter(|_| job.shares()).and_then(|idem_key| state.in_flight.get(&idem_key));
    found.extend(twin.filter(|twin| **twin != job.key).map(|twin| Wait::Twin(twin.clone())));
    found
}

/// The line of a ready job, or why nobody comes for it.
fn line(state: &State, job: &Job, now: Millis) -> Wait {
    let stage = job.key.stage;
    let wanted = &state.policy.code_version;
    // What a worker did not say since the orchestrator began it said to the one before.
    let fits = |worker: &&Worker| {
        let version = &worker.hello.code_version;
        wanted.is_empty() || version.is_empty() || version == wanted
    };
    let serving: Vec<&Worker> = state
        .workers
        .values()
        .filter(|worker| worker.hello.stages.contains(&stage) && is_alive(state, worker, now))
        .filter(fits)
        .collect();
    let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    if serving.is_empty() {
        return match state.strangers.get(&stage) {
            Some(found) => Wait::Version { wanted: wanted.clone(), found: found.clone() },
            None => Wait::NoWorker,
        };
    }
    let workers = count(serving.len());
    if serving.iter().all(|worker| worker.draining) {
        return Wait::Draining { workers };
    }
    let ready = state.ready.get(&stage);
    let before = ready.map_or(0, |ready| ready.iter().take_while(|(_, _, _, key)| *key != job.key).count());
    let busy = count(serving.iter().filter(|worker| !worker.held.is_empty()).count());
    Wait::Line { before: count(before), workers, busy }
}

fn held(state: &State, job: &Job, now: Millis) -> Option<Wait> {
    let attempt = job.current()?;
    let worker = state.workers.get(&attempt.instance);
    Some(Wait::Held {
        instance: attempt.instance.clone(),
        host: worker.map(|worker| worker.hello.host.chars().take(64).collect()).unwrap_or_default(),
        pid: worker.map_or(0, |worker| worker.hello.pid),
        attempt: attempt.number,
        for_ms: now.saturating_sub(attempt.granted),
        beat_ms: worker.map_or(0, |worker| now.saturating_sub(worker.seen)),
        deadline_ms: job.deadline_at.saturating_sub(now),
    })
}
