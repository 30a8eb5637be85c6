//! Recovery: the state is rebuilt from rows; leases get a fresh full term, so that workers that
//! survived keep what they hold.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use socrates_model::job::{JobKey, Stage};
use socrates_model::wire::Hello;

use crate::batches::{Batch, Queue};
use crate::pace::Pacer;
use crate::policy::Policy;
use crate::state::{Attempt, AttemptEnd, Job, JobResult, JobState, Millis, Scenario, State, Worker};
use crate::turn::Turn;

/// What a store holds.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Snapshot {
    /// Number of the reign that begins.
    pub epoch: u64,
    /// Scenarios.
    pub scenarios: Vec<Scenario>,
    /// Jobs, without attempts and results.
    pub jobs: Vec<Job>,
    /// Attempts, in order within each job.
    pub attempts: Vec<(JobKey, Attempt)>,
    /// Results.
    pub results: Vec<(JobKey, JobResult)>,
    /// Batches.
    #[serde(default)]
    pub batches: Vec<Batch>,
    /// Series.
    #[serde(default)]
    pub queues: Vec<Queue>,
    /// Paused batches.
    pub paused: Vec<String>,
    /// Paused stages.
    #[serde(default)]
    pub paused_stages: Vec<Stage>,
    /// Number after the last of the outbox.
    pub next_seq: u64,
}

impl State {
    /// Rebuilds the state from what a store holds. Follow it with [`crate::Event::Recover`].
    #[must_use]
    pub fn restore(snapshot: Snapshot, policy: Policy, now: Millis) -> Self {
        let mut state = Self::new(policy);
        state.epoch = snapshot.epoch;
        state.next_seq = snapshot.next_seq.max(1);
        state.paused = snapshot.paused.into_iter().collect::<BTreeSet<String>>();
        state.paused_stages = snapshot.paused_stages.into_iter().collect();
        state.pace = Pacer::new(now);
        for batch in snapshot.batches {
            let batch = Batch { spent: (0, 0), open: 0, counted_to: now, due: None, ..batch };
            state.batches.insert(batch.name.clone(), batch);
        }
        for queue in snapshot.queues {
            state.next_order = state.next_order.max(queue.end());
            state.queues.insert(queue.place, Queue { made: 0, waiting: 0, ..queue });
        }
        for mut scenario in snapshot.scenarios {
            scenario.jobs.clear();
            scenario.open = 0;
            let counted = scenario.started && scenario.end.is_none() && !scenario.spec.review;
            state.next_order = state.next_order.max(scenario.order + 1);
            state.done += usize::from(scenario.end.is_some());
            state.under_way += usize::from(counted);
            if let Some(queue) = state.queue_at(scenario.order) {
                queue.made += 1;
                queue.waiting += u32::from(!scenario.started && scenario.end.is_none());
            }
            state.batch(&scenario.batch, now).open += u64::from(scenario.end.is_none());
            state.by_order.insert(scenario.order, scenario.spec.id.clone());
            state.had_turn(&scenario.batch, scenario.turn, scenario.started);
            state.scenarios.insert(scenario.spec.id.clone(), scenario);
        }
        for (batch, unmade) in state.queues.values().map(|one| (one.batch.clone(), one.unmade())).collect::<Vec<_>>() {
            state.batch(&batch, now).open += u64::from(unmade);
        }
        for job in snapshot.jobs {
            state.jobs.insert(job.key.clone(), job);
        }
        for (key, mut attempt) in snapshot.attempts {
            state.next_fence = state.next_fence.max(attempt.fence + 1);
            attempt.granted = now;
            attempt.ready = now;
            attempt.counted = attempt.end.is_some();
            state.spent_by(&key, attempt.tokens, now);
            if let Some(job) = state.jobs.get_mut(&key) {
                job.attempts.push(attempt);
            }
        }
        for (key, result) in snapshot.results {
            if let Some(job) = state.jobs.get_mut(&key) {
                job.result = Some(result);
            }
        }
        state.link(now);
        state
    }

    /// Rebuilds what follows from the rows.
    fn link(&mut self, now: Millis) {
        let keys: Vec<JobKey> = self.jobs.keys().cloned().collect();
        // Jobs in order of their making: by revision, then along the pipeline.
        let mut made = keys.clone();
        made.sort_by_key(|key| (key.scenario.clone(), key.revision, key.stage, key.item.clone()));
        for key in &made {
            let Some(job) = self.jobs.get(key) else { continue };
            let open = !job.state.is_terminal();
            let sources: BTreeSet<JobKey> = job.sources.values().cloned().collect();
            if let Some(scenario) = self.scenarios.get_mut(&key.scenario) {
                scenario.jobs.push(key.clone());
                scenario.open += usize::from(open);
            }
            self.open_jobs += usize::from(open);
            for source in sources {
                if let Some(parent) = self.jobs.get_mut(&source) {
                    parent.children.push(key.clone());
                }
            }
        }
        for key in &keys {
            let held = self.jobs.get(key).and_then(|job| job.current()).map(|attempt| attempt.instance.clone());
            if let Some(instance) = held {
                let hello = Hello {
                    instance: instance.clone(),
                    stages: vec![key.stage],
                    code_version: String::new(),
                    pid: 0,
                    host: String::new(),
                };
                self.workers.entry(instance).or_insert_with(|| Worker::new(hello, now)).held.insert(key.clone());
            }
            Turn::new(self, now).index(key);
        }
    }
}

impl Turn<'_> {
    /// Arms every timer in full and tells every stage that has work.
    pub(crate) fn recover(&mut self, alone: bool) {
        let keys: Vec<JobKey> = self.state.jobs.keys().cloned().collect();
        if alone {
            self.end_all_leases(&keys);
        }
        let policy = self.state.policy.clone();
        let now = self.now;
        for key in keys {
            let Some(job) = self.state.jobs.get_mut(&key) else { continue };
            let due = match job.state {
                JobState::Leased => {
                    job.lease_until = now.saturating_add(policy.lease_ms);
                    job.deadline_at = now.saturating_add(policy.deadline_ms(key.stage));
                    Some(job.lease_until.min(job.deadline_at))
                }
                JobState::Delayed => Some(now.saturating_add(job.delay_ms)),
                JobState::Canceling => Some(now.saturating_add(policy.cancel_ms)),
                JobState::Ready => {
                    self.hint(key.stage);
                    None
                }
                JobState::Blocked
                | JobState::Succeeded
                | JobState::Failed
                | JobState::Dead
                | JobState::Canceled
                | JobState::Superseded => None,
            };
            self.arm(&key, due);
        }
        self.moved.extend(self.state.scenarios.keys().cloned());
        self.recover_batches();
    }

    /// Ends what workers held that are gone for certain: nobody waits for a lease that nobody can renew.
    fn end_all_leases(&mut self, keys: &[JobKey]) {
        for key in keys {
            match self.job(key).map(|job| job.state) {
                Some(JobState::Leased) => self.hand_out_again(key),
                Some(JobState::Canceling) => {
                    self.end_current(key, AttemptEnd::Canceled);
                    self.move_to(key, JobState::Canceled, "canceled");
                }
                Some(
                    JobState::Blocked
                    | JobState::Ready
                    | JobState::Delayed
                    | JobState::Succeeded
                    | JobState::Failed
                    | JobState::Dead
                    | JobState::Canceled
                    | JobState::Superseded,
                )
                | None => {}
            }
        }
        self.state.workers.clear();
    }
}
