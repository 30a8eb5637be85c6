//! The checker: what must hold after every step.
//!
//! | name | what must hold |
//! |---|---|
//! | I1 | a job has at most one result, and only a succeeded job has one |
//! | I2 | a job has one running attempt exactly while it is held |
//! | I3 | a job that ended leaves its state only by a requeue |
//! | I4 | counters equal the rows that they count |
//! | I5 | a job is ready exactly when all it needs has results |
//! | I6 | every acknowledged report is in the store |
//! | I7 | a job that has not ended has a timer, or a parent that can still run; a batch with open scenarios has a timer |
//! | I8 | scenarios done are those submitted without the failed, dead and canceled ones |
//! | I9 | fences of one job only grow |
//! | I10 | tokens spent are the sum over all attempts, late ones as well |

use std::collections::BTreeMap;

use crate::pipeline;
use crate::state::{Attempt, AttemptEnd, Job, JobState, State};

/// Everything that is wrong with a state; empty when nothing is.
#[must_use]
pub fn fsck(state: &State) -> Vec<String> {
    let mut wrong = Vec::new();
    for job in state.jobs.values() {
        check_job(state, job, &mut wrong);
    }
    check_indices(state, &mut wrong);
    check_scenarios(state, &mut wrong);
    check_batches(state, &mut wrong);
    wrong
}

fn check_job(state: &State, job: &Job, wrong: &mut Vec<String>) {
    let key = &job.key;
    let held = matches!(job.state, JobState::Leased | JobState::Canceling);
    // I1: one result, and only of a job that succeeded.
    if job.result.is_some() != (job.state == JobState::Succeeded) {
        wrong.push(format!("I1 {key}: {} with result `{}`", job.state.name(), job.result.is_some()));
    }
    let winners = job.attempts.iter().filter(|attempt| attempt.end == Some(AttemptEnd::Succeeded)).count();
    if winners > 1 {
        wrong.push(format!("I1 {key}: `{winners}` attempts succeeded"));
    }
    // I2: one attempt runs exactly while the job is held.
    let running = job.attempts.iter().filter(|attempt| attempt.end.is_none()).count();
    if running != usize::from(held) || (held && job.attempts.last().is_none_or(|last| last.end.is_some())) {
        wrong.push(format!("I2 {key}: `{running}` attempts run while it is {}", job.state.name()));
    }
    // I5: ready exactly when all it needs has results, and what stands beside has ended. Who went on without such an
    // input does not wait for it when it is tried once more.
    let parents = || job.sources.iter().map(|(role, source)| (role.is_beside(), state.jobs.get(source)));
    let lacks = parents().any(|(beside, parent)| !beside && parent.is_none_or(|parent| parent.result.is_none()));
    let waits = lacks || parents().any(|(_, parent)| parent.is_none_or(|parent| !parent.state.is_terminal()));
    match job.state {
        JobState::Ready | JobState::Delayed | JobState::Leased | JobState::Succeeded if lacks => {
            wrong.push(format!("I5 {key}: {} without all inputs", job.state.name()));
        }
        JobState::Blocked if !waits => wrong.push(format!("I5 {key}: blocked with all inputs")),
        JobState::Blocked => {
            let open = |source| state.jobs.get(source).is_some_and(|parent| !parent.state.is_terminal());
            if !job.sources.values().any(open) {
                wrong.push(format!("I7 {key}: blocked for nobody"));
            }
        }
        JobState::Ready
        | JobState::Delayed
        | JobState::Leased
        | JobState::Canceling
        | JobState::Succeeded
        | JobState::Failed
        | JobState::Dead
        | JobState::Canceled
        | JobState::Superseded => {}
    }
    // I7: what can stall has a timer; what cannot has none.
    let timed = matches!(job.state, JobState::Delayed | JobState::Leased | JobState::Canceling);
    if timed != job.due.is_some() || job.due.is_some_and(|due| !state.timers.contains(&(due, key.clone()))) {
        wrong.push(format!("I7 {key}: {} with timer `{:?}`", job.state.name(), job.due));
    }
    // I9: fences and numbers grow.
    let grows = |pair: &[Attempt]| matches!(pair, [a, b] if a.fence < b.fence && a.number < b.number);
    if !job.attempts.windows(2).all(grows) || job.attempts.last().is_some_and(|last| last.fence >= state.next_fence) {
        wrong.push(format!("I9 {key}: fences do not grow"));
    }
    // A held job is in its worker's hand.
    if held {
        let holder = job.attempts.last().and_then(|attempt| state.workers.get(&attempt.instance));
        if holder.is_none_or(|worker| !worker.held.contains(key)) {
            wrong.push(format!("{key}: its worker does not hold it"));
        }
    }
}

