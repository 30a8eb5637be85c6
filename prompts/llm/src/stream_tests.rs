//! Answers that come in parts, slowly, broken or not at all, and what is left out of a question that a server refuses.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::{Value, json};

use crate::chat::{ChatAnswer, ChatRequest, Detail, Finish, Speaker, Turn};
use crate::client::{ChatClient, ClientConfig};
use crate::dialect::{Dialect, Learned, Rung};
use crate::error::ChatError;
use crate::key::ApiKey;
use crate::listener::Listener;
use crate::server::{Close, Reply, Served};

fn request(png: Option<Vec<u8>>) -> ChatRequest {
    ChatRequest {
        turns: vec![Turn { speaker: Speaker::User, text: "Say yes.".into(), png }],
        form: "answer".into(),
        schema: Some(json!({"type": "object"})),
        grammar: None,
        seed: None,
        temperature: None,
        max_tokens: 100,
        detail: Detail::Low,
    }
}

fn client(served: &Served, dialect: Dialect, change: impl FnOnce(&mut ClientConfig)) -> ChatClient {
    let mut config = ClientConfig::new(dialect, &served.url, ApiKey::new("sk-very-secret"), "small");
    change(&mut config);
    ChatClient::new(config).unwrap()
}

/// A server that sends these events, and what a client makes of them.
async fn streamed(dialect: Dialect, texts: &[&str], close: Close) -> Result<ChatAnswer, ChatError> {
    let served = Served::replies(vec![Reply::parts(texts, close)]).await;
    client(&served, dialect, |config| config.rung = Some(Rung::Schema)).ask(&request(None)).await
}

fn event(data: &Value) -> String {
    format!("data: {data}\n\n")
}

fn delta(text: &str) -> String {
    event(&json!({"model": "small-1", "choices": [{"index": 0, "delta": {"content": text}, "finish_reason": null}]}))
}

fn end(finish: &str) -> String {
    event(&json!({"choices": [{"index": 0, "delta": {}, "finish_reason": finish}]}))
}

#[tokio::test]
async fn chat_completions_in_parts_are_the_same_answer_and_are_heard_while_they_come() {
    let usage = event(&json!({"choices": [], "usage": {"prompt_tokens": 12, "completion_tokens": 7,
        "prompt_tokens_details": {"cached_tokens": 8}, "completion_tokens_details": {"reasoning_tokens": 4}}}));
    let thought = event(&json!({"choices": [{"index": 0, "delta": {"reasoning_content": "hm"}}]}));
    let texts =
        [": working\n\n", &thought, &delta("{\"yes\":"), &delta(" \"ü\"}"), &end("stop"), &usage, "data: [DONE]\n\n"];
    let parts = texts.iter().map(|text| (3, (*text).to_owned())).collect();
    let served = Served::replies(vec![Reply::Parts(parts, Close::Well)]).await;
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hears = Arc::clone(&heard);
    let listener = Listener::new(move |characters| hears.lock().unwrap().push(characters));
    let asked = client(&served, Dialect::Vllm, |config| config.listener = listener);
    let answer = asked.ask(&request(None)).await.unwrap();
    assert_eq!((answer.text.as_str(), answer.finish, answer.tokens), ("{\"yes\": \"ü\"}", Finish::Stop, (12, 7)));
    assert_eq!((answer.cached, answer.thought, answer.model.as_str()), (8, 4, "small-1"));
    let heard = heard.lock().unwrap().clone();
    assert!(heard.first() == Some(&0) && heard.contains(&2) && heard.last() == Some(&14), "{heard:?}");
    assert!(heard.is_sorted(), "{heard:?}");
    let body: Value = serde_json::from_str(&served.seen().await.body).unwrap();
    assert_eq!((&body["stream"], &body["stream_options"]["include_usage"]), (&json!(true), &json!(true)));
}

