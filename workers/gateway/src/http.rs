//! The routes: the page, its data, files, and the sockets.

use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::{Path, Query, Request, State, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse as _, Response};
use axum::routing::{get, post};
use serde::Deserialize;
use serde_json::{Value, json};
use socrates_model::RunId;

use crate::guard::{COOKIE, Refusal, Rules};
use crate::hub::Hub;
use crate::run::Run;
use crate::{assets, files, fox, fox_socket, page};

/// Bytes that are read from a socket at once: acknowledgements are small, and the library clears the room for each.
const READ_BYTES: usize = 1024;

/// What all answers share.
pub struct Shared {
    /// The runs.
    pub hub: Hub,
    /// What is let in.
    pub rules: Arc<Rules>,
    /// What a page of ours may load, and which pages may show it.
    pub policy: Policy,
    /// Whether answers go over TLS.
    pub tls: bool,
}

/// What a browser is told of our pages: they load nothing from elsewhere, and only these pages may show them.
#[derive(Debug, Clone)]
pub struct Policy(HeaderValue);

impl Policy {
    /// The policy that lets these pages of others show ours in a frame.
    ///
    /// # Errors
    /// Where one of them cannot stand in a header, in a sentence.
    pub fn letting(frames: &[String]) -> Result<Self, String> {
        let frames = frames.join(" ");
        let policy = format!(
            "default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'; script-src 'self'; \
             frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self' {frames}"
        );
        let value = HeaderValue::from_str(policy.trim_end());
        value.map(Self).map_err(|_why| format!("`{}` is no list of origins", frames.escape_debug()))
    }
}

/// The routes of a gateway.
pub fn routes(shared: Arc<Shared>) -> Router {
    let data = Router::new()
        .route("/runs", get(runs))
        .route("/run/{id}/scene", get(scene))
        .route("/run/{id}/floor.svg", get(floor))
        .route("/run/{id}/frames", get(frames))
        .route("/run/{id}/events", get(events))
        .route("/run/{id}/standing", get(standing))
        .route("/run/{id}/recording.mcap", get(recording))
        .route("/run/{id}/ws", get(socket))
        .layer(middleware::from_fn_with_state(Arc::clone(&shared), with_token));
    Router::new()
        .route("/", get(index))
        .route("/run/{id}", get(index))
        .route("/assets/{name}", get(asset))
        .route("/layout.json", get(layout))
        .route("/enter", post(enter))
        .merge(data)
        .fallback(nowhere)
        .method_not_allowed_fallback(reading_only)
        .layer(middleware::from_fn_with_state(Arc::clone(&shared), guarded))
        .with_state(shared)
}

/// JSON as an answer.
fn told(what: &Value) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], what.to_string()).into_response()
}

/// An answer that says what was wrong and what helps.
fn refused(status: StatusCode, error: &str, hint: &str) -> Response {
    (status, told(&json!({ "error": error, "hint": hint }))).into_response()
}

async fn nowhere() -> Response {
    refused(StatusCode::NOT_FOUND, "there is nothing at this address", "`/` lists the runs")
}

async fn reading_only() -> Response {
    refused(StatusCode::METHOD_NOT_ALLOWED, "viewers only read", "GET is answered; nothing here changes a run")
}

/// Looks at host and origin, and puts on every answer what keeps a browser from being misled.
async fn guarded(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    if let Err(why) = shared.rules.address(request.headers()) {
        return refused(StatusCode::FORBIDDEN, &why.to_string(), "docs/live.md says who may look");
    }
    let reader = shared.rules.reader(request.headers()).map(str::to_owned);
    let mut answer = next.run(request).await;
    let headers = answer.headers_mut();
    // A drawing has a stricter policy of its own.
    headers.entry(header::CONTENT_SECURITY_POLICY).or_insert_with(|| shared.policy.0.clone());
    let mut put = |name: header::HeaderName, value: &str| {
        if let Ok(value) = HeaderValue::from_str(value) {
            headers.insert(name, value);
        }
    };
    put(header::X_CONTENT_TYPE_OPTIONS, "nosniff");
    put(header::REFERRER_POLICY, "no-referrer");
    if let Some(origin) = reader {
        put(header::ACCESS_CONTROL_ALLOW_ORIGIN, &origin);
        put(header::VARY, "Origin");
        put(header::ACCESS_CONTROL_EXPOSE_HEADERS, "Content-Range, Accept-Ranges, Content-Length, ETag");
    }
    answer
}

