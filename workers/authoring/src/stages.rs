//! The three stages.

use socrates_author::{AuthorContext, Keys};
use socrates_kit::{Done, Failure, Job, Stage};
use socrates_model::job;

macro_rules! stages {
    ($($(#[$about:meta])* $name:ident $stage:ident;)*) => {$(
        $(#[$about])*
        #[derive(Debug, Clone, Default)]
        pub struct $name(AuthorContext);

        impl $name {
            /// A stage whose authors use these keys; jobs carry none.
            #[must_use]
            pub const fn new(keys: Keys) -> Self {
                Self(AuthorContext::new(keys))
            }
        }

        impl Stage for $name {
            const STAGE: job::Stage = job::Stage::$stage;

            async fn run(&self, job: &Job) -> Result<Done, Failure> {
                crate::serve(&self.0, Self::STAGE, job).await
            }
        }
    )*};
}

stages! {
    /// From a request and its reading to a scenario in detail.
    ///
    /// Inputs by role: `request`, `reading`, `location`. Outputs: `proposal`, `exchange` for provenance, and `reading` where the author read the
    /// request itself.
    ProposalStage Proposal;
    /// From a proposal and the map to node sequences and encounters.
    ///
    /// Inputs by role: `request`, `reading`, `location`, `proposal`. Outputs: `paths`, and `exchange` for provenance.
    PathsStage Paths;
    /// From a proposal to one behavior tree per human.
    ///
    /// Inputs by role: `request`, `reading`, `location`, `proposal`. Outputs: `behaviors`, and `exchange` for
    /// provenance.
    BehaviorsStage Behaviors;
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::job::{JobKey, JobSpec};
    use socrates_model::{FailureClass, FaultCode, Request, Role};
    use std::collections::BTreeMap;

    fn spec_of(stage: job::Stage, settings: &[(&str, &str)]) -> JobSpec {
        let settings: BTreeMap<&str, &str> = settings.iter().copied().collect();
        let key = JobKey { scenario: "s".parse().unwrap(), stage, item: job::Item::Whole, revision: 0 };
        serde_json::from_value(serde_json::json!({"key": key, "inputs": {}, "seed": 5, "settings": settings})).unwrap()
    }

    fn spec(settings: &[(&str, &str)]) -> JobSpec {
        spec_of(job::Stage::Proposal, settings)
    }

    fn inputs() -> BTreeMap<Role, Vec<u8>> {
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
            (Role::Request, json(serde_json::to_vec(&request))),
            (Role::Reading, json(serde_json::to_vec(&reading))),
            (Role::Location, json(serde_json::to_vec(&location))),
        ])
    }

    #[tokio::test]
    async fn a_job_gives_a_proposal_and_its_exchange() {
        let job = Job::detached(spec(&[("author", "offline")]), inputs());
        let done = ProposalStage::default().run(&job).await.unwrap();
        let roles: Vec<&str> = done.artifacts.iter().map(|output| output.role.name()).collect();
        assert_eq!(roles, ["proposal", "exchange"]);
        assert_eq!(done.remark, "1 person");
    }

    #[tokio::test]
    async fn a_job_of_others_that_names_a_folder_fails_for_good_and_leaves_no_folder() {
        let tape = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("no-such-tape");
        for author in ["record", "replay"].map(|kind| format!("{kind}:{}=offline", tape.display())) {
            let job = Job::detached(spec(&[("author", &author)]), inputs());
            let failure = ProposalStage::default().run(&job).await.unwrap_err();
            assert_eq!((failure.class, failure.faults[0].code), (FailureClass::Permanent, FaultCode::JRequest));
            assert!(!tape.exists(), "{author}");
        }
    }

    #[tokio::test]
    async fn a_refused_answer_is_reported_with_its_text() {
        let job = Job::detached(spec(&[("author", "offline"), ("fault.trunc", "1")]), inputs());
        let failure = ProposalStage::default().run(&job).await.unwrap_err();
        let roles: Vec<&str> = failure.artifacts.iter().map(|output| output.role.name()).collect();
        assert_eq!((failure.class, roles), (FailureClass::Unparsable, vec!["refused", "exchange"]));
    }

    #[tokio::test]
    async fn a_missing_input_is_poison_in_every_stage() {
        let job = |stage| Job::detached(spec_of(stage, &[]), BTreeMap::new());
        let failures = [
            ProposalStage::default().run(&job(ProposalStage::STAGE)).await.unwrap_err(),
            PathsStage::default().run(&job(PathsStage::STAGE)).await.unwrap_err(),
            BehaviorsStage::default().run(&job(BehaviorsStage::STAGE)).await.unwrap_err(),
        ];
        for failure in failures {
            assert_eq!((failure.class, failure.faults[0].code), (FailureClass::Poison, FaultCode::JSpec));
        }
    }

    #[tokio::test]
    async fn paths_and_behaviors_need_the_proposal() {
        let job = |stage| Job::detached(spec_of(stage, &[]), inputs());
        for failure in [
            PathsStage::default().run(&job(PathsStage::STAGE)).await.unwrap_err(),
            BehaviorsStage::default().run(&job(BehaviorsStage::STAGE)).await.unwrap_err(),
        ] {
            assert_eq!(failure.faults[0].code, FaultCode::JSpec);
            assert!(failure.faults[0].to_string().contains("proposal"), "{}", failure.faults[0]);
        }
    }
}