#[tokio::test]
async fn every_format_in_parts_is_read_like_the_whole() {
    let text = |text: &str| event(&json!({"type": "response.output_text.delta", "delta": text}));
    let whole = json!({"model": "r", "status": "completed", "output": [{"type": "message",
        "content": [{"type": "output_text", "text": "{\"n\":1}"}]}], "usage": {"input_tokens": 3, "output_tokens": 2}});
    let last =
        format!("event: response.completed\n{}", event(&json!({"type": "response.completed", "response": whole})));
    let responses = streamed(Dialect::Responses, &[&text("{\"n\""), &text(":1}"), &last], Close::Well).await.unwrap();
    let messages = [
        event(&json!({"type": "message_start", "message": {"model": "c", "content": [], "usage": {"input_tokens": 1,
            "cache_read_input_tokens": 2, "output_tokens": 1}}})),
        event(
            &json!({"type": "content_block_start", "index": 0, "content_block": {"type": "thinking", "thinking": ""}}),
        ),
        event(
            &json!({"type": "content_block_delta", "index": 0, "delta": {"type": "thinking_delta", "thinking": "hm"}}),
        ),
        event(&json!({"type": "content_block_stop", "index": 0})),
        event(&json!({"type": "content_block_start", "index": 1, "content_block": {"type": "text", "text": ""}})),
        event(&json!({"type": "ping"})),
        event(&json!({"type": "content_block_delta", "index": 1, "delta": {"type": "text_delta", "text": "{\"n\""}})),
        event(&json!({"type": "content_block_delta", "index": 1, "delta": {"type": "text_delta", "text": ":1}"}})),
        event(&json!({"type": "message_delta", "delta": {"stop_reason": "end_turn"}, "usage": {"output_tokens": 2}})),
        event(&json!({"type": "message_stop"})),
    ];
    let messages: Vec<&str> = messages.iter().map(String::as_str).collect();
    let messages = streamed(Dialect::Anthropic, &messages, Close::Well).await.unwrap();
    let piece = |text: &str, thought: bool| json!({"content": {"parts": [{"text": text, "thought": thought}]}});
    let mut ended = piece(":1}", false);
    ended["finishReason"] = json!("STOP");
    let generate = [
        event(&json!({"candidates": [piece("hm", true)]})),
        event(&json!({"candidates": [piece("{\"n\"", false)], "modelVersion": "g"})),
        event(&json!({"candidates": [ended], "usageMetadata": {"promptTokenCount": 3, "candidatesTokenCount": 2}})),
    ];
    let generate: Vec<&str> = generate.iter().map(String::as_str).collect();
    let generate = streamed(Dialect::Gemini, &generate, Close::Well).await.unwrap();
    for (answer, model) in [(responses, "r"), (messages, "c"), (generate, "g")] {
        assert_eq!((answer.text.as_str(), answer.tokens), ("{\"n\":1}", (3, 2)), "{model}");
        assert_eq!((answer.model.as_str(), answer.finish, answer.estimated), (model, Finish::Stop, false));
    }
}

#[tokio::test]
async fn a_tool_whose_input_comes_in_parts_is_the_answer() {
    let events = [
        event(&json!({"type": "message_start", "message": {"model": "c"}})),
        event(
            &json!({"type": "content_block_start", "index": 0, "content_block": {"type": "tool_use", "name": "answer", "input": {}}}),
        ),
        event(
            &json!({"type": "content_block_delta", "index": 0, "delta": {"type": "input_json_delta", "partial_json": "{\"n\""}}),
        ),
        event(
            &json!({"type": "content_block_delta", "index": 0, "delta": {"type": "input_json_delta", "partial_json": ": 2}"}}),
        ),
        event(&json!({"type": "message_delta", "delta": {"stop_reason": "tool_use"}})),
        event(&json!({"type": "message_stop"})),
    ];
    let texts: Vec<&str> = events.iter().map(String::as_str).collect();
    let served = Served::replies(vec![Reply::parts(&texts, Close::Well)]).await;
    let by_tool = client(&served, Dialect::Anthropic, |config| config.rung = Some(Rung::Tool));
    assert_eq!(by_tool.ask(&request(None)).await.unwrap().text, "{\"n\":2}");
}

#[tokio::test]
async fn refusals_and_cuts_in_parts_are_told_apart() {
    let no = event(&json!({"choices": [{"delta": {"refusal": "I will not"}, "finish_reason": "stop"}]}));
    let told = streamed(Dialect::OpenAi, &[&no], Close::Well).await;
    assert_eq!(told, Err(ChatError::Refused { why: "I will not".into() }));
    let cut = streamed(Dialect::OpenAi, &[&delta("{\"ye"), &end("length")], Close::Well).await.unwrap();
    assert_eq!((cut.text.as_str(), cut.finish), ("{\"ye", Finish::Cut));
    let blocked = event(&json!({"promptFeedback": {"blockReason": "SAFETY"}}));
    assert!(matches!(streamed(Dialect::Gemini, &[&blocked], Close::Well).await, Err(ChatError::Refused { .. })));
    let failed = event(&json!({"type": "response.failed", "response": {"status": "failed", "output": [],
        "error": {"code": "server_error", "message": "oh"}}}));
    assert!(matches!(streamed(Dialect::Responses, &[&failed], Close::Well).await, Err(ChatError::Server { .. })));
}

