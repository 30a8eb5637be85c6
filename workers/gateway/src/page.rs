//! The socket of our own page: scene, events and standings as JSON, frames as bytes, of which at most two are on their way.
//!
//! A frame is sent when the page has drawn the one before the last, and then the newest there is: a page that reads slowly sees fewer
//! frames, none of them old. What the page sends is an acknowledgement or a rate; nothing of it goes further than this file.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket, close_code};
use futures_util::StreamExt as _;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::time::Instant;

use crate::run::{News, Run};
use crate::socket::{EARLY, Gone, Line, PING, WINDOW};

/// Subprotocol of the socket.
pub const PROTOCOL: &str = "socrates.live.v1";
/// Bytes of a message from the page, at most.
pub const MOST_BYTES: usize = 4 * 1024;
/// Frames a second where the page names no rate, and the most that it can name.
const RATE_HZ: (f64, f64) = (20.0, 60.0);
/// How often the page is told how late it is.
const LAG: Duration = Duration::from_secs(1);
/// What the page says in words.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case", deny_unknown_fields)]
enum Wish {
    /// So many frames a second.
    Rate {
        /// 1 to 60.
        hz: f64,
    },
}

/// What came from the page.
#[derive(Debug, Clone, PartialEq)]
enum Heard {
    /// A frame was drawn.
    Drawn(u32),
    /// A rate.
    Rate(f64),
    /// A sign of life.
    Life,
    /// It leaves.
    Leaves,
}

/// Reads a message of the page; the words are sent to it before it is let go.
fn heard(message: Message) -> Result<Heard, String> {
    match message {
        Message::Binary(bytes) => match <[u8; 4]>::try_from(&*bytes) {
            Ok(number) => Ok(Heard::Drawn(u32::from_le_bytes(number))),
            Err(_) => Err(format!("a message of {} bytes; 4 bytes acknowledge a frame", bytes.len())),
        },
        Message::Text(text) => match serde_json::from_str(&text) {
            Ok(Wish::Rate { hz }) if (1.0..=RATE_HZ.1).contains(&hz) => Ok(Heard::Rate(hz)),
            Ok(Wish::Rate { hz }) => Err(format!("a rate of `{hz}` Hz; allowed: 1 to 60")),
            Err(why) => Err(format!("words that are not understood ({why}); allowed: {{\"op\":\"rate\",\"hz\":20}}")),
        },
        Message::Ping(_) | Message::Pong(_) => Ok(Heard::Life),
        Message::Close(_) => Ok(Heard::Leaves),
    }
}

/// One page.
struct Viewer {
    run: Arc<Run>,
    line: Line,
    every: Duration,
    /// What is new as of the last look.
    now: News,
    events: usize,
    standings: u64,
    over: bool,
    last_frame: Option<u32>,
    sent_at: Option<Instant>,
    on_their_way: VecDeque<(u32, Instant)>,
    skipped: u64,
    lags_ms: Vec<f64>,
}

/// Talks to a page until it leaves, is frozen, or says what is not understood.
pub async fn talk(socket: WebSocket, run: Arc<Run>) {
    let (sink, mut stream) = socket.split();
    let mut news = run.news();
    let mut viewer = Viewer {
        run,
        line: Line::new(sink),
        every: Duration::from_secs_f64(1.0 / RATE_HZ.0),
        now: News::default(),
        events: 0,
        standings: 0,
        over: false,
        last_frame: None,
        sent_at: None,
        on_their_way: VecDeque::new(),
        skipped: 0,
        lags_ms: Vec::new(),
    };
    let scene = format!("{{\"op\":\"scene\",\"scene\":{}}}", viewer.run.scene_json());
    if viewer.line.send(Message::Text(scene.into())).await.is_err() {
        return;
    }
    viewer.now = news.borrow_and_update().clone();
    let mut lag = tokio::time::interval(LAG);
    loop {
        if viewer.catch_up().await.is_err() {
            return;
        }
        let due = viewer.due(Instant::now());
        let heard = tokio::select! {
            changed = news.changed() => {
                if changed.is_err() {
                    return;
                }
                viewer.now = news.borrow_and_update().clone();
                continue;
            }
            message = stream.next() => match message {
                Some(Ok(message)) => heard(message),
                Some(Err(_)) | None => return,
            },
            () = tokio::time::sleep_until(due.unwrap_or_else(Instant::now)), if due.is_some() => continue,
            _ = lag.tick() => {
                if viewer.beat().await.is_err() {
                    return;
                }
                continue;
            }
        };
        let too_much = viewer.line.says_too_much();
        let heard = if too_much { Err("too many messages in a second".to_owned()) } else { heard };
        match heard {
            Ok(Heard::Drawn(number)) => viewer.drawn(number),
            Ok(Heard::Rate(hz)) => viewer.every = Duration::from_secs_f64(1.0 / hz),
            Ok(Heard::Life) => viewer.line.moved(),
            Ok(Heard::Leaves) => return viewer.line.farewell().await,
            Err(why) => return viewer.part(&why).await,
        }
    }
}

