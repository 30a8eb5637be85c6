//! Chat Completions, with what vLLM, Ollama, llama.cpp and LM Studio do differently.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::{Call, Details, Usage, refused, unreadable};
use crate::chat::{ChatAnswer, Detail, Speaker};
use crate::dialect::{Dialect, Rung};
use crate::error::ChatError;
use crate::form;

/// The body of a request.
pub(super) fn body(call: &Call<'_>) -> Value {
    let (request, config) = (call.request, call.config);
    let messages: Vec<Value> = (0..request.turns.len()).filter_map(|index| message(call, index)).collect();
    let mut members = Map::new();
    members.insert("model".to_owned(), json!(config.model));
    members.insert("messages".to_owned(), json!(messages));
    let limit = if config.old_token_limit { "max_tokens" } else { "max_completion_tokens" };
    members.insert(limit.to_owned(), json!(request.max_tokens));
    if let Some(seed) = request.seed {
        // Servers read a signed number.
        members.insert("seed".to_owned(), json!(seed & 0x7fff_ffff));
    }
    if let Some(temperature) = request.temperature {
        members.insert("temperature".to_owned(), json!(temperature));
    }
    if let Some(schema) = &request.schema {
        enforce(call, &form::for_dialect(schema, config.dialect), &mut members);
    }
    Value::Object(members)
}

fn enforce(call: &Call<'_>, schema: &Value, members: &mut Map<String, Value>) {
    let mut put = |key: &str, value: Value| {
        members.insert(key.to_owned(), value);
    };
    let llama = call.config.dialect == Dialect::LlamaCpp;
    match (call.rung, &call.request.grammar) {
        (Rung::Schema, _) => {
            let form = json!({"name": call.request.form, "schema": schema, "strict": true});
            put("response_format", json!({"type": "json_schema", "json_schema": form}));
        }
        // llama.cpp keeps to a schema in its JSON mode as well.
        (Rung::Object, _) if llama => put("response_format", json!({"type": "json_object", "schema": schema})),
        (Rung::Object, _) => put("response_format", json!({"type": "json_object"})),
        (Rung::Grammar, Some(grammar)) if llama => put("grammar", json!(grammar)),
        (Rung::Grammar, Some(grammar)) => put("structured_outputs", json!({"grammar": grammar})),
        (Rung::Grammar, None) if llama => put("json_schema", schema.clone()),
        (Rung::Grammar, None) => put("structured_outputs", json!({"json": schema})),
        (Rung::Tool | Rung::Plain, _) => {}
    }
}

fn message(call: &Call<'_>, index: usize) -> Option<Value> {
    let turn = call.request.turns.get(index)?;
    let role = match turn.speaker {
        Speaker::System => "system",
        Speaker::User => "user",
        Speaker::Assistant => "assistant",
    };
    let text = call.text(index);
    Some(match &turn.png {
        None => json!({"role": role, "content": text}),
        Some(png) => {
            let url = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png));
            let detail = if call.request.detail == Detail::Low { "low" } else { "high" };
            json!({"role": role, "content": [
                {"type": "text", "text": text},
                {"type": "image_url", "image_url": {"url": url, "detail": detail}},
            ]})
        }
    })
}

#[derive(Deserialize)]
struct Completion {
    model: Option<String>,
    #[serde(default)]
    choices: Vec<Choice>,
    usage: Option<Counted>,
}

#[derive(Deserialize)]
struct Choice {
    message: Option<Said>,
    finish_reason: Option<String>,
}

#[derive(Deserialize)]
struct Said {
    content: Option<String>,
    refusal: Option<String>,
}

#[derive(Deserialize)]
struct Counted {
    #[serde(default)]
    prompt_tokens: u64,
    #[serde(default)]
    completion_tokens: u64,
    #[serde(default)]
    prompt_tokens_details: Option<Details>,
    #[serde(default)]
    completion_tokens_details: Option<Details>,
}

/// The answer in a successful body.
pub(super) fn answer(bytes: &[u8], call: &Call<'_>) -> Result<ChatAnswer, ChatError> {
    let completion: Completion = serde_json::from_slice(bytes).map_err(|error| unreadable(error.to_string()))?;
    let choice = completion.choices.into_iter().next().ok_or_else(|| unreadable("it has no `choices`"))?;
    let said = choice.message.ok_or_else(|| unreadable("it has no `message`"))?;
    if let Some(why) = said.refusal.filter(|why| !why.is_empty()) {
        return Err(refused(&why));
    }
    let cut = match choice.finish_reason.as_deref() {
        Some("content_filter") => return Err(refused("content filter")),
        reason => reason == Some("length"),
    };
    let usage = completion.usage.map(|counted| Usage {
        input: counted.prompt_tokens,
        cached: counted.prompt_tokens_details.and_then(|details| details.cached_tokens).unwrap_or(0),
        output: counted.completion_tokens,
        thought: counted.completion_tokens_details.and_then(|details| details.reasoning_tokens).unwrap_or(0),
    });
    Ok(call.told(said.content.unwrap_or_default(), cut, completion.model, usage))
}
