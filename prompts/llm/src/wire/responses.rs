//! OpenAI Responses.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::{Call, Details, Usage, refused, unreadable};
use crate::chat::{ChatAnswer, Detail, Speaker};
use crate::dialect::Rung;
use crate::error::{ChatError, Objection};
use crate::form;

/// The body of a request. Nothing is kept by the server for a later question: each one says everything.
pub(super) fn body(call: &Call<'_>) -> Value {
    let request = call.request;
    let input: Vec<Value> = (0..request.turns.len()).filter_map(|index| message(call, index)).collect();
    let mut members = Map::new();
    let mut put = |key: &str, value: Value| {
        members.insert(key.to_owned(), value);
    };
    put("model", json!(call.config.model));
    put("input", json!(input));
    put("max_output_tokens", json!(request.max_tokens));
    put("store", json!(false));
    if let Some(temperature) = request.temperature {
        put("temperature", json!(temperature));
    }
    if let Some(schema) = &request.schema {
        let schema = || form::for_dialect(schema, call.config.dialect);
        match call.rung {
            Rung::Schema => {
                let format = json!({"type": "json_schema", "name": request.form, "schema": schema(), "strict": true});
                put("text", json!({ "format": format }));
            }
            Rung::Object => put("text", json!({"format": {"type": "json_object"}})),
            Rung::Tool | Rung::Grammar | Rung::Plain => {}
        }
    }
    Value::Object(members)
}

fn message(call: &Call<'_>, index: usize) -> Option<Value> {
    let turn = call.request.turns.get(index)?;
    let text = call.text(index);
    Some(match turn.speaker {
        // What a model said is put as words: parts of an answer carry ids of the server.
        Speaker::Assistant => json!({"role": "assistant", "content": text}),
        Speaker::System => json!({"role": "system", "content": text}),
        Speaker::User => {
            let detail = if call.request.detail == Detail::Low { "low" } else { "high" };
            let picture = turn.png.as_ref().map(|png| {
                let url = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png));
                json!({"type": "input_image", "image_url": url, "detail": detail})
            });
            let words = json!({"type": "input_text", "text": text});
            let content: Vec<Value> = [words].into_iter().chain(picture).collect();
            json!({"role": "user", "content": content})
        }
    })
}

#[derive(Deserialize)]
struct Response {
    model: Option<String>,
    status: Option<String>,
    #[serde(default)]
    output: Option<Vec<Item>>,
    incomplete_details: Option<Incomplete>,
    error: Option<Failed>,
    usage: Option<Counted>,
}

/// One piece of the output; thoughts and calls of tools have no content that is read.
#[derive(Deserialize)]
struct Item {
    #[serde(rename = "type", default)]
    kind: ItemKind,
    #[serde(default)]
    content: Option<Vec<Part>>,
}

/// What a piece is.
#[derive(Deserialize, Default, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum ItemKind {
    Message,
    #[default]
    #[serde(other)]
    Other,
}

#[derive(Deserialize)]
struct Part {
    #[serde(rename = "type", default)]
    kind: PartKind,
    #[serde(default)]
    text: Option<String>,
    #[serde(default)]
    refusal: Option<String>,
}

/// What a part of a message is.
#[derive(Deserialize, Default, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum PartKind {
    OutputText,
    Refusal,
    #[default]
    #[serde(other)]
    Other,
}

#[derive(Deserialize)]
struct Incomplete {
    #[serde(default)]
    reason: Option<String>,
}

#[derive(Deserialize)]
struct Failed {
    #[serde(default)]
    code: Option<String>,
    #[serde(default)]
    message: Option<String>,
}

#[derive(Deserialize)]
struct Counted {
    #[serde(default)]
    input_tokens: u64,
    #[serde(default)]
    output_tokens: u64,
    #[serde(default)]
    input_tokens_details: Option<Details>,
    #[serde(default)]
    output_tokens_details: Option<Details>,
}

/// The answer in a successful body.
pub(super) fn answer(bytes: &[u8], call: &Call<'_>) -> Result<ChatAnswer, ChatError> {
    let response: Response = serde_json::from_slice(bytes).map_err(|error| unreadable(error.to_string()))?;
    let output = response.output.ok_or_else(|| unreadable("it has no `output`"))?;
    let parts =
        || output.iter().filter(|item| item.kind == ItemKind::Message).flat_map(|item| item.content.iter().flatten());
    if let Some(why) = parts().find_map(|part| part.refusal.as_deref().filter(|_| part.kind == PartKind::Refusal)) {
        return Err(refused(why));
    }
    let status = response.status.unwrap_or_else(|| "completed".to_owned());
    let reason = response.incomplete_details.and_then(|details| details.reason);
    let cut = match (status.as_str(), reason.as_deref()) {
        ("completed", _) => false,
        ("incomplete", Some("content_filter")) => return Err(refused("content filter")),
        ("incomplete", _) => true,
        ("failed", _) => return Err(failed(response.error, call)),
        // An answer that is made later is nothing that was asked for.
        (other, _) => return Err(unreadable(format!("its status is `{other}`, not `completed`"))),
    };
    // Never the first piece: thoughts stand before the message.
    let text: String =
        parts().filter(|part| part.kind == PartKind::OutputText).filter_map(|part| part.text.as_deref()).collect();
    let usage = response.usage.map(|counted| Usage {
        input: counted.input_tokens,
        cached: counted.input_tokens_details.and_then(|details| details.cached_tokens).unwrap_or(0),
        output: counted.output_tokens,
        thought: counted.output_tokens_details.and_then(|details| details.reasoning_tokens).unwrap_or(0),
    });
    Ok(call.told(text, cut, response.model, usage))
}

/// A failure that comes with a good status.
fn failed(error: Option<Failed>, call: &Call<'_>) -> ChatError {
    let (code, message) = error.map_or((None, None), |error| (error.code, error.message));
    let (code, message) = (code.unwrap_or_default(), message.unwrap_or_else(|| "it does not say why".to_owned()));
    let why = call.config.key.strike_from(&message);
    match code.as_str() {
        "rate_limit_exceeded" => ChatError::SlowDown { status: 429, retry_after_ms: None, why },
        "invalid_prompt" => ChatError::Rejected { status: 400, to: Objection::Nothing, why },
        _ => ChatError::Server { status: 500, retry_after_ms: None, to: Objection::Nothing, why },
    }
}