#[tokio::test]
async fn a_stream_that_breaks_is_named_by_how_it_broke() {
    let chat = async |texts: &[&str], close| streamed(Dialect::Vllm, texts, close).await;
    let torn = chat(&[&delta("{\"yes")], Close::Early).await.unwrap_err();
    assert!(matches!(torn, ChatError::Broken { characters: 5, .. }), "{torn}");
    let early = chat(&[&delta("{\"yes")], Close::Well).await.unwrap_err().to_string();
    assert_eq!(early, "the answer broke off after 5 characters: the stream ended without its last part");
    let junk = chat(&[&delta("{"), "data: {\"choices\": [\n\n"], Close::Well).await.unwrap_err().to_string();
    assert!(junk.contains("event 2 of the stream is no JSON"), "{junk}");
    let page = chat(&["<html>sk-very-secret</html>\n"], Close::Well).await.unwrap_err().to_string();
    assert!(page.contains("line 1") && page.contains("<html>***"), "{page}");
    let empty = chat(&[], Close::Well).await;
    assert!(matches!(&empty, Err(ChatError::Unreadable { why }) if why.contains("empty")), "{empty:?}");
    for (error, status) in [
        (json!({"error": {"message": "slow", "type": "rate_limit_error"}}), 429),
        (json!({"type": "error", "error": {"message": "busy", "type": "overloaded_error"}}), 529),
    ] {
        let told = chat(&[&delta("{"), &event(&error)], Close::Well).await;
        assert!(matches!(&told, Err(ChatError::SlowDown { status: found, .. }) if *found == status), "{told:?}");
    }
    let spoiled = chat(&[&event(&json!({"error": {"message": "boom", "code": 502}}))], Close::Well).await;
    assert!(matches!(spoiled, Err(ChatError::Server { status: 502, .. })), "{spoiled:?}");
}

#[tokio::test]
async fn an_answer_in_parts_has_the_same_cap_and_parts_have_one_of_their_own() {
    let large = async |texts: &[&str]| {
        let served = Served::replies(vec![Reply::parts(texts, Close::Well)]).await;
        client(&served, Dialect::Vllm, |config| config.max_bytes = 300).ask(&request(None)).await
    };
    let long = delta(&"x".repeat(100));
    assert_eq!(large(&[&long, &long, &long, &long]).await, Err(ChatError::TooLarge { most: 300 }));
    assert_eq!(large(&[&delta(&"x".repeat(400))]).await, Err(ChatError::TooLarge { most: 300 }));
    let life = ": alive\n".repeat(3_000);
    assert_eq!(large(&[&life]).await, Err(ChatError::TooLarge { most: 300 * 64 }));
}

#[tokio::test]
async fn a_slow_answer_comes_through_and_a_silent_server_does_not() {
    let slow: Vec<(u64, String)> = (0..12).map(|_| (40, delta("x"))).chain([(40, end("stop"))]).collect();
    let ask = async |silence: u64, longest: u64| {
        let served = Served::replies(vec![Reply::Parts(slow.clone(), Close::Well)]).await;
        let limits = |config: &mut ClientConfig| {
            config.silence = Duration::from_millis(silence);
            config.longest = Duration::from_millis(longest);
        };
        client(&served, Dialect::Vllm, limits).ask(&request(None)).await
    };
    // Half a second in all, of which the server is never silent for long.
    assert_eq!(ask(5_000, 60_000).await.unwrap().text, "x".repeat(12));
    assert_eq!(ask(5_000, 200).await, Err(ChatError::Late { limit_ms: 200 }));
    assert_eq!(ask(10, 60_000).await, Err(ChatError::Timeout { limit_ms: 10 }));
    // One that says nothing before its whole answer has the same time.
    let late = vec![(150, delta("{}")), (0, end("stop"))];
    let served = Served::replies(vec![Reply::Parts(late, Close::Well)]).await;
    let patient = client(&served, Dialect::Vllm, |config| config.silence = Duration::from_secs(20));
    assert_eq!(patient.ask(&request(None)).await.unwrap().text, "{}");
}

fn completion(content: &str) -> Reply {
    Reply::new(200, &json!({"choices": [{"message": {"content": content}, "finish_reason": "stop"}]}).to_string())
}

fn says(status: u16, error: Value) -> Reply {
    Reply::new(status, &json!({ "error": error }).to_string())
}

#[tokio::test]
async fn a_server_that_refuses_parts_is_asked_for_the_whole_and_remembered() {
    let no = json!({"message": "Your organization must be verified to stream this model.", "param": "stream",
        "code": "unsupported_value"});
    let served = Served::replies(vec![says(400, no), completion("{}"), completion("{}")]).await;
    let asked = client(&served, Dialect::OpenAi, |_| {});
    let first = asked.ask(&request(None)).await.unwrap();
    assert_eq!(first.rung, Some(Rung::Schema), "the form was not refused");
    assert!(first.steps[0].contains("in one piece") && first.steps[0].contains("verified"), "{:?}", first.steps);
    assert!(asked.ask(&request(None)).await.unwrap().steps.is_empty());
    let streams: Vec<bool> = served.all_seen().await.iter().map(|seen| seen.body.contains("\"stream\":true")).collect();
    assert_eq!(streams, [true, false, false]);
}

