//! What a reader sees of a store that belongs to somebody else: an orchestrator that works, or one that was killed.

use socrates_model::job::JobKey;
use socrates_orchestrator::{Attempt, Job, JobResult, Scenario};

/// How one scenario stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Standing {
    /// Its id.
    pub scenario: String,
    /// `realised` … or `failed`, `canceled`; none while it is not done.
    pub result: Option<String>,
}

/// Every row that tells what was tried. A [`socrates_orchestrator::Snapshot`] is what a new reign begins with; this begins none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Peek {
    /// Scenarios in order of submission.
    pub scenarios: Vec<Scenario>,
    /// Jobs.
    pub jobs: Vec<Job>,
    /// Attempts of each job, in order.
    pub attempts: Vec<(JobKey, Attempt)>,
    /// Results.
    pub results: Vec<(JobKey, JobResult)>,
}
