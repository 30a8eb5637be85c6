//! The witness: what workers and clients were told, written down where they stand, and held against what comes later and what the store has.
//!
//! It knows nothing of the state machine: only messages, the true clock, and the rows of the store at the end. It claims no more than whoever got
//! the messages can know, so that a lost answer is no fault.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::ScenarioId;
use socrates_model::job::JobKey;
use socrates_model::wire::{Acquire, Grant, Held, Outcome, Recorded, Report};

use crate::{AttemptEnd, JobState, Policy, Snapshot, State};

/// An attempt that a worker was told to do.
#[derive(Debug, Clone)]
struct Told {
    instance: String,
    fence: u64,
    /// When its lease was surely renewed last.
    renewed: u64,
    /// When its lease may have been renewed last.
    perhaps: u64,
    /// Until when it may run.
    deadline: u64,
    /// Whether its worker is done with it, or gone.
    over: bool,
}

/// What everybody was told.
#[derive(Debug, Default)]
pub(super) struct Witness {
    /// What does not fit together.
    pub(super) wrong: Vec<String>,
    submitted: BTreeSet<ScenarioId>,
    told: BTreeMap<JobKey, BTreeMap<u32, Told>>,
    acknowledged: Vec<(Report, Recorded)>,
    released: Vec<(JobKey, u32)>,
    reign_began: u64,
}

impl Witness {
    /// A submission was acknowledged.
    pub(super) fn submitted(&mut self, ids: impl Iterator<Item = ScenarioId>) {
        self.submitted.extend(ids);
    }

    /// A new orchestrator has begun: it gives every lease anew.
    pub(super) fn reign(&mut self, now: u64) {
        self.reign_began = now;
    }

    /// A worker got grants for a question that it asked first at `asked`, or of which a beat reminded it, at `now`.
    pub(super) fn granted(&mut self, instance: &str, grants: &[Grant], asked: Option<u64>, now: u64, policy: &Policy) {
        for grant in grants {
            let key = &grant.spec.key;
            let attempts = self.told.entry(key.clone()).or_default();
            if let Some(known) = attempts.get(&grant.attempt) {
                if known.instance != instance || known.fence != grant.fence {
                    self.wrong.push(format!("attempt {} of {key} was given to two workers", grant.attempt));
                }
                continue;
            }
            if attempts.keys().any(|number| *number > grant.attempt) {
                self.wrong.push(format!("attempt {} of {key} was given after a later one", grant.attempt));
            }
            if let Some((number, before)) = attempts.range(..grant.attempt).next_back() {
                if before.fence >= grant.fence {
                    self.wrong.push(format!("fence {} of {key} is not above {}", grant.fence, before.fence));
                }
                let lease = before.renewed.saturating_add(policy.lease_ms);
                if !before.over && *number + 1 == grant.attempt && lease.min(before.deadline) > now {
                    let early = lease.min(before.deadline) - now;
                    self.wrong.push(format!("{key} was taken from its worker {early} ms before its lease ended"));
                }
            }
            let told = Told {
                instance: instance.to_owned(),
                fence: grant.fence,
                renewed: asked.unwrap_or(0),
                perhaps: now,
                deadline: asked.unwrap_or(0).saturating_add(grant.deadline_ms),
                over: false,
            };
            self.told.entry(key.clone()).or_default().insert(grant.attempt, told);
        }
    }

    /// One question was answered twice by one orchestrator, with nothing in between.
    pub(super) fn doubled(&mut self, ask: &Acquire, first: &[Grant], second: &[Grant]) {
        if !first.is_empty() && first != second {
            self.wrong.push(format!(
                "question `{}` was answered with {} and with {} grants",
                ask.req_id,
                first.len(),
                second.len()
            ));
        }
    }

    /// A beat was sent; `heard` once it was answered that these go on.
    pub(super) fn beat(&mut self, held: &[Held], now: u64, heard: bool) {
        for held in held {
            let told = self.told.get_mut(&held.key).and_then(|attempts| attempts.get_mut(&held.attempt));
            if let Some(told) = told {
                told.perhaps = now;
                if heard {
                    told.renewed = now;
                }
            }
        }
    }

