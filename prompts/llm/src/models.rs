//! Which models a server has, asked before anything is made with it: a question without tokens.

use std::time::Duration;

use serde_json::Value;

use crate::client::{ChatClient, is_model_name};
use crate::dialect::{Dialect, Wire};
use crate::error::ChatError;
use crate::wire;

/// Longest wait for the answer: a server that is slow here may still answer the real questions.
const LIMIT: Duration = Duration::from_secs(10);

/// What a server says of a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Has {
    /// It has it.
    Yes,
    /// It has others; empty where it names none.
    No(Vec<String>),
    /// It does not say, or what it says need not hold.
    Unsaid,
}

/// The models that each server lists within a time for all of them; empty for one that answers late or with anything else. All
/// are asked at once.
pub async fn listed(clients: &[ChatClient], limit: Duration) -> Vec<Vec<String>> {
    let until = tokio::time::Instant::now() + limit;
    let ask = |client: ChatClient| async move {
        match tokio::time::timeout_at(until, client.get("/models", limit)).await {
            Ok(Ok((200, body))) => names(&body).filter(|name| is_model_name(name)).collect(),
            Ok(Ok(_) | Err(_)) | Err(_) => Vec::new(),
        }
    };
    let asked: Vec<_> = clients.iter().map(|client| tokio::spawn(ask(client.clone()))).collect();
    let mut lists = Vec::new();
    for list in asked {
        lists.push(list.await.unwrap_or_default());
    }
    lists
}

/// The names in a list of models; none in anything else.
fn names(body: &[u8]) -> impl Iterator<Item = String> {
    let mut list: Value = serde_json::from_slice(body).unwrap_or_default();
    let rows = list.get_mut("data").and_then(Value::as_array_mut).map(std::mem::take).unwrap_or_default();
    rows.into_iter().filter_map(|row| Some(row.get("id")?.as_str()?.to_owned()))
}

impl ChatClient {
    /// Asks the server whether it has the model.
    ///
    /// # Errors
    /// [`ChatError::Unreachable`] where nobody answers, [`ChatError::Key`] where the key is refused; whatever else a server does
    /// is [`Has::Unsaid`].
    pub async fn has_model(&self) -> Result<Has, ChatError> {
        let (dialect, model) = (self.config().dialect, self.model());
        let path = match dialect.wire() {
            Wire::Chat | Wire::Responses => "/models".to_owned(),
            Wire::Messages => format!("/v1/models/{model}"),
            Wire::Generate => format!("/v1beta/models/{model}"),
        };
        let lists = matches!(dialect.wire(), Wire::Chat | Wire::Responses);
        let (status, body) = match self.get(&path, LIMIT).await {
            Ok(answer) => answer,
            Err(error @ (ChatError::Unreachable { .. } | ChatError::Setup { .. })) => return Err(error),
            Err(error) => {
                tracing::debug!(%error, "the server does not tell its models");
                return Ok(Has::Unsaid);
            }
        };
        match status {
            // A key that may ask but not list is answered with 403 by some.
            401 => Err(wire::complaint(status, &body, &reqwest::header::HeaderMap::new(), self.config())),
            200 if lists => Ok(self.listed(&body)),
            200 => Ok(Has::Yes),
            // A server that names the model has looked for it; others answer any unknown address with 404.
            404 if !lists && String::from_utf8_lossy(&body).contains(model) => Ok(Has::No(Vec::new())),
            _ => Ok(Has::Unsaid),
        }
    }

