//! One step's bookkeeping: the only place where a job changes its state, and where indices, timers
//! and counters follow it.

use std::collections::BTreeSet;

use socrates_model::ScenarioId;
use socrates_model::job::{JobKey, Stage};
use socrates_model::wire::Notice;

use crate::event::{Answer, Effect, Row, Token};
use crate::pace::Pacer;
use crate::pipeline;
use crate::state::{Attempt, AttemptEnd, Job, JobState, Millis, Scenario, ScenarioEnd, State};

/// A step under way.
pub(crate) struct Turn<'a> {
    pub(crate) state: &'a mut State,
    pub(crate) now: Millis,
    /// Rows that are no job, attempt or scenario.
    pub(crate) rows: Vec<Row>,
    jobs: BTreeSet<JobKey>,
    attempts: BTreeSet<(JobKey, u32)>,
    scenarios: BTreeSet<ScenarioId>,
    /// Batches and series that changed.
    pub(crate) batches: BTreeSet<String>,
    pub(crate) queues: BTreeSet<u64>,
    /// Scenarios of series that this step made.
    pub(crate) drawn: usize,
    /// Batches that have taken what they may.
    pub(crate) exhausted: BTreeSet<String>,
    /// Scenarios in which a job ended.
    pub(crate) moved: BTreeSet<ScenarioId>,
    replies: Vec<Effect>,
    notices: Vec<Effect>,
    hints: BTreeSet<Stage>,
    ended: Vec<Effect>,
}

impl<'a> Turn<'a> {
    pub(crate) fn new(state: &'a mut State, now: Millis) -> Self {
        Self {
            state,
            now,
            rows: Vec::new(),
            jobs: BTreeSet::new(),
            attempts: BTreeSet::new(),
            scenarios: BTreeSet::new(),
            batches: BTreeSet::new(),
            queues: BTreeSet::new(),
            drawn: 0,
            exhausted: BTreeSet::new(),
            moved: BTreeSet::new(),
            replies: Vec::new(),
            notices: Vec::new(),
            hints: BTreeSet::new(),
            ended: Vec::new(),
        }
    }

    /// The effects: rows first, then answers, notices, hints.
    pub(crate) fn finish(mut self) -> Vec<Effect> {
        self.stop_exhausted();
        self.close_scenarios();
        while self.draw() {
            self.close_scenarios();
        }
        self.count_attempts();
        let mut effects: Vec<Effect> = Vec::new();
        for queue in self.queues.iter().filter_map(|place| self.state.queues.get(place)) {
            effects.push(Effect::Save(Row::Queue(Box::new(queue.clone()))));
        }
        for batch in self.batches.iter().filter_map(|name| self.state.batches.get(name)) {
            effects.push(Effect::Save(Row::Batch(Box::new(batch.clone()))));
        }
        for id in &self.scenarios {
            if let Some(scenario) = self.state.scenarios.get(id) {
                effects.push(Effect::Save(Row::Scenario(Box::new(scenario.clone()))));
            }
        }
        for key in &self.jobs {
            if let Some(job) = self.state.jobs.get(key) {
                // The store keeps attempts and results in rows of their own.
                let bare = Job { attempts: Vec::new(), result: None, children: Vec::new(), ..job.clone() };
                effects.push(Effect::Save(Row::Job(Box::new(bare))));
            }
        }
        for (key, number) in &self.attempts {
            let attempt = self.state.jobs.get(key).and_then(|job| job.attempts.iter().find(|a| a.number == *number));
            if let Some(attempt) = attempt {
                effects.push(Effect::Save(Row::Attempt(key.clone(), Box::new(attempt.clone()))));
            }
        }
        effects.extend(self.rows.into_iter().map(Effect::Save));
        effects.extend(self.replies);
        effects.extend(self.notices);
        effects.extend(self.hints.into_iter().map(Effect::Hint));
        effects.extend(self.ended);
        effects
    }

