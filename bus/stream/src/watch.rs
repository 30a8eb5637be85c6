//! Watching a run over the bus: every tick in order, or the exact list of those that are missing.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use serde::de::DeserializeOwned;
use socrates_link::{Bus, LinkError, Overflow, Subscription, keys};
use socrates_model::RunId;
use socrates_model::live::{LiveEnd, LiveEvents, LiveMeta, VERSION};
use socrates_model::lockstep::MAP_HEAD_BYTES;
use socrates_model::recording::{AgentInfo, AgentState, Event, RecordingHeader};
use tokio::time::Instant;

use crate::error::StreamError;
use crate::order::{Order, Seen, TickRange};
use crate::part::{self, Joiner, Part};
use crate::past::{Past, TIMEOUT};
use crate::shelf::Ctl;

/// Silence after which the run is asked how it stands.
const IDLE: Duration = Duration::from_millis(300);

/// What a watcher sees.
#[derive(Debug, Clone, PartialEq)]
pub enum Sight {
    /// The run: always first.
    Header(RecordingHeader),
    /// Every agent of the next tick.
    Tick {
        /// Which.
        tick: u64,
        /// The states in the header's order.
        states: Vec<AgentState>,
    },
    /// These ticks did not come; [`Watch::fetch`] gets them.
    Missing(TickRange),
    /// The next event.
    Event(Event),
    /// The run is over after so many ticks.
    End {
        /// How many.
        ticks: u64,
        /// How it is recorded, where the run said so.
        end: LiveEnd,
    },
}

/// What is watched of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharpness {
    /// Every tick.
    Whole,
    /// The newest tick, at most twenty a second: what is between is left out, and none is missing.
    Newest,
}

/// A watcher of one run.
pub struct Watch {
    bus: Arc<dyn Bus>,
    run: RunId,
    agents: Subscription,
    meta: Subscription,
    happenings: Subscription,
    sharpness: Sharpness,
    header: Option<RecordingHeader>,
    /// What was said of the run last.
    told: Option<LiveMeta>,
    joiner: Joiner,
    order: Order,
    events: u64,
    ended: bool,
    ready: VecDeque<Sight>,
}

impl Watch {
    /// Begins to watch every tick, before the run or in the midst of it. `depth` is the number of messages that may wait unread;
    /// each holds up to ten ticks.
    ///
    /// # Errors
    /// [`StreamError::Link`].
    pub async fn open(bus: Arc<dyn Bus>, run: &RunId, depth: usize) -> Result<Self, StreamError> {
        Self::open_as(bus, run, depth, Sharpness::Whole).await
    }

    /// The same, as sharp as wanted.
    ///
    /// # Errors
    /// [`StreamError::Link`].
    pub async fn open_as(
        bus: Arc<dyn Bus>,
        run: &RunId,
        depth: usize,
        sharpness: Sharpness,
    ) -> Result<Self, StreamError> {
        let failed = |why: LinkError| StreamError::Link { run: run.to_string(), why };
        let frames = match sharpness {
            Sharpness::Whole => keys::live_agents(run),
            Sharpness::Newest => keys::live_latest(run),
        };
        let agents = bus.subscribe(&frames, depth, Overflow::DropOldest).await.map_err(failed)?;
        let meta = bus.subscribe(&keys::live_meta(run), 64, Overflow::DropOldest).await.map_err(failed)?;
        let happenings = bus.subscribe(&keys::live_events(run), 256, Overflow::DropOldest).await.map_err(failed)?;
        let mut watch = Self {
            bus,
            run: run.clone(),
            agents,
            meta,
            happenings,
            sharpness,
            header: None,
            told: None,
            joiner: Joiner::default(),
            order: Order::new(),
            events: 0,
            ended: false,
            ready: VecDeque::new(),
        };
        watch.look(false).await?;
        Ok(watch)
    }

    /// What the run said of itself last: place, goal, pace, inputs, with all its agents; none before it was heard.
    #[must_use]
    pub const fn told(&self) -> Option<&LiveMeta> {
        self.told.as_ref()
    }

