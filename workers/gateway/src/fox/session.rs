//! One viewer: what it subscribes to, what it is sent, what it asks for.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use bytes::Bytes;
use socrates_model::SimTime;

use super::channels::{Topic, Topics};
use super::client::{self, BadMessage, ClientOp, Deed, Inbound, PlaybackControl, SUBSCRIPTIONS, Subscription};
use super::facts::Message;
use super::protocol::{
    self, Capability, HEAD_BYTES, JsonTime, Level, PlaybackStatus, ServerOp, message_head, playback_state, status,
};
use super::stage::Stage;

/// Simulated seconds per second at which something kept is played; Foxglove offers 0.01 to 5.
pub const SPEEDS: RangeInclusive<f32> = 0.01..=100.0;
/// How often one viewer is told what is wrong with its messages; after that once more, and no longer.
pub const COMPLAINTS: u32 = 20;

/// Something to be sent to one viewer.
#[derive(Debug, Clone, PartialEq)]
pub enum Out {
    /// A text.
    Text(String),
    /// Bytes.
    Binary(Bytes),
    /// A message: these bytes of the viewer's own, and after them in the same frame those that all viewers share.
    Data {
        /// The viewer's own.
        head: [u8; HEAD_BYTES],
        /// Shared.
        payload: Bytes,
    },
}

impl Out {
    /// The bytes of a frame in one piece; of a text its letters.
    #[must_use]
    pub fn into_bytes(self) -> Bytes {
        match self {
            Self::Text(text) => text.into_bytes().into(),
            Self::Binary(bytes) => bytes,
            Self::Data { head, payload } => [head.as_slice(), payload.as_ref()].concat().into(),
        }
    }

    /// How many bytes its frame has.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Binary(bytes) => bytes.len(),
            Self::Data { payload, .. } => HEAD_BYTES + payload.len(),
        }
    }

    /// Whether its frame is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What a viewer asks of the one who shows something kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ask {
    /// To go on like this, after a jump to `seek`.
    Play {
        /// Whether to play; else to stand.
        playing: bool,
        /// Simulated seconds per second, within [`SPEEDS`].
        speed: f32,
        /// Where to go first, within what is kept. After it: [`Stage::rewind`], the events before, the frame, then
        /// [`Session::caught_up`], because a viewer that jumps forgets what it has drawn.
        seek: Option<SimTime>,
    },
}

/// What becomes of a message of a viewer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Heard {
    /// To be sent to it, in this order.
    pub out: Vec<Out>,
    /// What it asks for.
    pub asks: Vec<Ask>,
    /// What it has just subscribed to. Where time stands still, the newest frame has to be shown once more for these.
    pub fresh: Topics,
}

/// How far a viewer of something kept is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Playback {
    /// Begin of what is kept, ns.
    pub start: u64,
    /// End of what is kept, ns.
    pub end: u64,
    /// Where it is, ns.
    pub at: u64,
    /// Simulated seconds per second.
    pub speed: f32,
    /// Whether it plays.
    pub playing: bool,
}

impl Playback {
    const fn status(&self) -> PlaybackStatus {
        match (self.playing, self.at >= self.end) {
            (true, true) => PlaybackStatus::Ended,
            (true, false) => PlaybackStatus::Playing,
            (false, _) => PlaybackStatus::Paused,
        }
    }

    fn state(&self, jumped: bool, request: &str) -> Out {
        Out::Binary(playback_state(self.status(), self.at, self.speed, jumped, request).into())
    }
}

/// One viewer. It changes nothing but itself.
#[derive(Debug, Clone)]
pub struct Session {
    name: String,
    id: String,
    offers: Topics,
    playback: Option<Playback>,
    /// Whether it has asked to play, stand or jump: before that it may not know what a state of a playback is.
    controls: bool,
    /// The viewer's number of each subscription.
    subscriptions: BTreeMap<Topic, u32>,
    /// Numbers of subscriptions that ended with their channel: a viewer may still end them.
    gone: BTreeSet<u32>,
    complaints: u32,
}

impl Session {
    /// A viewer that has just come. `name` says what is shown; `session_id` is another one whenever something else is shown;
    /// `offers` are those of the stage; `playback` is the range of something kept, begin and end in ns, and nothing for a run
    /// that goes on. Something kept plays from its begin by itself: Lichtblick has no keys for it and would show nothing.
    #[must_use]
    pub fn new(name: &str, playback: Option<(u64, u64)>, session_id: &str, offers: Topics) -> Self {
        let kept =
            |(start, end): (u64, u64)| Playback { start, end: end.max(start), at: start, speed: 1.0, playing: true };
        Self {
            name: name.to_owned(),
            id: session_id.to_owned(),
            offers,
            playback: playback.map(kept),
            controls: false,
            subscriptions: BTreeMap::new(),
            gone: BTreeSet::new(),
            complaints: 0,
        }
    }

