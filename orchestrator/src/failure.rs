//! Failures: what is done about each class of them.
//!
//! ```text
//! wrong answer:  1st, 2nd ─► ask again with the reasons
//!                3rd (or the same reasons twice) ─► another seed, the reasons as what to avoid
//!                4th ─► propose anew, once per scenario ─► else dead
//! ```

use std::collections::BTreeMap;

use socrates_model::fault::FailureClass;
use socrates_model::job::{JobKey, Stage};
use socrates_model::{Fault, FaultCode};

use crate::bucket::{Bucket, server_of};
use crate::circuit::Circuit;
use crate::pipeline;
use crate::policy::Policy;
use crate::revision::is_compiled;
use crate::state::{AttemptEnd, Job, JobState};
use crate::turn::Turn;

/// Reasons that travel with a job at most, and characters of each.
const FEEDBACK: usize = 40;
const FEEDBACK_CHARS: usize = 600;

/// A failed attempt.
pub(crate) struct Failure {
    pub(crate) class: FailureClass,
    pub(crate) faults: Vec<Fault>,
    pub(crate) retry_after_ms: Option<u64>,
    pub(crate) end: AttemptEnd,
}

impl Turn<'_> {
    /// Ends the attempt that holds the job with a failure and decides what comes next.
    pub(crate) fn fail(&mut self, key: &JobKey, failure: &Failure) {
        let (class, end) = (failure.class, failure.end);
        let number = self.job(key).and_then(|job| job.current()).map(|attempt| attempt.number);
        self.end_current(key, end);
        if let Some(number) = number
            && let Some(attempt) = self.attempt_mut(key, number)
        {
            attempt.class = Some(class);
            attempt.faults.clone_from(&failure.faults);
        }
        let Some(number) = number else { return };
        let why = codes(class, &failure.faults);
        let asks_again = matches!(class, FailureClass::Semantic | FailureClass::Unparsable);
        if asks_again && self.stop_if_spent(key, number, &why) {
            return;
        }
        let now = self.now;
        self.with_circuit(key, |circuit, policy| match class {
            FailureClass::Transient => circuit.failed(policy, now),
            // A server's rates have a way of their own, and a lost worker says nothing of the stage.
            FailureClass::Overload | FailureClass::WorkerDeath => {}
            FailureClass::Semantic | FailureClass::Unparsable | FailureClass::Poison | FailureClass::Permanent => {
                circuit.worked();
            }
        });
        match class {
            FailureClass::Transient => {
                // A question that got no answer in time may have been paid for; passing trouble costs nothing.
                let late = [FaultCode::TTimeout, FaultCode::JDeadline];
                let late = failure.faults.iter().any(|fault| late.contains(&fault.code));
                let limit = if late && pipeline::is_authored(key.stage) {
                    self.state.policy.late_tries
                } else {
                    self.state.policy.transient_tries
                };
                let tries = self.count(key, |job| &mut job.tries.transient);
                self.wait_or_die(key, number, tries, limit, failure.retry_after_ms, &why);
            }
            FailureClass::Overload => self.overload(key, number, failure, &why),
            FailureClass::WorkerDeath => {
                let limit = self.state.policy.lapses.saturating_sub(1);
                let tries = self.count(key, |job| &mut job.tries.lapses);
                self.wait_or_die(key, number, tries, limit, Some(0), &why);
            }
            FailureClass::Unparsable => {
                let limit = self.state.policy.unparsable_tries;
                // Asked again it had twice the room: who is cut off then will be cut off again.
                let cut_twice = is_cut(&failure.faults) && self.was_cut(key, number);
                if self.count(key, |job| &mut job.tries.unparsable) > limit || cut_twice {
                    self.move_to(key, JobState::Dead, why);
                } else {
                    self.ask_again(key, number, failure, &why);
                }
            }
            FailureClass::Semantic => self.climb(key, number, failure, &why),
            FailureClass::Poison => self.move_to(key, JobState::Dead, why),
            FailureClass::Permanent => self.move_to(key, JobState::Failed, why),
        }
    }

    /// Does something with the bucket of the server that a job's author asks, if it asks one.
    pub(crate) fn with_bucket(&mut self, key: &JobKey, edit: impl FnOnce(&mut Bucket, &Policy)) {
        let Some(server) = self.job(key).and_then(|job| server_of(&job.spec)).map(str::to_owned) else { return };
        let (policy, now) = (&self.state.policy, self.now);
        edit(self.state.servers.entry(server).or_insert_with(|| Bucket::new(policy, now)), policy);
    }

    /// Does something with the circuit of a job's stage, where there are circuits.
    pub(crate) fn with_circuit(&mut self, key: &JobKey, edit: impl FnOnce(&mut Circuit, &Policy)) {
        let policy = &self.state.policy;
        if policy.circuit_percent > 0 {
            edit(self.state.circuits.entry(key.stage).or_default(), policy);
        }
    }

    fn count(&mut self, key: &JobKey, which: impl FnOnce(&mut Job) -> &mut u32) -> u32 {
        let Some(job) = self.job_mut(key) else { return 0 };
        let counter = which(job);
        *counter = counter.saturating_add(1);
        *counter
    }

    fn wait_or_die(&mut self, key: &JobKey, number: u32, tries: u32, limit: u32, wish: Option<u64>, why: &str) {
        if tries > limit {
            return self.move_to(key, JobState::Dead, format!("{why}, {tries} times"));
        }
        let policy = &self.state.policy;
        let own = if wish == Some(0) { 0 } else { policy.backoff(key, number, tries) };
        // A server may wish any number; ten times our cap is the most that is believed.
        let wished = wish.unwrap_or(0).min(policy.backoff_cap_ms.saturating_mul(10));
        self.delay(key, own.max(wished), why);
    }

    fn delay(&mut self, key: &JobKey, pause_ms: u64, why: &str) {
        if let Some(job) = self.job_mut(key) {
            job.delay_ms = pause_ms;
        }
        if pause_ms == 0 {
            return self.offer(key, why);
        }
        self.move_to(key, JobState::Delayed, why);
        let due = self.now.saturating_add(pause_ms);
        self.arm(key, Some(due));
    }

    /// Too much asked of the author's server: everybody slows down, not only this job.
    fn overload(&mut self, key: &JobKey, number: u32, failure: &Failure, why: &str) {
        if pipeline::is_authored(key.stage) {
            self.state.author_slots = (self.state.author_slots.min(self.state.authoring.saturating_add(1)) / 2).max(1);
            if let Some(wish) = failure.retry_after_ms {
                let until = self.now.saturating_add(wish.min(self.state.policy.backoff_cap_ms));
                self.with_bucket(key, |bucket, _policy| bucket.pause(until));
            }
        }
        let (limit, hard_limit) = (self.state.policy.overload_tries, self.state.policy.overload_tries * 16);
        let tries = self.count(key, |job| &mut job.tries.overload);
        // A stated wait is no try, but not for ever.
        let limit = if failure.retry_after_ms.is_some() { hard_limit } else { limit };
        self.wait_or_die(key, number, tries, limit, failure.retry_after_ms, why);
    }

    /// A wrong answer: the next rung of the ladder, or back to the stage that can mend it.
    fn climb(&mut self, key: &JobKey, number: u32, failure: &Failure, why: &str) {
        let found_by = key.stage;
        let owners: Vec<Option<Stage>> = failure.faults.iter().map(|fault| pipeline::owner(fault, found_by)).collect();
        let own = owners.is_empty() || owners.contains(&Some(found_by));
        if !own || !pipeline::is_authored(found_by) {
            return self.send_back(key, failure, &owners, why);
        }
        // Compiled again, the same rules are wrong in the same way.
        if key.stage == Stage::Behaviors && self.scenario(&key.scenario).is_some_and(is_compiled) {
            let faults = BTreeMap::from([(Stage::Behaviors, failure.faults.clone())]);
            if !self.repair(&key.scenario, faults) {
                self.move_to(key, JobState::Dead, format!("{why}, nothing left to try"));
            }
            return;
        }
        let same = self.said_before(key, number, &failure.faults);
        let (feedback_tries, reseeds) = (self.state.policy.feedback_tries, self.state.policy.reseeds);
        let rung = match self.job_mut(key) {
            Some(job) => {
                let next = job.tries.semantic.saturating_add(1);
                // The same reasons twice: telling them a third time changes nothing.
                job.tries.semantic = if same { next.max(feedback_tries + 1) } else { next };
                job.tries.semantic
            }
            None => return,
        };
        if rung <= feedback_tries {
            self.ask_again(key, number, failure, why);
        } else if rung <= feedback_tries.saturating_add(reseeds) {
            self.reseed(key, failure, why);
        } else if found_by != Stage::Proposal && self.repropose(key, &failure.faults) {
            // The new revision has superseded this job.
        } else {
            self.move_to(key, JobState::Dead, format!("{why}, {number} attempts"));
        }
    }

    /// Whether the answer before was refused for the same reasons: the same codes at the same places.
    fn said_before(&self, key: &JobKey, number: u32, faults: &[Fault]) -> bool {
        let Some(job) = self.job(key) else { return false };
        let ended = Some(AttemptEnd::Failed);
        let before = job.attempts.iter().rev().find(|attempt| attempt.number < number && attempt.end == ended);
        before.is_some_and(|before| before.class == Some(FailureClass::Semantic) && are_like(&before.faults, faults))
    }

    /// Whether the answer before was cut off.
    fn was_cut(&self, key: &JobKey, number: u32) -> bool {
        let Some(job) = self.job(key) else { return false };
        let before = job.attempts.iter().rev().find(|attempt| attempt.number < number);
        before.is_some_and(|before| is_cut(&before.faults))
    }

    fn ask_again(&mut self, key: &JobKey, number: u32, failure: &Failure, why: &str) {
        self.reword(key, why, |job| {
            let left = job.attempts.iter().find(|attempt| attempt.number == number);
            job.spec.refused = left.and_then(|attempt| pipeline::refused(&attempt.artifacts));
            job.spec.feedback = feedback(&job.sent_back, &failure.faults);
        });
        self.offer(key, why);
    }

    fn reseed(&mut self, key: &JobKey, failure: &Failure, why: &str) {
        let Some(scenario) = self.scenario(&key.scenario) else { return };
        let spec = scenario.spec.clone();
        self.reword(key, why, |job| {
            job.reseeds += 1;
            job.spec.seed = pipeline::seed(&spec, job.key.stage, None, job.seed_revision, job.reseeds);
            job.spec.refused = None;
            job.spec.feedback = feedback(&job.sent_back, &failure.faults);
        });
        self.offer(key, why);
    }

    /// Changes the question of a job that nobody holds any more. It waits afterwards.
    fn reword(&mut self, key: &JobKey, why: &str, edit: impl FnOnce(&mut Job)) {
        // Delayed first: it leaves the index of its old key and enters none that hands it out.
        self.move_to(key, JobState::Delayed, why);
        self.reindex(key, |turn| {
            if let Some(job) = turn.job_mut(key) {
                job.trial += 1;
                edit(job);
            }
            turn.rekey(key);
        });
    }

    fn send_back(&mut self, key: &JobKey, failure: &Failure, owners: &[Option<Stage>], why: &str) {
        let mut targets: BTreeMap<Stage, Vec<Fault>> = BTreeMap::new();
        for (owner, fault) in owners.iter().zip(&failure.faults) {
            if let Some(owner) = owner.filter(|owner| pipeline::is_after(key.stage, &key.item, *owner)) {
                targets.entry(owner).or_default().push(fault.clone());
            }
        }
        if !self.repair(&key.scenario, targets) {
            self.move_to(key, JobState::Dead, format!("{why}, nothing left to try"));
        }
    }
}

fn is_cut(faults: &[Fault]) -> bool {
    faults.iter().any(|fault| fault.code == FaultCode::ETrunc)
}

fn are_like(before: &[Fault], now: &[Fault]) -> bool {
    before.len() == now.len() && before.iter().zip(now).all(|(one, other)| one.is_like(other))
}

/// The reasons a job carries: the newest refusal, then those it was sent back with. One that came twice counts twice.
pub(crate) fn feedback(sent_back: &[Fault], newest: &[Fault]) -> Vec<Fault> {
    let short = |fault: &Fault| {
        let whole = Fault { quotes: Vec::new(), ..fault.clone() };
        whole.shortened(FEEDBACK_CHARS, FEEDBACK_CHARS)
    };
    newest.iter().chain(sent_back).take(FEEDBACK).map(short).collect()
}

/// The codes of the faults for status lines: `G-DISC, G-MEET`.
fn codes(class: FailureClass, faults: &[Fault]) -> String {
    let mut codes: Vec<&str> = Vec::new();
    for fault in faults {
        if codes.len() < 6 && !codes.contains(&fault.code.code()) {
            codes.push(fault.code.code());
        }
    }
    if codes.is_empty() { format!("{class:?}").to_lowercase() } else { codes.join(", ") }
}
