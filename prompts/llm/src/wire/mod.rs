//! Wire formats: one file each, the same three questions to each of them.

mod anthropic;
mod chat;
mod gemini;
mod parts;
mod responses;

pub(crate) use parts::Parts;

use reqwest::header::HeaderMap;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::chat::{ChatAnswer, ChatRequest, Speaker};
use crate::client::ClientConfig;
use crate::dialect::{Rung, Wire};
use crate::error::{ChatError, Objection};
use crate::{estimate, ordered, waits};

/// Longest piece of a server's own words that is passed on, characters.
const WORDS: usize = 300;

/// What both formats of one vendor say of the tokens of one direction.
#[derive(Deserialize)]
struct Details {
    /// Of the input: those that came from the cache.
    #[serde(default)]
    cached_tokens: Option<u64>,
    /// Of the output: those of thinking.
    #[serde(default)]
    reasoning_tokens: Option<u64>,
}

/// A request in the words of one format.
pub(crate) struct Call<'a> {
    pub(crate) request: &'a ChatRequest,
    pub(crate) config: &'a ClientConfig,
    pub(crate) rung: Rung,
    /// Whether the answer is to come in parts.
    pub(crate) stream: bool,
}

/// Name and value of the header that carries the key.
pub(crate) fn key_header(config: &ClientConfig) -> (&'static str, String) {
    let key = config.key.secret();
    match config.dialect.wire() {
        Wire::Chat | Wire::Responses => ("authorization", format!("Bearer {key}")),
        Wire::Messages => ("x-api-key", key.to_owned()),
        Wire::Generate => ("x-goog-api-key", key.to_owned()),
    }
}

impl Call<'_> {
    /// Where it goes, after the base address.
    pub(crate) fn path(&self) -> String {
        match self.config.dialect.wire() {
            Wire::Chat => "/chat/completions".to_owned(),
            Wire::Responses => "/responses".to_owned(),
            Wire::Messages => "/v1/messages".to_owned(),
            Wire::Generate if self.stream => {
                format!("/v1beta/models/{}:streamGenerateContent?alt=sse", self.config.model)
            }
            Wire::Generate => format!("/v1beta/models/{}:generateContent", self.config.model),
        }
    }

    /// The body of the request.
    pub(crate) fn body(&self) -> Value {
        self.with_wish(match self.config.dialect.wire() {
            Wire::Chat => chat::body(self),
            Wire::Responses => responses::body(self),
            Wire::Messages => anthropic::body(self),
            Wire::Generate => gemini::body(self),
        })
    }

    /// The answer in a successful body.
    pub(crate) fn answer(&self, bytes: &[u8]) -> Result<ChatAnswer, ChatError> {
        match self.config.dialect.wire() {
            Wire::Chat => chat::answer(bytes, self),
            Wire::Responses => responses::answer(bytes, self),
            Wire::Messages => anthropic::answer(bytes, self),
            Wire::Generate => gemini::answer(bytes, self),
        }
    }

    /// What is said in turn `index`; the form is put where a server does not know it.
    fn text(&self, index: usize) -> String {
        let Some(turn) = self.request.turns.get(index) else { return String::new() };
        let first = self.request.turns.iter().position(|turn| turn.speaker == Speaker::User);
        match &self.request.schema {
            Some(schema) if !self.rung.knows_form() && first == Some(index) => {
                format!(
                    "{}\n\n# Form of the answer\nAnswer with one JSON object that keeps to this JSON schema:\n{}\n",
                    turn.text,
                    ordered::text(schema)
                )
            }
            Some(_) | None => turn.text.clone(),
        }
    }

    /// The answer with what the server said of itself, or with our estimates.
    fn told(&self, text: String, cut: bool, model: Option<String>, usage: Option<Usage>) -> ChatAnswer {
        // A server that counts nothing at all has not counted.
        let usage = usage.filter(|usage| usage.input + usage.output > 0);
        let estimated = usage.is_none();
        let usage = usage.unwrap_or_else(|| Usage {
            input: estimate::request_tokens(self.request, self.config.dialect),
            output: estimate::text_tokens(&text),
            ..Usage::default()
        });
        ChatAnswer {
            text,
            finish: if cut { crate::chat::Finish::Cut } else { crate::chat::Finish::Stop },
            model: model.filter(|name| !name.is_empty()).unwrap_or_else(|| self.config.model.clone()),
            tokens: (usage.input, usage.output),
            cached: usage.cached,
            thought: usage.thought,
            estimated,
            rung: Some(self.rung),
            steps: Vec::new(),
            without_picture: false,
            limits: None,
        }
    }
}

