//! The stage itself.

use socrates_author::{Desk, Keys};
use socrates_kit::{Done, Failure, Job, Stage};
use socrates_model::job;

/// Serves jobs of the proposal stage.
///
/// Inputs by role: `request`, `reading`, `location`. Outputs: `proposal`, and `exchange` for provenance.
#[derive(Debug, Clone, Default)]
pub struct ProposalStage {
    desk: Desk,
}

impl ProposalStage {
    /// A stage whose authors use these keys; jobs carry none.
    #[must_use]
    pub const fn new(keys: Keys) -> Self {
        Self { desk: Desk::new(keys) }
    }
}

impl Stage for ProposalStage {
    const STAGE: job::Stage = job::Stage::Proposal;

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        socrates_desk::serve(&self.desk, Self::STAGE, job).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::job::{JobKey, JobSpec};
    use socrates_model::{FailureClass, FaultCode, Request};
    use std::collections::BTreeMap;

    fn spec(settings: &[(&str, &str)]) -> JobSpec {
        let settings: BTreeMap<&str, &str> = settings.iter().copied().collect();
        let key =
            JobKey { scenario: "s".parse().unwrap(), stage: job::Stage::Proposal, item: String::new(), revision: 0 };
        serde_json::from_value(serde_json::json!({"key": key, "inputs": {}, "seed": 5, "settings": settings})).unwrap()
    }

    fn inputs() -> BTreeMap<String, Vec<u8>> {
        let name = socrates_maps::shipped::names()[0];
        let location = socrates_maps::shipped::load(name).unwrap();
        let request: Request = serde_json::from_value(serde_json::json!({
            "location": name, "social_context": "A busy day", "task": "Deliver a parcel",
            "rough_scenario": "One person comes towards the robot.",
        }))
        .unwrap();
        let reading = socrates_offline::read(&request, &location);
        let json = |value: serde_json::Result<Vec<u8>>| value.unwrap();
        BTreeMap::from([
            ("request".to_owned(), json(serde_json::to_vec(&request))),
            ("reading".to_owned(), json(serde_json::to_vec(&reading))),
            ("location".to_owned(), json(serde_json::to_vec(&location))),
        ])
    }

    #[tokio::test]
    async fn a_job_gives_a_proposal_and_its_exchange() {
        let job = Job::detached(spec(&[("author", "offline")]), inputs());
        let done = ProposalStage::default().run(&job).await.unwrap();
        let roles: Vec<&str> = done.artifacts.iter().map(|output| output.role.as_str()).collect();
        assert_eq!(roles, ["proposal", "exchange"]);
        assert_eq!(done.remark, "1 person");
    }

    #[tokio::test]
    async fn a_refused_answer_is_reported_with_its_text() {
        let job = Job::detached(spec(&[("author", "offline"), ("fault.trunc", "1")]), inputs());
        let failure = ProposalStage::default().run(&job).await.unwrap_err();
        let roles: Vec<&str> = failure.artifacts.iter().map(|output| output.role.as_str()).collect();
        assert_eq!((failure.class, roles), (FailureClass::Unparsable, vec!["refused", "exchange"]));
    }

    #[tokio::test]
    async fn a_missing_input_is_poison() {
        let job = Job::detached(spec(&[]), BTreeMap::new());
        let failure = ProposalStage::default().run(&job).await.unwrap_err();
        assert_eq!((failure.class, failure.faults[0].code), (FailureClass::Poison, FaultCode::JSpec));
    }
}