impl Viewer {
    async fn say(&mut self, what: &Value) -> Result<(), Gone> {
        self.line.send(Message::Text(Utf8Bytes::from(what.to_string()))).await
    }

    /// Says why it is let go, and lets it go.
    async fn part(mut self, why: &str) {
        let reason: String = why.chars().take(100).collect();
        let frame = CloseFrame { code: close_code::POLICY, reason: Utf8Bytes::from(reason) };
        drop(self.say(&json!({ "op": "status", "level": "error", "text": why })).await);
        drop(self.line.send(Message::Close(Some(frame))).await);
    }

    /// Sends what is new: events, how it stands, the newest frame where it is due, and the end.
    async fn catch_up(&mut self) -> Result<(), Gone> {
        if self.now.events > self.events {
            let (from, events) = (self.events, self.run.events_json(self.events));
            self.events += events.len();
            self.say(&json!({ "op": "events", "from": from, "events": events })).await?;
        }
        if self.now.standings > self.standings {
            self.standings = self.now.standings;
            self.say(&self.run.standing().json()).await?;
        }
        self.frame().await?;
        if self.now.over && !self.over {
            self.over = true;
            let (_, end) = self.run.phase();
            let reason = self.run.reason();
            let told =
                json!({ "op": "end", "time_s": self.run.time_s(), "reason": reason, "recording": end.recording });
            self.say(&told).await?;
        }
        Ok(())
    }

    /// The frame that waits, and when it may be sent; none where none waits or too many are on their way.
    fn due(&self, now: Instant) -> Option<Instant> {
        let newest = self.now.newest.as_ref()?.number;
        if self.last_frame == Some(newest) || self.on_their_way.len() >= WINDOW {
            return None;
        }
        // One that comes a little early goes at once: a timer for it would cost as much as sending it.
        Some(self.sent_at.map_or(now, |at| at + self.every.mul_f64(EARLY)))
    }

    async fn frame(&mut self) -> Result<(), Gone> {
        let now = Instant::now();
        if self.due(now).is_none_or(|due| due > now) {
            return Ok(());
        }
        let Some((number, bytes)) = self.now.newest.as_ref().map(|newest| (newest.number, newest.bytes.clone())) else {
            return Ok(());
        };
        if let Some(last) = self.last_frame {
            self.skipped += u64::from(number.wrapping_sub(last).saturating_sub(1));
        }
        self.last_frame = Some(number);
        self.sent_at = Some(now);
        self.on_their_way.push_back((number, now));
        self.line.send(Message::Binary(bytes)).await
    }

    fn drawn(&mut self, number: u32) {
        self.line.moved();
        while let Some((sent, at)) = self.on_their_way.front().copied() {
            // An acknowledgement is for all before it as well.
            if number.wrapping_sub(sent) > u32::MAX / 2 {
                break;
            }
            self.on_their_way.pop_front();
            self.lags_ms.push(at.elapsed().as_secs_f64() * 1_000.0);
        }
    }

    /// Tells how late the page is; lets go of one that is frozen.
    async fn beat(&mut self) -> Result<(), Gone> {
        if self.line.idle()? > PING {
            self.line.send(Message::Ping(Vec::new().into())).await?;
        }
        self.lags_ms.sort_by(f64::total_cmp);
        let Some(middle) = self.lags_ms.get(self.lags_ms.len() / 2).copied() else { return Ok(()) };
        self.lags_ms.clear();
        let told = json!({ "op": "lag", "ms": (middle * 10.0).round() / 10.0, "skipped": self.skipped });
        self.say(&told).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_acknowledges_and_names_a_rate_and_says_nothing_else() {
        let text = |text: &str| heard(Message::Text(text.to_owned().into()));
        let bytes = |bytes: &[u8]| heard(Message::Binary(bytes.to_vec().into()));
        assert_eq!(bytes(&[7, 0, 0, 0]), Ok(Heard::Drawn(7)));
        assert_eq!(text(r#"{"op":"rate","hz":1}"#), Ok(Heard::Rate(1.0)));
        for wrong in [
            r#"{"op":"rate","hz":0}"#,
            r#"{"op":"rate","hz":61}"#,
            r#"{"op":"rate","hz":"20"}"#,
            r#"{"op":"pause"}"#,
            r#"{"op":"rate","hz":20,"run":"x"}"#,
            "",
            "[[[[[[",
        ] {
            assert!(text(wrong).is_err(), "{wrong}");
        }
        assert!(bytes(&[]).unwrap_err().contains("0 bytes") && bytes(&[1; 5]).is_err());
    }
}
