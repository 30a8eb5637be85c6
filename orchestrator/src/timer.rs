//! Tick and Gone: leases and deadlines run out, pauses end, workers disappear.

use socrates_model::fault::{FailureClass, Fault, FaultCode};
use socrates_model::job::{JobKey, Stage};

use crate::failure::Failure;
use crate::state::{AttemptEnd, JobState};
use crate::turn::Turn;

/// A silent worker without work is forgotten after this many leases.
const FORGET_LEASES: u64 = 2;

impl Turn<'_> {
    pub(crate) fn tick(&mut self) {
        while let Some((due, key)) = self.state.timers.first().cloned() {
            if due > self.now {
                break;
            }
            self.state.timers.remove(&(due, key.clone()));
            if let Some(job) = self.state.jobs.get_mut(&key) {
                job.due = None;
            }
            self.fire(&key);
        }
        self.tick_batches();
        let silent = self.state.policy.lease_ms.saturating_mul(FORGET_LEASES);
        let now = self.now;
        self.state.workers.retain(|_, worker| !worker.held.is_empty() || now.saturating_sub(worker.seen) < silent);
        if self.state.author_wake_at != 0 && self.state.author_wake_at <= now {
            self.state.author_wake_at = 0;
            let ready: Vec<_> = self.state.ready.iter().filter(|(_, jobs)| !jobs.is_empty()).map(|(s, _)| *s).collect();
            for stage in ready {
                self.hint(stage);
            }
        }
    }

    fn fire(&mut self, key: &JobKey) {
        let Some(job) = self.job(key) else { return };
        let (lease_until, deadline_at) = (job.lease_until, job.deadline_at);
        match job.state {
            JobState::Delayed => self.offer(key, "waited"),
            JobState::Leased if self.now >= deadline_at => {
                let allowed = self.state.policy.deadline_ms(key.stage);
                let message = format!("the attempt took longer than `{allowed}` ms");
                self.fail(
                    key,
                    &Failure {
                        class: FailureClass::Transient,
                        faults: vec![Fault::new(FaultCode::JDeadline, key, message)],
                        retry_after_ms: None,
                        end: AttemptEnd::TimedOut,
                    },
                );
            }
            JobState::Leased if self.now >= lease_until && key.stage == Stage::Review => self.hand_out_again(key),
            JobState::Leased if self.now >= lease_until => {
                let instance = job.current().map(|attempt| attempt.instance.clone()).unwrap_or_default();
                let message = format!("worker `{instance}` was not heard of in time");
                self.fail(
                    key,
                    &Failure {
                        class: FailureClass::WorkerDeath,
                        faults: vec![Fault::new(FaultCode::JLost, key, message)],
                        retry_after_ms: None,
                        end: AttemptEnd::Lapsed,
                    },
                );
            }
            // Beats have moved the end of the lease since the timer was armed.
            JobState::Leased => self.arm(key, Some(lease_until.min(deadline_at))),
            JobState::Canceling => {
                self.end_current(key, AttemptEnd::Canceled);
                self.move_to(key, JobState::Canceled, "canceled");
            }
            JobState::Blocked
            | JobState::Ready
            | JobState::Succeeded
            | JobState::Failed
            | JobState::Dead
            | JobState::Canceled
            | JobState::Superseded => {}
        }
    }

    /// Hands out again what a lost worker held, without counting. A person's job is always handed out again: that
    /// the program before them went away says nothing against the job.
    pub(crate) fn hand_out_again(&mut self, key: &JobKey) {
        self.end_current(key, AttemptEnd::Lapsed);
        self.offer(key, "its worker was lost");
    }

    /// A worker's token is gone: its leases shrink to the grace; a beat before then restores them.
    pub(crate) fn gone(&mut self, instance: &str) {
        let until = self.now.saturating_add(self.state.policy.grace_ms);
        let Some(worker) = self.state.workers.get(instance) else { return };
        if worker.held.is_empty() {
            self.state.workers.remove(instance);
            return;
        }
        for key in worker.held.clone() {
            let Some(job) = self.state.jobs.get_mut(&key) else { continue };
            if job.state == JobState::Leased && job.lease_until > until {
                job.lease_until = until;
                let due = until.min(job.deadline_at);
                self.arm(&key, Some(due));
            }
        }
    }
}
