//! The client: one question, one answer.

use std::time::Duration;

use reqwest::header::{CONTENT_TYPE, HeaderValue};
use reqwest::{RequestBuilder, Response, Url};

use crate::chat::{ChatAnswer, ChatRequest};
use crate::dialect::{Dialect, Learned, Rung};
use crate::error::{ChatError, Objection};
use crate::key::ApiKey;
use crate::wire::{self, Call};
use crate::{limits, ordered};

/// Version of the Messages format that is spoken.
const ANTHROPIC_VERSION: &str = "2023-06-01";

/// Where and how to ask.
#[derive(Debug, Clone)]
pub struct ClientConfig {
    /// Kind of server.
    pub dialect: Dialect,
    /// Base address, such as `https://api.openai.com/v1`; see [`Dialect::default_url`]. Plain HTTP only to this machine.
    pub base_url: String,
    /// The key; empty for servers without one.
    pub key: ApiKey,
    /// Model.
    pub model: String,
    /// Longest time to connect. Default 5 s.
    pub connect_timeout: Duration,
    /// Longest time for the whole call, the body included. Default 90 s.
    pub timeout: Duration,
    /// Largest body that is read, bytes. Default 2 MiB.
    pub max_bytes: usize,
    /// The one rung to use; without one, the dialect's ladder from the top, or from where it was left.
    pub rung: Option<Rung>,
    /// Where rungs are remembered.
    pub learned: Learned,
    /// Whether the server knows `max_tokens` only. Default false for api.openai.com, true elsewhere.
    pub old_token_limit: bool,
    /// Whether the proxy of the environment is used. Default false.
    pub proxy: bool,
    /// Whether plain HTTP may go to other machines. Default false.
    pub plain_http: bool,
}

impl ClientConfig {
    /// A server with everything else at its default.
    #[must_use]
    pub fn new(dialect: Dialect, base_url: &str, key: ApiKey, model: &str) -> Self {
        Self {
            dialect,
            base_url: base_url.trim_end_matches('/').to_owned(),
            key,
            model: model.to_owned(),
            connect_timeout: Duration::from_secs(5),
            timeout: Duration::from_secs(90),
            max_bytes: 2 * 1024 * 1024,
            rung: None,
            learned: Learned::default(),
            old_token_limit: !base_url.contains("api.openai.com"),
            proxy: false,
            plain_http: false,
        }
    }
}

/// A client for one server and model. Cheap to keep; it holds its connections.
#[derive(Debug, Clone)]
pub struct ChatClient {
    http: reqwest::Client,
    base: Url,
    config: ClientConfig,
}

impl ChatClient {
    /// A client.
    ///
    /// # Errors
    /// [`ChatError::Setup`] when the address is none, holds a password or a query, or is plain HTTP to another machine, or
    /// when the model's name cannot stand in an address.
    pub fn new(config: ClientConfig) -> Result<Self, ChatError> {
        let setup = |why: String| ChatError::Setup { why };
        let base = Url::parse(&config.base_url)
            .map_err(|error| setup(format!("`{}` is no address: {error}", config.base_url)))?;
        if base.password().is_some() || !base.username().is_empty() || base.query().is_some() {
            return Err(setup("an address holds no key, name or query; the key has its own place".to_owned()));
        }
        let host = base.host_str().unwrap_or_default();
        let here = matches!(host, "localhost" | "127.0.0.1" | "[::1]");
        if base.scheme() != "https" && !(base.scheme() == "http" && (here || config.plain_http)) {
            return Err(setup(format!("`{}` is neither https nor on this machine", config.base_url)));
        }
        if config.model.is_empty() || config.model.chars().any(|c| c.is_whitespace() || "?#%".contains(c)) {
            return Err(setup(format!("`{}` is no name of a model", config.model)));
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
        Ok(Self { http, base, config })
    }

    /// Model that is asked.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.config.model
    }

    /// Asks once. A server that refuses the form of the question is asked in the next simpler form: what it refused it
    /// has not answered. The rung on which it answers is remembered.
    ///
    /// # Errors
    /// [`ChatError`]; nothing is tried again here.
    pub async fn ask(&self, request: &ChatRequest) -> Result<ChatAnswer, ChatError> {
        let server = format!("{} {}", self.base, self.config.model);
        let mut steps = Vec::new();
        let mut rungs = self.rungs(request, &server).into_iter().peekable();
        while let Some(rung) = rungs.next() {
            match self.call(request, rung).await {
                Ok(mut answer) => {
                    if request.schema.is_some() {
                        self.config.learned.keep(&server, rung);
                    }
                    answer.steps = steps;
                    return Ok(answer);
                }
                Err(error) => match rungs.peek() {
                    Some(next) if self.refuses_form(&error, request) => {
                        tracing::info!(%rung, %next, %error, "the server refuses the form of the question");
                        steps.push(format!("asked as `{next}`, as `{rung}` was refused: {error}"));
                    }
                    Some(_) | None => return Err(error),
                },
            }
        }
        Err(ChatError::Setup { why: "there is no way to ask".to_owned() })
    }