    /// Counts the attempts of this step that ended, once each, with what is known of them at its end.
    fn count_attempts(&mut self) {
        for (key, number) in &self.attempts {
            let job = self.state.jobs.get_mut(key);
            let attempt = job.and_then(|job| job.attempts.iter_mut().rev().find(|one| one.number == *number));
            let Some(attempt) = attempt.filter(|attempt| !attempt.counted) else { continue };
            let Some(end) = attempt.end else { continue };
            attempt.counted = true;
            let took = attempt.reported.then(|| self.now.saturating_sub(attempt.granted));
            self.state.tally.ended(key, *number, (end, attempt.class), took, self.now);
        }
    }

    /// Counts a job into its state, and out of it.
    fn counted(&mut self, key: &JobKey, enters: bool) {
        let Some(state) = self.state.jobs.get(key).map(|job| job.state) else { return };
        if enters {
            self.state.tally.enters(key.stage, state);
        } else {
            self.state.tally.leaves(key.stage, state);
        }
        // What a person looks at takes the time of a person.
        if !matches!(state, JobState::Leased | JobState::Canceling) || key.stage == Stage::Review {
            return;
        }
        let now = self.now;
        for pacer in self.pacers(&key.scenario) {
            if enters {
                pacer.takes(now);
            } else {
                pacer.gives_back(now);
            }
        }
    }

    /// The clocks of work of everything and of the batch of a scenario.
    fn pacers(&mut self, id: &ScenarioId) -> impl Iterator<Item = &mut Pacer> {
        let state = &mut *self.state;
        let batch = state.scenarios.get(id).map(|scenario| scenario.batch.clone()).unwrap_or_default();
        let now = self.now;
        let own = state.paces.entry(batch).or_insert_with(|| Pacer::new(now));
        [&mut state.pace, own].into_iter()
    }

    pub(crate) fn reply(&mut self, to: Token, answer: Answer) {
        self.replies.push(Effect::Reply { to, answer: Box::new(answer) });
    }

    pub(crate) fn hint(&mut self, stage: Stage) {
        self.hints.insert(stage);
    }

    pub(crate) fn job(&self, key: &JobKey) -> Option<&Job> {
        self.state.jobs.get(key)
    }

    /// A job to be changed; its row is saved at the end of the step.
    pub(crate) fn job_mut(&mut self, key: &JobKey) -> Option<&mut Job> {
        self.jobs.insert(key.clone());
        self.state.jobs.get_mut(key)
    }

    pub(crate) fn scenario(&self, id: &ScenarioId) -> Option<&Scenario> {
        self.state.scenarios.get(id)
    }

    /// A scenario to be changed; its row is saved at the end of the step.
    pub(crate) fn scenario_mut(&mut self, id: &ScenarioId) -> Option<&mut Scenario> {
        self.scenarios.insert(id.clone());
        self.state.scenarios.get_mut(id)
    }

    /// An attempt to be changed; its row is saved at the end of the step.
    pub(crate) fn attempt_mut(&mut self, key: &JobKey, number: u32) -> Option<&mut Attempt> {
        self.attempts.insert((key.clone(), number));
        self.state.jobs.get_mut(key).and_then(|job| job.attempts.iter_mut().rev().find(|a| a.number == number))
    }

    /// Writes how the attempt that holds the job ended, and takes the job from its worker.
    pub(crate) fn end_current(&mut self, key: &JobKey, end: AttemptEnd) {
        let Some((number, instance)) = self.job(key).and_then(|job| {
            let attempt = job.current()?;
            Some((attempt.number, attempt.instance.clone()))
        }) else {
            return;
        };
        if let Some(attempt) = self.attempt_mut(key, number) {
            // The first end stands: a failure that leads to a new revision stays a failure.
            attempt.end = attempt.end.or(Some(end));
        }
        if let Some(worker) = self.state.workers.get_mut(&instance) {
            worker.held.remove(key);
        }
    }

    /// Sets or clears when something happens to the job by itself.
    pub(crate) fn arm(&mut self, key: &JobKey, due: Option<Millis>) {
        let Some(job) = self.state.jobs.get_mut(key) else { return };
        if let Some(before) = std::mem::replace(&mut job.due, due) {
            self.state.timers.remove(&(before, key.clone()));
        }
        if let Some(due) = due {
            self.state.timers.insert((due, key.clone()));
        }
    }

