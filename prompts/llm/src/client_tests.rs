//! The client against a scripted server, format by format and fault by fault.

use std::time::Duration;

use serde_json::{Value, json};

use crate::chat::{ChatAnswer, ChatRequest, Detail, Finish, Speaker, Turn};
use crate::client::{ChatClient, ClientConfig};
use crate::dialect::{Dialect, Rung};
use crate::error::{ChatError, Objection};
use crate::key::ApiKey;
use crate::server::{Reply, Served};

const KEY: &str = "sk-very-secret";

fn request() -> ChatRequest {
    let turn = |speaker, text: &str, png| Turn { speaker, text: text.into(), png };
    ChatRequest {
        turns: vec![turn(Speaker::System, "Be brief.", None), turn(Speaker::User, "Say yes.", Some(vec![1, 2, 3]))],
        form: "answer".into(),
        schema: Some(json!({"type": "object", "properties": {"n": {"type": "number", "minimum": 1}}})),
        grammar: None,
        seed: Some(u64::MAX),
        temperature: None,
        max_tokens: 100,
        detail: Detail::High,
    }
}

fn client(served: &Served, dialect: Dialect, change: impl FnOnce(&mut ClientConfig)) -> ChatClient {
    let mut config = ClientConfig::new(dialect, &served.url, ApiKey::new(KEY), "small");
    change(&mut config);
    ChatClient::new(config).unwrap()
}

async fn ask(served: &Served, change: impl FnOnce(&mut ClientConfig)) -> Result<ChatAnswer, ChatError> {
    client(served, Dialect::OpenAi, change).ask(&request()).await
}