    /// The cells of the map, row by row from the lower left: 0 free, 100 occupied, 255 unknown; none where the run has no map.
    ///
    /// # Errors
    /// [`StreamError::Link`] when the run cannot be asked.
    pub async fn map(&self) -> Result<Vec<u8>, StreamError> {
        let Some(place) = self.told.as_ref().and_then(|told| told.scene.location.as_ref()) else {
            return Ok(Vec::new());
        };
        let whole = place.map.width.saturating_mul(place.map.height);
        let mut cells = Vec::new();
        while cells.len() < whole {
            let first = (cells.len() as u64).to_le_bytes().to_vec();
            let asked = self.bus.query(&keys::live_map(&self.run), first, TIMEOUT).await;
            let part = asked.map_err(|why| self.failed(why))?;
            let Some(part) = part.get(MAP_HEAD_BYTES..).filter(|part| !part.is_empty()) else { break };
            cells.extend_from_slice(part);
        }
        cells.truncate(whole);
        Ok(cells)
    }

    /// The next sight; `None` when nothing came within `patience`, or after the end.
    ///
    /// # Errors
    /// [`StreamError::Link`] when the bus is closed or speaks another version.
    pub async fn next(&mut self, patience: Duration) -> Result<Option<Sight>, StreamError> {
        let until = Instant::now() + patience;
        loop {
            if let Some(sight) = self.ready.pop_front() {
                return Ok(Some(sight));
            }
            let now = Instant::now();
            if self.ended || now >= until {
                return Ok(None);
            }
            let idle = IDLE.min(until - now);
            tokio::select! {
                biased;
                message = self.meta.next() => {
                    let Some((_, body)) = message else { return Err(self.failed(LinkError::Closed)) };
                    let meta = self.meta_of(&body)?;
                    self.hear(meta, false).await?;
                }
                message = self.happenings.next(), if self.header.is_some() => {
                    let Some((_, body)) = message else { return Err(self.failed(LinkError::Closed)) };
                    self.happened(self.json("its events", &body)?).await?;
                }
                message = self.agents.next(), if self.header.is_some() => {
                    let Some((_, body)) = message else { return Err(self.failed(LinkError::Closed)) };
                    if let Some(ticks) = self.frame(&body) {
                        self.look(false).await?;
                        self.end(ticks);
                    }
                }
                () = tokio::time::sleep(idle) => self.look(true).await?,
            }
        }
    }

    /// Every tick that is missing, in order; those left out, where the newest alone are watched.
    #[must_use]
    pub fn missing(&self) -> &[TickRange] {
        self.order.missing()
    }

    /// Fetches missing ticks; those that the run still has are given in order and are missing no longer.
    ///
    /// # Errors
    /// [`StreamError::Link`] when the run cannot be asked any more.
    pub async fn fetch(&mut self, range: TickRange) -> Result<Vec<AgentState>, StreamError> {
        let fetched = self.past().ticks(range.from, range.to).await?;
        for states in fetched.chunks_exact(self.agents_count()) {
            if let Some(state) = states.first() {
                self.order.filled(state.tick);
            }
        }
        Ok(fetched)
    }

    fn past(&self) -> Past {
        Past::new(Arc::clone(&self.bus), &self.run, self.agents_count())
    }

    fn failed(&self, why: LinkError) -> StreamError {
        StreamError::Link { run: self.run.to_string(), why }
    }

    /// Asks the run how it stands. `quiet`: nothing has come for a while, so what is not here will not come.
    async fn look(&mut self, quiet: bool) -> Result<(), StreamError> {
        match self.bus.query(&keys::live_meta(&self.run), Vec::new(), TIMEOUT).await {
            Ok(reply) => {
                let meta = self.meta_of(&reply)?;
                self.hear(meta, quiet).await
            }
            Err(why) if why.is_transient() && why != LinkError::Closed => Ok(()),
            Err(why) => Err(self.failed(why)),
        }
    }

    /// Reads what a run says in JSON.
    fn json<T: DeserializeOwned>(&self, what: &str, bytes: &[u8]) -> Result<T, StreamError> {
        serde_json::from_slice(bytes).map_err(|why| {
            let kind = format!("what the run says of {what}");
            self.failed(LinkError::Decode { kind, len: bytes.len(), why: why.to_string() })
        })
    }

    fn meta_of(&self, bytes: &[u8]) -> Result<LiveMeta, StreamError> {
        #[derive(serde::Deserialize)]
        struct Head {
            version: u32,
        }
        let known = VERSION;
        let incompatible =
            |found: u32| self.failed(LinkError::Incompatible { found, needs: known, low: known, high: known });
        // Before version 3 it was MessagePack.
        if !bytes.starts_with(b"{") {
            return Err(incompatible(2));
        }
        let head: Head = self.json("itself", bytes)?;
        if head.version != known {
            return Err(incompatible(head.version));
        }
        self.json("itself", bytes)
    }

