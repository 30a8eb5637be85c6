//! The stage itself.

use socrates_author::{Desk, Keys};
use socrates_kit::{Done, Failure, Job, Stage};
use socrates_model::job;

/// Serves jobs of the paths stage.
///
/// Inputs by role: `request`, `reading`, `location`, `proposal`. Outputs: `paths`, and `exchange` for provenance.
#[derive(Debug, Clone, Default)]
pub struct PathsStage {
    desk: Desk,
}

impl PathsStage {
    /// A stage whose authors use these keys; jobs carry none.
    #[must_use]
    pub const fn new(keys: Keys) -> Self {
        Self { desk: Desk::new(keys) }
    }
}

impl Stage for PathsStage {
    const STAGE: job::Stage = job::Stage::Paths;

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        socrates_desk::serve(&self.desk, Self::STAGE, job).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::FaultCode;
    use socrates_model::job::{JobKey, JobSpec};
    use std::collections::BTreeMap;

    #[tokio::test]
    async fn a_job_without_its_papers_is_poison() {
        let key = JobKey { scenario: "s".parse().unwrap(), stage: job::Stage::Paths, item: String::new(), revision: 0 };
        let spec: JobSpec = serde_json::from_value(serde_json::json!({"key": key, "inputs": {}, "seed": 5})).unwrap();
        let failure = PathsStage::default().run(&Job::detached(spec, BTreeMap::new())).await.unwrap_err();
        assert_eq!(failure.faults[0].code, FaultCode::JSpec);
    }
}
