//! What the sockets of our page and of Foxglove share: frames on their way, how much a viewer may say, and when it counts as gone.

use std::time::Duration;

use axum::extract::ws::{Message, WebSocket};
use futures_util::SinkExt as _;
use futures_util::stream::SplitSink;
use tokio::time::Instant;

/// Frames on their way, at most.
pub(crate) const WINDOW: usize = 2;
/// Share of the time from one frame to the next after which the next may go: one that comes a little early needs no timer.
pub(crate) const EARLY: f64 = 0.8;
/// A viewer that has nothing to take is asked for a sign of life so often.
pub(crate) const PING: Duration = Duration::from_secs(5);
/// A viewer that takes nothing, or gives no sign of life, for so long is let go.
const FROZEN: Duration = Duration::from_secs(30);
/// Messages that a viewer may send in a [`SECOND`].
const MOST_MESSAGES: u32 = 200;
const SECOND: Duration = Duration::from_secs(1);

/// The viewer is gone.
pub(crate) struct Gone;

/// The way to one viewer.
pub(crate) struct Line {
    sink: SplitSink<WebSocket, Message>,
    /// Last sign of life.
    moved_at: Instant,
    /// Messages since.
    messages: u32,
    since: Instant,
}

impl Line {
    /// To a viewer that has just come.
    pub(crate) fn new(sink: SplitSink<WebSocket, Message>) -> Self {
        let now = Instant::now();
        Self { sink, moved_at: now, messages: 0, since: now }
    }

    /// Sends, and waits until it is taken.
    pub(crate) async fn send(&mut self, message: Message) -> Result<(), Gone> {
        match tokio::time::timeout(FROZEN, self.sink.send(message)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) | Err(_) => Err(Gone),
        }
    }

    /// Answers a farewell.
    pub(crate) async fn farewell(&mut self) {
        drop(tokio::time::timeout(FROZEN, self.sink.close()).await);
    }

    /// Notes a sign of life.
    pub(crate) fn moved(&mut self) {
        self.moved_at = Instant::now();
    }

    /// How long there was none; [`Gone`] where that is too long.
    pub(crate) fn idle(&self) -> Result<Duration, Gone> {
        let idle = self.moved_at.elapsed();
        if idle > FROZEN { Err(Gone) } else { Ok(idle) }
    }

    /// Counts a message; whether there were too many of late.
    pub(crate) fn says_too_much(&mut self) -> bool {
        if self.since.elapsed() > SECOND {
            (self.messages, self.since) = (0, Instant::now());
        }
        self.messages += 1;
        self.messages > MOST_MESSAGES
    }
}
