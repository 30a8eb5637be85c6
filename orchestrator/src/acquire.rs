//! Acquire: who gets which job.
//!
//! Later stages first, then the turns of the batches and the order of submission; a bounded number of scenarios is under way.
//! The same question gets the same answer, so a lost reply costs time only.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::Digest;
use socrates_model::job::{JobKey, Stage};
use socrates_model::wire::{Acquire, Acquired, Grant, Hello, NoWork};

use crate::bucket::{Bucket, server_of};
use crate::circuit::Allows;
use crate::event::{Answer, Token};
use crate::pipeline;
use crate::state::{Attempt, JobState, Millis, Worker};
use crate::turn::Turn;

/// Jobs in one reply at most.
const GRANTS: usize = 16;
/// Bytes of specs in one reply at most; leaves room below the message limit for inline inputs.
const GRANT_BYTES: usize = 24 * 1024;
/// Pause before an idle worker asks again, ms; a hint wakes it earlier.
const RETRY_AFTER_MS: u64 = 500;

impl Turn<'_> {
    pub(crate) fn acquire(&mut self, ask: &Acquire, to: Token) {
        let now = self.now;
        let worker = self.state.workers.entry(ask.instance.clone()).or_insert_with(|| {
            // Unknown after a restart of the orchestrator: its question introduces it again.
            let hello = Hello {
                instance: ask.instance.clone(),
                stages: ask.stages.clone(),
                code_version: ask.code_version.clone(),
                pid: 0,
                host: String::new(),
            };
            Worker::new(hello, now)
        });
        worker.seen = now;
        if worker.hello.stages.is_empty() {
            // Its first word to this orchestrator was a beat, which names no stage.
            worker.hello.stages.clone_from(&ask.stages);
        }
        let draining = worker.draining;
        let repeated = if worker.last.0 == ask.req_id { worker.last.1.clone() } else { Vec::new() };

        let again: Vec<Grant> =
            repeated.iter().filter_map(|(key, attempt)| self.standing_grant(key, *attempt, &ask.instance)).collect();
        if !again.is_empty() {
            return self.reply(to, Answer::Acquired(Acquired::Grants(again)));
        }
        let wanted = &self.state.policy.code_version;
        if draining {
            return self.none(to, NoWork::Drained);
        }
        if !wanted.is_empty() && *wanted != ask.code_version {
            self.turned_away(&ask.stages, &ask.code_version);
            return self.none(to, NoWork::Version);
        }
        match self.choose(ask) {
            Ok(chosen) => {
                let grants: Vec<Grant> = chosen.iter().filter_map(|key| self.lease(key, &ask.instance)).collect();
                let given = grants.iter().map(|grant| (grant.spec.key.clone(), grant.attempt)).collect();
                if let Some(worker) = self.state.workers.get_mut(&ask.instance) {
                    worker.last = (ask.req_id.clone(), given);
                }
                self.reply(to, Answer::Acquired(Acquired::Grants(grants)));
            }
            Err((reason, wake)) => {
                if let Some(wake) = wake {
                    let standing = Some(self.state.author_wake_at).filter(|at| *at > 0);
                    self.state.author_wake_at = standing.map_or(wake, |at| at.min(wake));
                }
                self.none(to, reason);
            }
        }
    }

    fn none(&mut self, to: Token, reason: NoWork) {
        let none = Acquired::None { retry_after_ms: RETRY_AFTER_MS, reason };
        self.reply(to, Answer::Acquired(none));
    }

    /// Jobs to hand out, or why there are none.
    fn choose(&self, ask: &Acquire) -> Result<Vec<JobKey>, (NoWork, Option<Millis>)> {
        let state = &*self.state;
        let most = usize::try_from(ask.credits).unwrap_or(GRANTS).min(GRANTS);
        let mut chosen = Vec::new();
        let mut keys: BTreeMap<Digest, ()> = BTreeMap::new();
        let mut bytes = 0;
        let mut why = NoWork::Empty;
        let mut begun = 0;
        let mut wake = Millis::MAX;
        // Questions and their tokens that this reply already puts to each server.
        let mut questions: BTreeMap<&str, (u64, u64)> = BTreeMap::new();
        let mut authoring = state.authoring;
        let wip = state.most_begun();
        if state.paused.contains("") {
            return Err((NoWork::Paused, None));
        }
        for stage in pipeline::URGENCY.into_iter().filter(|stage| ask.stages.contains(stage)) {
            let allowed = match state.circuits.get(&stage).map_or(Allows::All, |circuit| circuit.allows(self.now)) {
                Allows::All => most,
                Allows::One => (chosen.len() + 1).min(most),
                Allows::NoneUntil(until) => {
                    if state.has_ready(stage) {
                        (why, wake) = (NoWork::Throttled, wake.min(until));
                    }
                    continue;
                }
            };
            if state.paused_stages.contains(&stage) {
                if state.has_ready(stage) {
                    why = NoWork::Paused;
                }
                continue;
            }
            let mut held: BTreeSet<&str> = BTreeSet::new();
            for (_, _, _, key) in state.ready.get(&stage).into_iter().flatten() {
                if chosen.len() >= most {
                    return Ok(chosen);
                }
                if chosen.len() >= allowed {
                    break;
                }
                let (Some(job), Some(scenario)) = (self.job(key), self.scenario(&key.scenario)) else { continue };
                if state.paused.contains(&scenario.batch) {
                    why = NoWork::Paused;
                    continue;
                }
                if pipeline::is_authored(stage) && authoring >= state.author_slots {
                    why = NoWork::Throttled;
                    break;
                }
                let server = server_of(&job.spec);
                if server.is_some_and(|server| held.contains(server)) {
                    why = NoWork::Throttled;
                    continue;
                }
                let asked = server.and_then(|server| questions.get(server)).copied().unwrap_or_default();
                let asks = server.map(|server| self.asks(server, stage, asked));
                if let Some((server, (from, _))) = server.zip(asks).filter(|(_, (from, _))| *from > self.now) {
                    (why, wake) = (NoWork::Throttled, wake.min(from));
                    // Nothing that is handed out in this reply makes it sooner: no other job of the stage need be looked at.
                    held.insert(server);
                    continue;
                }
                let begins = !scenario.started && !scenario.spec.review;
                if begins && state.under_way + begun >= wip {
                    // Ready jobs stand in the order of their turns: the later ones are not begun either,
                    // but a started one may still come.
                    why = NoWork::Throttled;
                    if stage == Stage::Proposal {
                        break;
                    }
                    continue;
                }
                if let Some(idem_key) = job.idem_key.filter(|_| job.shares()) {
                    // Single flight: the same work is done once; the others take its result.
                    if state.in_flight.contains_key(&idem_key) || keys.contains_key(&idem_key) {
                        continue;
                    }
                    keys.insert(idem_key, ());
                }
                bytes += weight(job);
                if !chosen.is_empty() && bytes > GRANT_BYTES {
                    return Ok(chosen);
                }
                begun += usize::from(begins);
                if let Some((server, (_, more))) = server.zip(asks) {
                    questions.insert(server, more);
                }
                authoring += u32::from(pipeline::is_authored(stage));
                chosen.push(key.clone());
            }
        }
        if chosen.is_empty() { Err((why, Some(wake).filter(|wake| *wake < Millis::MAX))) } else { Ok(chosen) }
    }

    /// From when on a server may be asked one more question of this stage, beside those already put to it in this reply; and
    /// how much all of them are.
    fn asks(&self, server: &str, stage: Stage, asked: (u64, u64)) -> (Millis, (u64, u64)) {
        let new;
        let bucket = match self.state.servers.get(server) {
            Some(bucket) => bucket,
            None => {
                new = Bucket::new(&self.state.policy, self.now);
                &new
            }
        };
        let tokens = bucket.typical(stage);
        (bucket.from(self.now, asked, tokens), (asked.0 + 1, asked.1.saturating_add(tokens)))
    }

    /// Leases a ready job to a worker.
    fn lease(&mut self, key: &JobKey, instance: &str) -> Option<Grant> {
        if self.job(key)?.state != JobState::Ready {
            return None;
        }
        let now = self.now;
        let fence = self.state.next_fence;
        let lease_until = now.saturating_add(self.state.policy.lease_ms);
        let deadline_at = now.saturating_add(self.state.policy.deadline_ms(key.stage));
        let at_ms = self.state.wall_ms(now);
        self.state.next_fence += 1;
        let job = self.job_mut(key)?;
        let number = job.attempts.last().map_or(0, |attempt| attempt.number) + 1;
        let ready = job.ready;
        let attempt = Attempt { ready, at_ms, ..Attempt::new(number, instance, fence, job.trial, now) };
        job.attempts.push(attempt);
        job.lease_until = lease_until;
        job.deadline_at = deadline_at;
        self.attempt_mut(key, number);
        self.state.tally.waited(key.stage, now.saturating_sub(ready));
        self.move_to(key, JobState::Leased, "");
        self.with_bucket(key, |bucket, _policy| bucket.take(now, key.stage));
        self.with_circuit(key, |circuit, policy| circuit.granted(policy, now));
        self.arm(key, Some(lease_until.min(deadline_at)));
        if let Some(worker) = self.state.workers.get_mut(instance) {
            worker.held.insert(key.clone());
        }
        if self.scenario(&key.scenario).is_some_and(|scenario| !scenario.started)
            && let Some(scenario) = self.scenario_mut(&key.scenario)
        {
            scenario.started = true;
            let (turn, order) = (scenario.turn, scenario.order);
            let counted = !scenario.spec.review;
            self.waits_no_more(order);
            self.state.begun_turn = self.state.begun_turn.max(turn);
            self.state.under_way += usize::from(counted);
        }
        self.standing_grant(key, number, instance)
    }

    /// The grant of an attempt that still holds.
    pub(crate) fn standing_grant(&self, key: &JobKey, number: u32, instance: &str) -> Option<Grant> {
        let job = self.job(key).filter(|job| job.state == JobState::Leased)?;
        let attempt = job.current().filter(|attempt| attempt.number == number && attempt.instance == instance)?;
        Some(Grant {
            spec: job.spec.clone(),
            attempt: number,
            fence: attempt.fence,
            lease_ms: self.state.policy.lease_ms,
            deadline_ms: self.state.policy.deadline_ms(key.stage),
            idem_key: job.idem_key?,
            inline: BTreeMap::new(),
            traceparent: self.scenario(&key.scenario).map(|scenario| scenario.trace().of_attempt(key, number)),
        })
    }
}

/// About how many bytes a job's spec takes on the bus.
fn weight(job: &crate::state::Job) -> usize {
    let spec = &job.spec;
    let faults: usize = spec.feedback.iter().map(|fault| fault.text_bytes() + 90).sum();
    let settings: usize = spec.settings.iter().map(|(name, value)| name.len() + value.len()).sum();
    600 + spec.inputs.len() * 90 + faults + settings
}

impl Attempt {
    /// An attempt that was just granted.
    #[must_use]
    pub(crate) fn new(number: u32, instance: &str, fence: u64, trial: u32, granted: u64) -> Self {
        Self {
            number,
            instance: instance.to_owned(),
            fence,
            trial,
            end: None,
            reported: false,
            class: None,
            faults: Vec::new(),
            wall_ms: 0,
            span_ms: 0,
            tokens: (0, 0),
            remark: String::new(),
            artifacts: Vec::new(),
            at_ms: 0,
            granted,
            ready: granted,
            counted: false,
            characters: 0,
        }
    }
}