    /// Moves a job to another state. Every change of state of every job comes through here.
    ///
    /// A move that the table does not have is not made; the checker finds what it leads to.
    pub(crate) fn move_to(&mut self, key: &JobKey, next: JobState, reason: impl Into<String>) {
        let Some(job) = self.state.jobs.get(key) else { return };
        let before = job.state;
        if !before.may_become(next) {
            return;
        }
        self.unindex(key);
        if !matches!(next, JobState::Leased | JobState::Canceling | JobState::Delayed) {
            self.arm(key, None);
        }
        let reason = reason.into();
        let now = self.now;
        let since_ms = self.state.wall_ms(now);
        if let Some(job) = self.job_mut(key) {
            job.state = next;
            job.reason = reason;
            job.since_ms = since_ms;
            if next == JobState::Ready {
                job.ready = now;
            }
        }
        self.index(key);
        self.announce(key);
        match (before.is_terminal(), next.is_terminal()) {
            (false, true) => self.closed(key, next),
            (true, false) => self.reopened(key),
            (false, false) | (true, true) => {}
        }
        if next == JobState::Ready {
            self.hint(key.stage);
        }
    }

    /// Puts a job that was just made into the books.
    pub(crate) fn enter(&mut self, job: Job) {
        let key = job.key.clone();
        for source in job.sources.values() {
            if let Some(parent) = self.state.jobs.get_mut(source)
                && !parent.children.contains(&key)
            {
                parent.children.push(key.clone());
            }
        }
        if let Some(scenario) = self.state.scenarios.get_mut(&key.scenario) {
            scenario.jobs.push(key.clone());
            scenario.open += 1;
        }
        self.state.open_jobs += 1;
        self.state.jobs.insert(key.clone(), job);
        self.counted(&key, true);
        self.jobs.insert(key);
    }

    fn closed(&mut self, key: &JobKey, how: JobState) {
        self.state.open_jobs = self.state.open_jobs.saturating_sub(1);
        if let Some(scenario) = self.state.scenarios.get_mut(&key.scenario) {
            scenario.open = scenario.open.saturating_sub(1);
        }
        self.moved.insert(key.scenario.clone());
        if matches!(how, JobState::Dead | JobState::Failed) {
            let reason = self.job(key).map(|job| job.reason.clone()).unwrap_or_default();
            self.rows.push(Row::Dead(key.clone(), reason));
        }
        let children = self.job(key).map(|job| job.children.clone()).unwrap_or_default();
        for child in children {
            self.unblock(&child);
        }
    }

    fn reopened(&mut self, key: &JobKey) {
        self.state.open_jobs += 1;
        if let Some(scenario) = self.state.scenarios.get_mut(&key.scenario) {
            scenario.open += 1;
        }
        self.rows.push(Row::Revived(key.clone()));
    }

    /// Takes a job out of the indices of its state.
    fn unindex(&mut self, key: &JobKey) {
        self.counted(key, false);
        let place = self.ready_place(key);
        let Some(job) = self.state.jobs.get(key) else { return };
        let idem_key = job.idem_key.filter(|_| job.shares());
        match job.state {
            JobState::Ready | JobState::Delayed => {
                if let (Some(place), Some(ready)) = (place, self.state.ready.get_mut(&key.stage)) {
                    ready.remove(&place);
                }
                if let Some(idem_key) = idem_key
                    && let Some(waiting) = self.state.waiting.get_mut(&idem_key)
                {
                    waiting.remove(key);
                    if waiting.is_empty() {
                        self.state.waiting.remove(&idem_key);
                    }
                }
            }
            JobState::Leased | JobState::Canceling => {
                if pipeline::is_authored(key.stage) {
                    self.state.authoring = self.state.authoring.saturating_sub(1);
                }
                if let Some(idem_key) = idem_key
                    && self.state.in_flight.get(&idem_key) == Some(key)
                {
                    self.state.in_flight.remove(&idem_key);
                    // Jobs that waited for this one may be handed out now.
                    if self.state.waiting.contains_key(&idem_key) {
                        self.hints.insert(key.stage);
                    }
                }
            }
            JobState::Blocked
            | JobState::Succeeded
            | JobState::Failed
            | JobState::Dead
            | JobState::Canceled
            | JobState::Superseded => {}
        }
    }

