//! The store of a simulated orchestrator: rows in memory, what a restart finds, and whether anything was written twice.

use std::collections::BTreeMap;

use socrates_model::ScenarioId;
use socrates_model::fault::FailureClass;
use socrates_model::job::{JobKey, Stage};
use socrates_orchestrator::{Attempt, AttemptEnd, Batch, Job, JobResult, JobState, Queue, Row, Scenario, Snapshot};

/// The rows that were committed.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    scenarios: BTreeMap<ScenarioId, Scenario>,
    jobs: BTreeMap<JobKey, Job>,
    attempts: BTreeMap<(JobKey, u32), Attempt>,
    results: BTreeMap<JobKey, JobResult>,
    batches: BTreeMap<String, Batch>,
    queues: BTreeMap<u64, Queue>,
    next_seq: u64,
    paused: Vec<String>,
    paused_stages: Vec<Stage>,
    /// Results of jobs that were written more than once.
    pub(crate) doubled: u64,
}

impl Rows {
    /// Saves a row; it replaces what is under the same key.
    pub(crate) fn save(&mut self, row: Row) {
        match row {
            Row::Scenario(scenario) => drop(self.scenarios.insert(scenario.spec.id.clone(), *scenario)),
            Row::Job(job) => drop(self.jobs.insert(job.key.clone(), *job)),
            Row::Attempt(key, attempt) => drop(self.attempts.insert((key, attempt.number), *attempt)),
            Row::Result(key, result) => self.doubled += u64::from(self.results.insert(key, *result).is_some()),
            Row::Event(_, notice) => self.next_seq = notice.seq.saturating_add(1),
            Row::Batch(batch) => drop(self.batches.insert(batch.name.clone(), *batch)),
            Row::Queue(queue) => drop(self.queues.insert(queue.place, *queue)),
            Row::Paused(paused) => self.paused = paused,
            Row::PausedStages(paused) => self.paused_stages = paused,
            Row::Text(..) | Row::Dead(..) | Row::Revived(_) => {}
        }
    }

    /// What an orchestrator of this reign finds when it starts.
    pub(crate) fn snapshot(&self, epoch: u64) -> Snapshot {
        Snapshot {
            epoch,
            scenarios: self.scenarios.values().cloned().collect(),
            jobs: self.jobs.values().cloned().collect(),
            attempts: self.attempts.iter().map(|((key, _), attempt)| (key.clone(), attempt.clone())).collect(),
            results: self.results.iter().map(|(key, result)| (key.clone(), result.clone())).collect(),
            batches: self.batches.values().cloned().collect(),
            queues: self.queues.values().cloned().collect(),
            paused: self.paused.clone(),
            paused_stages: self.paused_stages.clone(),
            next_seq: self.next_seq,
        }
    }

    /// The rows that a store holds.
    pub(crate) fn of(snapshot: Snapshot) -> Self {
        Self {
            scenarios: snapshot.scenarios.into_iter().map(|one| (one.spec.id.clone(), one)).collect(),
            jobs: snapshot.jobs.into_iter().map(|one| (one.key.clone(), one)).collect(),
            attempts: snapshot.attempts.into_iter().map(|(key, one)| ((key, one.number), one)).collect(),
            results: snapshot.results.into_iter().collect(),
            batches: snapshot.batches.into_iter().map(|one| (one.name.clone(), one)).collect(),
            queues: snapshot.queues.into_iter().map(|one| (one.place, one)).collect(),
            next_seq: snapshot.next_seq,
            paused: snapshot.paused,
            paused_stages: snapshot.paused_stages,
            doubled: 0,
        }
    }

    /// An attempt's row.
    pub(crate) fn attempt(&self, key: &JobKey, number: u32) -> Option<&Attempt> {
        self.attempts.get(&(key.clone(), number))
    }

    /// Stage and class of the failure with which each scenario's newest job that was given up ended.
    pub(crate) fn failures(&self) -> BTreeMap<ScenarioId, (Stage, FailureClass)> {
        let mut found: BTreeMap<ScenarioId, (u32, Stage, FailureClass)> = BTreeMap::new();
        for ((key, _), attempt) in &self.attempts {
            let given_up = self.jobs.get(key).is_some_and(|job| matches!(job.state, JobState::Failed | JobState::Dead));
            let class = match (attempt.class, attempt.end) {
                (None, Some(AttemptEnd::Lapsed)) => Some(FailureClass::WorkerDeath),
                (None, Some(AttemptEnd::TimedOut)) => Some(FailureClass::Transient),
                (class, _) => class,
            };
            let newest = found.get(&key.scenario).is_none_or(|(revision, _, _)| key.revision >= *revision);
            if let (true, true, Some(class)) = (given_up, newest, class) {
                found.insert(key.scenario.clone(), (key.revision, key.stage, class));
            }
        }
        found.into_iter().map(|(id, (_, stage, class))| (id, (stage, class))).collect()
    }

    /// The scenario's row.
    pub(crate) fn scenario(&self, id: &ScenarioId) -> Option<&Scenario> {
        self.scenarios.get(id)
    }

    /// Whether the result of a job is the one that this attempt reported.
    pub(crate) fn holds(&self, key: &JobKey, attempt: u32) -> bool {
        self.results.get(key).is_some_and(|result| result.attempt == attempt)
    }
}
