//! What a batch may take: time, tokens and money of all its scenarios together.
//!
//! ```text
//! tokens or money spent ─► nothing more is begun, no author is asked again; what was begun is finished
//! deadline passed       ─► what is open fails
//! ```
//!
//! The time of a batch goes on while something of it is open and an orchestrator runs. So every job that has not ended has an end in sight,
//! also one that only waits: that of its batch.

use socrates_model::ScenarioId;
use socrates_model::fault::{FailureClass, Fault, FaultCode};
use socrates_model::job::JobKey;
use socrates_model::standing::ScenarioEnd;
use socrates_model::wire::Limits;

use crate::batches::Batch;
use crate::failure::Failure;
use crate::pipeline;
use crate::state::{AttemptEnd, JobState, Millis, Scenario, State};
use crate::turn::Turn;

/// Longest time of a batch that a crash may lose, ms: so often it is saved while something of it is open.
const SAVED_EVERY_MS: Millis = 60_000;

impl State {
    /// The batch of this name, which is made where there is none.
    pub(crate) fn batch(&mut self, name: &str, now: Millis) -> &mut Batch {
        let new = || Batch { name: name.to_owned(), counted_to: now, ..Batch::default() };
        self.batches.entry(name.to_owned()).or_insert_with(new)
    }

    /// Counts what an attempt has cost into its batch.
    pub(crate) fn spent_by(&mut self, key: &JobKey, tokens: (u64, u64), now: Millis) -> Option<&mut Batch> {
        if tokens == (0, 0) || !pipeline::is_authored(key.stage) {
            return None;
        }
        let money = self.money(&key.scenario, tokens);
        let name = self.scenarios.get(&key.scenario)?.batch.clone();
        let batch = self.batch(&name, now);
        let tokens = tokens.0.saturating_add(tokens.1);
        batch.spent = (batch.spent.0.saturating_add(tokens), batch.spent.1.saturating_add(money));
        Some(batch)
    }

    /// Longest time of a batch, ms; none where nothing limits it.
    fn deadline_ms(&self, batch: &Batch) -> Option<u64> {
        let own = if batch.limits.deadline_ms > 0 { batch.limits.deadline_ms } else { self.policy.batch_deadline_ms };
        (own > 0).then_some(own)
    }
}

