//! The client: one request, one answer.

use std::time::Duration;

use reqwest::header::{AUTHORIZATION, CONTENT_TYPE, HeaderValue};
use reqwest::{Response, Url};

use crate::chat::{ChatAnswer, ChatRequest};
use crate::error::ChatError;
use crate::key::ApiKey;
use crate::{waits, wire};

/// How far a server enforces the form of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Structured {
    /// `json_schema`: the server keeps to the schema.
    #[default]
    Schema,
    /// `json_object`: some JSON object.
    Object,
    /// Nothing; the prompt has to say it.
    Plain,
}

/// Where and how to ask.
#[derive(Debug, Clone)]
pub struct ClientConfig {
    /// Address up to and with the version, such as `https://api.openai.com/v1`. Plain HTTP only to this machine.
    pub base_url: String,
    /// The key; empty for servers without one.
    pub key: ApiKey,
    /// Model.
    pub model: String,
    /// Longest time to connect. Default 5 s.
    pub connect_timeout: Duration,
    /// Longest time for the whole call. Default 90 s.
    pub timeout: Duration,
    /// Largest body that is read, bytes. Default 2 MiB.
    pub max_bytes: usize,
    /// Enforcement of the form. Default by schema.
    pub structured: Structured,
    /// Whether the server knows `max_tokens` only. Default false for api.openai.com, true elsewhere.
    pub old_token_limit: bool,
    /// Whether the proxy of the environment is used. Default false.
    pub proxy: bool,
}

impl ClientConfig {
    /// A server with everything else at its default.
    #[must_use]
    pub fn new(base_url: &str, key: ApiKey, model: &str) -> Self {
        Self {
            base_url: base_url.trim_end_matches('/').to_owned(),
            key,
            model: model.to_owned(),
            connect_timeout: Duration::from_secs(5),
            timeout: Duration::from_secs(90),
            max_bytes: 2 * 1024 * 1024,
            structured: Structured::Schema,
            old_token_limit: !base_url.contains("api.openai.com"),
            proxy: false,
        }
    }
}

/// A client for one server and model. Cheap to keep; it holds its connections.
#[derive(Debug, Clone)]
pub struct ChatClient {
    http: reqwest::Client,
    url: Url,
    config: ClientConfig,
}

impl ChatClient {
    /// A client.
    ///
    /// # Errors
    /// [`ChatError::Setup`] when the address is none, or is plain HTTP to another machine.
    pub fn new(config: ClientConfig) -> Result<Self, ChatError> {
        let setup = |why: String| ChatError::Setup { why };
        let url = Url::parse(&format!("{}/chat/completions", config.base_url))
            .map_err(|error| setup(format!("`{}` is no address: {error}", config.base_url)))?;
        let host = url.host_str().unwrap_or_default();
        let here = matches!(host, "localhost" | "127.0.0.1" | "[::1]");
        if url.scheme() != "https" && !(url.scheme() == "http" && here) {
            return Err(setup(format!("`{}` is neither https nor on this machine", config.base_url)));
        }
        // Somebody else of the process may have chosen a provider first; then that one serves.
        if rustls::crypto::CryptoProvider::get_default().is_none() {
            let _lost_race = rustls::crypto::ring::default_provider().install_default().is_err();
        }
        let mut builder = reqwest::Client::builder()
            .connect_timeout(config.connect_timeout)
            .timeout(config.timeout)
            .redirect(reqwest::redirect::Policy::none())
            .user_agent(concat!("socrates/", env!("CARGO_PKG_VERSION")));
        if !config.proxy {
            builder = builder.no_proxy();
        }
        let http = builder.build().map_err(|error| setup(error.without_url().to_string()))?;
        Ok(Self { http, url, config })
    }