    /// The rungs to try, best first.
    fn rungs(&self, request: &ChatRequest, server: &str) -> Vec<Rung> {
        if request.schema.is_none() {
            return vec![Rung::Plain];
        }
        if let Some(rung) = self.config.rung {
            return vec![rung];
        }
        let mut ladder = self.config.dialect.ladder().to_vec();
        if request.grammar.is_some() && self.config.dialect.takes_grammar() {
            // A request has a grammar where no schema says as much.
            ladder.retain(|rung| *rung != Rung::Grammar);
            ladder.insert(0, Rung::Grammar);
        }
        let known = self.config.learned.rung(server).and_then(|rung| ladder.iter().position(|step| *step == rung));
        ladder.split_off(known.unwrap_or(0))
    }

    /// Whether the server would have taken the question in a simpler form. Vendors name what they refuse; other servers
    /// answer anything, up to 500, to a form that they do not know.
    fn refuses_form(&self, error: &ChatError, request: &ChatRequest) -> bool {
        let local = !matches!(self.config.dialect, Dialect::OpenAi | Dialect::Anthropic | Dialect::Gemini)
            || !self.base.domain().is_some_and(|host| host.contains('.'));
        match error {
            ChatError::Rejected { status: 400 | 422 | 501, to, .. } => {
                request.schema.is_some()
                    && match to {
                        Objection::Form => true,
                        Objection::Model => false,
                        Objection::Unsaid => local,
                    }
            }
            ChatError::Server { status: 500 | 501, retry_after_ms: None, .. } => request.schema.is_some() && local,
            ChatError::Rejected { .. }
            | ChatError::Server { .. }
            | ChatError::Unreachable { .. }
            | ChatError::Timeout { .. }
            | ChatError::SlowDown { .. }
            | ChatError::Key { .. }
            | ChatError::TooLarge { .. }
            | ChatError::Refused { .. }
            | ChatError::Unreadable { .. }
            | ChatError::Setup { .. } => false,
        }
    }

    /// One HTTP request.
    async fn call(&self, request: &ChatRequest, rung: Rung) -> Result<ChatAnswer, ChatError> {
        let call = Call { request, config: &self.config, rung };
        let url = Url::parse(&format!("{}{}", self.config.base_url, call.path()))
            .map_err(|error| ChatError::Setup { why: error.to_string() })?;
        let http = self.http.post(url).header(CONTENT_TYPE, "application/json").body(ordered::text(&call.body()));
        let response = self.signed(http)?.send().await.map_err(|error| self.broken(error))?;
        let status = response.status();
        let headers = response.headers().clone();
        tracing::debug!(status = status.as_u16(), model = %self.config.model, "language model answered");
        let bytes = self.read(response).await?;
        if status.is_success() {
            let mut answer = call.answer(&bytes)?;
            answer.limits = limits::limits(&headers);
            // A server may repeat what it was sent; the key is not for keeping.
            answer.text = self.config.key.strike_from(&answer.text);
            answer.model = self.config.key.strike_from(&answer.model);
            Ok(answer)
        } else {
            Err(wire::complaint(status.as_u16(), &bytes, &headers, &self.config))
        }
    }

    /// A request with the headers that every request to the server has.
    fn signed(&self, mut http: RequestBuilder) -> Result<RequestBuilder, ChatError> {
        if self.config.dialect == Dialect::Anthropic {
            http = http.header("anthropic-version", ANTHROPIC_VERSION);
        }
        if !self.config.key.is_empty() {
            let (name, text) = wire::key_header(&self.config);
            let mut value = HeaderValue::try_from(text).map_err(|_bytes| ChatError::Setup {
                why: "the key holds characters that no header can carry".to_owned(),
            })?;
            value.set_sensitive(true);
            http = http.header(name, value);
        }
        Ok(http)
    }

    /// Reads something small from below the base address: status and body.
    pub(crate) async fn get(&self, path: &str, limit: Duration) -> Result<(u16, Vec<u8>), ChatError> {
        let url = Url::parse(&format!("{}{path}", self.config.base_url))
            .map_err(|error| ChatError::Setup { why: error.to_string() })?;
        let response =
            self.signed(self.http.get(url).timeout(limit))?.send().await.map_err(|error| self.broken(error))?;
        let status = response.status().as_u16();
        Ok((status, self.read(response).await?))
    }

    /// How it was set up.
    pub(crate) const fn config(&self) -> &ClientConfig {
        &self.config
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
