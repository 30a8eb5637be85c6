//! The door of the console, asked by bytes as any program would.

use std::net::SocketAddr;
use std::sync::Arc;

use serde_json::{Value, json};
use socrates_gateway::guard::Rules;
use socrates_gateway::server;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::Instant;

use super::{ANSWER_BYTES, QUESTION_BYTES, Shared, checked, inner, routes};
use crate::console::desk::Desk;

const TOKEN: &str = "0123456789abcdef0123456789abcdef";

async fn open() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let at = listener.local_addr().unwrap();
    let rules = Arc::new(Rules { token: Some(TOKEN.to_owned()), ..Rules::default() });
    let (desk, news) = Desk::new(Instant::now());
    let shared = Arc::new(Shared { desk, rules: Arc::clone(&rules) });
    drop(tokio::spawn(async move {
        let _kept = news;
        server::serve(listener, routes(shared), rules, None).await;
    }));
    at
}

/// Status and body of the answer to a request with these further lines of its head.
async fn asked(at: SocketAddr, line: &str, head: &str, body: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(at).await.unwrap();
    let length = body.len();
    let text =
        format!("{line} HTTP/1.1\r\nhost: {at}\r\nconnection: close\r\ncontent-length: {length}\r\n{head}\r\n{body}");
    // One that is too long may be refused before it is read.
    drop(stream.write_all(text.as_bytes()).await);
    let mut answer = Vec::new();
    drop(stream.read_to_end(&mut answer).await);
    let answer = String::from_utf8_lossy(&answer).into_owned();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
    (head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0), body.to_owned())
}

/// What the page asks.
async fn page(at: SocketAddr, line: &str, body: &str) -> (u16, Value) {
    let (status, body) =
        asked(at, line, &format!("authorization: Bearer {TOKEN}\r\norigin: http://{at}\r\n"), body).await;
    (status, serde_json::from_str(&body).unwrap_or_else(|why| panic!("{line}: {why}: {body}")))
}

fn question(stream: bool) -> String {
    let schema = json!({"type": "object", "properties": {"n": {"type": "number", "minimum": 1}}, "required": ["n"]});
    json!({"model": "anna", "stream": stream, "messages": [{"role": "user", "content": "How many?"}],
        "response_format": {"type": "json_schema", "json_schema": {"name": "count", "schema": schema}}})
    .to_string()
}

/// Waits until the page sees this many questions that wait.
async fn waits(at: SocketAddr, count: usize) {
    for _ in 0..10_000 {
        let (_, list) = page(at, "GET /questions", "").await;
        if list["questions"].as_array().unwrap().iter().filter(|one| one["state"] == "waits").count() == count {
            return;
        }
        tokio::task::yield_now().await;
    }
    panic!("no {count} questions wait");
}