    /// Model that is asked.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.config.model
    }

    /// Asks once.
    ///
    /// # Errors
    /// [`ChatError`]; nothing is tried again here.
    pub async fn ask(&self, request: &ChatRequest) -> Result<ChatAnswer, ChatError> {
        let body = wire::body(request, &self.config).to_string();
        let mut call = self.http.post(self.url.clone()).header(CONTENT_TYPE, "application/json").body(body);
        if !self.config.key.is_empty() {
            let mut value =
                HeaderValue::try_from(format!("Bearer {}", self.config.key.secret())).map_err(|_bytes| {
                    ChatError::Setup { why: "the key holds characters that no header can carry".to_owned() }
                })?;
            value.set_sensitive(true);
            call = call.header(AUTHORIZATION, value);
        }
        let response = call.send().await.map_err(|error| self.broken(error))?;
        let status = response.status();
        let wait = waits::retry_after_ms(response.headers());
        tracing::debug!(status = status.as_u16(), model = %self.config.model, "language model answered");
        let bytes = self.read(response).await?;
        if status.is_success() {
            wire::answer(&bytes, request, &self.config)
        } else {
            Err(wire::complaint(status.as_u16(), &bytes, wait, &self.config))
        }
    }

    /// The body, counted as it comes: a length in a header is only a claim.
    async fn read(&self, mut response: Response) -> Result<Vec<u8>, ChatError> {
        let mut bytes = Vec::new();
        while let Some(part) = response.chunk().await.map_err(|error| self.broken(error))? {
            if bytes.len() + part.len() > self.config.max_bytes {
                return Err(ChatError::TooLarge { most: self.config.max_bytes });
            }
            bytes.extend_from_slice(&part);
        }
        Ok(bytes)
    }

    fn broken(&self, error: reqwest::Error) -> ChatError {
        if error.is_timeout() {
            let limit_ms = u64::try_from(self.config.timeout.as_millis()).unwrap_or(u64::MAX);
            return ChatError::Timeout { limit_ms };
        }
        let error = error.without_url();
        let mut why = error.to_string();
        let mut cause = std::error::Error::source(&error);
        while let Some(inner) = cause {
            why = format!("{why}: {inner}");
            cause = inner.source();
        }
        ChatError::Unreachable { why: self.config.key.strike_from(&why) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chat::{Finish, Speaker, Turn};
    use crate::server::Served;
    use serde_json::{Value, json};

    fn request() -> ChatRequest {
        ChatRequest {
            turns: vec![Turn { speaker: Speaker::User, text: "Say yes.".into(), png: Some(vec![1, 2, 3]) }],
            form: "answer".into(),
            schema: Some(json!({"type": "object"})),
            seed: Some(u64::MAX),
            temperature: None,
            max_tokens: 100,
        }
    }

    async fn ask(served: &Served, change: impl FnOnce(&mut ClientConfig)) -> Result<ChatAnswer, ChatError> {
        let mut config = ClientConfig::new(&served.url, ApiKey::new("sk-very-secret"), "small");
        change(&mut config);
        ChatClient::new(config).unwrap().ask(&request()).await
    }

    fn completion(content: &str, finish: &str) -> String {
        json!({"model": "small-1", "choices": [{"message": {"content": content}, "finish_reason": finish}],
            "usage": {"prompt_tokens": 12, "completion_tokens": 3}})
        .to_string()
    }

    #[tokio::test]
    async fn one_call_asks_in_the_agreed_form_and_reads_the_answer() {
        let served = Served::once(200, &[], &completion("{\"yes\": true}", "stop")).await;
        let answer = ask(&served, |_| {}).await.unwrap();
        assert_eq!((answer.text.as_str(), answer.finish, answer.tokens), ("{\"yes\": true}", Finish::Stop, (12, 3)));
        let seen = served.seen().await;
        assert!(seen.head.starts_with("POST /v1/chat/completions"), "{}", seen.head);
        assert!(seen.head.to_lowercase().contains("authorization: bearer sk-very-secret"), "{}", seen.head);
        let body: Value = serde_json::from_str(&seen.body).unwrap();
        assert_eq!(body["response_format"]["json_schema"]["strict"], true);
        assert_eq!(body["messages"][0]["content"][1]["image_url"]["url"], "data:image/png;base64,AQID");
        assert_eq!((&body["max_tokens"], &body["seed"]), (&json!(100), &json!(0x7fff_ffff)));
    }

    #[tokio::test]
    async fn a_cut_answer_and_a_refusal_are_told_apart() {
        let served = Served::once(200, &[], &completion("{\"ye", "length")).await;
        assert_eq!(ask(&served, |_| {}).await.unwrap().finish, Finish::Cut);
        let refusal = json!({"choices": [{"message": {"refusal": "I will not"}}]}).to_string();
        let served = Served::once(200, &[], &refusal).await;
        assert!(matches!(ask(&served, |_| {}).await, Err(ChatError::Refused { .. })));
    }

    #[tokio::test]
    async fn every_status_has_its_error_and_its_wait() {
        let error = |code: &str| json!({"error": {"message": "no sk-very-secret", "code": code}}).to_string();
        let served = Served::once(429, &[("retry-after", "2")], &error("rate_limit_exceeded")).await;
        assert!(matches!(ask(&served, |_| {}).await, Err(ChatError::SlowDown { retry_after_ms: Some(2000), .. })));
        let served = Served::once(429, &[], &error("insufficient_quota")).await;
        assert!(matches!(ask(&served, |_| {}).await, Err(ChatError::Key { .. })));
        let served = Served::once(503, &[], "busy").await;
        assert!(matches!(ask(&served, |_| {}).await, Err(ChatError::Server { status: 503, .. })));
        let served = Served::once(404, &[], &error("model_not_found")).await;
        assert!(matches!(ask(&served, |_| {}).await, Err(ChatError::Rejected { status: 404, .. })));
        let served = Served::once(401, &[], &error("")).await;
        let told = ask(&served, |_| {}).await.unwrap_err().to_string();
        assert!(told.contains("no ***") && !told.contains("secret"), "{told}");
    }

    #[tokio::test]
    async fn large_slow_and_missing_servers_are_no_trap() {
        let served = Served::once(200, &[], &completion(&"x".repeat(5000), "stop")).await;
        let small = ask(&served, |config| config.max_bytes = 1000).await;
        assert_eq!(small, Err(ChatError::TooLarge { most: 1000 }));
        let silent = Served::silent().await;
        let slow = ask(&silent, |config| config.timeout = Duration::from_millis(200)).await;
        assert_eq!(slow, Err(ChatError::Timeout { limit_ms: 200 }));
        let gone = Served::gone().await;
        assert!(matches!(ask(&gone, |_| {}).await, Err(ChatError::Unreachable { .. })));
        let served = Served::once(200, &[], "<html>").await;
        assert!(matches!(ask(&served, |_| {}).await, Err(ChatError::Unreadable { .. })));
    }

    #[test]
    fn plain_http_goes_to_this_machine_only() {
        let client = |url: &str| ChatClient::new(ClientConfig::new(url, ApiKey::new(""), "m")).map(|_| ());
        assert!(client("http://127.0.0.1:8080/v1").is_ok());
        assert!(matches!(client("http://example.org/v1"), Err(ChatError::Setup { .. })));
        assert!(matches!(client("not an address"), Err(ChatError::Setup { .. })));
    }
}
