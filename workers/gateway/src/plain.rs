//! One text at one address, put together anew for everybody who asks: figures for programs that collect them. The same door as that of
//! the viewers, without its routes.

use std::net::SocketAddr;
use std::sync::Arc;

use async_trait::async_trait;
use axum::Router;
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse as _, Response};
use axum::routing::get;
use tokio::net::TcpListener;

use crate::guard::{Refusal, Rules};
use crate::server;

/// Connections at once: a collector has one.
const MOST: usize = 16;

/// Where the text comes from.
#[async_trait]
pub trait Source: Send + Sync {
    /// The text as of now; none where it cannot be had in time.
    async fn text(&self) -> Option<String>;
}

/// What is served.
pub struct Plain {
    /// The path, such as `/metrics`.
    pub path: &'static str,
    /// Its media type.
    pub media: &'static str,
    /// Where the text comes from.
    pub source: Arc<dyn Source>,
}

struct Shared {
    plain: Plain,
    rules: Arc<Rules>,
    /// Whether only this machine can ask. Then a page of a stranger could, too, under a name of its own.
    near: bool,
}

/// Serves the text on a listener at this address until it is dropped.
pub async fn serve(listener: TcpListener, at: SocketAddr, plain: Plain) {
    let rules = Arc::new(Rules { most: MOST, most_each: MOST, ..Rules::default() });
    let shared = Arc::new(Shared { plain, rules: Arc::clone(&rules), near: at.ip().is_loopback() });
    server::serve(listener, routes(&shared), rules, None).await;
}

fn routes(shared: &Arc<Shared>) -> Router {
    Router::new()
        .route(shared.plain.path, get(text))
        .fallback(nowhere)
        .method_not_allowed_fallback(reading_only)
        .layer(middleware::from_fn_with_state(Arc::clone(shared), guarded))
        .with_state(Arc::clone(shared))
}

/// A line for those who asked for something else.
fn refused(status: StatusCode, why: &str) -> Response {
    (status, [(header::CONTENT_TYPE, "text/plain; charset=utf-8")], format!("{why}\n")).into_response()
}

async fn text(State(shared): State<Arc<Shared>>) -> Response {
    match shared.plain.source.text().await {
        Some(text) => ([(header::CONTENT_TYPE, shared.plain.media)], text).into_response(),
        None => refused(StatusCode::SERVICE_UNAVAILABLE, "the figures could not be put together in time; ask again"),
    }
}

async fn nowhere(State(shared): State<Arc<Shared>>) -> Response {
    refused(
        StatusCode::NOT_FOUND,
        &format!("there is nothing at this address; the figures are at {}", shared.plain.path),
    )
}

async fn reading_only(State(shared): State<Arc<Shared>>) -> Response {
    refused(
        StatusCode::METHOD_NOT_ALLOWED,
        &format!("only GET {} is answered; nothing is changed here", shared.plain.path),
    )
}

/// Looks at host and origin, as for viewers. Where other machines may ask, they do so under any name.
async fn guarded(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    match shared.rules.address(request.headers()) {
        Err(Refusal::Host { .. }) if !shared.near => {}
        Err(why) => return refused(StatusCode::FORBIDDEN, &why.to_string()),
        Ok(()) => {}
    }
    let mut answer = next.run(request).await;
    answer.headers_mut().insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    answer
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
    use tokio::net::TcpStream;

    use super::*;

    struct Fixed(Option<&'static str>);

    #[async_trait]
    impl Source for Fixed {
        async fn text(&self) -> Option<String> {
            self.0.map(str::to_owned)
        }
    }

    async fn open(text: Option<&'static str>) -> SocketAddr {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let at = listener.local_addr().unwrap();
        let plain = Plain { path: "/metrics", media: "text/plain; version=0.0.4", source: Arc::new(Fixed(text)) };
        drop(tokio::spawn(serve(listener, at, plain)));
        at
    }

    /// The answer to these bytes, up to the end of the connection.
    async fn ask(at: SocketAddr, head: &str) -> String {
        let mut stream = TcpStream::connect(at).await.unwrap();
        stream.write_all(head.as_bytes()).await.unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).await.unwrap();
        answer
    }

    #[tokio::test]
    async fn the_text_is_at_its_path_and_everything_else_is_told_where_that_is() {
        let at = open(Some("a 1\n")).await;
        let got = ask(at, "GET /metrics HTTP/1.1\r\nhost: 127.0.0.1\r\nconnection: close\r\n\r\n").await;
        assert!(got.starts_with("HTTP/1.1 200 ") && got.ends_with("\r\n\r\na 1\n"), "{got}");
        assert!(got.contains("content-type: text/plain; version=0.0.4"), "{got}");
        for (head, status) in [
            ("GET / HTTP/1.1\r\nhost: 127.0.0.1\r\nconnection: close\r\n\r\n", "404"),
            ("POST /metrics HTTP/1.1\r\nhost: 127.0.0.1\r\nconnection: close\r\ncontent-length: 0\r\n\r\n", "405"),
            ("GET /metrics HTTP/1.1\r\nhost: evil.example\r\nconnection: close\r\n\r\n", "403"),
            ("nonsense\r\n\r\n", "400"),
        ] {
            let got = ask(at, head).await;
            assert!(got.starts_with(&format!("HTTP/1.1 {status} ")), "{head}: {got}");
        }
        let told = ask(at, "GET /x HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").await;
        assert!(told.ends_with("the figures are at /metrics\n"), "{told}");
    }

    #[tokio::test]
    async fn figures_that_do_not_come_in_time_are_no_empty_text() {
        let at = open(None).await;
        let got = ask(at, "GET /metrics HTTP/1.1\r\nhost: 127.0.0.1\r\nconnection: close\r\n\r\n").await;
        assert!(got.starts_with("HTTP/1.1 503 "), "{got}");
    }
}