#[tokio::test]
async fn a_question_waits_is_checked_and_answered_as_a_whole_and_in_parts() {
    let at = open().await;
    for stream in [false, true] {
        let program = tokio::spawn(async move { asked(at, "POST /v1/chat/completions", "", &question(stream)).await });
        waits(at, 1).await;
        let number = if stream { 2 } else { 1 };
        let (_, one) = page(at, &format!("GET /questions/{number}"), "").await;
        assert_eq!(
            (&one["form"], &one["model"], &one["turns"][0]["text"]),
            (&json!("count"), &json!("anna"), &json!("How many?"))
        );
        assert!(one["schema"].as_str().unwrap().contains("\"minimum\":1"), "{one}");
        let (status, found) = page(at, &format!("POST /questions/{number}/check"), r#"{"text": "{\"n\": 0}"}"#).await;
        assert_eq!((status, &found["faults"][0]["at"]), (200, &json!("n")));
        // What has faults goes only where a person insists.
        let (status, found) = page(at, &format!("POST /questions/{number}/answer"), r#"{"text": "{\"n\": 0}"}"#).await;
        assert_eq!((status, found["faults"].as_array().unwrap().len()), (422, 1));
        let sent =
            page(at, &format!("POST /questions/{number}/answer"), r#"{"text": "{\"n\": 0}", "anyway": true}"#).await;
        assert_eq!(sent, (200, json!({ "sent": number })));
        let (status, answer) = program.await.unwrap();
        assert_eq!(status, 200, "{answer}");
        if stream {
            assert!(answer.contains("\"content\":\"{\\\"n\\\": 0}\"") && answer.contains("data: [DONE]"), "{answer}");
        } else {
            let answer: Value = serde_json::from_str(&answer).unwrap();
            assert_eq!(answer["choices"][0]["message"]["content"], "{\"n\": 0}");
        }
        let (status, told) = page(at, &format!("POST /questions/{number}/answer"), r#"{"text": "{\"n\": 2}"}"#).await;
        assert_eq!(status, 409, "{told}");
    }
}

#[tokio::test]
async fn an_answer_that_keeps_to_its_form_goes_at_once() {
    let at = open().await;
    let program = tokio::spawn(async move { asked(at, "POST /v1/chat/completions", "", &question(false)).await });
    waits(at, 1).await;
    let sent = page(at, "POST /questions/1/answer", r#"{"text": " {\"n\": 3}\n"}"#).await;
    assert_eq!(sent, (200, json!({"sent": 1})));
    let answer: Value = serde_json::from_str(&program.await.unwrap().1).unwrap();
    // As it was typed.
    assert_eq!(answer["choices"][0]["message"]["content"], " {\"n\": 3}\n");
}

#[tokio::test]
async fn a_person_may_refuse_and_a_program_may_leave() {
    let at = open().await;
    let program = tokio::spawn(async move { asked(at, "POST /v1/chat/completions", "", &question(false)).await });
    waits(at, 1).await;
    page(at, "POST /questions/1/refusal", r#"{"text": "it makes no sense"}"#).await;
    let answer: Value = serde_json::from_str(&program.await.unwrap().1).unwrap();
    assert_eq!(answer["choices"][0]["message"]["refusal"], "it makes no sense");
    for stream in [false, true] {
        let leaves = tokio::spawn(async move { asked(at, "POST /v1/chat/completions", "", &question(stream)).await });
        waits(at, 1).await;
        leaves.abort();
        waits(at, 0).await;
    }
    let (_, list) = page(at, "GET /questions", "").await;
    let states: Vec<&str> =
        list["questions"].as_array().unwrap().iter().map(|one| one["state"].as_str().unwrap()).collect();
    assert_eq!(states, ["refused", "left", "left"]);
}

#[tokio::test]
async fn strangers_are_kept_out_and_every_bad_request_is_told_why() {
    let at = open().await;
    let wrong = "authorization: Bearer 0123456789abcdef0123456789abcdee\r\n";
    for (line, head, body, wanted) in [
        ("GET /questions", "", "", 401),
        ("GET /questions", wrong, "", 401),
        ("POST /questions/1/answer", wrong, "{}", 401),
        ("POST /v1/chat/completions", "origin: https://evil.example\r\n", "{}", 403),
        ("POST /v1/chat/completions", "origin: null\r\n", "{}", 403),
        ("GET /v1/models", "", "", 200),
        ("GET /", "", "", 200),
        ("GET /console.js", "", "", 200),
        ("GET /v1/embeddings", "", "", 404),
        ("GET /v1/chat/completions", "", "", 405),
        ("POST /v1/chat/completions", "", "{", 400),
        ("POST /v1/chat/completions", "", r#"{"model": "m", "messages": []}"#, 400),
    ] {
        let (status, told) = asked(at, line, head, body).await;
        assert_eq!(status, wanted, "{line}: {told}");
        if status >= 400 {
            let told: Value = serde_json::from_str(&told).unwrap_or_else(|why| panic!("{line}: {why}: {told}"));
            assert!(told["error"]["message"].as_str().unwrap().len() > 10, "{told}");
        }
    }
    let (status, told) = page(at, "GET /questions/7", "").await;
    assert_eq!((status, told["error"]["message"].as_str().unwrap()), (404, "there is no question 7, or no longer"));
    assert_eq!(page(at, "GET /questions/x", "").await.0, 404);
    assert_eq!(page(at, "POST /questions/1/check", "{\"words\": 1}").await.0, 404);
    let (status, _) = asked(at, "POST /v1/chat/completions", "", &"x".repeat(QUESTION_BYTES + 1)).await;
    assert!(status == 413 || status == 0, "{status}");
    let long = json!({"text": "x".repeat(ANSWER_BYTES)}).to_string();
    let (status, _) = asked(at, "POST /questions/1/answer", &format!("authorization: Bearer {TOKEN}\r\n"), &long).await;
    assert!(status == 404 || status == 413 || status == 0, "{status}");
}

#[test]
fn an_answer_with_words_around_it_is_told_what_it_holds() {
    let schema = json!({"type": "object"});
    let found = checked(Some(&schema), "Here it is:\n```json\n{\"a\": 1}\n```");
    assert_eq!((&found["faults"][0]["at"], &found["inner"]), (&json!("line 1, column 1"), &json!("{\"a\": 1}")));
    assert_eq!(inner("{\"a\": 1}"), None);
    assert_eq!(checked(Some(&schema), " ")["faults"][0]["message"], "the answer is empty");
    assert_eq!(checked(None, "words")["faults"], json!([]));
    assert_eq!(checked(Some(&schema), "{}")["faults"], json!([]));
}
