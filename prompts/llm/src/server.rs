//! A server of scripted answers on this machine, for the tests of this crate.

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;

/// What the client sent.
pub(crate) struct Seen {
    pub(crate) head: String,
    pub(crate) body: String,
}

/// What the server does with one request.
pub(crate) enum Reply {
    /// A whole answer: status, headers, body.
    Whole(u16, Vec<(&'static str, &'static str)>, String),
    /// An answer that claims more bytes than come before the connection closes.
    Torn(String),
    /// A number of bytes, without a length.
    Flood(usize),
    /// One byte after the other, for ever.
    Drip,
    /// An answer in parts, each after a pause, ms; then the connection closes, with or without the end that it promised.
    Parts(Vec<(u64, String)>, Close),
}

impl Reply {
    /// An answer in parts, at once.
    pub(crate) fn parts(texts: &[&str], close: Close) -> Self {
        Self::Parts(texts.iter().map(|text| (0, (*text).to_owned())).collect(), close)
    }

    pub(crate) fn new(status: u16, body: &str) -> Self {
        Self::Whole(status, Vec::new(), body.to_owned())
    }
}

/// How an answer in parts ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Close {
    /// As it should.
    Well,
    /// In the middle of what was promised.
    Early,
}

/// A running server.
pub(crate) struct Served {
    pub(crate) url: String,
    task: Option<JoinHandle<Vec<Seen>>>,
    _held: Option<TcpListener>,
}

impl Served {
    /// Answers one request like this.
    pub(crate) async fn once(status: u16, headers: &[(&'static str, &'static str)], body: &str) -> Self {
        Self::replies(vec![Reply::Whole(status, headers.to_vec(), body.to_owned())]).await
    }

    /// Answers one request after the other.
    pub(crate) async fn replies(replies: Vec<Reply>) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/v1", listener.local_addr().unwrap());
        let task = tokio::spawn(async move {
            let mut seen = Vec::new();
            for reply in replies {
                let (mut socket, _) = listener.accept().await.unwrap();
                seen.push(read(&mut socket).await);
                answer(&mut socket, reply).await;
            }
            seen
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

    /// What was sent first.
    pub(crate) async fn seen(self) -> Seen {
        self.all_seen().await.remove(0)
    }

    /// Everything that was sent.
    pub(crate) async fn all_seen(self) -> Vec<Seen> {
        self.task.unwrap().await.unwrap()
    }
}

async fn read(socket: &mut TcpStream) -> Seen {
    let mut bytes = Vec::new();
    let mut part = [0_u8; 4096];
    loop {
        let count = socket.read(&mut part).await.unwrap();
        bytes.extend_from_slice(&part[..count]);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let Some((head, body)) = text.split_once("\r\n\r\n") else { continue };
        let length =
            head.to_lowercase().lines().find_map(|line| line.strip_prefix("content-length: ").map(str::to_owned));
        if count == 0 || body.len() >= length.and_then(|n| n.parse().ok()).unwrap_or(0) {
            return Seen { head: head.to_owned(), body: body.to_owned() };
        }
    }
}

/// The client may hang up before the end of an answer that it does not want.
async fn answer(socket: &mut TcpStream, reply: Reply) {
    match reply {
        Reply::Whole(status, headers, body) => {
            let more: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
            let head =
                format!("HTTP/1.1 {status} X\r\ncontent-length: {}\r\nconnection: close\r\n{more}\r\n", body.len());
            let _sent = socket.write_all((head + &body).as_bytes()).await.is_ok();
        }
        Reply::Torn(body) => {
            let head = format!("HTTP/1.1 200 X\r\ncontent-length: {}\r\n\r\n", body.len() + 1000);
            let _sent = socket.write_all((head + &body).as_bytes()).await.is_ok();
        }
        Reply::Flood(count) => {
            let part = vec![b'x'; 1 << 20];
            let mut open = socket.write_all(b"HTTP/1.1 200 X\r\nconnection: close\r\n\r\n{\"x\": \"").await.is_ok();
            let mut sent = 0;
            while open && sent < count {
                open = socket.write_all(&part).await.is_ok();
                sent += part.len();
            }
        }
        Reply::Parts(parts, close) => {
            let head = "HTTP/1.1 200 X\r\ncontent-type: text/event-stream; charset=utf-8\r\ntransfer-encoding: chunked\r\n\r\n";
            let mut open = socket.write_all(head.as_bytes()).await.is_ok();
            for (pause, text) in parts {
                tokio::time::sleep(std::time::Duration::from_millis(pause)).await;
                let chunk = format!("{:x}\r\n{text}\r\n", text.len());
                open = open && socket.write_all(chunk.as_bytes()).await.is_ok();
            }
            if open && close == Close::Well {
                let _sent = socket.write_all(b"0\r\n\r\n").await.is_ok();
            }
        }
        Reply::Drip => {
            let mut open = socket.write_all(b"HTTP/1.1 200 X\r\nconnection: close\r\n\r\n").await.is_ok();
            while open {
                open = socket.write_all(b" ").await.is_ok();
                tokio::time::sleep(std::time::Duration::from_millis(5)).await;
            }
        }
    }
}
