//! A job's papers, and what becomes of them: everything the three authoring stages share.

use std::collections::BTreeMap;

use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_model::{FailureClass, Fault, HumanId, Location, Proposal, Reading, Request};
use socrates_prompts::Question;

use crate::attempt::{Exchange, Made, Refused, Written, attempt};
use crate::settings::{Keys, author_of_job};

/// Everything a job hands to its author.
#[derive(Debug, Clone, PartialEq)]
pub struct Papers {
    /// Stage: proposal, paths or behaviors.
    pub stage: Stage,
    /// What the user gave.
    pub request: Request,
    /// What was read of it.
    pub reading: Reading,
    /// The place.
    pub location: Location,
    /// The proposal, for paths and behaviors.
    pub proposal: Option<Proposal>,
    /// Only these humans; empty for all.
    pub only: Vec<HumanId>,
    /// Why earlier answers were refused.
    pub feedback: Vec<Fault>,
    /// The newest refused answer.
    pub refused: Option<String>,
    /// Seed of the job; the attempt never enters.
    pub seed: u64,
    /// Settings of the job: `author`, `fault.…`.
    pub settings: BTreeMap<String, String>,
    /// Number of the attempt, from 1; only injected faults look at it.
    pub attempt: u32,
}

impl Papers {
    /// The papers of the first question of a scenario: a proposal is asked for at the first attempt, with no settings.
    #[must_use]
    pub const fn first(request: Request, reading: Reading, location: Location, seed: u64) -> Self {
        Self {
            stage: Stage::Proposal,
            request,
            reading,
            location,
            proposal: None,
            only: Vec::new(),
            feedback: Vec::new(),
            refused: None,
            seed,
            settings: BTreeMap::new(),
            attempt: 1,
        }
    }

    /// The question to the author.
    #[must_use]
    pub fn question(self) -> Question {
        Question {
            stage: self.stage,
            request: self.request,
            reading: self.reading,
            location: self.location,
            proposal: self.proposal,
            only: self.only,
            feedback: self.feedback,
            refused: self.refused,
            seed: self.seed,
        }
    }
}

/// A job that was done.
#[derive(Debug, Clone, PartialEq)]
pub struct JobAnswer {
    /// The artifact.
    pub written: Written,
    /// How it came about.
    pub exchange: Exchange,
    /// Short words for the status line.
    pub remark: String,
}

/// A job that was not done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JobRefusal {
    /// How the orchestrator treats it.
    pub class: FailureClass,
    /// Every reason at once.
    pub faults: Vec<Fault>,
    /// The refused text.
    pub text: Option<String>,
    /// How long the server wants us to wait, ms.
    pub retry_after_ms: Option<u64>,
    /// How it came about; nothing where nobody was asked.
    pub exchange: Option<Box<Exchange>>,
}

/// The desk of an authoring worker: its keys, and one way to do a job.
#[derive(Debug, Clone, Default)]
pub struct Desk {
    keys: Keys,
}

impl Desk {
    /// A desk with these keys.
    #[must_use]
    pub const fn new(keys: Keys) -> Self {
        Self { keys }
    }

    /// Does a job: one question, one ask.
    ///
    /// # Errors
    /// [`JobRefusal`] with every reason at once.
    pub async fn answer(&self, papers: Papers) -> Result<JobAnswer, JobRefusal> {
        // What only a person can settle is not put to an author.
        let unsettled: Vec<Fault> = hard(&papers.reading.problems)
            .into_iter()
            .filter(|fault| fault.code.class() == FailureClass::Permanent)
            .collect();
        if papers.stage == Stage::Proposal && !unsettled.is_empty() {
            return Err(unasked(unsettled));
        }
        let author = author_of_job(&papers.settings, &self.keys, papers.attempt)
            .map_err(|error| unasked(vec![error.fault()]))?;
        match attempt(author.as_ref(), &papers.question()).await {
            Ok(Made { written, exchange }) => Ok(JobAnswer { remark: written.remark(), written, exchange }),
            Err(Refused { class, faults, text, retry_after_ms, exchange }) => {
                Err(JobRefusal { class, faults, text, retry_after_ms, exchange: Some(exchange) })
            }
        }
    }
}

fn unasked(faults: Vec<Fault>) -> JobRefusal {
    JobRefusal { class: FailureClass::Permanent, faults, text: None, retry_after_ms: None, exchange: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::papers;
    use socrates_model::FaultCode;

    #[tokio::test]
    async fn what_only_a_person_can_settle_is_not_asked() {
        let mut papers = papers(Stage::Proposal);
        papers.reading.problems = vec![Fault::new(FaultCode::PContra, "rough_scenario", "both follow and run away")];
        let refusal = Desk::default().answer(papers).await.unwrap_err();
        assert_eq!((refusal.class, refusal.exchange), (FailureClass::Permanent, None));
    }

    #[tokio::test]
    async fn an_unknown_author_is_a_permanent_fault() {
        let mut papers = papers(Stage::Paths);
        papers.settings.insert("author".into(), "oracle".into());
        let refusal = Desk::default().answer(papers).await.unwrap_err();
        assert_eq!((refusal.class, refusal.faults[0].code), (FailureClass::Permanent, FaultCode::JRequest));
    }
}