    /// What is sent first: who speaks, and what there is.
    #[must_use]
    pub fn opening(&self) -> Vec<Out> {
        let range = self.playback.map(|playback| (JsonTime::of(playback.start), JsonTime::of(playback.end)));
        let info = ServerOp::ServerInfo {
            name: &self.name,
            capabilities: [Capability::Time].into_iter().chain(range.map(|_| Capability::PlaybackControl)).collect(),
            metadata: BTreeMap::from([("socrates", env!("CARGO_PKG_VERSION"))]),
            session_id: &self.id,
            data_start_time: range.map(|(start, _)| start),
            data_end_time: range.map(|(_, end)| end),
        };
        vec![Out::Text(info.text()), Out::Text(ServerOp::advertise(self.offers).text())]
    }

    /// Shows something else to the same viewer: what there was is taken back, and the opening follows.
    pub fn restart(&mut self, name: &str, playback: Option<(u64, u64)>, session_id: &str, offers: Topics) -> Vec<Out> {
        let channel_ids = self.offers.iter().map(Topic::id).collect();
        // A viewer ends these by itself when it hears that they are gone; older ones it has ended long since.
        let gone = self.subscriptions.values().copied().collect();
        let (controls, complaints) = (self.controls, self.complaints);
        *self = Self { gone, controls, complaints, ..Self::new(name, playback, session_id, offers) };
        let mut out = vec![Out::Text(ServerOp::Unadvertise { channel_ids }.text())];
        out.extend(self.opening());
        out
    }

    /// What it subscribes to: nothing else need be encoded for it.
    #[must_use]
    pub fn wanted(&self) -> Topics {
        self.subscriptions.keys().copied().collect()
    }

    /// Whether it subscribes to a topic.
    #[must_use]
    pub fn wants(&self, topic: Topic) -> bool {
        self.subscriptions.contains_key(&topic)
    }

    /// How far a playback is; nothing for a run that goes on.
    #[must_use]
    pub const fn playback(&self) -> Option<Playback> {
        self.playback
    }

    /// A message for this viewer; nothing unless it subscribes to its topic.
    #[must_use]
    pub fn give(&self, message: &Message) -> Option<Out> {
        let subscription = self.subscriptions.get(&message.topic)?;
        let head = message_head(*subscription, message.time.nanos());
        Some(Out::Data { head, payload: message.payload.clone() })
    }

    /// All that it would be given if it subscribed now: after a jump of the time.
    #[must_use]
    pub fn caught_up(&self, stage: &Stage) -> Vec<Out> {
        self.wanted().iter().flat_map(|topic| stage.latched(topic)).filter_map(|message| self.give(&message)).collect()
    }

    /// A playback is at this time now. Where that is its end, a viewer that has keys for it is told so, once.
    pub fn moved(&mut self, time: SimTime) -> Option<Out> {
        let playback = self.playback.as_mut()?;
        let before = playback.status();
        playback.at = time.nanos().clamp(playback.start, playback.end);
        let is_at_end = playback.status() == PlaybackStatus::Ended && before != PlaybackStatus::Ended;
        (is_at_end && self.controls).then(|| playback.state(false, ""))
    }

    /// Hears a message of the viewer. Whatever is wrong with it is said to the viewer, and nothing else comes of it.
    pub fn hear(&mut self, inbound: Inbound<'_>, stage: &Stage) -> Heard {
        match client::read(inbound) {
            Ok(ClientOp::Subscribe(list)) => self.subscribe(list, stage),
            Ok(ClientOp::Unsubscribe(ids)) => self.unsubscribe(ids),
            Ok(ClientOp::Playback(control)) => self.control(control),
            Ok(ClientOp::Other(deed)) => self.refuse(&deed),
            Err(bad) => {
                let told = self.told_bad(&bad);
                Heard { out: told.into_iter().collect(), ..Heard::default() }
            }
        }
    }

