//! What is asked and what comes back.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::dialect::Rung;
use crate::limits::Limits;

/// The speaker of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Speaker {
    /// Rules of the conversation.
    System,
    /// The one who asks.
    User,
    /// The model.
    Assistant,
}

/// One turn of a conversation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Turn {
    /// The speaker.
    pub speaker: Speaker,
    /// What is said.
    pub text: String,
    /// A PNG picture that goes with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub png: Option<Vec<u8>>,
}

/// How closely pictures are looked at, where the server offers a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Detail {
    /// Coarsely, for few tokens.
    Low,
    /// Closely.
    #[default]
    High,
}

/// One request.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChatRequest {
    /// The conversation so far.
    pub turns: Vec<Turn>,
    /// Name of the form of the answer, `[A-Za-z0-9_-]{1,64}`.
    pub form: String,
    /// JSON schema that the answer should keep; without one, any text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<Value>,
    /// The same form as a GBNF grammar, where a grammar says more than a schema can.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grammar: Option<String>,
    /// Seed for servers that take one; best effort everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Sampling temperature, 0 to 2; without one, the server's own (some models take no other).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// Most tokens of the answer.
    pub max_tokens: u32,
    /// How closely pictures are looked at.
    #[serde(default)]
    pub detail: Detail,
}

/// How an answer ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// By itself.
    Stop,
    /// Cut by the limit of tokens.
    Cut,
}

/// One answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChatAnswer {
    /// The text.
    pub text: String,
    /// How it ended.
    pub finish: Finish,
    /// Model as the server names it.
    pub model: String,
    /// Tokens in and out; estimated (see [`crate::estimate`]) where the server does not say.
    pub tokens: (u64, u64),
    /// Tokens of the input that came from the server's cache.
    #[serde(default)]
    pub cached: u64,
    /// Tokens of the output that were thinking and stand in no text.
    #[serde(default, skip_serializing_if = "is_none")]
    pub thought: u64,
    /// Whether the tokens are an estimate.
    #[serde(default)]
    pub estimated: bool,
    /// How far the server enforced the form; nothing where it was not asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rung: Option<Rung>,
    /// What was stepped down from on the way, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<String>,
    /// Whether the pictures of the question were left out, as the server refuses them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub without_picture: bool,
    /// What the server says is left of its rates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<Limits>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
const fn is_none(count: &u64) -> bool {
    *count == 0
}
