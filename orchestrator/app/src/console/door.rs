//! The routes: Chat Completions for programs, and the page for a person.

use std::sync::Arc;

use axum::Router;
use axum::body::Bytes;
use axum::extract::rejection::{BytesRejection, PathRejection};
use axum::extract::{DefaultBodyLimit, Path, State};
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use axum::routing::{get, post};
use serde::Deserialize;
use serde_json::{Value, json};
use socrates_gateway::guard::Rules;
use socrates_prompts::{Misfit, misfits};
use tokio::time::Instant;

use super::desk::{Desk, DeskError, Said};
use super::reply::Waiting;
use super::wire;
use crate::loopback::{self, body, refused, told};

/// Model that is listed and that the printed lines name; any other name is taken as well.
pub(super) const NAME: &str = "person";
/// Bytes of a question, at most: prompts of ours have some hundred thousand, most of it pictures.
pub(super) const QUESTION_BYTES: usize = 16 << 20;
/// Bytes of an answer, at most.
pub(super) const ANSWER_BYTES: usize = 2 << 20;
/// Faults of an answer that are shown.
const FAULTS: usize = 12;
/// What a stranger is told, and what the page may do: nothing from elsewhere, no script but ours.
const WORDS: loopback::Words = loopback::Words {
    stranger: "only programs of this machine and the page of this console may ask here",
    token: "the token is missing or wrong; open the address that `socrates author console` printed",
    policy: "default-src 'none'; connect-src 'self'; img-src data:; style-src 'self'; script-src 'self'; base-uri 'none'; \
             form-action 'none'; frame-ancestors 'none'",
};

/// What all answers share.
pub(super) struct Shared {
    pub(super) desk: Arc<Desk>,
    pub(super) rules: Arc<Rules>,
}

/// The routes of a console.
pub(super) fn routes(shared: Arc<Shared>) -> Router {
    let door = Arc::new(loopback::Door { rules: Arc::clone(&shared.rules), words: WORDS });
    let of_page = Router::new()
        .route("/questions", get(list))
        .route("/questions/{number}", get(one))
        .route("/questions/{number}/check", post(check))
        .route("/questions/{number}/answer", post(answer))
        .route("/questions/{number}/refusal", post(refuse))
        .layer(DefaultBodyLimit::max(ANSWER_BYTES));
    let all = Router::new()
        .route("/", get(page))
        .route("/console.css", get(style))
        .route("/console.js", get(script))
        .route("/v1/models", get(models))
        .route("/v1/chat/completions", post(complete).layer(DefaultBodyLimit::max(QUESTION_BYTES)))
        .merge(door.with_token(of_page))
        .fallback(nowhere)
        .method_not_allowed_fallback(otherwise);
    door.guarded(all).with_state(shared)
}

async fn nowhere() -> Response {
    let message = "there is nothing at this address; programs ask at /v1/chat/completions, people at /";
    refused(StatusCode::NOT_FOUND, message, None, "unknown_url")
}

async fn otherwise(method: Method) -> Response {
    let message =
        format!("this address does not answer {method}; /v1/chat/completions takes POST, /v1/models takes GET");
    refused(StatusCode::METHOD_NOT_ALLOWED, &message, None, "method_not_allowed")
}

fn part(media: &'static str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, media), (header::CACHE_CONTROL, "no-cache")], text).into_response()
}

async fn page() -> Response {
    part("text/html; charset=utf-8", include_str!("web/console.html"))
}

async fn style() -> Response {
    part("text/css; charset=utf-8", include_str!("web/console.css"))
}

async fn script() -> Response {
    part("text/javascript; charset=utf-8", include_str!("web/console.js"))
}

async fn models() -> Response {
    told(&json!({"object": "list", "data": [{"id": NAME, "object": "model", "created": 0, "owned_by": "socrates"}]}))
}

async fn complete(
    State(shared): State<Arc<Shared>>,
    bytes: Result<Bytes, BytesRejection>,
) -> Result<Response, Response> {
    let bytes = body(bytes, QUESTION_BYTES)?;
    let (asked, wish) = wire::read(&bytes)
        .map_err(|why| refused(StatusCode::BAD_REQUEST, &why.to_string(), Some(&why.param), "invalid_value"))?;
    let model = asked.model.clone();
    let (number, answer) = shared.desk.put(asked, Instant::now()).map_err(|why| {
        let mut busy = refused(StatusCode::TOO_MANY_REQUESTS, &why.to_string(), None, "rate_limit_exceeded");
        busy.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from_static("30"));
        busy
    })?;
    let waiting = Waiting::new(Arc::clone(&shared.desk), number, model, answer);
    if wish.stream {
        let kind = [(header::CONTENT_TYPE, "text/event-stream"), (header::CACHE_CONTROL, "no-store")];
        return Ok((kind, waiting.parts(wish)).into_response());
    }
    match waiting.whole().await {
        Some(whole) => Ok(told(&whole)),
        None => Err(refused(StatusCode::SERVICE_UNAVAILABLE, "the console ends", None, "server_error")),
    }
}

