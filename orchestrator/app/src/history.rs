//! What was tried: every revision and attempt, out of a job store.

use std::collections::BTreeMap;

use socrates_model::job::{Artifact, JobKey, Stage};
use socrates_model::{Digest, Fault, JobState, Role, ScenarioEnd, ScenarioId};
use socrates_orchestrator::{Attempt, Snapshot};

/// One revision of one job.
#[derive(Debug, Clone)]
pub struct PastJob {
    /// Which.
    pub(crate) key: JobKey,
    /// How it ended, in lower case.
    pub(crate) state: JobState,
    /// Seed it was done with.
    pub(crate) seed: u64,
    /// Inputs by role.
    pub(crate) inputs: BTreeMap<Role, Digest>,
    /// Reasons for which this revision was made.
    pub(crate) sent_back: Vec<Fault>,
    /// Attempts in order.
    pub attempts: Vec<Attempt>,
    /// What a scoring job found.
    pub(crate) verdict: Option<socrates_model::Verdict>,
    /// The stage that a scoring job sends back.
    pub(crate) blames: Option<Stage>,
    /// Remark of its result, else why it is where it is.
    pub(crate) remark: String,
    /// Outputs of its result.
    pub(crate) artifacts: Vec<Artifact>,
    /// Wall time since which it stands so, ms since 1970; 0 where it is not known.
    pub(crate) since_ms: u64,
}

/// Everything that was tried, by scenario.
#[derive(Debug, Clone, Default)]
pub struct History {
    jobs: BTreeMap<ScenarioId, Vec<PastJob>>,
    /// Scenarios in order of submission, and how each ended; none while it is not done.
    pub(crate) ends: Vec<(ScenarioId, Option<ScenarioEnd>)>,
}

impl History {
    /// What the rows of a store tell.
    pub(crate) fn of_rows(rows: Snapshot) -> Self {
        let mut attempts: BTreeMap<JobKey, Vec<Attempt>> = BTreeMap::new();
        for (key, attempt) in rows.attempts {
            attempts.entry(key).or_default().push(attempt);
        }
        let mut results: BTreeMap<JobKey, _> = rows.results.into_iter().collect();
        let ends = rows.scenarios.into_iter().map(|scenario| (scenario.spec.id, scenario.end)).collect();
        let mut history = Self { ends, ..Self::default() };
        for job in rows.jobs {
            let result = results.remove(&job.key);
            let past = PastJob {
                state: job.state,
                seed: job.spec.seed,
                inputs: job.spec.inputs,
                sent_back: job.sent_back,
                attempts: attempts.remove(&job.key).unwrap_or_default(),
                verdict: result.as_ref().and_then(|result| result.verdict),
                blames: result.as_ref().and_then(|result| Some(result.repair.as_ref()?.stage)),
                remark: result.as_ref().map_or(job.reason, |result| result.remark.clone()),
                artifacts: result.map(|result| result.artifacts).unwrap_or_default(),
                since_ms: job.since_ms,
                key: job.key,
            };
            history.jobs.entry(past.key.scenario.clone()).or_default().push(past);
        }
        for jobs in history.jobs.values_mut() {
            jobs.sort_by(|a, b| {
                (a.key.stage, &a.key.item, a.key.revision).cmp(&(b.key.stage, &b.key.item, b.key.revision))
            });
        }
        history
    }

    /// What was tried for a scenario, in pipeline order.
    #[must_use]
    pub fn of(&self, scenario: &ScenarioId) -> &[PastJob] {
        self.jobs.get(scenario).map_or(&[], Vec::as_slice)
    }
}
