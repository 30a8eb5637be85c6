//! What was tried: every revision and attempt, out of the job store of a finished making.

use std::collections::BTreeMap;
use std::path::Path;

use socrates_model::job::{Artifact, JobKey};
use socrates_model::{Digest, Fault, ScenarioId};
use socrates_orchestrator::Attempt;
use socrates_store::{SqliteStore, Store as _, StoreError};

/// One revision of one job.
#[derive(Debug, Clone)]
pub(crate) struct PastJob {
    /// Which.
    pub(crate) key: JobKey,
    /// How it ended, in lower case.
    pub(crate) state: String,
    /// Seed it was done with.
    pub(crate) seed: u64,
    /// Inputs by role.
    pub(crate) inputs: BTreeMap<String, Digest>,
    /// Reasons for which this revision was made.
    pub(crate) sent_back: Vec<Fault>,
    /// Attempts in order.
    pub(crate) attempts: Vec<Attempt>,
    /// What a scoring job found.
    pub(crate) verdict: Option<socrates_model::Verdict>,
    /// Outputs of its result.
    pub(crate) artifacts: Vec<Artifact>,
}

/// Everything that was tried, by scenario.
#[derive(Debug, Clone, Default)]
pub(crate) struct History(BTreeMap<ScenarioId, Vec<PastJob>>);

impl History {
    /// What was tried for a scenario, in pipeline order.
    pub(crate) fn of(&self, scenario: &ScenarioId) -> &[PastJob] {
        self.0.get(scenario).map_or(&[], Vec::as_slice)
    }
}

/// Reads the store; nobody else may have it open.
pub(crate) fn read(path: &Path) -> Result<History, StoreError> {
    let snapshot = SqliteStore::open(path)?.load()?;
    let mut attempts: BTreeMap<JobKey, Vec<Attempt>> = BTreeMap::new();
    for (key, attempt) in snapshot.attempts {
        attempts.entry(key).or_default().push(attempt);
    }
    let mut results: BTreeMap<JobKey, _> = snapshot.results.into_iter().collect();
    let mut history = History::default();
    for job in snapshot.jobs {
        let result = results.remove(&job.key);
        let past = PastJob {
            state: format!("{:?}", job.state).to_lowercase(),
            seed: job.spec.seed,
            inputs: job.spec.inputs,
            sent_back: job.sent_back,
            attempts: attempts.remove(&job.key).unwrap_or_default(),
            verdict: result.as_ref().and_then(|result| result.verdict),
            artifacts: result.map(|result| result.artifacts).unwrap_or_default(),
            key: job.key,
        };
        history.0.entry(past.key.scenario.clone()).or_default().push(past);
    }
    for jobs in history.0.values_mut() {
        jobs.sort_by(|a, b| {
            (a.key.stage, &a.key.item, a.key.revision).cmp(&(b.key.stage, &b.key.item, b.key.revision))
        });
    }
    Ok(history)
}