    async fn hear(&mut self, meta: LiveMeta, quiet: bool) -> Result<(), StreamError> {
        if self.header.is_none() {
            let mut header = meta.header.clone();
            if !self.agents_up_to(&mut header.agents, meta.agents).await? {
                return Ok(());
            }
            self.ready.push_back(Sight::Header(header.clone()));
            self.header = Some(header);
        }
        self.events_up_to(meta.events).await?;
        let (ended, ticks) = (meta.ended.is_some(), meta.ticks);
        // With all agents, of whom a message may hold the first.
        let header = self.header.clone().unwrap_or_else(|| meta.header.clone());
        self.told = Some(LiveMeta { header, ..meta });
        if quiet && ended {
            // Frames that came while the run was asked go first.
            while let Some((_, body)) = self.agents.try_next() {
                self.frame(&body);
            }
            self.end(ticks);
        }
        Ok(())
    }

    /// Takes events that came; those between are fetched.
    async fn happened(&mut self, LiveEvents { first, events }: LiveEvents) -> Result<(), StreamError> {
        self.events_up_to(first).await?;
        let known = self.events.saturating_sub(first);
        for event in events.into_iter().skip(usize::try_from(known).unwrap_or(usize::MAX)) {
            if self.events < first {
                // What is missing could not be fetched now; all of it is asked for again.
                break;
            }
            self.events += 1;
            self.ready.push_back(Sight::Event(event));
        }
        Ok(())
    }

    /// Fetches the agents that did not fit into the message about the run; `false` where it does not answer now.
    async fn agents_up_to(&self, agents: &mut Vec<AgentInfo>, count: u64) -> Result<bool, StreamError> {
        while (agents.len() as u64) < count {
            let more: Vec<AgentInfo> = match self.past().ask(&Ctl::Agents { from: agents.len() as u64 }).await {
                Ok(more) => self.json("its agents", &more)?,
                Err(why) if why.is_transient() => return Ok(false),
                Err(why) => return Err(self.failed(why)),
            };
            if more.is_empty() {
                return Ok(false);
            }
            agents.extend(more);
        }
        Ok(true)
    }

    fn agents_count(&self) -> usize {
        self.header.as_ref().map_or(1, |header| header.agents.len()).max(1)
    }

    async fn events_up_to(&mut self, count: u64) -> Result<(), StreamError> {
        while self.events < count {
            let LiveEvents { events, .. } = match self.past().ask(&Ctl::Events { from: self.events }).await {
                Ok(events) => self.json("its events", &events)?,
                Err(why) if why.is_transient() => return Ok(()),
                Err(why) => return Err(self.failed(why)),
            };
            if events.is_empty() {
                return Ok(());
            }
            self.events += events.len() as u64;
            self.ready.extend(events.into_iter().map(Sight::Event));
        }
        Ok(())
    }

    /// Takes one message of frames; gives the number of ticks when it says that the run is over.
    fn frame(&mut self, body: &[u8]) -> Option<u64> {
        let agents = self.agents_count();
        let states = match part::read(body, agents)? {
            Part::Over(ticks) => return Some(ticks),
            Part::Ticks(states) => states,
            Part::Piece { tick, part, last, states } => self.joiner.join((tick, part, last), states, agents)?,
        };
        for states in states.chunks_exact(agents) {
            let tick = states.first()?.tick;
            match self.order.saw(tick) {
                Seen::Old => continue,
                Seen::After(gap) if self.sharpness == Sharpness::Whole => self.ready.push_back(Sight::Missing(gap)),
                Seen::Next | Seen::After(_) => {}
            }
            self.ready.push_back(Sight::Tick { tick, states: states.to_vec() });
        }
        None
    }

    fn end(&mut self, ticks: u64) {
        if self.ended {
            return;
        }
        let missing = self.order.up_to(ticks).filter(|_| self.sharpness == Sharpness::Whole);
        self.ready.extend(missing.map(Sight::Missing));
        let end = self.told.as_ref().and_then(|told| told.ended.clone()).unwrap_or_default();
        self.ready.push_back(Sight::End { ticks, end });
        self.ended = true;
    }
}