fn check_indices(state: &State, wrong: &mut Vec<String>) {
    let count = |wanted: fn(&Job) -> bool| state.jobs.values().filter(|job| wanted(job)).count();
    // I4: counters and indices equal counts of rows.
    let ready: usize = state.ready.values().map(std::collections::BTreeSet::len).sum();
    let pairs = [
        ("ready", ready, count(|job| job.state == JobState::Ready)),
        ("open", state.open_jobs, count(|job| !job.state.is_terminal())),
        ("timers", state.timers.len(), count(|job| job.due.is_some())),
        (
            "authoring",
            usize::try_from(state.authoring).unwrap_or(usize::MAX),
            count(|job| {
                matches!(job.state, JobState::Leased | JobState::Canceling) && pipeline::is_authored(job.key.stage)
            }),
        ),
        ("waiting", state.waiting.values().map(std::collections::BTreeSet::len).sum(), {
            count(|job| {
                matches!(job.state, JobState::Ready | JobState::Delayed) && job.shares() && job.idem_key.is_some()
            })
        }),
    ];
    for (what, counter, rows) in pairs {
        if counter != rows {
            wrong.push(format!("I4 {what}: counter `{counter}`, rows `{rows}`"));
        }
    }
    for ((stage, of), counter) in &state.tally.jobs {
        let rows = state.jobs.values().filter(|job| (job.key.stage, job.state) == (*stage, *of)).count();
        if usize::try_from(*counter).unwrap_or(usize::MAX) != rows {
            wrong.push(format!("I4 {stage} {}: counter `{counter}`, rows `{rows}`", of.name()));
        }
    }
    let all: u64 = state.tally.jobs.values().sum();
    let held = count(|job| {
        matches!(job.state, JobState::Leased | JobState::Canceling)
            && job.key.stage != socrates_model::job::Stage::Review
    });
    if usize::try_from(all).ok() != Some(state.jobs.len()) || usize::try_from(state.pace.held).ok() != Some(held) {
        let (jobs, paced) = (state.jobs.len(), state.pace.held);
        wrong.push(format!("I4 jobs: `{all}` counted of `{jobs}`, `{paced}` held of `{held}`"));
    }
    for worker in state.workers.values() {
        for key in &worker.held {
            let holds = state.jobs.get(key).and_then(Job::current).is_some_and(|a| a.instance == worker.hello.instance);
            if !holds {
                wrong.push(format!("I2 {key}: in the hand of `{}`, which has lost it", worker.hello.instance));
            }
        }
    }
    // Single flight: no key twice at one time.
    let mut flying: BTreeMap<_, &Job> = BTreeMap::new();
    for job in state.jobs.values().filter(|job| job.state == JobState::Leased && job.shares()) {
        let Some(idem_key) = job.idem_key else {
            wrong.push(format!("{}: leased without a key", job.key));
            continue;
        };
        if let Some(twin) = flying.insert(idem_key, job) {
            wrong.push(format!("{} and {} do the same work", job.key, twin.key));
        }
    }
}

fn check_scenarios(state: &State, wrong: &mut Vec<String>) {
    let mut done = 0;
    let mut under_way = 0;
    for (id, scenario) in &state.scenarios {
        let open =
            scenario.jobs.iter().filter_map(|key| state.jobs.get(key)).filter(|j| !j.state.is_terminal()).count();
        if open != scenario.open {
            wrong.push(format!("I4 {id}: counter `{}`, open jobs `{open}`", scenario.open));
        }
        // I8: a scenario ends when, and only when, nothing is left to do.
        if scenario.end.is_some() != (open == 0) {
            wrong.push(format!("I8 {id}: `{open}` jobs open, ended `{:?}`", scenario.end));
        }
        done += usize::from(scenario.end.is_some());
        under_way += usize::from(scenario.started && scenario.end.is_none() && !scenario.spec.review);
        if scenario.repairs > state.policy.repairs || scenario.reproposals > state.policy.reproposals {
            wrong.push(format!("{id}: more revisions than its budget"));
        }
    }
    if (done, under_way) != (state.done, state.under_way) {
        wrong.push(format!("I4 scenarios: `{done}` ended, `{under_way}` under way, not what was counted"));
    }
    let known = |id: &socrates_model::ScenarioId| state.scenarios.contains_key(id);
    wrong.extend(state.jobs.keys().filter(|key| !known(&key.scenario)).map(|key| format!("{key}: no such scenario")));
}

fn check_batches(state: &State, wrong: &mut Vec<String>) {
    for (name, batch) in &state.batches {
        let own = |one: &&crate::state::Scenario| one.batch == *name && one.end.is_none();
        let unmade = state.queues.values().filter(|queue| queue.batch == *name).map(|queue| u64::from(queue.unmade()));
        let open =
            u64::try_from(state.scenarios.values().filter(own).count()).unwrap_or(u64::MAX) + unmade.sum::<u64>();
        if batch.open != open {
            wrong.push(format!("I4 batch `{name}`: counter `{}`, open scenarios `{open}`", batch.open));
        }
        let timed = batch.due.is_some_and(|due| state.batch_timers.contains(&(due, name.clone())));
        if timed != (open > 0) {
            wrong.push(format!("I7 batch `{name}`: `{open}` scenarios open with timer `{:?}`", batch.due));
        }
    }
    if state.batch_timers.len() != state.batches.values().filter(|batch| batch.due.is_some()).count() {
        wrong.push("I4 batches: a timer belongs to none of them".to_owned());
    }
    for (place, queue) in &state.queues {
        let own =
            || state.by_order.range(*place..queue.end()).filter_map(|(at, id)| Some((at, state.scenarios.get(id)?)));
        let made = own().count();
        let waiting = own().filter(|(_, one)| !one.started && one.end.is_none()).count();
        let counted = (usize::try_from(queue.made).ok(), usize::try_from(queue.waiting).ok());
        if counted != (Some(made), Some(waiting)) {
            wrong.push(format!("I4 series `{place}`: counters `{counted:?}`, made `{made}`, waiting `{waiting}`"));
        }
        for (at, scenario) in own() {
            let index = u32::try_from(at - place).unwrap_or(u32::MAX);
            if queue.series.scenario(index).as_ref() != Some(&scenario.spec) || scenario.batch != queue.batch {
                wrong.push(format!("series `{place}`: scenario `{}` is not its number `{index}`", scenario.spec.id));
            }
        }
        let idle = queue.waiting < crate::series::AHEAD && queue.unmade() > 0;
        if idle && !state.drawing.contains(place) {
            wrong.push(format!("series `{place}`: `{waiting}` wait, and nobody draws the next ones"));
        }
    }
}