    /// Puts a job into the indices of its state.
    pub(crate) fn index(&mut self, key: &JobKey) {
        self.counted(key, true);
        let place = self.ready_place(key);
        let Some(job) = self.state.jobs.get(key) else { return };
        let idem_key = job.idem_key.filter(|_| job.shares());
        match job.state {
            JobState::Ready | JobState::Delayed => {
                if job.state == JobState::Ready
                    && let Some(place) = place
                {
                    self.state.ready.entry(key.stage).or_default().insert(place);
                }
                if let Some(idem_key) = idem_key {
                    self.state.waiting.entry(idem_key).or_default().insert(key.clone());
                }
            }
            JobState::Leased | JobState::Canceling => {
                if pipeline::is_authored(key.stage) {
                    self.state.authoring += 1;
                }
                if let Some(idem_key) = idem_key {
                    self.state.in_flight.entry(idem_key).or_insert_with(|| key.clone());
                }
            }
            JobState::Succeeded => {
                if let Some(idem_key) = idem_key {
                    self.state.cached.entry(idem_key).or_insert_with(|| key.clone());
                }
            }
            JobState::Blocked | JobState::Failed | JobState::Dead | JobState::Canceled | JobState::Superseded => {}
        }
    }

    /// Changes what a job is indexed by.
    pub(crate) fn reindex(&mut self, key: &JobKey, edit: impl FnOnce(&mut Self)) {
        self.unindex(key);
        edit(self);
        self.index(key);
    }

    fn ready_place(&self, key: &JobKey) -> Option<(u64, u64, usize, JobKey)> {
        let job = self.job(key)?;
        let scenario = self.scenario(&key.scenario)?;
        // The reference robot goes before the planners under test, whatever their names.
        let rank = usize::from(job.spec.run().is_some_and(|run| !run.planner.is_reference()));
        Some((scenario.turn, scenario.order, rank, key.clone()))
    }

    /// Tells viewers where a job stands now, through the outbox.
    pub(crate) fn announce(&mut self, key: &JobKey) {
        let Some(job) = self.state.jobs.get(key) else { return };
        let batch = self.scenario(&key.scenario).map(|scenario| scenario.batch.clone()).unwrap_or_default();
        let (remark, wall_ms) = match &job.result {
            Some(result) => (result.remark.clone(), result.wall_ms),
            None => (job.reason.clone(), job.attempts.last().map_or(0, |attempt| attempt.wall_ms)),
        };
        let notice = Box::new(Notice {
            seq: self.state.next_seq,
            key: key.clone(),
            state: job.state,
            attempt: job.attempts.last().map_or(0, |attempt| attempt.number),
            remark,
            wall_ms,
        });
        self.state.next_seq += 1;
        self.rows.push(Row::Event(batch.clone(), notice.clone()));
        self.notices.push(Effect::Notice { batch, notice });
    }

    /// Ends a scenario; once.
    pub(crate) fn end_scenario(&mut self, id: &ScenarioId, end: ScenarioEnd) {
        let Some(scenario) = self.scenario_mut(id) else { return };
        if scenario.end.is_some() {
            return;
        }
        scenario.end = Some(end);
        if end != ScenarioEnd::Canceled {
            let now = self.now;
            self.pacers(id).for_each(|pacer| pacer.ended(now));
        }
        let Some(scenario) = self.scenario(id) else { return };
        let counted = scenario.started && !scenario.spec.review;
        let (batch, order, waited) = (scenario.batch.clone(), scenario.order, !scenario.started);
        self.state.done += 1;
        self.shut(&batch, 1);
        if waited {
            self.waits_no_more(order);
        }
        if counted {
            self.state.under_way = self.state.under_way.saturating_sub(1);
            // A place is free for a scenario that was not begun.
            self.hints.extend(
                Stage::WORKERS
                    .into_iter()
                    .filter(|stage| self.state.ready.get(stage).is_some_and(|ready| !ready.is_empty())),
            );
        }
        self.ended.push(Effect::ScenarioDone { id: id.clone(), end });
    }
}
