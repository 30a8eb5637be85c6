//! What whoever asked is answered, as a whole or in parts.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use futures_util::stream;
use serde_json::{Value, json};
use tokio::sync::oneshot;
use tokio::time::Instant;

use super::desk::{Desk, Said};
use super::wire::Wish;

/// How often a program that waits hears that there is somebody: well within the silence that any client allows.
const ALIVE: Duration = Duration::from_secs(5);

/// A question whose answer is waited for. Whoever asked has left when it is dropped before.
pub(super) struct Waiting {
    desk: Arc<Desk>,
    number: u64,
    model: String,
    created: i64,
    answer: oneshot::Receiver<Said>,
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.desk.leave(self.number, Instant::now());
    }
}

impl Waiting {
    pub(super) fn new(desk: Arc<Desk>, number: u64, model: String, answer: oneshot::Receiver<Said>) -> Self {
        Self { desk, number, model, created: jiff::Timestamp::now().as_second(), answer }
    }

    /// The answer as a whole, once it is there; none where the console ends.
    pub(super) async fn whole(mut self) -> Option<Value> {
        let said = (&mut self.answer).await.ok()?;
        let message = match said {
            Said::Answer(text) => json!({"role": "assistant", "content": text, "refusal": null}),
            Said::Refusal(why) => json!({"role": "assistant", "content": null, "refusal": why}),
        };
        let choice = json!({"index": 0, "message": message, "finish_reason": "stop", "logprobs": null});
        Some(json!({"id": self.id(), "object": "chat.completion", "created": self.created, "model": self.model,
            "choices": [choice], "usage": usage()}))
    }

    /// The answer in parts: at once a first one, signs of life while a person thinks, then all of it.
    pub(super) fn parts(self, wish: Wish) -> Body {
        let first = self.chunk(&json!({"role": "assistant", "content": ""}), None);
        let begun = Parts { queue: VecDeque::from([first]), waiting: Some(self), wish };
        Body::from_stream(stream::unfold(begun, Parts::next))
    }

    fn id(&self) -> String {
        format!("chatcmpl-console-{}", self.number)
    }

    fn chunk(&self, delta: &Value, finish: Option<&str>) -> String {
        let choice = json!({"index": 0, "delta": delta, "finish_reason": finish});
        self.event(&json!([choice]), &Value::Null)
    }

    fn event(&self, choices: &Value, usage: &Value) -> String {
        let chunk = json!({"id": self.id(), "object": "chat.completion.chunk", "created": self.created, "model": self.model,
            "choices": choices, "usage": usage});
        format!("data: {chunk}\n\n")
    }

    /// Everything that is sent once a person has spoken.
    fn last(&self, said: &Said, wish: Wish) -> VecDeque<String> {
        let delta = match said {
            Said::Answer(text) => json!({ "content": text }),
            Said::Refusal(why) => json!({ "refusal": why }),
        };
        let mut queue = VecDeque::from([self.chunk(&delta, None), self.chunk(&json!({}), Some("stop"))]);
        if wish.usage {
            queue.push_back(self.event(&json!([]), &usage()));
        }
        queue.push_back("data: [DONE]\n\n".to_owned());
        queue
    }
}

/// Nobody counts what a person reads and writes.
fn usage() -> Value {
    json!({"prompt_tokens": 0, "completion_tokens": 0, "total_tokens": 0})
}

/// What of an answer in parts is still to come.
struct Parts {
    queue: VecDeque<String>,
    waiting: Option<Waiting>,
    wish: Wish,
}

impl Parts {
    async fn next(mut self) -> Option<(Result<String, Infallible>, Self)> {
        if let Some(text) = self.queue.pop_front() {
            return Some((Ok(text), self));
        }
        let mut waiting = self.waiting.take()?;
        let said = tokio::time::timeout(ALIVE, &mut waiting.answer).await;
        match said {
            Err(_pause) => {
                self.waiting = Some(waiting);
                Some((Ok(": a person is at it\n\n".to_owned()), self))
            }
            // The console ends: the answer breaks off, and is asked for again.
            Ok(Err(_ends)) => None,
            Ok(Ok(said)) => {
                self.queue = waiting.last(&said, self.wish);
                let first = self.queue.pop_front()?;
                Some((Ok(first), self))
            }
        }
    }
}