#[tokio::test]
async fn a_server_that_does_not_know_of_parts_may_answer_as_a_whole() {
    let served = Served::replies(vec![completion("{\"a\": 1}")]).await;
    assert_eq!(client(&served, Dialect::Vllm, |_| {}).ask(&request(None)).await.unwrap().text, "{\"a\": 1}");
    let served = Served::replies(vec![completion("{}")]).await;
    client(&served, Dialect::Vllm, |config| config.stream = false).ask(&request(None)).await.unwrap();
    assert!(!served.seen().await.body.contains("\"stream\""));
}

#[tokio::test]
async fn a_picture_that_is_refused_is_left_out_and_that_is_said() {
    let words = [
        (400, json!({"message": "small is not a multimodal model"})),
        (400, json!({"message": "Failed to deserialize the JSON body: unknown variant `image_url`, expected `text`"})),
        (404, json!({"message": "No endpoints found that support image input"})),
        (500, json!({"message": "image input is not supported - hint: you may need to provide the mmproj"})),
        (400, json!({"message": "not one of the allowed values", "param": "input[0].content[1].image_url"})),
    ];
    for (status, error) in words {
        let served = Served::replies(vec![says(status, error.clone()), completion("{}")]).await;
        let learned = Learned::default();
        let asked = client(&served, Dialect::Vllm, |config| config.learned = learned.clone());
        let answer = asked.ask(&request(Some(vec![1, 2, 3]))).await.unwrap();
        assert!(answer.without_picture && answer.rung == Some(Rung::Schema), "{error}: {answer:?}");
        assert!(answer.steps[0].contains("without its picture"), "{:?}", answer.steps);
        let seen = served.all_seen().await;
        assert!(seen[0].body.contains("image_url") && !seen[1].body.contains("image_url"), "{error}");
    }
    // The next question brings none, and that is said of it as well.
    let served =
        Served::replies(vec![says(400, json!({"message": "no vision here"})), completion("{}"), completion("{}")])
            .await;
    let asked = client(&served, Dialect::Vllm, |_| {});
    asked.ask(&request(Some(vec![1]))).await.unwrap();
    let next = asked.ask(&request(Some(vec![2]))).await.unwrap();
    assert!(next.without_picture && next.steps[0].contains("refused before"), "{:?}", next.steps);
}

#[tokio::test]
async fn what_was_not_sent_is_not_left_out() {
    let error = json!({"message": "upstream failed: image too large"});
    for dialect in [Dialect::OpenAi, Dialect::Responses] {
        // A vendor's own server, as far as its name tells, which never is asked here.
        let config = ClientConfig::new(dialect, "https://api.example.org/v1", ApiKey::new(""), "small");
        let learned = config.learned.of("any");
        assert!(learned.streams && learned.pictures && learned.rung.is_none());
    }
    // A local server that speaks of a picture although none was sent is taken to mean something else.
    let served = Served::replies(vec![says(400, error), completion("{}")]).await;
    let answer = client(&served, Dialect::LmStudio, |_| {}).ask(&request(None)).await.unwrap();
    assert_eq!((answer.rung, answer.without_picture), (Some(Rung::Plain), false));
}

#[tokio::test]
async fn a_server_that_says_nothing_of_what_it_refuses_is_asked_ever_simpler() {
    let no = || Reply::new(500, "boom");
    let served = Served::replies(vec![no(), no(), no(), no(), completion("{}")]).await;
    let asked = client(&served, Dialect::Ollama, |_| {});
    let answer = asked.ask(&request(Some(vec![1]))).await.unwrap();
    assert_eq!((answer.rung, answer.without_picture, answer.steps.len()), (Some(Rung::Plain), true, 4));
    let told: Vec<&str> = answer.steps.iter().map(|step| step.split(',').next().unwrap()).collect();
    assert_eq!(
        told,
        ["asked as `object`", "asked as `plain`", "asked for the answer in one piece", "asked without its picture"]
    );
    // In the end it is an error like any other.
    let served = Served::replies(vec![no(), no(), no(), no()]).await;
    let told = client(&served, Dialect::Ollama, |_| {}).ask(&request(None)).await;
    assert!(matches!(told, Err(ChatError::Server { status: 500, .. })), "{told:?}");
}
