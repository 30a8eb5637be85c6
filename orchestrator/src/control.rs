//! Control: pause, resume, cancel, requeue.

use socrates_model::ScenarioId;
use socrates_model::job::{JobKey, Stage};
use socrates_model::wire::{Control, Submitted};

use crate::event::{Answer, Row, Token};
use crate::state::{JobState, Tries};
use crate::turn::Turn;

impl Turn<'_> {
    pub(crate) fn control(&mut self, control: &Control, to: Token) {
        let answer = match control {
            Control::Pause(batch) => self.pause(batch, true),
            Control::Resume(batch) => self.pause(batch, false),
            Control::Cancel(batch) => self.cancel(batch),
            Control::Requeue(id) => self.requeue(id),
        };
        self.reply(to, Answer::Submitted(answer));
    }

    fn of_batch(&self, batch: &str) -> Vec<ScenarioId> {
        let all = self.state.scenarios.iter();
        all.filter(|(_, scenario)| batch.is_empty() || scenario.batch == batch).map(|(id, _)| id.clone()).collect()
    }

    fn pause(&mut self, batch: &str, paused: bool) -> Submitted {
        let touched = self.of_batch(batch).len();
        if paused {
            self.state.paused.insert(batch.to_owned());
        } else {
            self.state.paused.remove(batch);
            if batch.is_empty() {
                self.state.paused.clear();
            }
            for stage in Stage::WORKERS {
                if self.state.has_ready(stage) {
                    self.hint(stage);
                }
            }
        }
        self.rows.push(Row::Paused(self.state.paused.iter().cloned().collect()));
        Submitted::Accepted { new: u32::try_from(touched).unwrap_or(u32::MAX) }
    }

    fn cancel(&mut self, batch: &str) -> Submitted {
        let open: Vec<ScenarioId> = self
            .of_batch(batch)
            .into_iter()
            .filter(|id| self.scenario(id).is_some_and(|scenario| scenario.end.is_none() && !scenario.canceled))
            .collect();
        for id in &open {
            let jobs = match self.scenario_mut(id) {
                Some(scenario) => {
                    scenario.canceled = true;
                    scenario.jobs.clone()
                }
                None => continue,
            };
            // From the front: what waits for a canceled job is canceled with it.
            for key in jobs {
                self.cancel_job(&key);
            }
            self.moved.insert(id.clone());
        }
        Submitted::Accepted { new: u32::try_from(open.len()).unwrap_or(u32::MAX) }
    }

    fn cancel_job(&mut self, key: &JobKey) {
        let Some(state) = self.job(key).map(|job| job.state) else { return };
        match state {
            JobState::Blocked | JobState::Ready | JobState::Delayed => {
                self.move_to(key, JobState::Canceled, "canceled");
            }
            JobState::Leased => {
                self.move_to(key, JobState::Canceling, "canceled");
                let due = self.now.saturating_add(self.state.policy.cancel_ms);
                self.arm(key, Some(due));
            }
            JobState::Canceling
            | JobState::Succeeded
            | JobState::Failed
            | JobState::Dead
            | JobState::Canceled
            | JobState::Superseded => {}
        }
    }

    /// Dead and failed jobs of the newest revision once more, with new budgets.
    fn requeue(&mut self, id: &ScenarioId) -> Submitted {
        let Some(scenario) = self.scenario(id) else {
            return Submitted::Refused { why: format!("no scenario `{id}` is known") };
        };
        if scenario.canceled {
            return Submitted::Refused { why: format!("scenario `{id}` was canceled; submit it under another name") };
        }
        let revision = scenario.settled.unwrap_or(scenario.revision);
        let again: Vec<JobKey> = scenario
            .jobs
            .iter()
            .filter(|key| self.state.place(id, key.stage, &key.item, revision) == Some(*key))
            .filter(|key| self.job(key).is_some_and(|job| matches!(job.state, JobState::Failed | JobState::Dead)))
            .cloned()
            .collect();
        if again.is_empty() {
            return Submitted::Accepted { new: 0 };
        }
        self.reopen(id);
        for key in &again {
            if let Some(job) = self.job_mut(key) {
                job.tries = Tries::default();
                job.delay_ms = 0;
            }
            self.move_to(key, JobState::Blocked, "requeued");
        }
        for key in &again {
            self.unblock(key);
        }
        Submitted::Accepted { new: 1 }
    }

    fn reopen(&mut self, id: &ScenarioId) {
        let Some(scenario) = self.scenario_mut(id) else { return };
        scenario.repairs = 0;
        scenario.reproposals = 0;
        if scenario.end.take().is_some() {
            let counted = scenario.started && !scenario.spec.review;
            self.state.done = self.state.done.saturating_sub(1);
            self.state.under_way += usize::from(counted);
        }
    }
}
