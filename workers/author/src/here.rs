//! Servers of language models on this machine, among which `auto` finds an author where there is no key.

use std::time::Duration;

use socrates_llm::{ChatClient, models};
use socrates_model::request::ServerKind;

use crate::llm::ask_error;
use crate::settings::{Keys, config, dialect};

/// Kinds of servers that are looked for, the preferred first.
const KINDS: [ServerKind; 4] = [ServerKind::Ollama, ServerKind::LlamaCpp, ServerKind::Vllm, ServerKind::LmStudio];
/// Time for all answers together: a server on this machine lists its models within a few milliseconds.
pub const LIMIT: Duration = Duration::from_millis(200);

/// A server that was looked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LocalServer {
    /// Its kind.
    pub kind: ServerKind,
    /// The address that was asked; empty where none was.
    pub url: String,
    /// Its first model that writes, or why it is not taken.
    pub model: Result<String, String>,
}

/// Asks for the models of each kind of server that runs on this machine, at its configured or usual address; the preferred kind
/// comes first. No other machine is asked, and a server without a list of models in time is none.
pub async fn look(keys: &Keys, limit: Duration) -> Vec<LocalServer> {
    let clients = KINDS.map(|kind| client(kind, keys));
    let asked: Vec<ChatClient> = clients.iter().flatten().cloned().collect();
    let mut lists = models::listed(&asked, limit).await.into_iter();
    let server = |(kind, client): (ServerKind, Result<ChatClient, String>)| match client {
        Ok(client) => {
            let model = first(lists.next().unwrap_or_default());
            LocalServer { kind, url: client.address().to_owned(), model }
        }
        Err(why) => LocalServer { kind, url: String::new(), model: Err(why) },
    };
    KINDS.into_iter().zip(clients).map(server).collect()
}

/// The client of a kind of server on this machine, or why that server is not asked.
fn client(kind: ServerKind, keys: &Keys) -> Result<ChatClient, String> {
    // A server lists the same models whichever is named.
    let config = config(dialect(kind), "any", keys).map_err(|why| why.message)?;
    let client = ChatClient::new(config).map_err(|error| ask_error(&error).message)?;
    if client.is_here() { Ok(client) } else { Err("its address is not on this machine and was not asked".to_owned()) }
}

/// The first model that writes.
fn first(models: Vec<String>) -> Result<String, String> {
    let why = if models.is_empty() { "no list of models came in time" } else { "its models embed, and write nothing" };
    models.into_iter().find(|model| !model.to_lowercase().contains("embed")).ok_or_else(|| why.to_owned())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use socrates_llm::Dialect;
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
    use tokio::net::TcpListener;

    use super::*;
    use crate::settings::Server;

    /// Long enough for a busy machine; nothing waits for its end where every port answers or is closed.
    const PATIENT: Duration = Duration::from_secs(60);

    /// A free port of this machine.
    async fn port() -> (TcpListener, String) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/v1", listener.local_addr().unwrap());
        (listener, url)
    }

    /// A server that answers one question with this text.
    async fn stub(body: &'static str) -> String {
        let (listener, url) = port().await;
        tokio::spawn(async move {
            let (mut socket, _) = listener.accept().await.unwrap();
            let mut seen = Vec::new();
            while !seen.ends_with(b"\r\n\r\n") {
                seen.push(socket.read_u8().await.unwrap());
            }
            assert!(seen.starts_with(b"GET /v1/models "));
            let head = format!("HTTP/1.1 200 OK\r\ncontent-length: {}\r\nconnection: close\r\n\r\n", body.len());
            socket.write_all((head + body).as_bytes()).await.unwrap();
        });
        url
    }

    /// Keys with these addresses; the other kinds of servers have an address at which nothing listens.
    async fn at(urls: &[(Dialect, &str)]) -> Keys {
        let (closed, gone) = port().await;
        drop(closed);
        let all = KINDS.map(|kind| (dialect(kind), gone.as_str()));
        let servers = all.into_iter().chain(urls.iter().copied());
        let servers = servers.map(|(dialect, url)| (dialect, Server { key: None, url: Some(url.to_owned()) }));
        Keys { servers: servers.collect::<BTreeMap<_, _>>(), ..Keys::default() }
    }

    fn found(servers: &[LocalServer]) -> Vec<(ServerKind, &str)> {
        servers.iter().filter_map(|server| Some((server.kind, server.model.as_deref().ok()?))).collect()
    }

    #[tokio::test]
    async fn a_server_of_each_kind_is_found_with_its_first_model_that_writes() {
        for kind in KINDS {
            let url = stub(r#"{"data":[{"id":"nomic-Embed-text"},{"id":"writes:7b"},{"id":"other"}]}"#).await;
            let servers = look(&at(&[(dialect(kind), &url)]).await, PATIENT).await;
            assert_eq!(found(&servers), [(kind, "writes:7b")]);
            assert!(servers.iter().any(|server| server.kind == kind && server.url == url));
        }
    }

    #[tokio::test]
    async fn the_order_of_servers_is_fixed() {
        let (first, second) = (stub(r#"{"data":[{"id":"a"}]}"#).await, stub(r#"{"data":[{"id":"b"}]}"#).await);
        let keys = at(&[(Dialect::LmStudio, &second), (Dialect::Vllm, &first)]).await;
        let servers = look(&keys, PATIENT).await;
        assert_eq!(found(&servers), [(ServerKind::Vllm, "a"), (ServerKind::LmStudio, "b")]);
        assert_eq!(servers.iter().map(|server| server.kind).collect::<Vec<_>>(), KINDS);
    }

    #[tokio::test]
    async fn what_lists_no_model_that_writes_is_no_server() {
        for body in ["words", "{}", r#"{"data":[]}"#, r#"{"data":[{"id":"text-embedding-3"}]}"#] {
            let url = stub(body).await;
            assert!(found(&look(&at(&[(Dialect::Ollama, &url)]).await, PATIENT).await).is_empty(), "{body}");
        }
        let (_listening, silent) = port().await;
        let servers = look(&at(&[(Dialect::Ollama, &silent)]).await, Duration::from_millis(1)).await;
        assert_eq!(servers[0].model, Err("no list of models came in time".to_owned()));
    }

    #[tokio::test]
    async fn only_this_machine_is_asked() {
        for url in ["https://models.example.org/v1", "http://192.0.2.1/v1", "https://127.0.0.1.example.org/v1", "?"] {
            let keys = Keys { plain_http: true, ..at(&[(Dialect::Vllm, url)]).await };
            let servers = look(&keys, PATIENT).await;
            assert!(servers[2].url.is_empty() && servers[2].model.is_err(), "{url}: {:?}", servers[2]);
        }
    }
}
