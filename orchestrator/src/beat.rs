//! Beat: leases are renewed, lost grants sent again, needless work stopped.

use socrates_model::job::JobKey;
use socrates_model::wire::{Beat, BeatReply, BeatVerdict, Grant, Hello};

use crate::event::{Answer, Token};
use crate::state::{AttemptEnd, JobState, Worker};
use crate::turn::Turn;

/// Grants repeated in one beat at most, so that the reply stays small.
const MISSING: usize = 8;

impl Turn<'_> {
    pub(crate) fn beat(&mut self, beat: &Beat, to: Token) {
        let now = self.now;
        let worker = self.state.workers.entry(beat.instance.clone()).or_insert_with(|| {
            let hello = Hello {
                instance: beat.instance.clone(),
                stages: Vec::new(),
                code_version: String::new(),
                pid: 0,
                host: String::new(),
            };
            Worker::new(hello, now)
        });
        worker.seen = now;
        worker.draining = beat.draining;
        let mine = worker.held.clone();

        let mut verdicts = Vec::with_capacity(beat.held.len());
        for held in &beat.held {
            let verdict = self.judge(&held.key, held.attempt, held.fence);
            if verdict == BeatVerdict::Ok {
                // In memory only: the timer that is armed looks again when it fires.
                let lease_until = now.saturating_add(self.state.policy.lease_ms);
                if let Some(job) = self.state.jobs.get_mut(&held.key) {
                    job.lease_until = lease_until;
                    if let Some(attempt) = job.attempts.last_mut() {
                        attempt.characters = held.characters;
                    }
                }
            }
            verdicts.push((held.key.clone(), held.attempt, verdict));
        }

        let mut missing: Vec<Grant> = Vec::new();
        for key in mine.iter().filter(|key| beat.held.iter().all(|held| held.key != **key)) {
            let Some(job) = self.job(key) else { continue };
            let Some(attempt) = job.current() else { continue };
            let (number, granted) = (attempt.number, attempt.granted);
            match job.state {
                JobState::Canceling => {
                    // It does not list what it was told to stop: it stopped.
                    self.end_current(key, AttemptEnd::Canceled);
                    self.move_to(key, JobState::Canceled, "canceled");
                }
                // A beat that crossed with the grant knows nothing of it yet.
                JobState::Leased
                    if missing.len() < MISSING && now.saturating_sub(granted) >= self.state.policy.beat_ms =>
                {
                    missing.extend(self.standing_grant(key, number, &beat.instance));
                }
                JobState::Leased
                | JobState::Blocked
                | JobState::Ready
                | JobState::Delayed
                | JobState::Succeeded
                | JobState::Failed
                | JobState::Dead
                | JobState::Canceled
                | JobState::Superseded => {}
            }
        }
        let epoch = self.state.epoch;
        self.reply(to, Answer::Beat(BeatReply { verdicts, missing, epoch }));
    }

    fn judge(&self, key: &JobKey, number: u32, fence: u64) -> BeatVerdict {
        let Some(job) = self.job(key) else { return BeatVerdict::Lost };
        let holds = job.current().is_some_and(|attempt| attempt.number == number && attempt.fence == fence);
        match job.state {
            JobState::Leased if holds => BeatVerdict::Ok,
            JobState::Leased | JobState::Blocked | JobState::Ready | JobState::Delayed => BeatVerdict::Lost,
            JobState::Canceling
            | JobState::Succeeded
            | JobState::Failed
            | JobState::Dead
            | JobState::Canceled
            | JobState::Superseded => BeatVerdict::Cancel,
        }
    }
}