/// Tokens as a server counts them.
#[derive(Debug, Clone, Copy, Default)]
struct Usage {
    /// All of the input, cached or not.
    input: u64,
    /// Part of the input that came from the server's cache.
    cached: u64,
    /// All of the output, thoughts included.
    output: u64,
    /// Part of the output that was thinking.
    thought: u64,
}

fn unreadable(why: impl Into<String>) -> ChatError {
    ChatError::Unreadable { why: why.into() }
}

fn refused(why: &str) -> ChatError {
    ChatError::Refused { why: why.chars().take(WORDS).collect() }
}

/// The error in an unsuccessful body. All formats have `error` with `message` and some kind of code.
pub(crate) fn complaint(status: u16, bytes: &[u8], headers: &HeaderMap, config: &ClientConfig) -> ChatError {
    let body: Value = serde_json::from_slice(bytes).unwrap_or_default();
    let error = body.get("error").cloned().unwrap_or_else(|| json!({}));
    let word = |key: &str| error.get(key).and_then(Value::as_str).unwrap_or_default();
    let words = error.get("message").and_then(Value::as_str).or_else(|| error.as_str()).map(str::to_owned);
    let words = words.unwrap_or_else(|| String::from_utf8_lossy(bytes.get(..4 * WORDS).unwrap_or(bytes)).into_owned());
    let why: String = config.key.strike_from(&words).chars().take(WORDS).collect();
    let retry_after_ms = waits::retry_after_ms(headers).or_else(|| waits::retry_delay_ms(&error));
    // The server knows best whether asking again can help.
    let should_retry = headers.get("x-should-retry").and_then(|value| value.to_str().ok());
    match status {
        401 | 403 => ChatError::Key { status, why },
        // No waiting fills an empty purse.
        429 if word("code") == "insufficient_quota" || word("type") == "billing_error" => {
            ChatError::Key { status, why }
        }
        402 => ChatError::Key { status, why },
        429 | 529 if should_retry != Some("false") => ChatError::SlowDown { status, retry_after_ms, why },
        408 | 409 | 425 | 500..=599 if should_retry != Some("false") => {
            ChatError::Server { status, retry_after_ms, to: objection(&error, &why, &config.model), why }
        }
        _ if should_retry == Some("true") => ChatError::Server { status, retry_after_ms, to: Objection::Unsaid, why },
        _ => ChatError::Rejected { status, to: objection(&error, &why, &config.model), why },
    }
}

/// Words by which servers name the form of an answer, in small letters.
const FORM: [&str; 9] = [
    "schema",
    "response_format",
    "json",
    "grammar",
    "output_config",
    "structured",
    "generationconfig",
    "tool",
    "response format",
];

/// Words by which they name a picture.
const PICTURE: [&str; 6] = ["image", "picture", "vision", "multimodal", "multi-modal", "mmproj"];

/// What an error in a body objects to: its code and its parameter where it has them, else the server's sentence, which is
/// all that most servers give. A sentence may name more than one thing: the picture is named by few words, the form by many.
fn objection(error: &Value, why: &str, model: &str) -> Objection {
    let word = |key: &str| error.get(key).and_then(Value::as_str).unwrap_or_default().to_lowercase();
    let one_of = |words: &[&str], text: &str| words.iter().any(|word| text.contains(word));
    // A server behind another one is upstream of it.
    let why = why.to_lowercase().replace("upstream", "").replace("downstream", "");
    let (param, model) = (word("param"), model.to_lowercase());
    // A model's own name says nothing, be it `vision-7b`.
    let sentence = if model.len() > 2 { why.replace(&model, "") } else { why.clone() };
    if word("code") == "model_not_found" {
        Objection::Model
    } else if one_of(&PICTURE, &param) || one_of(&PICTURE, &sentence) {
        Objection::Picture
    } else if param.starts_with("stream") || sentence.contains("stream") {
        Objection::Stream
    } else if one_of(&FORM, &param) || one_of(&FORM, &why) {
        Objection::Form
    } else if why.contains("model") && why.contains(&model) {
        Objection::Model
    } else {
        Objection::Unsaid
    }
}
