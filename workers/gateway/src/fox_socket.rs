//! The socket of Foxglove and Lichtblick: a live run as it comes, a kept one as its viewer plays it.
//!
//! Their protocol has no acknowledgement, but every WebSocket answers a ping: one follows each frame, and while two are unanswered the
//! next frame waits, and then is the newest.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use futures_util::StreamExt as _;
use socrates_model::{Recording, SimTime};
use tokio::time::Instant;

use crate::fox::{self, Ask, Frame, Heard, Inbound, Level, Out, Session, Stage, protocol};
use crate::run::Run;
use crate::scene::Eyes;
use crate::socket::{EARLY, Gone, Line, PING, WINDOW};
use crate::staging::{ranges, stage};
use crate::words::words;

/// Bytes of a message from a viewer, at most.
pub(crate) const MOST_BYTES: usize = 64 * 1024;
/// Time from one frame to the next, at least: 20 a second.
const EVERY: Duration = Duration::from_millis(50);
/// Longest wait for a new viewer to answer.
const GREETING: Duration = Duration::from_millis(300);
/// The way to one viewer, on which pings tell what has come.
struct Pinged {
    line: Line,
    /// Pings so far, and answers.
    pinged: u32,
    answered: u32,
    pinged_at: Instant,
}

impl Pinged {
    async fn put(&mut self, out: Out) -> Result<(), Gone> {
        match out {
            Out::Text(text) => self.line.send(Message::Text(Utf8Bytes::from(text))).await,
            other @ (Out::Binary(_) | Out::Data { .. }) => self.line.send(Message::Binary(other.into_bytes())).await,
        }
    }

    async fn put_all(&mut self, outs: Vec<Out>) -> Result<(), Gone> {
        for out in outs {
            self.put(out).await?;
        }
        Ok(())
    }

    /// Asks whether what was sent has come.
    async fn ping(&mut self) -> Result<(), Gone> {
        self.pinged = self.pinged.wrapping_add(1);
        self.pinged_at = Instant::now();
        self.line.send(Message::Ping(self.pinged.to_le_bytes().to_vec().into())).await
    }

    fn answered(&mut self, bytes: &[u8]) {
        self.line.moved();
        if let Ok(number) = <[u8; 4]>::try_from(bytes) {
            let number = u32::from_le_bytes(number);
            // Only what was asked can be answered.
            if self.pinged.wrapping_sub(number) < u32::MAX / 2 {
                self.answered = number;
            }
        }
    }

    const fn is_free(&self) -> bool {
        (self.pinged.wrapping_sub(self.answered) as usize) < WINDOW
    }

    /// Lets go of a frozen viewer, and asks an idle one for a sign of life.
    async fn beat(&mut self) -> Result<(), Gone> {
        self.line.idle()?;
        if self.pinged_at.elapsed() > PING { self.ping().await } else { Ok(()) }
    }

    /// Whether a viewer leaves, or says too much and has to; then it is answered.
    async fn parts(&mut self, came: &Came) -> bool {
        let parts = self.line.says_too_much() || matches!(came, Came::Leaves);
        if parts {
            self.line.farewell().await;
        }
        parts
    }
}

/// Waits until a new viewer has answered a ping, or not for long: some begin to listen a moment after their socket is open, and would miss
/// the first texts. Gives what came instead.
async fn greeted(line: &mut Pinged, stream: &mut Stream) -> Result<Option<Came>, Gone> {
    line.ping().await?;
    match tokio::time::timeout(GREETING, stream.next()).await {
        Ok(message) => match came(line, message) {
            Came::Nothing => Ok(None),
            other @ (Came::Text(_) | Came::Bytes(_) | Came::Leaves) => Ok(Some(other)),
        },
        Err(_elapsed) => Ok(None),
    }
}

/// What came from a viewer.
enum Came {
    Text(Utf8Bytes),
    Bytes(axum::body::Bytes),
    Nothing,
    Leaves,
}

fn came(line: &mut Pinged, message: Option<Result<Message, axum::Error>>) -> Came {
    match message {
        Some(Ok(Message::Text(text))) => Came::Text(text),
        Some(Ok(Message::Binary(bytes))) => Came::Bytes(bytes),
        Some(Ok(Message::Pong(bytes))) => {
            line.answered(&bytes);
            Came::Nothing
        }
        Some(Ok(Message::Ping(_))) => Came::Nothing,
        Some(Ok(Message::Close(_)) | Err(_)) | None => Came::Leaves,
    }
}

