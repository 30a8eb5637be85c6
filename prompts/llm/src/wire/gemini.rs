//! Gemini generateContent.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::{Call, Usage, refused, unreadable};
use crate::chat::{ChatAnswer, Detail, Speaker};
use crate::dialect::Rung;
use crate::error::ChatError;
use crate::form;

/// The body of a request.
pub(super) fn body(call: &Call<'_>) -> Value {
    let request = call.request;
    let mut system = Vec::new();
    let mut contents = Vec::new();
    for (index, turn) in request.turns.iter().enumerate() {
        let text = json!({"text": call.text(index)});
        let picture = turn
            .png
            .as_ref()
            .map(|png| json!({"inlineData": {"mimeType": "image/png", "data": BASE64_STANDARD.encode(png)}}));
        let parts: Vec<Value> = [text].into_iter().chain(picture).collect();
        match turn.speaker {
            Speaker::System => system.extend(parts),
            Speaker::User => contents.push(json!({"role": "user", "parts": parts})),
            Speaker::Assistant => contents.push(json!({"role": "model", "parts": parts})),
        }
    }
    let mut settings = Map::new();
    settings.insert("maxOutputTokens".to_owned(), json!(request.max_tokens));
    settings.insert("candidateCount".to_owned(), json!(1));
    if let Some(seed) = request.seed {
        settings.insert("seed".to_owned(), json!(seed & 0x7fff_ffff));
    }
    if let Some(temperature) = request.temperature {
        settings.insert("temperature".to_owned(), json!(temperature));
    }
    if request.turns.iter().any(|turn| turn.png.is_some()) && request.detail == Detail::Low {
        settings.insert("mediaResolution".to_owned(), json!("MEDIA_RESOLUTION_LOW"));
    }
    if let Some(schema) = &request.schema {
        if call.rung != Rung::Plain {
            settings.insert("responseMimeType".to_owned(), json!("application/json"));
        }
        if call.rung == Rung::Schema {
            settings.insert("responseJsonSchema".to_owned(), form::for_dialect(schema, call.config.dialect));
        }
    }
    let mut body = json!({"contents": contents, "generationConfig": settings});
    if !system.is_empty()
        && let Some(members) = body.as_object_mut()
    {
        members.insert("systemInstruction".to_owned(), json!({"parts": system}));
    }
    body
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Generated {
    #[serde(default)]
    candidates: Vec<Candidate>,
    prompt_feedback: Option<PromptFeedback>,
    usage_metadata: Option<Counted>,
    model_version: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Candidate {
    content: Option<Content>,
    finish_reason: Option<String>,
}

#[derive(Deserialize)]
struct Content {
    #[serde(default)]
    parts: Vec<Part>,
}

#[derive(Deserialize)]
struct Part {
    #[serde(default)]
    text: Option<String>,
    #[serde(default)]
    thought: bool,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct PromptFeedback {
    block_reason: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Counted {
    #[serde(default)]
    prompt_token_count: u64,
    #[serde(default)]
    candidates_token_count: u64,
    #[serde(default)]
    thoughts_token_count: u64,
    #[serde(default)]
    cached_content_token_count: u64,
}

/// The answer in a successful body.
pub(super) fn answer(bytes: &[u8], call: &Call<'_>) -> Result<ChatAnswer, ChatError> {
    let generated: Generated = serde_json::from_slice(bytes).map_err(|error| unreadable(error.to_string()))?;
    let blocked = generated.prompt_feedback.and_then(|feedback| feedback.block_reason);
    let Some(candidate) = generated.candidates.into_iter().next() else {
        return Err(blocked.map_or_else(
            || unreadable("it has no `candidates`"),
            |reason| refused(&format!("block reason {reason}")),
        ));
    };
    let reason = candidate.finish_reason.unwrap_or_default();
    const FILTERS: [&str; 7] =
        ["SAFETY", "RECITATION", "BLOCKLIST", "PROHIBITED_CONTENT", "SPII", "IMAGE_SAFETY", "LANGUAGE"];
    if FILTERS.contains(&reason.as_str()) {
        return Err(refused(&format!("finish reason {reason}")));
    }
    let parts = candidate.content.map(|content| content.parts).unwrap_or_default();
    let text: String = parts.into_iter().filter(|part| !part.thought).filter_map(|part| part.text).collect();
    let usage = generated.usage_metadata.map(|counted| Usage {
        input: counted.prompt_token_count,
        cached: counted.cached_content_token_count,
        // What it thought is paid for like what it said.
        output: counted.candidates_token_count + counted.thoughts_token_count,
        thought: counted.thoughts_token_count,
    });
    Ok(call.told(text, reason == "MAX_TOKENS", generated.model_version, usage))
}
