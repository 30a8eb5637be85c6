//! An answer that comes in parts, put together into the body that it would have been as a whole. One reader then reads both.

use serde_json::{Map, Value, json};

use super::{Call, complaint, unreadable};
use crate::client::ClientConfig;
use crate::dialect::Wire;
use crate::error::{ChatError, Objection};
use crate::events::Event;

/// Text that is sent behind the last part by two formats.
const DONE: &str = "[DONE]";

/// The parts that came so far.
pub(crate) struct Parts<'a> {
    config: &'a ClientConfig,
    /// The body as far as it came.
    body: Map<String, Value>,
    /// Texts that grow, which is where nearly all parts go: the answer, its refusal.
    said: String,
    refused: String,
    /// Blocks of the format that has them: kind and text.
    blocks: Vec<(String, String)>,
    events: u64,
    characters: u64,
    /// Whether the last part was there.
    whole: bool,
}

impl<'a> Parts<'a> {
    /// None yet.
    pub(crate) fn new(config: &'a ClientConfig) -> Self {
        Self {
            config,
            body: Map::new(),
            said: String::new(),
            refused: String::new(),
            blocks: Vec::new(),
            events: 0,
            characters: 0,
            whole: false,
        }
    }

    /// Characters so far, thoughts included.
    pub(crate) const fn characters(&self) -> u64 {
        self.characters
    }

    /// Takes the next event.
    ///
    /// # Errors
    /// [`ChatError::Unreadable`] where it is no JSON, [`ChatError::TooLarge`], and whatever error the server sends in place of a
    /// part.
    pub(crate) fn take(&mut self, event: &Event) -> Result<(), ChatError> {
        self.events += 1;
        if event.data.trim() == DONE {
            self.whole = self.whole || !self.body.is_empty();
            return Ok(());
        }
        let part: Value = serde_json::from_str(&event.data)
            .map_err(|error| unreadable(format!("event {} of the stream is no JSON: {error}", self.events)))?;
        let is_error = event.is_error || part.get("type").and_then(Value::as_str) == Some("error");
        if is_error || part.get("error").is_some_and(|error| !error.is_null()) {
            return Err(self.failed(&part));
        }
        match self.config.dialect.wire() {
            Wire::Chat => self.of_chat(&part),
            Wire::Responses => return self.of_responses(&part),
            Wire::Messages => self.of_messages(&part),
            Wire::Generate => self.of_generate(&part),
        }
        let most = self.config.max_bytes;
        let held = self.said.len() + self.refused.len() + self.blocks.iter().map(|(_, text)| text.len()).sum::<usize>();
        if held > most { Err(ChatError::TooLarge { most }) } else { Ok(()) }
    }

    /// The body, once nothing more comes.
    ///
    /// # Errors
    /// [`ChatError::Broken`] where the last part is missing.
    pub(crate) fn whole(mut self) -> Result<Vec<u8>, ChatError> {
        if self.events == 0 {
            return Err(unreadable("its stream is empty"));
        }
        if !self.whole {
            let why = "the stream ended without its last part".to_owned();
            return Err(ChatError::Broken { characters: self.characters, why });
        }
        match self.config.dialect.wire() {
            Wire::Chat => {
                let refusal = Some(self.refused).filter(|words| !words.is_empty());
                let finish = self.body.remove("finish_reason");
                let choice = json!({"message": {"content": self.said, "refusal": refusal}, "finish_reason": finish});
                self.body.insert("choices".to_owned(), json!([choice]));
            }
            Wire::Responses => {}
            Wire::Messages => {
                let content: Vec<Value> = self.blocks.iter().map(|(kind, text)| block(kind, text)).collect();
                self.body.insert("content".to_owned(), json!(content));
            }
            Wire::Generate => {
                let finish = self.body.remove("finishReason");
                if finish.is_some() {
                    let candidate = json!({"content": {"parts": [{"text": self.said}]}, "finishReason": finish});
                    self.body.insert("candidates".to_owned(), json!([candidate]));
                }
            }
        }
        Ok(Value::Object(self.body).to_string().into_bytes())
    }

    /// The error that a server sends in place of a part: its status was good before it failed.
    fn failed(&self, part: &Value) -> ChatError {
        let inner = part.get("error").filter(|error| error.is_object() || error.is_string()).unwrap_or(part);
        let word = |key: &str| inner.get(key).and_then(Value::as_str).unwrap_or_default();
        let number = inner.get("code").or_else(|| inner.get("status")).and_then(Value::as_u64);
        let status = match (word("code"), word("type")) {
            (code, kind) if code.contains("rate_limit") || kind.contains("rate_limit") => 429,
            ("insufficient_quota", _) | (_, "billing_error") => 402,
            (_, "overloaded_error") => 529,
            (_, "authentication_error" | "permission_error") => 401,
            (_, "invalid_request_error") | ("invalid_prompt", _) => 400,
            _ => number
                .and_then(|status| u16::try_from(status).ok())
                .filter(|status| (400..600).contains(status))
                .unwrap_or(500),
        };
        let body = json!({ "error": inner }).to_string();
        let mut told = complaint(status, body.as_bytes(), &reqwest::header::HeaderMap::new(), self.config);
        // Asked in another way, it would fail just so: it has begun to answer.
        if let ChatError::Rejected { to, .. } | ChatError::Server { to, .. } = &mut told {
            *to = Objection::Nothing;
        }
        told
    }

