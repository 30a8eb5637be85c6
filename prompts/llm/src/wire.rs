//! The Chat Completions wire format.

use serde::Deserialize;
use serde_json::{Value, json};

use crate::base64;
use crate::chat::{ChatAnswer, ChatRequest, Finish, Speaker, Turn};
use crate::client::{ClientConfig, Structured};
use crate::error::ChatError;

/// The body of a request.
pub(crate) fn body(request: &ChatRequest, config: &ClientConfig) -> Value {
    let messages: Vec<Value> = request.turns.iter().map(message).collect();
    let mut body = json!({"model": config.model, "messages": messages});
    let Some(members) = body.as_object_mut() else { return body };
    let limit = if config.old_token_limit { "max_tokens" } else { "max_completion_tokens" };
    members.insert(limit.to_owned(), json!(request.max_tokens));
    if let Some(seed) = request.seed {
        // Servers read a signed number.
        members.insert("seed".to_owned(), json!(seed & 0x7fff_ffff));
    }
    if let Some(temperature) = request.temperature {
        members.insert("temperature".to_owned(), json!(temperature));
    }
    match (&request.schema, config.structured) {
        (Some(schema), Structured::Schema) => {
            let form = json!({"name": request.form, "schema": schema, "strict": true});
            members.insert("response_format".to_owned(), json!({"type": "json_schema", "json_schema": form}));
        }
        (Some(_), Structured::Object) => {
            members.insert("response_format".to_owned(), json!({"type": "json_object"}));
        }
        (Some(_), Structured::Plain) | (None, _) => {}
    }
    body
}

fn message(turn: &Turn) -> Value {
    let role = match turn.speaker {
        Speaker::System => "system",
        Speaker::User => "user",
        Speaker::Assistant => "assistant",
    };
    match &turn.png {
        None => json!({"role": role, "content": turn.text}),
        Some(png) => {
            let url = format!("data:image/png;base64,{}", base64::encode(png));
            json!({"role": role, "content": [
                {"type": "text", "text": turn.text},
                {"type": "image_url", "image_url": {"url": url, "detail": "high"}},
            ]})
        }
    }
}

#[derive(Deserialize)]
struct Completion {
    #[serde(default)]
    model: String,
    #[serde(default)]
    choices: Vec<Choice>,
    usage: Option<Usage>,
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
struct Usage {
    #[serde(default)]
    prompt_tokens: u64,
    #[serde(default)]
    completion_tokens: u64,
}

#[derive(Deserialize)]
struct Complaint {
    error: Value,
}

/// The answer in a successful body.
pub(crate) fn answer(bytes: &[u8], request: &ChatRequest, config: &ClientConfig) -> Result<ChatAnswer, ChatError> {
    let completion: Completion =
        serde_json::from_slice(bytes).map_err(|error| ChatError::Unreadable { why: error.to_string() })?;
    let Some(choice) = completion.choices.into_iter().next() else {
        return Err(ChatError::Unreadable { why: "it has no `choices`".to_owned() });
    };
    let said = choice.message.ok_or_else(|| ChatError::Unreadable { why: "it has no `message`".to_owned() })?;
    if let Some(why) = said.refusal.filter(|why| !why.is_empty()) {
        return Err(ChatError::Refused { why: why.chars().take(300).collect() });
    }
    let finish = match choice.finish_reason.as_deref() {
        Some("content_filter") => return Err(ChatError::Refused { why: "content filter".to_owned() }),
        Some("length") => Finish::Cut,
        Some(_) | None => Finish::Stop,
    };
    let text = said.content.unwrap_or_default();
    let estimated = completion.usage.is_none();
    let tokens = completion.usage.map_or_else(
        || (request.turns.iter().map(|turn| turn.text.len() as u64 / 4 + 4).sum(), text.len() as u64 / 4),
        |usage| (usage.prompt_tokens, usage.completion_tokens),
    );
    let model = if completion.model.is_empty() { config.model.clone() } else { completion.model };
    Ok(ChatAnswer { text, finish, model, tokens, estimated })
}

/// The error in an unsuccessful body.
pub(crate) fn complaint(status: u16, bytes: &[u8], retry_after_ms: Option<u64>, config: &ClientConfig) -> ChatError {
    let error = serde_json::from_slice::<Complaint>(bytes).map(|complaint| complaint.error).unwrap_or_default();
    let code = error.get("code").and_then(Value::as_str).unwrap_or_default().to_owned();
    let words = error.get("message").and_then(Value::as_str).or_else(|| error.as_str()).map(str::to_owned);
    let words = words.unwrap_or_else(|| String::from_utf8_lossy(bytes).into_owned());
    let why: String = config.key.strike_from(&words).chars().take(300).collect();
    match status {
        401 | 403 => ChatError::Key { status, why },
        // No waiting fills an empty purse.
        429 if code == "insufficient_quota" => ChatError::Key { status, why },
        429 | 529 => ChatError::SlowDown { status, retry_after_ms, why },
        408 | 409 | 425 | 500..=599 => ChatError::Server { status, retry_after_ms, why },
        _ => ChatError::Rejected { status, why },
    }
}
