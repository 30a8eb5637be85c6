//! What a server really does with a form: asked for a word that the form does not allow, only a server that enforces the form
//! answers with another one.

use serde_json::{Value, json};

use crate::chat::{ChatRequest, Detail, Speaker, Turn};
use crate::client::ChatClient;
use crate::dialect::Rung;
use crate::error::ChatError;

/// Words that the form allows, and the one that is asked for.
const ALLOWED: [&str; 2] = ["amber", "cobalt"];
const ASKED: &str = "violet";

/// How far a server keeps to a form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// It cannot answer otherwise.
    Enforced,
    /// It answers in JSON, and with what it likes.
    Hinted,
    /// It answers with any text.
    Ignored,
}

/// What a probe found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Probe {
    /// Model as the server names it.
    pub model: String,
    /// The rung on which it answered.
    pub rung: Option<Rung>,
    /// What was refused on the way.
    pub steps: Vec<String>,
    /// How far it keeps to the form on that rung.
    pub kept: Kept,
}

impl ChatClient {
    /// Asks one small question that tells whether the server enforces a form. The rung is remembered like that of any other
    /// answer.
    ///
    /// # Errors
    /// As [`ChatClient::ask`].
    pub async fn probe(&self) -> Result<Probe, ChatError> {
        let schema = json!({"type": "object", "properties": {"word": {"type": "string", "enum": ALLOWED}},
            "required": ["word"], "additionalProperties": false});
        let text = format!("Answer with the JSON object {{\"word\": \"{ASKED}\"}}, exactly so.");
        let request = ChatRequest {
            turns: vec![Turn { speaker: Speaker::User, text, png: None }],
            form: "probe".to_owned(),
            schema: Some(schema),
            grammar: None,
            seed: Some(1),
            temperature: None,
            max_tokens: 1_000,
            detail: Detail::Low,
        };
        let answer = self.ask(&request).await?;
        Ok(Probe { kept: kept(&answer.text), model: answer.model, rung: answer.rung, steps: answer.steps })
    }
}

fn kept(text: &str) -> Kept {
    let read = serde_json::from_str::<Value>(text.trim()).ok();
    match read.as_ref().and_then(Value::as_object).map(|members| members.get("word").and_then(Value::as_str)) {
        Some(Some(word)) if ALLOWED.contains(&word) => Kept::Enforced,
        Some(_) => Kept::Hinted,
        None => Kept::Ignored,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::client::ClientConfig;
    use crate::dialect::Dialect;
    use crate::key::ApiKey;
    use crate::server::{Reply, Served};

    fn completion(content: &str) -> Reply {
        let body = json!({"choices": [{"message": {"content": content}, "finish_reason": "stop"}]});
        Reply::new(200, &body.to_string())
    }

    async fn probe(replies: Vec<Reply>) -> Probe {
        let served = Served::replies(replies).await;
        let config = ClientConfig::new(Dialect::LmStudio, &served.url, ApiKey::new(""), "m");
        ChatClient::new(config).unwrap().probe().await.unwrap()
    }

    #[tokio::test]
    async fn what_a_server_answers_tells_what_it_enforces() {
        assert_eq!(probe(vec![completion("{\"word\": \"amber\"}")]).await.kept, Kept::Enforced);
        assert_eq!(probe(vec![completion("{\"word\": \"violet\"}")]).await.kept, Kept::Hinted);
        assert_eq!(probe(vec![completion("Violet!")]).await.kept, Kept::Ignored);
        let found = probe(vec![Reply::new(400, "no response_format"), completion("{\"word\": \"violet\"}")]).await;
        assert_eq!((found.rung, found.steps.len(), found.kept), (Some(Rung::Plain), 1, Kept::Hinted));
    }
}
