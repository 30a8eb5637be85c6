//! A server of one answer on this machine, for the tests of this crate.

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpListener;
use tokio::task::JoinHandle;

/// What the client sent.
pub(crate) struct Seen {
    pub(crate) head: String,
    pub(crate) body: String,
}

/// A running server.
pub(crate) struct Served {
    pub(crate) url: String,
    task: Option<JoinHandle<Seen>>,
    _held: Option<TcpListener>,
}

impl Served {
    /// Answers one request like this.
    pub(crate) async fn once(status: u16, headers: &[(&str, &str)], body: &str) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/v1", listener.local_addr().unwrap());
        let more: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
        let answer =
            format!("HTTP/1.1 {status} X\r\ncontent-length: {}\r\nconnection: close\r\n{more}\r\n{body}", body.len());
        let task = tokio::spawn(async move {
            let (mut socket, _) = listener.accept().await.unwrap();
            let mut bytes = Vec::new();
            let mut part = [0_u8; 4096];
            loop {
                let count = socket.read(&mut part).await.unwrap();
                bytes.extend_from_slice(&part[..count]);
                let text = String::from_utf8_lossy(&bytes).into_owned();
                let Some((head, body)) = text.split_once("\r\n\r\n") else { continue };
                let length = head
                    .to_lowercase()
                    .lines()
                    .find_map(|line| line.strip_prefix("content-length: ").map(str::to_owned));
                if count == 0 || body.len() >= length.and_then(|n| n.parse().ok()).unwrap_or(0) {
                    // The client may have hung up already when the body is too large for it.
                    let _sent = socket.write_all(answer.as_bytes()).await.is_ok();
                    return Seen { head: head.to_owned(), body: body.to_owned() };
                }
            }
        });
        Self { url, task: Some(task), _held: None }
    }

    /// Takes connections and never answers.
    pub(crate) async fn silent() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        Self { url: format!("http://{}/v1", listener.local_addr().unwrap()), task: None, _held: Some(listener) }
    }

    /// An address where nobody listens any more.
    pub(crate) async fn gone() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        Self { url: format!("http://{}/v1", listener.local_addr().unwrap()), task: None, _held: None }
    }

    /// What was sent.
    pub(crate) async fn seen(self) -> Seen {
        self.task.unwrap().await.unwrap()
    }
}