impl Turn<'_> {
    /// A batch to be changed; its row is saved at the end of the step.
    pub(crate) fn batch_mut(&mut self, name: &str) -> &mut Batch {
        self.batches.insert(name.to_owned());
        self.state.batch(name, self.now)
    }

    /// What a batch may take is set; where it was over, it goes on.
    pub(crate) fn limit(&mut self, name: &str, limits: Limits) {
        let batch = self.batch_mut(name);
        batch.anew();
        if !limits.are_none() {
            batch.limits = limits;
        }
    }

    /// More of a batch is open.
    pub(crate) fn opened(&mut self, name: &str, count: u64) {
        self.count_time(name);
        self.state.batch(name, self.now).open += count;
        self.watch(name);
    }

    /// Less of a batch is open.
    pub(crate) fn shut(&mut self, name: &str, count: u64) {
        let batch = self.state.batch(name, self.now);
        batch.open = batch.open.saturating_sub(count);
        if batch.open == 0 {
            self.count_time(name);
            self.batch_mut(name);
            self.watch(name);
        }
    }

    /// Counts the time that a batch was open since it was counted last.
    fn count_time(&mut self, name: &str) {
        let now = self.now;
        let batch = self.state.batch(name, now);
        if batch.due.is_some() {
            batch.ran_ms = batch.ran_ms.saturating_add(now.saturating_sub(batch.counted_to));
        }
        batch.counted_to = now;
    }

    /// Arms the timer of a batch of which something is open, and clears that of any other.
    fn watch(&mut self, name: &str) {
        let now = self.now;
        let Some(batch) = self.state.batches.get(name) else { return };
        let left = self.state.deadline_ms(batch).map_or(SAVED_EVERY_MS, |most| most.saturating_sub(batch.ran_ms));
        // What is left open after the deadline, a run that a verdict let follow, gets the same pause once more.
        let pause = if left == 0 { SAVED_EVERY_MS } else { left.min(SAVED_EVERY_MS) };
        let due = (batch.open > 0).then(|| now.saturating_add(pause));
        let batch = self.state.batch(name, now);
        let before = std::mem::replace(&mut batch.due, due);
        if let Some(before) = before {
            self.state.batch_timers.remove(&(before, name.to_owned()));
        }
        if let Some(due) = due {
            self.state.batch_timers.insert((due, name.to_owned()));
        }
    }

    /// Arms the timers of all batches, and draws from all series.
    pub(crate) fn recover_batches(&mut self) {
        for name in self.state.batches.keys().cloned().collect::<Vec<_>>() {
            self.watch(&name);
        }
        self.state.drawing = self.state.queues.keys().copied().collect();
    }

    /// Counts the time of the batches whose timers have run out, and ends those whose deadline has passed.
    pub(crate) fn tick_batches(&mut self) {
        while let Some((due, name)) = self.state.batch_timers.first().cloned() {
            if due > self.now {
                break;
            }
            self.count_time(&name);
            let batch = self.batch_mut(&name).clone();
            if let Some(most) = self.state.deadline_ms(&batch).filter(|most| batch.ran_ms >= *most) {
                let (ran, most) = (hours(batch.ran_ms), hours(most));
                self.end_batch(&name, &format!("the batch `{name}` ran for {ran}, its deadline is {most}"));
            }
            self.watch(&name);
        }
    }

    /// Counts what an attempt has cost. Where that was all its batch may cost, nothing more of it is begun.
    pub(crate) fn spend(&mut self, key: &JobKey, tokens: (u64, u64)) {
        let Some(batch) = self.state.spent_by(key, tokens, self.now) else { return };
        let (name, limits, taken) = (&batch.name, batch.limits, batch.taken());
        let over = |limit: u64, taken: u64| limit > 0 && taken >= limit;
        let why = if over(limits.tokens, taken.tokens) {
            format!("the batch `{name}` spent {} tokens, {} are allowed", taken.tokens, limits.tokens)
        } else if over(limits.money, taken.money) {
            let (spent, limit) = (taken.money / 10_000, limits.money / 10_000);
            format!("the authors of the batch `{name}` cost {spent} cents, {limit} are allowed")
        } else {
            return;
        };
        if batch.over.is_empty() {
            batch.over = why;
            let name = batch.name.clone();
            self.batches.insert(name.clone());
            self.exhausted.insert(name);
        }
    }

    /// Fails what was not begun of the batches that have spent in this step what they may.
    pub(crate) fn stop_exhausted(&mut self) {
        while let Some(name) = self.exhausted.pop_first() {
            let why = self.batch_mut(&name).over.clone();
            self.leave_out(&name, ScenarioEnd::Failed);
            self.fail_open(&name, &why, FaultCode::JBudget, |scenario| !scenario.started);
        }
    }

    /// Ends a batch: what is open of it fails.
    fn end_batch(&mut self, name: &str, why: &str) {
        why.clone_into(&mut self.batch_mut(name).over);
        self.leave_out(name, ScenarioEnd::Failed);
        self.fail_open(name, why, FaultCode::JDeadline, |_| true);
    }

    /// Fails the open jobs of the chosen scenarios of a batch.
    fn fail_open(&mut self, name: &str, why: &str, code: FaultCode, chosen: impl Fn(&Scenario) -> bool) {
        let own = |one: &&Scenario| one.batch == name && one.end.is_none() && chosen(one);
        let all = self.state.by_order.values().filter_map(|id| self.state.scenarios.get(id));
        let ids: Vec<ScenarioId> = all.filter(own).map(|one| one.spec.id.clone()).collect();
        for id in ids {
            let keys = self.scenario(&id).map(|scenario| scenario.jobs.clone()).unwrap_or_default();
            for key in keys {
                match self.job(&key).map(|job| job.state) {
                    Some(JobState::Leased) => {
                        let faults = vec![Fault::new(code, &key, why)];
                        let (class, end) = (FailureClass::Permanent, AttemptEnd::TimedOut);
                        self.fail(&key, &Failure { class, faults, retry_after_ms: None, end });
                    }
                    Some(JobState::Blocked | JobState::Ready | JobState::Delayed) => {
                        self.move_to(&key, JobState::Failed, format!("{code}: {why}"));
                    }
                    Some(
                        JobState::Canceling
                        | JobState::Succeeded
                        | JobState::Failed
                        | JobState::Dead
                        | JobState::Canceled
                        | JobState::Superseded,
                    )
                    | None => {}
                }
            }
            self.moved.insert(id);
        }
    }
}

/// A time in words, as precise as it needs to be.
fn hours(ms: u64) -> String {
    let (seconds, tenths) = (ms / 1_000, ms / 360_000);
    match seconds {
        0..120 => format!("{seconds} s"),
        120..7_200 => format!("{} min", seconds / 60),
        _ => format!("{}.{} h", tenths / 10, tenths % 10),
    }
}