    fn subscribe(&mut self, list: Vec<Subscription>, stage: &Stage) -> Heard {
        let mut heard = Heard::default();
        for Subscription { id, channel_id } in list {
            let topic = Topic::of(channel_id).filter(|topic| self.offers.has(*topic));
            let wrong = match topic {
                None => Some(format!(
                    "`subscribe` asks for channel {channel_id}, which is not advertised; channels: {}",
                    told_channels(self.offers)
                )),
                Some(topic) if self.subscriptions.contains_key(&topic) => Some(format!(
                    "`subscribe` asks for channel {channel_id} a second time; `unsubscribe` the first before"
                )),
                Some(_) if self.subscriptions.values().any(|other| *other == id) => {
                    Some(format!("`subscribe` gives the id {id} a second time; another id is needed"))
                }
                Some(_) if self.subscriptions.len() >= SUBSCRIPTIONS => {
                    Some(format!("`subscribe` asks for more than {SUBSCRIPTIONS} channels"))
                }
                Some(topic) => {
                    self.subscriptions.insert(topic, id);
                    self.gone.remove(&id);
                    heard.fresh = heard.fresh.with(topic);
                    None
                }
            };
            heard.out.extend(wrong.and_then(|wrong| self.told(Level::Error, &wrong, "subscribe")));
        }
        let late = heard.fresh.iter().flat_map(|topic| stage.latched(topic));
        heard.out.extend(late.filter_map(|message| self.give(&message)));
        heard
    }

    fn unsubscribe(&mut self, ids: Vec<u32>) -> Heard {
        let mut heard = Heard::default();
        for id in ids {
            let before = self.subscriptions.len();
            self.subscriptions.retain(|_, other| *other != id);
            if self.subscriptions.len() == before && !self.gone.remove(&id) {
                let wrong = format!("`unsubscribe` names the id {id}, which no subscription has");
                heard.out.extend(self.told(Level::Warning, &wrong, "unsubscribe"));
            }
        }
        heard
    }

    fn control(&mut self, control: PlaybackControl) -> Heard {
        let mut heard = Heard::default();
        let Some(mut playback) = self.playback else {
            let wrong = "this run goes on by itself: only what is kept can be played, stopped and wound";
            heard.out.extend(self.told(Level::Warning, wrong, "playback"));
            return heard;
        };
        self.controls = true;
        let PlaybackControl { play, speed, seek, request } = control;
        let jumped = if SPEEDS.contains(&speed) {
            playback.playing = play;
            playback.speed = speed;
            let seek = seek.map(|nanos| nanos.clamp(playback.start, playback.end));
            playback.at = seek.unwrap_or(playback.at);
            self.playback = Some(playback);
            heard.asks.push(Ask::Play { playing: play, speed, seek: seek.map(SimTime::from_nanos) });
            seek.is_some()
        } else {
            let (least, most) = (SPEEDS.start(), SPEEDS.end());
            let wrong = format!("`speed` of a playback control is {speed}; allowed: {least} to {most}");
            heard.out.extend(self.told(Level::Error, &wrong, "playback"));
            false
        };
        // A request that changes nothing is answered too: a viewer waits for it.
        heard.out.push(playback.state(jumped, &request));
        heard
    }

    fn refuse(&mut self, deed: &Deed) -> Heard {
        let what = match deed {
            Deed::Advertise { topics } => format!(" of {}", topics.first().map_or("no topic", String::as_str)),
            Deed::SetParameters { names } => format!(" of {}", names.first().map_or("none", String::as_str)),
            Deed::FetchAsset { uri, .. } => format!(" of {uri}"),
            Deed::CallService { service, .. } => format!(" of service {service}"),
            Deed::Publish { channel } => format!(" on channel {channel}"),
            Deed::Unadvertise { .. }
            | Deed::GetParameters { .. }
            | Deed::SubscribeParameterUpdates { .. }
            | Deed::UnsubscribeParameterUpdates { .. }
            | Deed::SubscribeConnectionGraph
            | Deed::UnsubscribeConnectionGraph => String::new(),
        };
        let told = format!("`{}`{what}: viewers here only read, nothing of it reaches a run", deed.op());
        Heard { out: self.told(Level::Warning, &told, deed.op()).into_iter().collect(), ..Heard::default() }
    }

    fn told_bad(&mut self, bad: &BadMessage) -> Option<Out> {
        self.told(Level::Error, &bad.to_string(), "message")
    }

    /// A status; with it a viewer's list of problems stays short, whatever it sends.
    fn told(&mut self, level: Level, message: &str, id: &str) -> Option<Out> {
        self.complaints = self.complaints.saturating_add(1);
        let id = Some(id);
        match self.complaints {
            ..=COMPLAINTS => Some(Out::Text(status(level, message, id))),
            count if count == COMPLAINTS + 1 => {
                let last = format!("{COMPLAINTS} messages were not understood; of more nothing is said");
                Some(Out::Text(status(level, &last, id)))
            }
            _ => None,
        }
    }

    /// The simulated time, for every viewer alike; where a playback is, see [`Session::moved`].
    #[must_use]
    pub fn time(time: SimTime) -> Out {
        Out::Binary(protocol::time(time.nanos()).into())
    }
}

/// Channels that there are, for an error to name.
fn told_channels(offers: Topics) -> String {
    offers.iter().map(|topic| format!("{} {}", topic.id(), topic.sheet().name)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests;