async fn list(State(shared): State<Arc<Shared>>) -> Response {
    told(&shared.desk.list(Instant::now()))
}

/// The number of an address.
fn number(path: Result<Path<u64>, PathRejection>) -> Result<u64, Response> {
    let unknown = |_why| refused(StatusCode::NOT_FOUND, "questions have numbers from 1 on", None, "unknown_question");
    path.map(|Path(number)| number).map_err(unknown)
}

fn of_desk(why: DeskError) -> Response {
    let status = match why {
        DeskError::Unknown(_) => StatusCode::NOT_FOUND,
        DeskError::Over(_) => StatusCode::CONFLICT,
        DeskError::Full => StatusCode::TOO_MANY_REQUESTS,
    };
    refused(status, &why.to_string(), None, "question")
}

async fn one(State(shared): State<Arc<Shared>>, path: Result<Path<u64>, PathRejection>) -> Result<Response, Response> {
    Ok(told(&shared.desk.one(number(path)?, Instant::now()).map_err(of_desk)?))
}

/// What the page sends.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Typed {
    /// The answer, or the reason of a refusal.
    text: String,
    /// Whether an answer with faults is sent all the same.
    #[serde(default)]
    anyway: bool,
}

fn typed(bytes: Result<Bytes, BytesRejection>) -> Result<Typed, Response> {
    let bytes = body(bytes, ANSWER_BYTES)?;
    serde_json::from_slice(&bytes).map_err(|why| {
        let message = format!("the page sent what cannot be read ({why}); load it anew");
        refused(StatusCode::BAD_REQUEST, &message, None, "invalid_value")
    })
}

/// What is wrong with an answer, and whether a part of it would be right.
fn checked(schema: Option<&Value>, text: &str) -> Value {
    let Some(schema) = schema else {
        let empty = Misfit { at: String::new(), message: "the answer is empty".to_owned() };
        let faults: Vec<Misfit> = if text.trim().is_empty() { vec![empty] } else { Vec::new() };
        return json!({"faults": faults, "inner": null});
    };
    match serde_json::from_str::<Value>(text) {
        Ok(answer) => json!({"faults": misfits(schema, &answer, FAULTS), "inner": null}),
        Err(why) => {
            let fault = if text.trim().is_empty() {
                Misfit { at: String::new(), message: "the answer is empty".to_owned() }
            } else {
                let at = format!("line {}, column {}", why.line(), why.column());
                Misfit { at, message: format!("it is no JSON: {why}") }
            };
            json!({"faults": [fault], "inner": inner(text)})
        }
    }
}

/// The JSON object inside a text that was pasted with words around it, where there is one.
fn inner(text: &str) -> Option<String> {
    let inner = socrates_prompts::json::core(text).filter(|inner| inner.len() < text.trim().len())?;
    serde_json::from_str::<Value>(inner).ok().map(|_value| inner.to_owned())
}

async fn check(
    State(shared): State<Arc<Shared>>,
    path: Result<Path<u64>, PathRejection>,
    bytes: Result<Bytes, BytesRejection>,
) -> Result<Response, Response> {
    let schema = shared.desk.schema(number(path)?).map_err(of_desk)?;
    Ok(told(&checked(schema.as_ref(), &typed(bytes)?.text)))
}

async fn answer(
    State(shared): State<Arc<Shared>>,
    path: Result<Path<u64>, PathRejection>,
    bytes: Result<Bytes, BytesRejection>,
) -> Result<Response, Response> {
    let (number, typed) = (number(path)?, typed(bytes)?);
    let checked = checked(shared.desk.schema(number).map_err(of_desk)?.as_ref(), &typed.text);
    let has_faults = checked.get("faults").and_then(Value::as_array).is_some_and(|faults| !faults.is_empty());
    if has_faults && !typed.anyway {
        return Ok((StatusCode::UNPROCESSABLE_ENTITY, told(&checked)).into_response());
    }
    shared.desk.settle(number, Said::Answer(typed.text), Instant::now()).map_err(of_desk)?;
    Ok(told(&json!({"sent": number})))
}

async fn refuse(
    State(shared): State<Arc<Shared>>,
    path: Result<Path<u64>, PathRejection>,
    bytes: Result<Bytes, BytesRejection>,
) -> Result<Response, Response> {
    let (number, typed) = (number(path)?, typed(bytes)?);
    let why = Some(typed.text.trim().to_owned()).filter(|why| !why.is_empty());
    let why = why.unwrap_or_else(|| "a person could not answer".to_owned());
    shared.desk.settle(number, Said::Refusal(why), Instant::now()).map_err(of_desk)?;
    Ok(told(&json!({"sent": number})))
}

#[cfg(test)]
#[path = "door_tests.rs"]
mod tests;