fn completion(content: &str, finish: &str) -> String {
    json!({"model": "small-1", "choices": [{"message": {"content": content}, "finish_reason": finish}],
        "usage": {"prompt_tokens": 12, "completion_tokens": 3, "prompt_tokens_details": {"cached_tokens": 8}}})
    .to_string()
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[tokio::test]
async fn chat_completions_are_asked_in_the_agreed_form_and_read() {
    let served = Served::once(200, &[], &completion("{\"yes\": true}", "stop")).await;
    let answer = ask(&served, |_| {}).await.unwrap();
    assert_eq!((answer.text.as_str(), answer.finish, answer.tokens), ("{\"yes\": true}", Finish::Stop, (12, 3)));
    assert_eq!((answer.cached, answer.rung), (8, Some(Rung::Schema)));
    let seen = served.seen().await;
    assert!(seen.head.starts_with("POST /v1/chat/completions"), "{}", seen.head);
    assert!(seen.head.to_lowercase().contains("authorization: bearer sk-very-secret"), "{}", seen.head);
    let body = object(&seen.body);
    assert_eq!(body["response_format"]["json_schema"]["strict"], true);
    assert_eq!(body["messages"][1]["content"][1]["image_url"]["url"], "data:image/png;base64,AQID");
    assert_eq!((&body["max_tokens"], &body["seed"]), (&json!(100), &json!(0x7fff_ffff)));
    assert!(!seen.body.contains("JSON schema"), "the form stands in the prompt as well");
}

#[tokio::test]
async fn messages_are_asked_in_the_agreed_form_and_read() {
    let told = json!({"model": "small-2", "content": [{"type": "text", "text": "{\"yes\":"}, {"type": "text", "text": " 1}"}],
        "stop_reason": "max_tokens",
        "usage": {"input_tokens": 5, "cache_read_input_tokens": 20, "cache_creation_input_tokens": 3, "output_tokens": 4}});
    let served = Served::once(200, &[], &told.to_string()).await;
    let answer = client(&served, Dialect::Anthropic, |_| {}).ask(&request()).await.unwrap();
    assert_eq!((answer.text.as_str(), answer.finish, answer.tokens), ("{\"yes\": 1}", Finish::Cut, (28, 4)));
    assert_eq!((answer.cached, answer.model.as_str()), (20, "small-2"));
    let seen = served.seen().await;
    assert!(seen.head.starts_with("POST /v1/v1/messages"), "{}", seen.head);
    assert!(seen.head.contains("x-api-key: sk-very-secret") && seen.head.contains("anthropic-version: 2023-06-01"));
    let body = object(&seen.body);
    assert_eq!((&body["system"], &body["max_tokens"]), (&json!("Be brief."), &json!(100)));
    let content = &body["messages"][0]["content"];
    assert_eq!(content[0]["source"], json!({"type": "base64", "media_type": "image/png", "data": "AQID"}));
    assert_eq!(content[1]["cache_control"]["type"], "ephemeral");
    let number = &body["output_config"]["format"]["schema"]["properties"]["n"];
    assert_eq!(*number, json!({"type": "number", "description": "minimum 1"}));
}

#[tokio::test]
async fn a_tool_takes_the_answer_where_no_form_is_enforced() {
    let told =
        json!({"content": [{"type": "tool_use", "name": "answer", "input": {"n": 2}}], "stop_reason": "tool_use"});
    let served = Served::once(200, &[], &told.to_string()).await;
    let by_tool = client(&served, Dialect::Anthropic, |config| config.rung = Some(Rung::Tool));
    let answer = by_tool.ask(&request()).await.unwrap();
    assert_eq!((answer.text.as_str(), answer.estimated), ("{\"n\":2}", true));
    let body = object(&served.seen().await.body);
    assert_eq!(body["tool_choice"]["name"], "answer");
    assert_eq!(body["tools"][0]["input_schema"]["type"], "object");
}

#[tokio::test]
async fn generate_content_is_asked_in_the_agreed_form_and_read() {
    let told = json!({"candidates": [{"content": {"parts": [{"text": "hm", "thought": true}, {"text": "{}"}]}, "finishReason": "STOP"}],
        "usageMetadata": {"promptTokenCount": 9, "candidatesTokenCount": 2, "thoughtsTokenCount": 5}, "modelVersion": "small-3"});
    let served = Served::once(200, &[], &told.to_string()).await;
    let answer = client(&served, Dialect::Gemini, |_| {}).ask(&request()).await.unwrap();
    assert_eq!((answer.text.as_str(), answer.tokens, answer.model.as_str()), ("{}", (9, 7), "small-3"));
    let seen = served.seen().await;
    assert!(seen.head.starts_with("POST /v1/v1beta/models/small:streamGenerateContent?alt=sse "), "{}", seen.head);
    assert!(seen.head.contains("x-goog-api-key: sk-very-secret"), "{}", seen.head);
    let body = object(&seen.body);
    assert_eq!(body["systemInstruction"]["parts"][0]["text"], "Be brief.");
    assert_eq!(body["contents"][0]["parts"][1]["inlineData"]["data"], "AQID");
    assert_eq!(body["generationConfig"]["responseMimeType"], "application/json");
    assert_eq!(body["generationConfig"]["responseJsonSchema"]["propertyOrdering"], json!(["n"]));
}

#[tokio::test]
async fn responses_are_asked_in_the_agreed_form_and_read() {
    let told = json!({"model": "small-4", "status": "completed", "error": null, "output": [
            {"type": "reasoning", "summary": []},
            {"type": "message", "content": [{"type": "output_text", "text": "{\"yes\":"}, {"type": "output_text", "text": " 1}"}]}],
        "usage": {"input_tokens": 40, "input_tokens_details": {"cached_tokens": 32}, "output_tokens": 9,
            "output_tokens_details": {"reasoning_tokens": 6}}});
    let served = Served::once(200, &[], &told.to_string()).await;
    let with_an_answer = |mut asked: ChatRequest| {
        let said = Turn { speaker: Speaker::Assistant, text: "{}".into(), png: None };
        asked.turns.push(said);
        asked
    };
    let answer = client(&served, Dialect::Responses, |_| {}).ask(&with_an_answer(request())).await.unwrap();
    assert_eq!((answer.text.as_str(), answer.finish, answer.tokens), ("{\"yes\": 1}", Finish::Stop, (40, 9)));
    assert_eq!((answer.cached, answer.thought, answer.model.as_str()), (32, 6, "small-4"));
    let seen = served.seen().await;
    assert!(seen.head.starts_with("POST /v1/responses "), "{}", seen.head);
    assert!(seen.head.to_lowercase().contains("authorization: bearer sk-very-secret"), "{}", seen.head);
    let body = object(&seen.body);
    assert_eq!(body["input"][0], json!({"role": "system", "content": "Be brief."}));
    let content = &body["input"][1]["content"];
    assert_eq!(content[0], json!({"type": "input_text", "text": "Say yes."}));
    let picture = json!({"type": "input_image", "image_url": "data:image/png;base64,AQID", "detail": "high"});
    assert_eq!(content[1], picture);
    assert_eq!(body["input"][2], json!({"role": "assistant", "content": "{}"}));
    let format = &body["text"]["format"];
    assert_eq!((&format["type"], &format["name"]), (&json!("json_schema"), &json!("answer")));
    assert_eq!((&format["strict"], &format["schema"]["type"]), (&json!(true), &json!("object")));
    assert_eq!((&body["max_output_tokens"], &body["store"]), (&json!(100), &json!(false)));
    assert!(body.get("seed").is_none() && body.get("messages").is_none(), "{body}");
}

#[tokio::test]
async fn responses_that_are_no_answer_are_told_apart() {
    let ask = async |body: Value| {
        let served = Served::once(200, &[], &body.to_string()).await;
        client(&served, Dialect::Responses, |config| config.rung = Some(Rung::Schema)).ask(&request()).await
    };
    let said = json!([{"type": "message", "content": [{"type": "output_text", "text": "{\"ye"}]}]);
    let cut = json!({"status": "incomplete", "incomplete_details": {"reason": "max_output_tokens"}, "output": said});
    assert_eq!(ask(cut).await.unwrap().finish, Finish::Cut);
    let failed =
        |code: &str| json!({"status": "failed", "error": {"code": code, "message": "no sk-very-secret"}, "output": []});
    let told = ask(failed("rate_limit_exceeded")).await.unwrap_err();
    assert!(matches!(&told, ChatError::SlowDown { why, .. } if why == "no ***"), "{told}");
    assert!(matches!(ask(failed("server_error")).await, Err(ChatError::Server { .. })));
    assert!(matches!(ask(failed("invalid_prompt")).await, Err(ChatError::Rejected { status: 400, .. })));
    let later = ask(json!({"status": "queued", "output": []})).await.unwrap_err().to_string();
    assert!(later.contains("`queued`"), "{later}");
    // A form that is refused is named by its parameter.
    let no = json!({"error": {"message": "Invalid schema", "param": "text.format.schema"}}).to_string();
    let yes = json!({"output": [{"type": "message", "content": [{"type": "output_text", "text": "{}"}]}]}).to_string();
    let served = Served::replies(vec![Reply::new(400, &no), Reply::new(200, &yes)]).await;
    let answer = client(&served, Dialect::Responses, |_| {}).ask(&request()).await.unwrap();
    assert_eq!((answer.rung, answer.estimated), (Some(Rung::Object), true));
    assert_eq!(object(&served.all_seen().await[1].body)["text"]["format"]["type"], "json_object");
}

#[tokio::test]
async fn who_counts_nothing_has_not_counted() {
    let told = json!({"content": [{"type": "text", "text": "{\"yes\": 1}"}], "stop_reason": "end_turn",
        "usage": {"input_tokens": 0, "output_tokens": 0}});
    let served = Served::once(200, &[], &told.to_string()).await;
    let answer = client(&served, Dialect::Anthropic, |_| {}).ask(&request()).await.unwrap();
    assert!(answer.estimated && answer.tokens.0 > 0 && answer.tokens.1 == 3, "{answer:?}");
}

#[tokio::test]
async fn a_cut_answer_and_a_refusal_are_told_apart_in_every_format() {
    let served = Served::once(200, &[], &completion("{\"ye", "length")).await;
    assert_eq!(ask(&served, |_| {}).await.unwrap().finish, Finish::Cut);
    let refusals = [
        (Dialect::OpenAi, json!({"choices": [{"message": {"refusal": "I will not"}}]})),
        (Dialect::OpenAi, json!({"choices": [{"message": {"content": ""}, "finish_reason": "content_filter"}]})),
        (
            Dialect::Responses,
            json!({"output": [{"type": "message", "content": [{"type": "refusal", "refusal": "no"}]}]}),
        ),
        (
            Dialect::Responses,
            json!({"status": "incomplete", "incomplete_details": {"reason": "content_filter"}, "output": []}),
        ),
        (Dialect::Anthropic, json!({"content": [], "stop_reason": "refusal"})),
        (Dialect::Gemini, json!({"promptFeedback": {"blockReason": "SAFETY"}})),
        (Dialect::Gemini, json!({"candidates": [{"finishReason": "PROHIBITED_CONTENT"}]})),
    ];
    for (dialect, body) in refusals {
        let served = Served::once(200, &[], &body.to_string()).await;
        let told = client(&served, dialect, |_| {}).ask(&request()).await;
        assert!(matches!(told, Err(ChatError::Refused { .. })), "{dialect} {body}: {told:?}");
    }
}

#[tokio::test]
async fn every_status_has_its_error_and_its_wait() {
    let error = |code: &str| json!({"error": {"message": "no sk-very-secret", "code": code}}).to_string();
    let told = async |status, headers: &[(&'static str, &'static str)], body: &str| {
        let served = Served::once(status, headers, body).await;
        ask(&served, |config| config.rung = Some(Rung::Schema)).await.unwrap_err()
    };
    let slow = told(429, &[("retry-after", "2")], &error("rate_limit_exceeded")).await;
    assert!(matches!(slow, ChatError::SlowDown { retry_after_ms: Some(2000), .. }), "{slow}");
    let inside = json!({"error": {"message": "quota", "details": [{"retryDelay": "17s"}]}}).to_string();
    let slow = told(429, &[], &inside).await;
    assert!(matches!(slow, ChatError::SlowDown { retry_after_ms: Some(17_000), .. }), "{slow}");
    assert!(matches!(told(529, &[], "").await, ChatError::SlowDown { status: 529, .. }));
    assert!(matches!(told(429, &[], &error("insufficient_quota")).await, ChatError::Key { .. }));
    assert!(matches!(told(402, &[], "").await, ChatError::Key { .. }));
    assert!(matches!(told(503, &[], "busy").await, ChatError::Server { status: 503, .. }));
    assert!(matches!(told(503, &[("x-should-retry", "false")], "").await, ChatError::Rejected { .. }));
    assert!(matches!(told(404, &[], &error("model_not_found")).await, ChatError::Rejected { status: 404, .. }));
    let key = told(401, &[], &error("")).await.to_string();
    assert!(key.contains("no ***") && !key.contains("secret"), "{key}");
}

#[tokio::test]
async fn what_a_server_objects_to_is_read_from_code_parameter_and_sentence_in_this_order() {
    for (error, objection) in [
        (json!({"message": "no `schema-small` here", "code": "model_not_found"}), Objection::Model),
        (json!({"message": "this value is not known", "param": "response_format"}), Objection::Form),
        (json!({"message": "Grammar cannot be compiled"}), Objection::Form),
        (json!({"message": "this value is not known", "param": "temperature"}), Objection::Unsaid),
        (json!({"message": ""}), Objection::Unsaid),
    ] {
        let served = Served::once(400, &[], &json!({ "error": error }).to_string()).await;
        let alone =
            client(&served, Dialect::OpenAi, |config| (config.rung, config.stream) = (Some(Rung::Schema), false));
        let mut asked = request();
        asked.turns.pop();
        let told = alone.ask(&asked).await.unwrap_err();
        assert!(matches!(&told, ChatError::Rejected { to, .. } if *to == objection), "{error}: {told:?}");
    }
}

#[tokio::test]
async fn a_server_that_refuses_the_form_is_asked_in_a_simpler_one_and_remembered() {
    let no = json!({"error": {"message": "response_format json_schema is not supported"}}).to_string();
    let yes = completion("{}", "stop");
    let replies = vec![Reply::new(400, &no), Reply::new(200, &yes), Reply::new(200, &yes)];
    let served = Served::replies(replies).await;
    let asked = client(&served, Dialect::Ollama, |_| {});
    let first = asked.ask(&request()).await.unwrap();
    assert_eq!(first.rung, Some(Rung::Object));
    assert!(first.steps[0].contains("`object`") && first.steps[0].contains("not supported"), "{:?}", first.steps);
    let second = asked.ask(&request()).await.unwrap();
    assert_eq!((second.rung, second.steps.len()), (Some(Rung::Object), 0));
    let seen = served.all_seen().await;
    assert_eq!(object(&seen[0].body)["response_format"]["type"], "json_schema");
    for later in &seen[1..] {
        assert_eq!(object(&later.body)["response_format"]["type"], "json_object");
        assert!(later.body.contains("keeps to this JSON schema"), "the form has to stand in the prompt now");
    }
}

#[tokio::test]
async fn a_local_server_may_fail_at_a_form_and_a_vendor_may_not() {
    let served = Served::replies(vec![Reply::new(500, "boom"), Reply::new(200, &completion("{}", "stop"))]).await;
    let answer = client(&served, Dialect::LlamaCpp, |_| {}).ask(&request()).await.unwrap();
    assert_eq!(answer.rung, Some(Rung::Object));
    assert_eq!(object(&served.all_seen().await[1].body)["response_format"]["schema"]["type"], "object");
    // A wrong model is no matter of form.
    let unknown = json!({"error": {"message": "model `small` not found"}}).to_string();
    let served = Served::once(400, &[], &unknown).await;
    let told = client(&served, Dialect::Vllm, |_| {}).ask(&request()).await;
    assert!(matches!(told, Err(ChatError::Rejected { status: 400, .. })), "{told:?}");
}

#[tokio::test]
async fn a_grammar_is_sent_where_grammars_are_taken() {
    for (dialect, place) in [(Dialect::LlamaCpp, "/grammar"), (Dialect::Vllm, "/structured_outputs/grammar")] {
        let served = Served::once(200, &[], &completion("{}", "stop")).await;
        let with = ChatRequest { grammar: Some("root ::= \"{}\"".into()), ..request() };
        let answer = client(&served, dialect, |_| {}).ask(&with).await.unwrap();
        assert_eq!(answer.rung, Some(Rung::Grammar));
        let body = object(&served.seen().await.body);
        assert_eq!(body.pointer(place), Some(&json!("root ::= \"{}\"")), "{dialect}");
        assert!(body.get("response_format").is_none());
    }
}

#[tokio::test]
async fn large_endless_torn_and_missing_answers_are_no_trap() {
    let served = Served::once(200, &[], &completion(&"x".repeat(5000), "stop")).await;
    let small = ask(&served, |config| config.max_bytes = 1000).await;
    assert_eq!(small, Err(ChatError::TooLarge { most: 1000 }));
    let flood = Served::replies(vec![Reply::Flood(200 << 20)]).await;
    assert_eq!(ask(&flood, |_| {}).await, Err(ChatError::TooLarge { most: 2 << 20 }));
    let drip = Served::replies(vec![Reply::Drip]).await;
    let endless = ask(&drip, |config| config.longest = Duration::from_millis(300)).await;
    assert_eq!(endless, Err(ChatError::Late { limit_ms: 300 }));
    let silent = Served::silent().await;
    let slow = ask(&silent, |config| config.silence = Duration::from_millis(200)).await;
    assert_eq!(slow, Err(ChatError::Timeout { limit_ms: 200 }));
    let torn = Served::replies(vec![Reply::Torn("{\"choices\": [".into())]).await;
    assert!(matches!(ask(&torn, |_| {}).await, Err(ChatError::Unreachable { .. })));
    let gone = Served::gone().await;
    assert!(matches!(ask(&gone, |_| {}).await, Err(ChatError::Unreachable { .. })));
}

#[tokio::test]
async fn what_is_no_answer_is_unreadable_in_every_format() {
    let deep = format!("{}{}", "[".repeat(10_000), "]".repeat(10_000));
    let bodies = ["<html>".to_owned(), String::new(), "{}".into(), "{\"x\": NaN}".into(), deep];
    for dialect in [Dialect::OpenAi, Dialect::Responses, Dialect::Anthropic, Dialect::Gemini] {
        for body in &bodies {
            let served = Served::once(200, &[], body).await;
            let told = client(&served, dialect, |_| {}).ask(&request()).await;
            let start: String = body.chars().take(20).collect();
            assert!(matches!(told, Err(ChatError::Unreadable { .. })), "{dialect} `{start}`: {told:?}");
        }
    }
}

#[tokio::test]
async fn the_key_is_in_nothing_that_leaves_the_client() {
    // A server that repeats the key wherever it can.
    let echo =
        json!({"model": KEY, "choices": [{"message": {"content": format!("{{\"n\": \"{KEY}\"}}")}}]}).to_string();
    let served = Served::once(200, &[], &echo).await;
    let answer = ask(&served, |_| {}).await.unwrap();
    assert!(!format!("{answer:?}").contains(KEY), "{answer:?}");
    for (status, dialect) in [(400, Dialect::OpenAi), (401, Dialect::Anthropic), (500, Dialect::Gemini)] {
        let body = json!({"error": {"message": format!("bad {KEY}"), "type": KEY, "code": KEY}}).to_string();
        let served = Served::once(status, &[], &body).await;
        let asked = client(&served, dialect, |config| config.rung = Some(Rung::Plain));
        let error = asked.ask(&request()).await.unwrap_err();
        assert!(!format!("{error} {error:?} {asked:?}").contains(KEY), "{error:?}");
    }
    assert!(!serde_json::to_string(&request()).unwrap().contains(KEY));
}

#[tokio::test]
async fn a_local_server_is_asked_without_a_key() {
    let served = Served::once(200, &[], &completion("{}", "stop")).await;
    client(&served, Dialect::Ollama, |config| config.key = ApiKey::new("")).ask(&request()).await.unwrap();
    assert!(!served.seen().await.head.to_lowercase().contains("authorization"));
}

#[test]
fn addresses_and_models_that_cannot_be_used_are_named() {
    let client = |url: &str, model: &str| {
        ChatClient::new(ClientConfig::new(Dialect::OpenAi, url, ApiKey::new(""), model)).map(|_| ())
    };
    assert!(client("http://127.0.0.1:8080/v1", "m").is_ok());
    let wrong = [
        ("http://example.org/v1", "m"),
        ("not an address", "m"),
        ("https://me:pass@example.org", "m"),
        ("https://example.org/v1?key=1", "m"),
        ("https://example.org/v1", "a b"),
        ("https://example.org/v1", "a?key=1"),
    ];
    for (url, model) in wrong {
        assert!(matches!(client(url, model), Err(ChatError::Setup { .. })), "{url} {model}");
    }
}
