//! The trait, and what passes through it.

use async_trait::async_trait;
use socrates_model::{Fault, FaultCode};
use socrates_prompts::{Message, Question};

/// What an author said.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Answer {
    /// The text, as it came.
    pub text: String,
    /// Tokens in and out; 0 for authors without any.
    pub tokens: (u64, u64),
    /// Who answered, for provenance: `offline/1`, `openai:<model as the server names it>`.
    pub model: String,
    /// Whether the text was cut by a limit.
    pub cut: bool,
    /// What was sent, where the author reads messages.
    pub sent: Vec<Message>,
    /// Faults put in on purpose; empty outside of experiments.
    pub injected: Vec<String>,
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