/// Data is for those with the token; the page itself tells nothing.
async fn with_token(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    match shared.rules.token(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(why) => no_token(&why),
    }
}

/// Keeps a page in that brought its token once: pictures and sockets of a page cannot bring headers.
async fn enter(State(shared): State<Arc<Shared>>, headers: HeaderMap) -> Response {
    if let Err(why) = shared.rules.token(&headers) {
        return refused(StatusCode::UNAUTHORIZED, &why.to_string(), "open the address as it was printed");
    }
    let token = shared.rules.token.as_deref().unwrap_or_default();
    let secure = if shared.tls { "; Secure" } else { "" };
    let cookie = format!("{COOKIE}={token}; Path=/; HttpOnly; SameSite=Strict{secure}");
    ([(header::SET_COOKIE, cookie)], StatusCode::NO_CONTENT).into_response()
}

/// What an address asks for besides.
#[derive(Debug, Deserialize)]
struct Wish {
    /// `?records=1`: the records of every agent, for programs.
    records: Option<String>,
}

/// The page; or the socket of a program that speaks Foxglove's protocol, of the run that is named or any.
async fn index(
    State(shared): State<Arc<Shared>>,
    id: Option<Path<String>>,
    Query(wish): Query<Wish>,
    headers: HeaderMap,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Response> {
    let Ok(upgrade) = upgrade else { return Ok(asset_of("index.html")) };
    shared.rules.token(&headers).map_err(|why| no_token(&why))?;
    let offered = headers.get(header::SEC_WEBSOCKET_PROTOCOL).and_then(|value| value.to_str().ok()).unwrap_or_default();
    let Some(protocol) = fox::pick(offered) else {
        let error = format!("the subprotocol `{}` is not spoken here", offered.chars().take(80).collect::<String>());
        let hint = format!(
            "spoken here: {}; our own page speaks `{}` at /run/NAME/ws",
            fox::SUBPROTOCOLS.join(", "),
            page::PROTOCOL
        );
        return Err(refused(StatusCode::BAD_REQUEST, &error, &hint));
    };
    let name = match id {
        Some(Path(id)) => Some(id),
        None => shared.hub.any().await.map(|run| run.to_string()),
    };
    let Some(name) = name else {
        let (error, hint) = ("there is no run yet", "connect again when one has begun");
        return Err(refused(StatusCode::NOT_FOUND, error, hint));
    };
    let run = run(&shared, &name).await?;
    let (upgrade, records) = (upgrade.protocols([protocol]), wish.records.is_some());
    let upgrade = upgrade
        .max_message_size(fox_socket::MOST_BYTES)
        .max_frame_size(fox_socket::MOST_BYTES)
        .read_buffer_size(READ_BYTES);
    Ok(upgrade.on_upgrade(move |socket| fox_socket::talk(socket, run, records)))
}

fn no_token(why: &Refusal) -> Response {
    refused(StatusCode::UNAUTHORIZED, &why.to_string(), "docs/live.md says how a program brings it")
}

async fn asset(Path(name): Path<String>) -> Response {
    asset_of(&name)
}

fn asset_of(name: &str) -> Response {
    match assets::find(name) {
        Some((media, text)) => {
            ([(header::CONTENT_TYPE, media), (header::CACHE_CONTROL, "no-cache")], text).into_response()
        }
        None => refused(StatusCode::NOT_FOUND, "there is no such part of the page", "reload the page"),
    }
}

async fn layout() -> Response {
    ([(header::CONTENT_TYPE, "application/json")], assets::LAYOUT).into_response()
}

async fn runs(State(shared): State<Arc<Shared>>) -> Response {
    told(&json!({ "runs": shared.hub.list().await }))
}

/// The run of an address, or the answer that there is none.
async fn run(shared: &Shared, id: &str) -> Result<Arc<Run>, Response> {
    let name = RunId::new(id).map_err(|bad| {
        refused(
            StatusCode::BAD_REQUEST,
            &bad.to_string(),
            "run names look like scenario.planner-seed; `/runs` lists them",
        )
    })?;
    match shared.hub.run(&name).await {
        Ok(Some(run)) => Ok(run),
        Ok(None) => Err(refused(
            StatusCode::NOT_FOUND,
            &format!("there is no run `{name}`, or not yet"),
            "`/runs` lists those that are there",
        )),
        Err(why) => Err(refused(StatusCode::BAD_GATEWAY, &why, "the run may be of another version of the program")),
    }
}

async fn scene(State(shared): State<Arc<Shared>>, Path(id): Path<String>) -> Result<Response, Response> {
    let scene = run(&shared, &id).await?.scene_json();
    Ok(([(header::CONTENT_TYPE, "application/json")], scene).into_response())
}

async fn floor(State(shared): State<Arc<Shared>>, Path(id): Path<String>) -> Result<Response, Response> {
    let run = run(&shared, &id).await?;
    // A drawing cannot run anything, whatever a name in it says.
    let policy = "default-src 'none'; style-src 'unsafe-inline'";
    let svg = run.floor.svg().to_owned();
    Ok(([(header::CONTENT_TYPE, "image/svg+xml"), (header::CONTENT_SECURITY_POLICY, policy)], svg).into_response())
}

/// Which frames.
#[derive(Debug, Deserialize)]
struct Span {
    /// First tick.
    #[serde(default)]
    from: u64,
    /// Last tick; default all.
    to: Option<u64>,
    /// Every so many ticks; default each.
    every: Option<u64>,
}

async fn frames(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
    Query(span): Query<Span>,
) -> Result<Response, Response> {
    let run = run(&shared, &id).await?;
    let bytes = run.frames(span.from, span.to.unwrap_or(u64::MAX), span.every.unwrap_or(1)).await;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

async fn events(State(shared): State<Arc<Shared>>, Path(id): Path<String>) -> Result<Response, Response> {
    let events: Vec<Value> = run(&shared, &id).await?.events_json(0);
    Ok(told(&json!({ "events": events })))
}

async fn standing(State(shared): State<Arc<Shared>>, Path(id): Path<String>) -> Result<Response, Response> {
    Ok(told(&run(&shared, &id).await?.standing().json()))
}

async fn recording(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Response> {
    let run = run(&shared, &id).await?;
    let (Some((_, file)), Some(digest)) = (run.recording(), run.phase().1.recording) else {
        let (error, hint) = ("the run goes on, or its recording is not here yet", "ask again when it has ended");
        return Err(refused(StatusCode::NOT_FOUND, error, hint));
    };
    Ok(files::answer(&method, &headers, &digest.to_string(), file).map(Body::from))
}

async fn socket(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Response> {
    let run = run(&shared, &id).await?;
    let upgrade = upgrade
        .protocols([page::PROTOCOL])
        .max_message_size(page::MOST_BYTES)
        .max_frame_size(page::MOST_BYTES)
        .read_buffer_size(READ_BYTES);
    if upgrade.selected_protocol().is_none() {
        let error = format!("this socket speaks `{}`", page::PROTOCOL);
        return Err(refused(StatusCode::BAD_REQUEST, &error, "name it as the subprotocol; docs/live.md describes it"));
    }
    Ok(upgrade.on_upgrade(move |socket| page::talk(socket, run)))
}