    /// A worker, or its token, is gone: whatever it held may be given away.
    pub(super) fn gone(&mut self, instance: &str) {
        let all = self.told.values_mut().flat_map(BTreeMap::values_mut);
        all.filter(|told| told.instance == instance).for_each(|told| told.over = true);
    }

    /// A worker is done with an attempt, whether or not it is answered.
    pub(super) fn over(&mut self, key: &JobKey, attempt: u32) {
        if let Some(told) = self.told.get_mut(key).and_then(|attempts| attempts.get_mut(&attempt)) {
            told.over = true;
        }
    }

    /// A report was answered. `sent_before` says whether it went out before this time.
    pub(super) fn reported(&mut self, report: &Report, recorded: Recorded, sent_before: bool) {
        let of = format!("attempt {} of {}", report.attempt, report.key);
        if recorded == Recorded::Duplicate && !sent_before {
            self.wrong.push(format!("the first report of {of} was called a duplicate"));
        }
        let known = self.acknowledged.iter().any(|(earlier, _)| earlier == report);
        if recorded == Recorded::Accepted && known {
            self.wrong.push(format!("the report of {of} was accepted twice"));
        }
        self.acknowledged.push((report.clone(), recorded));
    }

    /// A job was taken back.
    pub(super) fn released(&mut self, key: &JobKey, attempt: u32, recorded: Recorded) {
        if recorded == Recorded::Accepted {
            self.released.push((key.clone(), attempt));
        }
    }

    /// After time has passed: nobody holds a job who was silent for longer than a lease.
    pub(super) fn look(&mut self, state: &State, now: u64) {
        for job in state.jobs.values().filter(|job| job.state == JobState::Leased) {
            let Some(current) = job.current() else { continue };
            let told = self.told.get(&job.key).and_then(|attempts| attempts.get(&current.number));
            let Some(told) = told else { continue };
            let last = told.perhaps.max(self.reign_began);
            if last.saturating_add(state.policy.lease_ms) <= now {
                self.wrong.push(format!("{} is held by a worker that was silent for {} ms", job.key, now - last));
            }
        }
    }

    /// At the end: everything that was acknowledged is in the store.
    pub(super) fn close(&mut self, store: &Snapshot) {
        let scenarios: BTreeSet<&ScenarioId> = store.scenarios.iter().map(|scenario| &scenario.spec.id).collect();
        let attempts: BTreeMap<(&JobKey, u32), _> =
            store.attempts.iter().map(|(key, attempt)| ((key, attempt.number), attempt)).collect();
        let results: BTreeMap<&JobKey, u32> = store.results.iter().map(|(key, result)| (key, result.attempt)).collect();
        for id in self.submitted.iter().filter(|id| !scenarios.contains(id)) {
            self.wrong.push(format!("scenario {id} was acknowledged and is not in the store"));
        }
        for (report, _) in self.acknowledged.iter().filter(|(_, recorded)| *recorded == Recorded::Accepted) {
            let of = format!("attempt {} of {}", report.attempt, report.key);
            let Some(attempt) = attempts.get(&(&report.key, report.attempt)).filter(|attempt| attempt.reported) else {
                self.wrong.push(format!("the report of {of} was acknowledged and is not in the store"));
                continue;
            };
            if report.outcome != Outcome::Ok {
                continue;
            }
            match attempt.end {
                Some(AttemptEnd::Canceled) => {}
                Some(AttemptEnd::Succeeded) if results.get(&report.key) == Some(&report.attempt) => {}
                end => self.wrong.push(format!("the success of {of} was acknowledged and is not the result: {end:?}")),
            }
        }
        for (key, number) in &self.released {
            let end = attempts.get(&(key, *number)).and_then(|attempt| attempt.end);
            if !matches!(end, Some(AttemptEnd::Released | AttemptEnd::Canceled)) {
                self.wrong.push(format!("attempt {number} of {key} was taken back, and the store says {end:?}"));
            }
        }
    }
}
