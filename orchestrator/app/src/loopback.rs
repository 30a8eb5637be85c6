//! A page of this machine alone: one port of loopback, the token of its address, and what all its answers have in common.
//!
//! ```text
//! bind ─► routes ─► with_token ─► guarded ─► serve
//!            ▲          ▲             └ host and origin are ours; what the page may do
//!            └ told, refused, body    └ `Authorization: Bearer` with the token behind `#token=`
//! ```

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;

use axum::Router;
use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse as _, Response};
use serde_json::{Value, json};
use socrates_gateway::guard::Rules;
use socrates_gateway::server;
use tokio::net::TcpListener;

use crate::exit::{Code, Diagnostic};
use crate::view::new_token;

/// Connections at once: a page has a few, and so has each program that asks.
const MOST: usize = 256;

/// What is told to those who are not let in, and what the page may do.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Words {
    /// To a page or a program under another name.
    pub(crate) stranger: &'static str,
    /// To somebody without the token.
    pub(crate) token: &'static str,
    /// The policy of every answer that brings none of its own.
    pub(crate) policy: &'static str,
}

/// What opens the door, and what the others are told.
#[derive(Debug)]
pub(crate) struct Door {
    /// The rules.
    pub(crate) rules: Arc<Rules>,
    /// The words.
    pub(crate) words: Words,
}

/// A port that is taken, with its token.
#[derive(Debug)]
pub(crate) struct Loopback {
    listener: TcpListener,
    /// Where it listens.
    pub(crate) address: SocketAddr,
    /// Its token.
    pub(crate) token: String,
    /// Its rules.
    pub(crate) rules: Arc<Rules>,
}

impl Loopback {
    /// Takes a port of this machine; none for any that is free.
    ///
    /// # Errors
    /// A [`Diagnostic`] where the port is taken, or no token can be drawn.
    pub(crate) async fn bind(port: Option<u16>) -> Result<Self, Diagnostic> {
        let port = port.unwrap_or(0);
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await.map_err(|why| {
            let hint = "name another with `--port`, or leave it out for any that is free";
            Diagnostic::input(format!("cannot listen on port {port} of this machine: {why}"), hint)
        })?;
        let address = listener.local_addr();
        let address = address.map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))?;
        let token = new_token()?;
        let rules = Arc::new(Rules { token: Some(token.clone()), most: MOST, ..Rules::default() });
        Ok(Self { listener, address, token, rules })
    }

    /// The address of the page, which lets whoever has it in.
    pub(crate) fn page(&self) -> String {
        format!("http://{}/#token={}", self.address, self.token)
    }

    /// Opens it in a browser.
    pub(crate) fn open(&self) {
        let page = self.page();
        // The desktop's program may stay for as long as its window.
        drop(tokio::task::spawn_blocking(move || crate::files::open_outside(page.as_ref())));
    }

    /// Serves routes until it is dropped.
    pub(crate) async fn serve(self, routes: Router) {
        server::serve(self.listener, routes, self.rules, None).await;
    }
}

impl Door {
    /// These routes for those with the token.
    pub(crate) fn with_token<S: Clone + Send + Sync + 'static>(self: &Arc<Self>, routes: Router<S>) -> Router<S> {
        routes.layer(middleware::from_fn_with_state(Arc::clone(self), with_token))
    }

    /// These routes for programs and pages of this machine.
    pub(crate) fn guarded<S: Clone + Send + Sync + 'static>(self: &Arc<Self>, routes: Router<S>) -> Router<S> {
        routes.layer(middleware::from_fn_with_state(Arc::clone(self), guarded))
    }
}

/// Looks at host and origin: a page of a stranger in the same browser asks nothing and reads nothing.
async fn guarded(State(door): State<Arc<Door>>, request: Request, next: Next) -> Response {
    if door.rules.address(request.headers()).is_err() {
        return refused(StatusCode::FORBIDDEN, door.words.stranger, None, "forbidden");
    }
    let mut answer = next.run(request).await;
    let headers = answer.headers_mut();
    for (name, value) in [(header::X_CONTENT_TYPE_OPTIONS, "nosniff"), (header::REFERRER_POLICY, "no-referrer")] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers.entry(header::CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(door.words.policy));
    answer
}

async fn with_token(State(door): State<Arc<Door>>, request: Request, next: Next) -> Response {
    if door.rules.token(request.headers()).is_err() {
        return refused(StatusCode::UNAUTHORIZED, door.words.token, None, "no_token");
    }
    next.run(request).await
}

/// JSON as an answer.
pub(crate) fn told(what: &Value) -> Response {
    ([(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")], what.to_string())
        .into_response()
}

/// An error: what is wrong in words, the member that is wrong, and a code for programs.
pub(crate) fn refused(status: StatusCode, message: &str, param: Option<&str>, code: &str) -> Response {
    let kind = if status.is_server_error() { "server_error" } else { "invalid_request_error" };
    let error = json!({"error": {"message": message, "type": kind, "param": param, "code": code}});
    (status, told(&error)).into_response()
}

/// The bytes of a request, or the answer that there are too many.
pub(crate) fn body(bytes: Result<Bytes, BytesRejection>, most: usize) -> Result<Bytes, Response> {
    bytes.map_err(|why| {
        let message = format!("the request cannot be read ({why}); at most {most} bytes");
        refused(StatusCode::PAYLOAD_TOO_LARGE, &message, None, "too_large")
    })
}
