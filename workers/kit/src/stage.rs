//! What a stage is and what it gives back.

use serde::Serialize;
use socrates_model::report::{Repair, Verdict};
use socrates_model::wire::Rates;
use socrates_model::{FailureClass, Fault, FaultCode, Role, Where};

use crate::job::Job;

/// A stage: one kind of job, done by a worker.
pub trait Stage: Send + Sync + 'static {
    /// Which stage it is.
    const STAGE: socrates_model::job::Stage;

    /// Does one job, once. Never asks twice, never sleeps on a rate limit; long computations go to a blocking
    /// thread and look at the job's [`crate::Cancel`] now and then.
    ///
    /// # Errors
    /// A [`Failure`] with every reason at once.
    fn run(&self, job: &Job) -> impl Future<Output = Result<Done, Failure>> + Send;
}

/// Media types of artifacts.
pub mod media {
    /// JSON text.
    pub const JSON: &str = "application/json";
    /// Plain text.
    pub const TEXT: &str = "text/plain";
    /// Comma-separated values.
    pub const CSV: &str = "text/csv";
    /// A recording.
    pub const MCAP: &str = "application/mcap";
    /// A picture.
    pub const PNG: &str = "image/png";
    /// A drawing.
    pub const SVG: &str = "image/svg+xml";
}

/// One output of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    /// What it is.
    pub role: Role,
    /// Media type, see [`media`].
    pub media: String,
    /// The content.
    pub bytes: Vec<u8>,
}

impl Output {
    /// An output of plain bytes.
    #[must_use]
    pub fn bytes(role: Role, media: &str, bytes: Vec<u8>) -> Self {
        Self { role, media: media.to_owned(), bytes }
    }

    /// An output of text.
    #[must_use]
    pub fn text(role: Role, media: &str, text: impl Into<String>) -> Self {
        Self::bytes(role, media, text.into().into_bytes())
    }

    /// A value as compact JSON.
    ///
    /// # Errors
    /// A poison [`Failure`] when the value cannot be written (a map with keys that are no text).
    pub fn json<T: Serialize>(role: Role, value: &T) -> Result<Self, Failure> {
        match serde_json::to_vec(value) {
            Ok(bytes) => Ok(Self::bytes(role, media::JSON, bytes)),
            Err(why) => {
                let fault = Fault::new(
                    FaultCode::JSpec,
                    Where::key(role),
                    format!("output `{role}` cannot be written as JSON: {why}"),
                );
                Err(Failure::new(FailureClass::Poison, vec![fault]))
            }
        }
    }
}

/// A job that was done.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Done {
    /// Outputs.
    pub artifacts: Vec<Output>,
    /// Short words for the status line: `2 people`.
    pub remark: String,
    /// Scoring: the repair it asks for.
    pub repair: Option<Repair>,
    /// Review: the stages that the person wants made again, with reasons.
    pub anew: Vec<Repair>,
    /// Scoring: the verdict.
    pub verdict: Option<Verdict>,
    /// Tokens in and out.
    pub tokens: (u64, u64),
    /// Authoring: what the server said of its rates.
    pub rates: Option<Rates>,
}

impl Done {
    /// Done with these outputs.
    #[must_use]
    pub fn with(artifacts: Vec<Output>) -> Self {
        Self { artifacts, ..Self::default() }
    }

    /// The same with a remark.
    #[must_use]
    pub fn remark(mut self, remark: impl Into<String>) -> Self {
        self.remark = remark.into();
        self
    }
}

/// A job that was not done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// How the orchestrator treats it.
    pub class: FailureClass,
    /// Every reason at once.
    pub faults: Vec<Fault>,
    /// What is kept all the same: the refused answer, the exchange.
    pub artifacts: Vec<Output>,
    /// The server's own wish, ms.
    pub retry_after_ms: Option<u64>,
    /// Tokens in and out.
    pub tokens: (u64, u64),
    /// Authoring: what the server said of its rates.
    pub rates: Option<Box<Rates>>,
}

impl Failure {
    /// A failure of this class.
    #[must_use]
    pub fn new(class: FailureClass, faults: Vec<Fault>) -> Self {
        Self { class, faults, artifacts: Vec::new(), retry_after_ms: None, tokens: (0, 0), rates: None }
    }

    /// A failure of the class that its faults give, see [`FailureClass::of`].
    #[must_use]
    pub fn from_faults(faults: Vec<Fault>) -> Self {
        Self::new(FailureClass::of(&faults), faults)
    }

    /// The same with one more artifact.
    #[must_use]
    pub fn with(mut self, artifact: Output) -> Self {
        self.artifacts.push(artifact);
        self
    }

    /// The same with the tokens that were spent.
    #[must_use]
    pub const fn tokens(mut self, tokens: (u64, u64)) -> Self {
        self.tokens = tokens;
        self
    }

    /// The same with the pause that the server asked for, ms.
    #[must_use]
    pub const fn retry_after(mut self, retry_after_ms: Option<u64>) -> Self {
        self.retry_after_ms = retry_after_ms;
        self
    }
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        Self::from_faults(vec![fault])
    }
}

impl From<Vec<Fault>> for Failure {
    fn from(faults: Vec<Fault>) -> Self {
        Self::from_faults(faults)
    }
}
