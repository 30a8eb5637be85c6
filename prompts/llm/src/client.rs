//! The client: one question, one answer.

use std::borrow::Cow;
use std::time::Duration;

use reqwest::header::{CONTENT_TYPE, HeaderValue};
use reqwest::{RequestBuilder, Response, Url};

use crate::chat::{ChatAnswer, ChatRequest};
use crate::dialect::{Dialect, Known, Learned, Rung};
use crate::error::{ChatError, Objection};
use crate::events::Events;
use crate::key::ApiKey;
use crate::listener::Listener;
use crate::wire::{self, Call, Parts};
use crate::{limits, ordered};

/// Version of the Messages format that is spoken.
const ANTHROPIC_VERSION: &str = "2023-06-01";
/// How much larger an answer may be in parts than as a whole: around each word of it stand about 300 bytes.
const AROUND_PARTS: usize = 64;

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
    /// How long the server may be silent, before its answer as within it. Default 5 min: a model that thinks may say nothing.
    pub silence: Duration,
    /// Longest time of a call, from connecting to the last byte. Default 30 min.
    pub longest: Duration,
    /// Largest answer that is read, bytes. Default 2 MiB. Around the parts of an answer stands more, which is not kept.
    pub max_bytes: usize,
    /// Whether answers are asked for in parts, so that they can be heard while they come. Default true; a server that refuses
    /// is asked without.
    pub stream: bool,
    /// Hears how far an answer is. Default nobody.
    pub listener: Listener,
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
    /// Whether a question whose picture is refused ends there. Default false: it is asked without.
    pub needs_pictures: bool,
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
            silence: Duration::from_secs(300),
            longest: Duration::from_secs(1800),
            max_bytes: 2 * 1024 * 1024,
            stream: true,
            listener: Listener::default(),
            rung: None,
            learned: Learned::default(),
            old_token_limit: !base_url.contains("api.openai.com"),
            proxy: false,
            plain_http: false,
            needs_pictures: false,
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
        if base.scheme() != "https" && !(base.scheme() == "http" && (is_here(&base) || config.plain_http)) {
            return Err(setup(format!("`{}` is neither https nor on this machine", config.base_url)));
        }
        if !is_model_name(&config.model) {
            return Err(setup(format!("`{}` is no name of a model", config.model)));
        }
        // Somebody else of the process may have chosen a provider first; then that one serves.
        if rustls::crypto::CryptoProvider::get_default().is_none() {
            let _lost_race = rustls::crypto::ring::default_provider().install_default().is_err();
        }
        let mut builder = reqwest::Client::builder()
            .connect_timeout(config.connect_timeout)
            .redirect(reqwest::redirect::Policy::none())
            .user_agent(concat!("socrates/", env!("CARGO_PKG_VERSION")));
        if !config.proxy {
            builder = builder.no_proxy();
        }
        let http = builder.build().map_err(|error| setup(error.without_url().to_string()))?;
        Ok(Self { http, base, config })
    }

    /// Whether the address is one of this machine alone.
    #[must_use]
    pub fn is_here(&self) -> bool {
        is_here(&self.base)
    }

    /// Base address.
    #[must_use]
    pub fn address(&self) -> &str {
        &self.config.base_url
    }

    /// Model that is asked.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.config.model
    }

    /// Asks once. A server that refuses the form of the question, its picture, or an answer in parts is asked again without
    /// what it refused: it has not answered yet. How it answers is remembered.
    ///
    /// # Errors
    /// [`ChatError`]; nothing is tried again here.
    pub async fn ask(&self, request: &ChatRequest) -> Result<ChatAnswer, ChatError> {
        let server = format!("{} {}", self.base, self.config.model);
        let known = self.config.learned.of(&server);
        let mut rungs = self.rungs(request, known.rung).into_iter();
        let Some(rung) = rungs.next() else {
            return Err(ChatError::Setup { why: "there is no way to ask".to_owned() });
        };
        let has_picture = request.turns.iter().any(|turn| turn.png.is_some());
        let picture = has_picture && (known.pictures || self.config.needs_pictures);
        let mut way = Way { rung, stream: self.config.stream && known.streams, picture };
        let mut steps = Vec::new();
        if has_picture && !way.picture {
            steps.push("asked without its picture, which the server refused before".to_owned());
        }
        loop {
            let asked = if way.picture { Cow::Borrowed(request) } else { Cow::Owned(without_pictures(request)) };
            let error = match self.call(&asked, way).await {
                Ok(mut answer) => {
                    // Of now: another question may have taught something meanwhile.
                    let known = self.config.learned.of(&server);
                    self.config.learned.keep(&server, self.learned(known, way, request, has_picture));
                    answer.steps = steps;
                    answer.without_picture = has_picture && !way.picture;
                    return Ok(answer);
                }
                Err(error) => error,
            };
            let Some((simpler, what)) = self.simpler(way, rungs.as_slice().first().copied(), &error, request) else {
                return Err(error);
            };
            if simpler.rung != way.rung {
                rungs.next();
            }
            if way.picture && !simpler.picture {
                tracing::warn!(model = %self.config.model, %error, "the server refuses the picture and is asked without it");
            } else {
                tracing::info!(%what, %error, "the server refuses how it was asked");
            }
            steps.push(format!("{what}: {error}"));
            way = simpler;
        }
    }

    /// What an answer that came this way tells of the server.
    fn learned(&self, known: Known, way: Way, request: &ChatRequest, has_picture: bool) -> Known {
        Known {
            rung: if request.schema.is_some() { Some(way.rung) } else { known.rung },
            streams: if self.config.stream { way.stream } else { known.streams },
            pictures: if has_picture { way.picture } else { known.pictures },
        }
    }

    /// The rungs to try, best first.
    fn rungs(&self, request: &ChatRequest, known: Option<Rung>) -> Vec<Rung> {
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
        let known = known.and_then(|rung| ladder.iter().position(|step| *step == rung));
        ladder.split_off(known.unwrap_or(0))
    }

    /// The same question without what the server refuses of it, and that in words; none where the server would refuse it in any
    /// form. Vendors name what they refuse; other servers answer anything, up to 500, to what they do not know.
    fn simpler(&self, way: Way, next: Option<Rung>, error: &ChatError, request: &ChatRequest) -> Option<(Way, String)> {
        let local = !self.config.dialect.is_vendor() || !self.base.domain().is_some_and(|host| host.contains('.'));
        let to = objection(error, local)?;
        let rung = || {
            let rung = next.filter(|_| request.schema.is_some())?;
            Some((Way { rung, ..way }, format!("asked as `{rung}`, as `{}` was refused", way.rung)))
        };
        let whole = || {
            way.stream.then(|| {
                (Way { stream: false, ..way }, "asked for the answer in one piece, as parts were refused".to_owned())
            })
        };
        let blind = || {
            (way.picture && !self.config.needs_pictures)
                .then(|| (Way { picture: false, ..way }, "asked without its picture, which was refused".to_owned()))
        };
        match to {
            Objection::Picture if way.picture => blind(),
            Objection::Stream if way.stream => whole(),
            Objection::Model | Objection::Nothing => None,
            Objection::Form => rung(),
            // It names a thing that was not sent, or none: what servers know least is left out first.
            Objection::Unsaid | Objection::Picture | Objection::Stream if local => rung().or_else(whole).or_else(blind),
            Objection::Unsaid | Objection::Picture | Objection::Stream => None,
        }
    }

    /// One HTTP request, within the time of a call.
    async fn call(&self, request: &ChatRequest, way: Way) -> Result<ChatAnswer, ChatError> {
        self.config.listener.tell(0);
        let call = Call { request, config: &self.config, rung: way.rung, stream: way.stream };
        let whole = tokio::time::timeout(self.config.longest, self.exchange(&call)).await;
        whole.unwrap_or_else(|_late| Err(ChatError::Late { limit_ms: ms(self.config.longest) }))
    }

    async fn exchange(&self, call: &Call<'_>) -> Result<ChatAnswer, ChatError> {
        let url = Url::parse(&format!("{}{}", self.config.base_url, call.path()))
            .map_err(|error| ChatError::Setup { why: error.to_string() })?;
        let http = self.http.post(url).header(CONTENT_TYPE, "application/json").body(ordered::text(&call.body()));
        let sent = self.heard(self.signed(http)?.send()).await?;
        let response = sent.map_err(|error| self.broken(error))?;
        let status = response.status();
        let headers = response.headers().clone();
        tracing::debug!(status = status.as_u16(), model = %self.config.model, "language model answered");
        let kind = headers.get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
        let in_parts = call.stream && kind.starts_with("text/event-stream");
        let bytes = if in_parts && status.is_success() {
            self.put_together(response).await?
        } else {
            self.read(response).await?
        };
        if !status.is_success() {
            return Err(wire::complaint(status.as_u16(), &bytes, &headers, &self.config));
        }
        let mut answer = call.answer(&bytes)?;
        answer.limits = limits::limits(&headers);
        // A server may repeat what it was sent; the key is not for keeping.
        answer.text = self.config.key.strike_from(&answer.text);
        answer.model = self.config.key.strike_from(&answer.model);
        Ok(answer)
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

    /// Waits for the server, as long as it may be silent.
    async fn heard<T>(&self, waited: impl Future<Output = T>) -> Result<T, ChatError> {
        let silent = ChatError::Timeout { limit_ms: ms(self.config.silence) };
        tokio::time::timeout(self.config.silence, waited).await.map_err(|_silent| silent)
    }

    /// The body, counted as it comes: a length in a header is only a claim.
    async fn read(&self, mut response: Response) -> Result<Vec<u8>, ChatError> {
        let mut bytes = Vec::new();
        while let Some(part) = self.heard(response.chunk()).await?.map_err(|error| self.broken(error))? {
            if bytes.len() + part.len() > self.config.max_bytes {
                return Err(ChatError::TooLarge { most: self.config.max_bytes });
            }
            bytes.extend_from_slice(&part);
        }
        Ok(bytes)
    }

    /// The body that comes in parts, as it would have come as a whole. Whoever listens hears each of them.
    async fn put_together(&self, mut response: Response) -> Result<Vec<u8>, ChatError> {
        let most = self.config.max_bytes.saturating_mul(AROUND_PARTS);
        let (mut events, mut parts) = (Events::new(self.config.max_bytes), Parts::new(&self.config));
        let mut size = 0_usize;
        loop {
            let heard = self.heard(response.chunk()).await?;
            let Some(bytes) = heard.map_err(|error| self.broken_off(error, parts.characters()))? else { break };
            size = size.saturating_add(bytes.len());
            if size > most {
                return Err(ChatError::TooLarge { most });
            }
            for event in events.take(&bytes).map_err(|error| self.struck(error))? {
                parts.take(&event)?;
            }
            self.config.listener.tell(parts.characters());
        }
        if let Some(event) = events.end().map_err(|error| self.struck(error))? {
            parts.take(&event)?;
        }
        parts.whole()
    }

    /// The error without the key, where a server repeats it.
    fn struck(&self, mut error: ChatError) -> ChatError {
        if let ChatError::Unreadable { why } = &mut error {
            *why = self.config.key.strike_from(why);
        }
        error
    }

    /// A connection that broke within an answer in parts.
    fn broken_off(&self, error: reqwest::Error, characters: u64) -> ChatError {
        let broken = self.broken(error);
        if let (ChatError::Unreachable { why }, 1..) = (&broken, characters) {
            return ChatError::Broken { characters, why: why.clone() };
        }
        broken
    }

    fn broken(&self, error: reqwest::Error) -> ChatError {
        if error.is_timeout() {
            // Of the connection, or of a small question with a limit of its own.
            return ChatError::Timeout { limit_ms: ms(self.config.connect_timeout) };
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

/// How a question is put.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Way {
    rung: Rung,
    stream: bool,
    picture: bool,
}

/// What the server objects to in how it was asked; none where asking in another way changes nothing. One of this machine may fail
/// at what it does not know.
fn objection(error: &ChatError, local: bool) -> Option<Objection> {
    match error {
        // Some answer as if nobody served such a question.
        ChatError::Rejected { status: 404 | 415, to: to @ (Objection::Picture | Objection::Stream), .. }
        | ChatError::Rejected { status: 400 | 422 | 501, to, .. } => Some(*to),
        ChatError::Server { status: 500 | 501, retry_after_ms: None, to, .. } if local => Some(*to),
        ChatError::Rejected { .. }
        | ChatError::Server { .. }
        | ChatError::Unreachable { .. }
        | ChatError::Timeout { .. }
        | ChatError::Late { .. }
        | ChatError::Broken { .. }
        | ChatError::SlowDown { .. }
        | ChatError::Key { .. }
        | ChatError::TooLarge { .. }
        | ChatError::Refused { .. }
        | ChatError::Unreadable { .. }
        | ChatError::Setup { .. } => None,
    }
}

/// Whether an address is one of this machine alone.
fn is_here(base: &Url) -> bool {
    matches!(base.host_str(), Some("localhost" | "127.0.0.1" | "[::1]"))
}

/// Whether a model of this name can be asked: names stand in addresses and on one line.
pub(crate) fn is_model_name(name: &str) -> bool {
    !name.is_empty() && !name.chars().any(|c| c.is_whitespace() || c.is_control() || "?#%".contains(c))
}

fn without_pictures(request: &ChatRequest) -> ChatRequest {
    let mut request = request.clone();
    request.turns.iter_mut().for_each(|turn| turn.png = None);
    request
}

fn ms(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
