//! The store in memory, for tests and the model of the real one.

use std::collections::BTreeMap;

use socrates_model::job::{JobKey, Stage};
use socrates_model::{Digest, ScenarioId};
use socrates_orchestrator::{Attempt, Batch, Job, JobResult, Queue, Row, Scenario, Snapshot};

use crate::{Store, StoreError, check};

/// Rows in ordered maps; as exact as the file and gone with the process.
#[derive(Debug, Clone, Default)]
pub struct MemoryStore {
    epoch: u64,
    next_seq: u64,
    scenarios: BTreeMap<ScenarioId, Scenario>,
    jobs: BTreeMap<JobKey, Job>,
    attempts: BTreeMap<(JobKey, u32), Attempt>,
    results: BTreeMap<JobKey, JobResult>,
    texts: BTreeMap<Digest, String>,
    dead: BTreeMap<JobKey, String>,
    batches: BTreeMap<String, Batch>,
    queues: BTreeMap<u64, Queue>,
    paused: Vec<String>,
    paused_stages: Vec<Stage>,
}

impl MemoryStore {
    /// An empty store.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    fn read(&self) -> Snapshot {
        let mut scenarios: Vec<Scenario> = self.scenarios.values().cloned().collect();
        scenarios.sort_by_key(|scenario| scenario.order);
        Snapshot {
            epoch: self.epoch,
            scenarios,
            jobs: self.jobs.values().cloned().collect(),
            attempts: self.attempts.iter().map(|((key, _), attempt)| (key.clone(), attempt.clone())).collect(),
            results: self.results.iter().map(|(key, result)| (key.clone(), result.clone())).collect(),
            batches: self.batches.values().cloned().collect(),
            queues: self.queues.values().cloned().collect(),
            paused: self.paused.clone(),
            paused_stages: self.paused_stages.clone(),
            next_seq: self.next_seq.max(1),
        }
    }
}

impl Store for MemoryStore {
    fn save(&mut self, rows: &[Row]) -> Result<(), StoreError> {
        let mut fresh = std::collections::BTreeSet::new();
        for row in rows {
            if let Row::Result(key, _) = row
                && (self.results.contains_key(key) || !fresh.insert(key))
            {
                return Err(StoreError::SecondResult { job: key.to_string() });
            }
        }
        for row in rows.iter().cloned() {
            match row {
                Row::Scenario(scenario) => {
                    self.scenarios.insert(scenario.spec.id.clone(), *scenario);
                }
                Row::Job(job) => {
                    self.jobs.insert(job.key.clone(), *job);
                }
                Row::Attempt(key, attempt) => {
                    self.attempts.insert((key, attempt.number), *attempt);
                }
                Row::Result(key, result) => {
                    self.results.insert(key, *result);
                }
                Row::Text(digest, content) => {
                    self.texts.insert(digest, content);
                }
                Row::Event(_, notice) => self.next_seq = self.next_seq.max(notice.seq + 1),
                Row::Dead(key, reason) => {
                    self.dead.insert(key, reason);
                }
                Row::Revived(key) => {
                    self.dead.remove(&key);
                }
                Row::Batch(batch) => {
                    self.batches.insert(batch.name.clone(), *batch);
                }
                Row::Queue(queue) => {
                    self.queues.insert(queue.place, *queue);
                }
                Row::Paused(paused) => self.paused = paused,
                Row::PausedStages(stages) => self.paused_stages = stages,
            }
        }
        Ok(())
    }

    fn load(&mut self) -> Result<Snapshot, StoreError> {
        self.epoch += 1;
        Ok(self.read())
    }

    fn text(&self, digest: &Digest) -> Result<Option<String>, StoreError> {
        Ok(self.texts.get(digest).cloned())
    }

    fn texts(&self) -> Result<Vec<Digest>, StoreError> {
        Ok(self.texts.keys().copied().collect())
    }

    fn fsck(&self) -> Result<Vec<String>, StoreError> {
        Ok(check(&self.read()))
    }
}
