//! A job's question, and what becomes of it: everything the three authoring stages share.

use std::collections::BTreeMap;

use socrates_llm::Listener;
use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_model::{FailureClass, Fault, Reading};
use socrates_prompts::Question;

use crate::attempt::{Exchange, Made, Refused, Written, attempt};
use crate::settings::{Keys, author_of_job};

/// How a question is put: what of a job is no part of its question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Asking {
    /// Settings of the job: `author`, `prompt.…`, `fault.…`.
    pub settings: BTreeMap<String, String>,
    /// Number of the attempt, from 1; only injected faults look at it.
    pub attempt: u32,
}

impl Default for Asking {
    /// The first attempt, with no settings.
    fn default() -> Self {
        Self { settings: BTreeMap::new(), attempt: 1 }
    }
}

impl Asking {
    /// The first attempt with the offline author.
    #[must_use]
    pub fn offline() -> Self {
        Self { settings: BTreeMap::from([("author".to_owned(), "offline".to_owned())]), attempt: 1 }
    }
}

/// A job that was done.
#[derive(Debug, Clone, PartialEq)]
pub struct JobAnswer {
    /// The artifact.
    pub written: Written,
    /// How the author read the request, where it read it itself.
    pub reading: Option<Reading>,
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

/// What an authoring worker knows beside its jobs: the keys of its authors.
#[derive(Debug, Clone, Default)]
pub struct AuthorContext {
    keys: Keys,
}

impl AuthorContext {
    /// A context with these keys.
    #[must_use]
    pub const fn new(keys: Keys) -> Self {
        Self { keys }
    }

    /// The same context, whose authors tell this how many characters they have written so far.
    #[must_use]
    pub fn heard_by(&self, hear: impl Fn(u64) + Send + Sync + 'static) -> Self {
        Self { keys: Keys { listener: Listener::new(hear), ..self.keys.clone() } }
    }

    /// Does a job: one question, one ask.
    ///
    /// # Errors
    /// [`JobRefusal`] with every reason at once.
    pub async fn answer(&self, question: &Question, asking: &Asking) -> Result<JobAnswer, JobRefusal> {
        // What only a person can settle is not put to an author.
        let unsettled: Vec<Fault> = hard(&question.reading.problems)
            .into_iter()
            .filter(|fault| fault.code.class() == FailureClass::Permanent)
            .collect();
        if question.stage == Stage::Proposal && !unsettled.is_empty() {
            return Err(unasked(unsettled));
        }
        let author = author_of_job(&asking.settings, &self.keys, asking.attempt)
            .map_err(|error| unasked(vec![error.fault()]))?;
        match attempt(author.as_ref(), question).await {
            Ok(Made { written, reading, exchange }) => {
                Ok(JobAnswer { remark: written.remark(), written, reading, exchange })
            }
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
    use crate::testing::question;
    use socrates_model::FaultCode;

    #[tokio::test]
    async fn what_only_a_person_can_settle_is_not_asked() {
        let mut question = question(Stage::Proposal);
        question.reading.problems = vec![Fault::new(FaultCode::PContra, "rough_scenario", "both follow and run away")];
        let refusal = AuthorContext::default().answer(&question, &Asking::default()).await.unwrap_err();
        assert_eq!((refusal.class, refusal.exchange), (FailureClass::Permanent, None));
    }

    #[tokio::test]
    async fn an_unknown_author_is_a_permanent_fault() {
        let asking = Asking { settings: BTreeMap::from([("author".into(), "oracle".into())]), attempt: 1 };
        let refusal = AuthorContext::default().answer(&question(Stage::Paths), &asking).await.unwrap_err();
        assert_eq!((refusal.class, refusal.faults[0].code), (FailureClass::Permanent, FaultCode::JRequest));
    }
}