fn hear(session: &mut Session, came: &Came, stage: &Stage) -> Heard {
    match came {
        Came::Text(text) => session.hear(Inbound::Text(text), stage),
        Came::Bytes(bytes) => session.hear(Inbound::Binary(bytes), stage),
        Came::Nothing | Came::Leaves => Heard::default(),
    }
}

/// What a viewer is given of these messages.
fn given(session: &Session, messages: &[fox::Message]) -> Vec<Out> {
    messages.iter().filter_map(|message| session.give(message)).collect()
}

/// Talks to a viewer until it leaves or is frozen.
///
/// With `records` the records of every agent are offered too: viewers of others show an error about a schema that they do not know.
pub(crate) async fn talk(socket: WebSocket, run: Arc<Run>, records: bool) {
    let (sink, stream) = socket.split();
    let line = Pinged { line: Line::new(sink), pinged: 0, answered: 0, pinged_at: Instant::now() };
    let recording = run.recording().map(|(recording, _)| recording);
    // A viewer that is gone need not be told.
    let _gone = match recording {
        Some(recording) => Player::new(&run, recording, line, records).talk(stream).await,
        None => live(&run, line, stream, records).await,
    };
}

type Stream = futures_util::stream::SplitStream<WebSocket>;

/// Name of what is shown.
fn name(run: &Run) -> String {
    format!("socrates {}", run.id())
}

/// What a viewer is offered of a stage.
const fn offers(stage: &Stage, records: bool) -> fox::Topics {
    if records { stage.offers() } else { stage.offers().without(fox::Topic::Agents) }
}

/// A run that goes on: everybody sees the same moment.
async fn live(run: &Run, mut line: Pinged, mut stream: Stream, records: bool) -> Result<(), Gone> {
    let (guest, mut session) = {
        let mut staging = run.staging();
        (staging.admit(), Session::new(&name(run), None, run.id().as_str(), offers(staging.stage(), records)))
    };
    let gone = watch(run, &mut line, &mut stream, &mut session, guest).await;
    run.staging().wants(guest, fox::Topics::NONE);
    gone
}

async fn watch(
    run: &Run,
    line: &mut Pinged,
    stream: &mut Stream,
    session: &mut Session,
    guest: u64,
) -> Result<(), Gone> {
    let mut early = greeted(line, stream).await?;
    line.put_all(session.opening()).await?;
    let mut news = run.news();
    let mut beat = tokio::time::interval(Duration::from_secs(1));
    let (mut shown, mut sent_at, mut over) = (None, None::<Instant>, false);
    let mut told = {
        let mut staging = run.staging();
        staging.catch_up(|seen| run.events(seen));
        staging.seen()
    };
    loop {
        let new = news.borrow_and_update().clone();
        if new.events > told {
            let happened = {
                let mut staging = run.staging();
                staging.catch_up(|seen| run.events(seen));
                let happened = staging.events(told);
                told = staging.seen();
                happened
            };
            for messages in happened {
                line.put_all(given(session, &messages)).await?;
            }
        }
        let newest = new.newest.filter(|newest| shown != Some(newest.number) && line.is_free());
        let now = Instant::now();
        let due = newest.as_ref().map(|_| sent_at.map_or(now, |at| at + EVERY.mul_f64(EARLY)));
        if let Some(newest) = newest.filter(|_| due.is_some_and(|due| due <= now)) {
            (shown, sent_at) = (Some(newest.number), Some(Instant::now()));
            let messages = run.staging().frame(&newest);
            line.put(Session::time(SimTime::at_tick(newest.tick))).await?;
            line.put_all(given(session, &messages)).await?;
            line.ping().await?;
            continue;
        }
        if new.over && !over {
            over = true;
            let text = "the run has ended; connect again to play its recording";
            line.put(Out::Text(protocol::status(Level::Info, text, Some("end")))).await?;
        }
        let came = tokio::select! {
            biased;
            () = std::future::ready(()), if early.is_some() => early.take().unwrap_or(Came::Nothing),
            changed = news.changed() => {
                if changed.is_err() {
                    return Ok(());
                }
                continue;
            }
            message = stream.next() => came(line, message),
            () = tokio::time::sleep_until(due.unwrap_or_else(Instant::now)), if due.is_some() => continue,
            _ = beat.tick() => {
                line.beat().await?;
                continue;
            }
        };
        if line.parts(&came).await {
            return Ok(());
        }
        let heard = {
            let mut staging = run.staging();
            let heard = hear(session, &came, staging.stage());
            staging.wants(guest, session.wanted());
            heard
        };
        line.put_all(heard.out).await?;
    }
}