    fn count(&mut self, text: &str) {
        self.characters += u64::try_from(text.chars().count()).unwrap_or(u64::MAX);
    }

    /// Takes over these members where the part has them.
    fn keep(&mut self, part: &Value, names: &[&str]) {
        for name in names {
            if let Some(value) = part.get(*name).filter(|value| !value.is_null()) {
                self.body.insert((*name).to_owned(), value.clone());
            }
        }
    }

    fn of_chat(&mut self, part: &Value) {
        self.keep(part, &["model", "usage"]);
        // Only the first of several answers is read, as in whole ones.
        let choices = part.get("choices").and_then(Value::as_array).into_iter().flatten();
        let mut first = choices.filter(|choice| choice.get("index").and_then(Value::as_u64).unwrap_or(0) == 0);
        let Some(choice) = first.next() else { return };
        let text = |key: &str| choice.pointer(&format!("/delta/{key}")).and_then(Value::as_str).unwrap_or_default();
        for thought in ["reasoning_content", "reasoning"] {
            self.count(text(thought));
        }
        self.count(text("content"));
        self.said.push_str(text("content"));
        self.refused.push_str(text("refusal"));
        self.keep(choice, &["finish_reason"]);
        self.whole = self.whole || self.body.contains_key("finish_reason");
    }

    fn of_responses(&mut self, part: &Value) -> Result<(), ChatError> {
        let kind = part.get("type").and_then(Value::as_str).unwrap_or_default();
        match kind {
            // The last event holds the whole answer.
            "response.completed" | "response.incomplete" | "response.failed" => {
                let whole = part.get("response").and_then(Value::as_object);
                self.body = whole.cloned().ok_or_else(|| unreadable(format!("`{kind}` holds no `response`")))?;
                self.whole = true;
            }
            "response.output_text.delta"
            | "response.refusal.delta"
            | "response.reasoning_text.delta"
            | "response.reasoning_summary_text.delta" => {
                let delta = part.get("delta").and_then(Value::as_str).unwrap_or_default();
                self.count(delta);
            }
            _ => {}
        }
        Ok(())
    }

    fn of_messages(&mut self, part: &Value) {
        let text = |path: &str| part.pointer(path).and_then(Value::as_str).unwrap_or_default();
        match text("/type") {
            "message_start" => {
                if let Some(message) = part.get("message") {
                    self.keep(message, &["model", "usage", "stop_reason"]);
                }
            }
            "content_block_start" => {
                let kind = text("/content_block/type");
                self.blocks.push((kind.to_owned(), text("/content_block/text").to_owned()));
            }
            "content_block_delta" => {
                // Only one of them is there.
                let (said, input, thought) =
                    (text("/delta/text"), text("/delta/partial_json"), text("/delta/thinking"));
                [said, input, thought].into_iter().for_each(|more| self.count(more));
                if let Some((_, held)) = self.blocks.last_mut() {
                    held.push_str(said);
                    held.push_str(input);
                }
            }
            "message_delta" => {
                if let Some(delta) = part.get("delta") {
                    self.keep(delta, &["stop_reason"]);
                }
                // Counts of the end stand beside those of the beginning.
                let counts = part.get("usage").and_then(Value::as_object).into_iter().flatten();
                if let Some(usage) = self.body.entry("usage").or_insert_with(|| json!({})).as_object_mut() {
                    usage.extend(
                        counts.filter(|(_, count)| !count.is_null()).map(|(name, count)| (name.clone(), count.clone())),
                    );
                }
            }
            "message_stop" => self.whole = true,
            _ => {}
        }
    }

    fn of_generate(&mut self, part: &Value) {
        self.keep(part, &["usageMetadata", "modelVersion", "promptFeedback"]);
        if part.pointer("/promptFeedback/blockReason").is_some() {
            self.whole = true;
        }
        let Some(candidate) = part.pointer("/candidates/0") else { return };
        for piece in candidate.pointer("/content/parts").and_then(Value::as_array).into_iter().flatten() {
            let text = piece.get("text").and_then(Value::as_str).unwrap_or_default();
            self.count(text);
            if piece.get("thought").and_then(Value::as_bool) != Some(true) {
                self.said.push_str(text);
            }
        }
        self.keep(candidate, &["finishReason"]);
        self.whole = self.whole || self.body.contains_key("finishReason");
    }
}

/// A block of text, or the input of a tool.
fn block(kind: &str, text: &str) -> Value {
    if kind == "tool_use" {
        // What is no JSON was cut; it is passed on as the text that it is.
        let input = serde_json::from_str::<Value>(text).unwrap_or_else(|_cut| json!(text));
        json!({"type": kind, "input": input})
    } else {
        json!({"type": kind, "text": text})
    }
}

impl Call<'_> {
    /// The body with the wish that the answer comes in parts, where this call has it.
    pub(super) fn with_wish(&self, mut body: Value) -> Value {
        if !self.stream {
            return body;
        }
        if let Some(members) = body.as_object_mut() {
            match self.config.dialect.wire() {
                Wire::Chat => {
                    members.insert("stream".to_owned(), json!(true));
                    members.insert("stream_options".to_owned(), json!({"include_usage": true}));
                }
                Wire::Responses | Wire::Messages => {
                    members.insert("stream".to_owned(), json!(true));
                }
                // The address says it.
                Wire::Generate => {}
            }
        }
        body
    }
}
