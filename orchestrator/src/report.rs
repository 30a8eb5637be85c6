//! Report and Release: an attempt ends. At most one of them becomes the job's result.

use socrates_model::Role;
use socrates_model::fault::{FailureClass, Fault, FaultCode};
use socrates_model::job::{Artifact, JobKey, Stage};
use socrates_model::wire::{Outcome, Recorded, Release, Report};

use crate::bucket::server_of;
use crate::event::{Answer, Row, Token};
use crate::failure::Failure;
use crate::pipeline;
use crate::state::{AttemptEnd, JobResult, JobState};
use crate::turn::Turn;

/// Longest remark that is kept, characters.
const REMARK_CHARS: usize = 200;
/// Artifacts of one report at most.
const ARTIFACTS: usize = 12;

impl Turn<'_> {
    pub(crate) fn report(&mut self, report: Report, to: Token) {
        let recorded = self.record(report);
        match recorded {
            Recorded::Duplicate => self.state.tally.duplicates += 1,
            Recorded::Late => self.state.tally.late += 1,
            Recorded::Accepted | Recorded::Busy => {}
        }
        self.reply(to, Answer::Recorded(recorded));
    }

    fn record(&mut self, mut report: Report) -> Recorded {
        let now = self.now;
        if let Some(worker) = self.state.workers.get_mut(&report.instance) {
            worker.seen = now;
        }
        let key = report.key.clone();
        let Some(job) = self.job(&key) else { return Recorded::Late };
        let known = job.granted(report.attempt, report.fence, &report.instance);
        let Some(attempt) = known else { return Recorded::Late };
        if attempt.reported {
            return Recorded::Duplicate;
        }
        let (state, trial, ended, asked) = (job.state, job.trial, attempt.end, attempt.trial);
        let holds = job.current().is_some_and(|current| current.number == report.attempt);
        report.artifacts.truncate(ARTIFACTS);
        report.remark = report.remark.chars().take(REMARK_CHARS).collect();
        self.keep_texts(&mut report.artifacts);
        self.annotate(&report);

        if holds && state == JobState::Canceling {
            self.end_current(&key, AttemptEnd::Canceled);
            self.move_to(&key, JobState::Canceled, "canceled");
            return Recorded::Accepted;
        }
        if holds {
            let failure = match &report.outcome {
                Outcome::Ok if self.is_whole(&report) => None,
                Outcome::Ok => Some(hollow(&report)),
                Outcome::Failed { class, faults, retry_after_ms } => Some(Failure {
                    class: *class,
                    faults: faults.clone(),
                    retry_after_ms: *retry_after_ms,
                    end: AttemptEnd::Failed,
                }),
            };
            match failure {
                Some(failure) => self.fail(&key, &failure),
                None => {
                    self.with_circuit(&key, |circuit, _policy| circuit.worked());
                    self.end_current(&key, AttemptEnd::Succeeded);
                    self.accept(report);
                }
            }
            return Recorded::Accepted;
        }
        // A worker that was taken for lost comes back with a result before anybody else has one.
        let open = matches!(state, JobState::Ready | JobState::Delayed | JobState::Leased);
        let lost = matches!(ended, Some(AttemptEnd::Lapsed | AttemptEnd::TimedOut));
        if open && lost && asked == trial && report.outcome == Outcome::Ok && self.is_whole(&report) {
            self.end_current(&key, AttemptEnd::Superseded);
            self.accept(report);
            return Recorded::Accepted;
        }
        Recorded::Late
    }

    /// Writes into the attempt what its worker said, whatever becomes of it.
    fn annotate(&mut self, report: &Report) {
        let now = self.now;
        let Some(attempt) = self.attempt_mut(&report.key, report.attempt) else { return };
        attempt.reported = true;
        attempt.wall_ms = report.wall_ms;
        attempt.span_ms = now.saturating_sub(attempt.ready);
        attempt.tokens = report.tokens;
        attempt.remark.clone_from(&report.remark);
        let tokens = report.tokens.0.saturating_add(report.tokens.1);
        if let Outcome::Failed { class, faults, .. } = &report.outcome {
            attempt.class = Some(*class);
            attempt.faults.clone_from(faults);
            attempt.artifacts.clone_from(&report.artifacts);
        }
        self.spend(&report.key, report.tokens);
        if let Some(server) = self.job(&report.key).and_then(|job| server_of(&job.spec)).map(str::to_owned) {
            self.state.tally.asked(&server, report.tokens);
        }
        let (stage, rates) = (report.key.stage, report.rates);
        self.with_bucket(&report.key, |bucket, policy| bucket.answered(policy, now, stage, tokens, rates));
    }

    /// Small contents become rows of their own; the artifacts keep their addresses.
    fn keep_texts(&mut self, artifacts: &mut [Artifact]) {
        for artifact in artifacts {
            if let Some(text) = artifact.inline.take() {
                self.rows.push(Row::Text(artifact.digest, text));
            }
        }
    }

    /// Whether the main output of the stage is there.
    fn is_whole(&self, report: &Report) -> bool {
        let role = Role::made_by(report.key.stage);
        role.is_none_or(|role| pipeline::output(&report.artifacts, role).is_some())
    }

    /// A success; the attempt need not be the one that holds the job now.
    fn accept(&mut self, report: Report) {
        let key = report.key.clone();
        let Some(idem_key) = self.job(&key).and_then(|job| job.idem_key) else { return };
        if let Some(attempt) = self.attempt_mut(&key, report.attempt) {
            attempt.end = Some(AttemptEnd::Succeeded);
        }
        if pipeline::is_authored(key.stage) {
            let most = self.state.policy.author_slots;
            self.state.author_slots = self.state.author_slots.saturating_add(1).min(most);
        }
        let result = JobResult {
            attempt: report.attempt,
            idem_key,
            artifacts: report.artifacts,
            verdict: report.verdict,
            repair: report.repair,
            anew: report.anew,
            remark: report.remark,
            wall_ms: report.wall_ms,
        };
        self.succeed(&key, result);
    }

    /// Gives a job its one result; whoever waits for the same key gets it too.
    pub(crate) fn succeed(&mut self, key: &JobKey, result: JobResult) {
        let Some(job) = self.job_mut(key) else { return };
        if job.result.is_some() || job.state.is_terminal() {
            return;
        }
        let same = job.shares().then_some(result.idem_key);
        job.result = Some(result.clone());
        self.rows.push(Row::Result(key.clone(), Box::new(result.clone())));
        if key.stage == Stage::Review {
            // First, so that nothing that is to be made again is begun, or known already, in between.
            self.reviewed(key, &result);
        }
        self.move_to(key, JobState::Succeeded, "");
        if key.stage == Stage::Scoring {
            self.judged(key, &result);
        }
        let waiting = same.and_then(|same| self.state.waiting.get(&same).cloned()).unwrap_or_default();
        for twin in waiting {
            self.take_known(&twin);
        }
    }

    /// Takes over the result of a job with the same key, if there is one.
    pub(crate) fn take_known(&mut self, key: &JobKey) -> bool {
        let Some(job) = self.job(key).filter(|job| job.shares()) else { return false };
        let known = job.idem_key.and_then(|idem_key| self.state.cached.get(&idem_key));
        let Some(known) = known.and_then(|known| self.job(known)).and_then(|known| known.result.clone()) else {
            return false;
        };
        self.succeed(key, JobResult { attempt: 0, wall_ms: 0, ..known });
        true
    }

    pub(crate) fn release(&mut self, release: &Release, to: Token) {
        let key = &release.key;
        let known = self.job(key).and_then(|job| {
            let attempt = job.granted(release.attempt, release.fence, &release.instance)?;
            Some((job.state, attempt.end, job.current().is_some_and(|current| current.number == attempt.number)))
        });
        let recorded = match known {
            Some((JobState::Leased, _, true)) => {
                self.end_current(key, AttemptEnd::Released);
                self.offer(key, "released");
                Recorded::Accepted
            }
            Some((JobState::Canceling, _, true)) => {
                self.end_current(key, AttemptEnd::Canceled);
                self.move_to(key, JobState::Canceled, "canceled");
                Recorded::Accepted
            }
            Some((_, Some(AttemptEnd::Released), _)) => Recorded::Duplicate,
            Some(_) | None => Recorded::Late,
        };
        self.reply(to, Answer::Recorded(recorded));
    }
}

/// A success without its main output: the worker's code is at fault, and would be again.
fn hollow(report: &Report) -> Failure {
    let role = Role::made_by(report.key.stage).map_or("", Role::name);
    let message = format!("attempt `{}` reports success without an artifact `{role}`", report.attempt);
    Failure {
        class: FailureClass::Poison,
        faults: vec![Fault::new(FaultCode::JSpec, &report.key, message)],
        retry_after_ms: None,
        end: AttemptEnd::Failed,
    }
}
