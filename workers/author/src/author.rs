//! The trait, and what passes through it.

use async_trait::async_trait;
use serde::{Deserialize, Serialize};
use socrates_llm::Limits;
use socrates_model::{Fault, FaultCode};
use socrates_prompts::{Message, Question, Style, Template};

/// What an author said.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Answer {
    /// The text, as it came.
    pub text: String,
    /// Tokens in and out; 0 for authors without any.
    pub tokens: (u64, u64),
    /// Name of the author that answered, for provenance: `offline/1`, `openai:<model as the server names it>`.
    pub model: String,
    /// Whether the text was cut by a limit.
    pub cut: bool,
    /// What was sent, where the author reads messages.
    pub sent: Vec<Message>,
    /// Faults put in on purpose; empty outside of experiments.
    pub injected: Vec<String>,
    /// How it was asked and answered.
    pub how: How,
}

/// How a question was put and what the server did with it; everything empty for authors that read no messages.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct How {
    /// Words of the question.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub template: Option<Template>,
    /// Style of the question.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub style: Option<Style>,
    /// How far the server enforced the form: `schema`, `tool`, `object`, `grammar`, `plain`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rung: Option<String>,
    /// What was changed on the way, in words: forms that the server refused.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<String>,
    /// Whether the solver wrote the paths in the author's place.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub by_solver: bool,
    /// Tokens of the input that came from the server's cache.
    pub cached: u64,
    /// Tokens of the output that were thinking and stand in no text.
    #[serde(skip_serializing_if = "is_none")]
    pub thought: u64,
    /// Whether the tokens are our estimate.
    pub estimated: bool,
    /// Width and height of the picture that was sent, pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<(u32, u32)>,
    /// What the server said is left of its rates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits: Option<Limits>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
const fn is_none(count: &u64) -> bool {
    *count == 0
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{code}: {message}")]
pub struct AskError {
    /// A `T-` or `E-` code, or `J-REQUEST` for an author that cannot be had as configured.
    pub code: FaultCode,
    /// What happened, and what can be done.
    pub message: String,
    /// How long the server wants us to wait, ms.
    pub retry_after_ms: Option<u64>,
}

impl AskError {
    /// An error without a wish to wait.
    pub fn new(code: FaultCode, message: impl Into<String>) -> Self {
        Self { code, message: message.into(), retry_after_ms: None }
    }

    /// The error as a fault.
    #[must_use]
    pub fn fault(&self) -> Fault {
        Fault::new(self.code, "author", self.message.clone())
    }
}

/// Whoever answers the authoring questions.
#[async_trait]
pub trait Author: Send + Sync {
    /// Asks once.
    ///
    /// # Errors
    /// [`AskError`] when no text came back at all. A wrong text is no error here; reading and checking come after.
    async fn ask(&self, question: &Question) -> Result<Answer, AskError>;

    /// Name for people and provenance, such as `offline/1`.
    fn name(&self) -> String;
}

#[async_trait]
impl Author for Box<dyn Author> {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        self.as_ref().ask(question).await
    }

    fn name(&self) -> String {
        self.as_ref().name()
    }
}

/// Says one text to every question, at once: answers that are known beforehand.
#[derive(Debug, Clone)]
pub struct Says(pub String);

#[async_trait]
impl Author for Says {
    async fn ask(&self, _question: &Question) -> Result<Answer, AskError> {
        Ok(Answer { text: self.0.clone(), model: self.name(), ..Answer::default() })
    }

    fn name(&self) -> String {
        "says".into()
    }
}
