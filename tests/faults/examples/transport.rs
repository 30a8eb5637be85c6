//! `T-` and refusals: servers of language models that do not answer, on this machine.

use std::collections::BTreeMap;
use std::time::Duration;

use socrates_author::{Asking, AuthorContext, Keys, Server};
use socrates_llm::Dialect;
use socrates_model::Fault;
use socrates_model::job::Stage;
use socrates_prompts::Question;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpListener;

use super::{Examples, keep, office, question};

/// What is said of a server whose port is another one every time.
const PORT: &str = "11434";

/// An answer that a model refuses to give.
const REFUSAL: &str = r#"{"model": "m", "choices": [{"finish_reason": "stop", "message": {"role": "assistant", "content": null, "refusal": "I cannot help with that."}}], "usage": {"prompt_tokens": 1, "completion_tokens": 1}}"#;

pub(super) async fn examples() -> Examples {
    let mut all = Examples::new();
    let (request, location) = office("Drive to the exit", "A visitor comes towards the robot.");
    let question = question(&request, &location, Stage::Proposal).await;
    for (status, body) in [(429, "{}"), (503, "{}"), (401, "{}"), (200, REFUSAL)] {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let port = listener.local_addr().unwrap().port();
        let server = tokio::spawn(async move {
            while let Ok((mut socket, _)) = listener.accept().await {
                let mut head = vec![0_u8; 65_536];
                let _read = socket.read(&mut head).await;
                let answer = format!(
                    "HTTP/1.1 {status} X\r\ncontent-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n{body}",
                    body.len()
                );
                let _sent = socket.write_all(answer.as_bytes()).await;
            }
        });
        keep(&mut all, asked(&question, port).await);
        server.abort();
    }
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    // It takes the connection and never answers; then nobody is there any more.
    keep(&mut all, asked(&question, port).await);
    drop(listener);
    keep(&mut all, asked(&question, port).await);
    all
}

/// What a model at this port is refused for; the port is shown as the usual one.
async fn asked(question: &Question, port: u16) -> Vec<Fault> {
    let server = Server { key: None, url: Some(format!("http://127.0.0.1:{port}/v1")) };
    let keys = Keys {
        servers: BTreeMap::from([(Dialect::Ollama, server)]),
        silence: Some(Duration::from_millis(500)),
        ..Keys::default()
    };
    let settings = BTreeMap::from([("author".to_owned(), "ollama:m".to_owned())]);
    let refused = AuthorContext::new(keys).answer(question, &Asking { settings, attempt: 1 }).await.err();
    let shown = |fault: Fault| {
        let text = fault.message.to_string().replace(&format!(":{port}"), &format!(":{PORT}"));
        Fault { message: text.into(), ..fault }
    };
    refused.into_iter().flat_map(|refusal| refusal.faults).map(shown).collect()
}