    /// What a list of models says.
    fn listed(&self, body: &[u8]) -> Has {
        let names: Vec<String> = names(body).collect();
        let model = self.model();
        if names.iter().any(|name| name == model || name.strip_suffix(":latest") == Some(model)) {
            return Has::Yes;
        }
        let dialect = self.config().dialect;
        // One serves whatever model it was started with under any name; somebody else's server before others may know more
        // than it lists.
        let whole = match dialect {
            Dialect::LlamaCpp | Dialect::Console => false,
            Dialect::OpenAi | Dialect::Responses => self.config().base_url == dialect.default_url(),
            Dialect::Vllm | Dialect::Ollama | Dialect::LmStudio | Dialect::Anthropic | Dialect::Gemini => true,
        };
        if names.is_empty() || !whole { Has::Unsaid } else { Has::No(names) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::client::ClientConfig;
    use crate::key::ApiKey;
    use crate::server::Served;

    async fn asked(dialect: Dialect, model: &str, status: u16, body: &str) -> (Result<Has, ChatError>, String) {
        let server = Served::once(status, &[], body).await;
        let client = ChatClient::new(ClientConfig::new(dialect, &server.url, ApiKey::new("secret"), model)).unwrap();
        let has = client.has_model().await;
        (has, server.seen().await.head)
    }

    #[tokio::test]
    async fn a_model_is_there_or_the_others_are_named() {
        let list = r#"{"data":[{"id":"small"},{"id":"llama:latest"}]}"#;
        let (has, head) = asked(Dialect::Vllm, "small", 200, list).await;
        assert_eq!(has.unwrap(), Has::Yes);
        assert!(head.starts_with("GET /v1/models ") && head.to_lowercase().contains("bearer secret"), "{head}");
        assert_eq!(asked(Dialect::Ollama, "llama", 200, list).await.0.unwrap(), Has::Yes);
        let others = Has::No(vec!["small".to_owned(), "llama:latest".to_owned()]);
        assert_eq!(asked(Dialect::Vllm, "smal", 200, list).await.0.unwrap(), others);
        // These take names that they do not list.
        for dialect in [Dialect::LlamaCpp, Dialect::OpenAi] {
            assert_eq!(asked(dialect, "any", 200, list).await.0.unwrap(), Has::Unsaid, "{dialect}");
        }
        let (has, head) = asked(Dialect::Anthropic, "c-1", 404, r#"{"error":{"message":"model: c-1"}}"#).await;
        assert_eq!(has.unwrap(), Has::No(Vec::new()));
        assert!(head.starts_with("GET /v1/v1/models/c-1 ") && head.to_lowercase().contains("x-api-key"), "{head}");
    }

    #[tokio::test]
    async fn lists_come_in_the_order_of_the_clients_and_anything_else_is_no_list() {
        let body = r#"{"data":[{"id":"two words"},{"id":"b\u0007"},{"id":"good"},{"name":"none"}]}"#;
        let replies = [(200, body), (500, body), (200, "<html>"), (200, r#"{"data":{"id":"x"}}"#), (302, body)];
        let client =
            |url: &str| ChatClient::new(ClientConfig::new(Dialect::Vllm, url, ApiKey::new(""), "any")).unwrap();
        let gone = Served::gone().await;
        let (mut servers, mut clients) = (Vec::new(), vec![client(&gone.url)]);
        for (status, body) in replies {
            let server = Served::once(status, &[], body).await;
            clients.push(client(&server.url));
            servers.push(server);
        }
        let none = Vec::<String>::new;
        let found = listed(&clients, Duration::from_secs(60)).await;
        assert_eq!(found, [none(), vec!["good".to_owned()], none(), none(), none(), none()]);
        let silent = Served::silent().await;
        assert_eq!(listed(&[client(&silent.url)], Duration::from_millis(1)).await, [none()]);
    }

    #[tokio::test]
    async fn what_a_server_does_not_say_stops_nobody_but_a_refused_key_does() {
        for (status, body) in [(404, "not found"), (403, "no"), (500, "oh"), (200, "{}"), (200, "words")] {
            assert_eq!(asked(Dialect::Vllm, "m", status, body).await.0.unwrap(), Has::Unsaid, "{status} {body}");
        }
        let refused = asked(Dialect::Vllm, "m", 401, r#"{"error":{"message":"wrong key"}}"#).await.0;
        assert!(matches!(refused, Err(ChatError::Key { status: 401, .. })), "{refused:?}");
        let gone = Served::gone().await;
        let client = ChatClient::new(ClientConfig::new(Dialect::Vllm, &gone.url, ApiKey::new(""), "m")).unwrap();
        assert!(matches!(client.has_model().await, Err(ChatError::Unreachable { .. })));
    }
}