/// A recording that one viewer plays.
struct Player<'a> {
    run: &'a Run,
    recording: Arc<Recording>,
    line: Pinged,
    stage: Stage,
    session: Session,
    eyes: Eyes,
    /// Where it is, simulated s.
    at_s: f64,
    events: usize,
    /// The tick that was shown last.
    shown: Option<u64>,
}

impl<'a> Player<'a> {
    fn new(run: &'a Run, recording: Arc<Recording>, line: Pinged, records: bool) -> Self {
        let stage = stage(&run.scene);
        let end = SimTime::of_last(recording.ticks() as u64).nanos();
        let session = Session::new(&name(run), Some((0, end)), run.id().as_str(), offers(&stage, records));
        let eyes = run.eyes();
        Self { run, recording, line, stage, session, eyes, at_s: 0.0, events: 0, shown: None }
    }

    async fn talk(mut self, mut stream: Stream) -> Result<(), Gone> {
        let mut early = greeted(&mut self.line, &mut stream).await?;
        self.line.put_all(self.session.opening()).await?;
        let mut step = tokio::time::interval(EVERY);
        step.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        let mut before = Instant::now();
        loop {
            let came = tokio::select! {
                biased;
                () = std::future::ready(()), if early.is_some() => early.take().unwrap_or(Came::Nothing),
                message = stream.next() => came(&mut self.line, message),
                now = step.tick() => {
                    let passed_s = (now - before).as_secs_f64();
                    before = now;
                    self.play(passed_s).await?;
                    self.line.beat().await?;
                    continue;
                }
            };
            if self.line.parts(&came).await {
                return Ok(());
            }
            let heard = hear(&mut self.session, &came, &self.stage);
            self.line.put_all(heard.out).await?;
            for Ask::Play { seek, .. } in heard.asks {
                if let Some(to) = seek {
                    self.jump(to).await?;
                }
            }
            if !heard.fresh.is_empty() {
                // Where the time stands still, what was just subscribed to is shown once.
                self.shown = None;
                self.show(heard.fresh).await?;
            }
        }
    }

    /// Goes on by what has passed of the clock, where it plays.
    async fn play(&mut self, passed_s: f64) -> Result<(), Gone> {
        let Some(playback) = self.session.playback().filter(|playback| playback.playing) else { return Ok(()) };
        if !self.line.is_free() {
            return Ok(());
        }
        let end_s = SimTime::from_nanos(playback.end).secs();
        self.at_s = (self.at_s + passed_s * f64::from(playback.speed)).min(end_s);
        self.show(self.session.wanted()).await
    }

    async fn jump(&mut self, to: SimTime) -> Result<(), Gone> {
        self.stage.rewind();
        self.eyes = self.run.eyes();
        (self.at_s, self.events, self.shown) = (to.secs(), 0, None);
        self.happened(false).await?;
        self.show(self.session.wanted()).await?;
        let caught_up = self.session.caught_up(&self.stage);
        self.line.put_all(caught_up).await
    }

    /// Shows the events up to now; `told`: to the viewer as well.
    async fn happened(&mut self, told: bool) -> Result<(), Gone> {
        let recording = Arc::clone(&self.recording);
        let wanted = if told { self.session.wanted() } else { fox::Topics::NONE };
        while let Some(event) = recording.events.get(self.events).filter(|event| event.time.secs() <= self.at_s + 1e-9)
        {
            self.events += 1;
            self.eyes.happened(event);
            let messages = self.stage.event(event, &words(&event.kind), wanted);
            self.line.put_all(given(&self.session, &messages)).await?;
        }
        Ok(())
    }

    /// Shows the moment on these topics, unless it was shown.
    async fn show(&mut self, topics: fox::Topics) -> Result<(), Gone> {
        self.happened(true).await?;
        let step_s = self.recording.header.step_s.max(1e-6);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time within the recording")]
        let tick = (self.at_s / step_s + 1e-6) as usize;
        let states = self.recording.tick(tick);
        if states.is_empty() || self.shown == Some(tick as u64) {
            return Ok(());
        }
        self.shown = Some(tick as u64);
        let time = SimTime::at_tick(tick as u64);
        let scan = ranges(&self.eyes.look(states));
        let messages = self.stage.frame(&Frame { time, states, scan: scan.as_deref() }, topics);
        self.line.put(Session::time(time)).await?;
        self.line.put_all(given(&self.session, &messages)).await?;
        if let Some(out) = self.session.moved(time) {
            self.line.put(out).await?;
        }
        self.line.ping().await
    }
}
