//! Anthropic Messages.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::{Call, Usage, refused, unreadable};
use crate::chat::{ChatAnswer, Speaker};
use crate::dialect::Rung;
use crate::error::ChatError;
use crate::form;

/// The body of a request. What stays the same from one question to the next is marked for the server's cache.
pub(super) fn body(call: &Call<'_>) -> Value {
    let request = call.request;
    let turns = || request.turns.iter().enumerate();
    let system: Vec<String> =
        turns().filter(|(_, turn)| turn.speaker == Speaker::System).map(|(index, _)| call.text(index)).collect();
    let mut messages: Vec<Value> = Vec::new();
    let mut stable = true;
    for (index, turn) in turns().filter(|(_, turn)| turn.speaker != Speaker::System) {
        let mut text = json!({"type": "text", "text": call.text(index)});
        // The first turn of the user holds the rules; they are the same for every question of a kind.
        if std::mem::take(&mut stable)
            && let Some(block) = text.as_object_mut()
        {
            block.insert("cache_control".to_owned(), json!({"type": "ephemeral"}));
        }
        let picture = turn.png.as_ref().map(|png| {
            let source = json!({"type": "base64", "media_type": "image/png", "data": BASE64_STANDARD.encode(png)});
            json!({"type": "image", "source": source})
        });
        let content: Vec<Value> = picture.into_iter().chain([text]).collect();
        let role = if turn.speaker == Speaker::Assistant { "assistant" } else { "user" };
        messages.push(json!({"role": role, "content": content}));
    }
    let mut members = Map::new();
    let mut put = |key: &str, value: Value| {
        members.insert(key.to_owned(), value);
    };
    put("model", json!(call.config.model));
    put("max_tokens", json!(request.max_tokens));
    put("messages", json!(messages));
    if !system.is_empty() {
        put("system", json!(system.join("\n\n")));
    }
    if let Some(temperature) = request.temperature {
        put("temperature", json!(temperature.clamp(0.0, 1.0)));
    }
    if let Some(schema) = &request.schema {
        let schema = form::for_dialect(schema, call.config.dialect);
        match call.rung {
            Rung::Schema => put("output_config", json!({"format": {"type": "json_schema", "schema": schema}})),
            Rung::Tool => {
                let tool = json!({"name": request.form, "description": "Takes the answer.", "input_schema": schema});
                put("tools", json!([tool]));
                let choice = json!({"type": "tool", "name": request.form, "disable_parallel_tool_use": true});
                put("tool_choice", choice);
            }
            Rung::Object | Rung::Grammar | Rung::Plain => {}
        }
    }
    Value::Object(members)
}

#[derive(Deserialize)]
struct Message {
    model: Option<String>,
    #[serde(default)]
    content: Vec<Block>,
    stop_reason: Option<String>,
    usage: Option<Counted>,
}

#[derive(Deserialize)]
struct Block {
    #[serde(rename = "type", default)]
    kind: String,
    #[serde(default)]
    text: Option<String>,
    #[serde(default)]
    input: Option<Value>,
}

#[derive(Deserialize)]
struct Counted {
    #[serde(default)]
    input_tokens: u64,
    #[serde(default)]
    output_tokens: u64,
    #[serde(default)]
    cache_creation_input_tokens: Option<u64>,
    #[serde(default)]
    cache_read_input_tokens: Option<u64>,
}

/// The answer in a successful body.
pub(super) fn answer(bytes: &[u8], call: &Call<'_>) -> Result<ChatAnswer, ChatError> {
    let message: Message = serde_json::from_slice(bytes).map_err(|error| unreadable(error.to_string()))?;
    if message.content.is_empty() && message.stop_reason.is_none() {
        return Err(unreadable("it has neither `content` nor `stop_reason`"));
    }
    let called = message.content.iter().find(|block| block.kind == "tool_use").and_then(|block| block.input.as_ref());
    let said: String =
        message.content.iter().filter(|block| block.kind == "text").filter_map(|block| block.text.as_deref()).collect();
    if message.stop_reason.as_deref() == Some("refusal") {
        return Err(refused(if said.is_empty() { "stop reason `refusal`" } else { &said }));
    }
    let cut = matches!(message.stop_reason.as_deref(), Some("max_tokens" | "model_context_window_exceeded"));
    // Cached tokens are counted apart from the input.
    let usage = message.usage.map(|counted| {
        let cached = counted.cache_read_input_tokens.unwrap_or(0);
        let written = counted.cache_creation_input_tokens.unwrap_or(0);
        Usage { input: counted.input_tokens + cached + written, cached, output: counted.output_tokens, thought: 0 }
    });
    Ok(call.told(called.map_or(said, Value::to_string), cut, message.model, usage))
}
