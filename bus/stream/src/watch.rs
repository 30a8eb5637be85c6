//! Watching a run over the bus: every tick in order, or the exact list of those that are missing.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, Envelope, LinkError, Overflow, Subscription, call, decode, encode, keys};
use socrates_model::RunId;
use socrates_model::recording::{AgentInfo, AgentState, Event, RecordingHeader};
use tokio::time::Instant;

use crate::error::StreamError;
use crate::order::{Order, Seen, TickRange};
use crate::part::{self, Joiner, Part};
use crate::shelf::{Ctl, KIND_CTL, KIND_META, Meta};

/// Silence after which the run is asked how it stands.
const IDLE: Duration = Duration::from_millis(300);
/// Limit of one question to the run.
const TIMEOUT: Duration = Duration::from_secs(2);

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
    },
}

/// A watcher of one run.
pub struct Watch {
    bus: Arc<dyn Bus>,
    run: RunId,
    agents: Subscription,
    meta: Subscription,
    header: Option<RecordingHeader>,
    joiner: Joiner,
    order: Order,
    events: u64,
    ended: bool,
    ready: VecDeque<Sight>,
}

impl Watch {
    /// Begins to watch, before the run or in the midst of it. `depth` is the number of messages that may wait unread;
    /// each holds up to ten ticks.
    ///
    /// # Errors
    /// [`StreamError::Link`].
    pub async fn open(bus: Arc<dyn Bus>, run: &RunId, depth: usize) -> Result<Self, StreamError> {
        let failed = |why: LinkError| StreamError::Link { run: run.to_string(), why };
        let agents = bus.subscribe(&keys::live_agents(run), depth, Overflow::DropOldest).await.map_err(failed)?;
        let meta = bus.subscribe(&keys::live_meta(run), 64, Overflow::DropOldest).await.map_err(failed)?;
        let mut watch = Self {
            bus,
            run: run.clone(),
            agents,
            meta,
            header: None,
            joiner: Joiner::default(),
            order: Order::new(),
            events: 0,
            ended: false,
            ready: VecDeque::new(),
        };
        watch.look(false).await?;
        Ok(watch)
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
                    let meta = decode::<Meta>(KIND_META, &body).map_err(|why| self.failed(why))?;
                    self.hear(meta.body, false).await?;
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

    /// Every tick that is missing, in order.
    #[must_use]
    pub fn missing(&self) -> &[TickRange] {
        self.order.missing()
    }

    /// Fetches missing ticks; those that the run still has are given in order and are missing no longer.
    ///
    /// # Errors
    /// [`StreamError::Link`] when the run cannot be asked any more.
    pub async fn fetch(&mut self, range: TickRange) -> Result<Vec<AgentState>, StreamError> {
        let agents = self.agents_count();
        let (mut fetched, mut joiner): (Vec<AgentState>, Joiner) = (Vec::new(), Joiner::default());
        let (mut from, mut asked) = (range.from, 0);
        while from <= range.to {
            let ask = Ctl::Frames { from, to: range.to, part: asked };
            let body = encode(&Envelope::fresh(KIND_CTL, self.bus.name(), 0, ask)).map_err(|why| self.failed(why))?;
            let reply =
                self.bus.query(&keys::live_ctl(&self.run), body, TIMEOUT).await.map_err(|why| self.failed(why))?;
            let states = match part::read(&reply, agents) {
                Some(Part::Ticks(states)) => states,
                Some(Part::Piece { tick, part, last, states }) if tick == from && part == asked => {
                    let joined = joiner.join((tick, part, last), states, agents);
                    if !last {
                        asked += 1;
                        continue;
                    }
                    asked = 0;
                    joined.unwrap_or_default()
                }
                Some(Part::Piece { .. } | Part::Over(_)) | None => break,
            };
            if states.first().is_none_or(|first| first.tick != from) {
                break;
            }
            for states in states.chunks_exact(agents) {
                self.order.filled(from);
                fetched.extend_from_slice(states);
                from += 1;
            }
        }
        Ok(fetched)
    }

    fn failed(&self, why: LinkError) -> StreamError {
        StreamError::Link { run: self.run.to_string(), why }
    }

    /// Asks the run how it stands. `quiet`: nothing has come for a while, so what is not here will not come.
    async fn look(&mut self, quiet: bool) -> Result<(), StreamError> {
        match self.bus.query(&keys::live_meta(&self.run), Vec::new(), TIMEOUT).await {
            Ok(reply) => {
                let meta = decode::<Meta>(KIND_META, &reply).map_err(|why| self.failed(why))?;
                self.hear(meta.body, quiet).await
            }
            Err(why) if why.is_transient() && why != LinkError::Closed => Ok(()),
            Err(why) => Err(self.failed(why)),
        }
    }

    async fn hear(&mut self, meta: Meta, quiet: bool) -> Result<(), StreamError> {
        if self.header.is_none() {
            if meta.version != part::VERSION {
                let (found, known) = (meta.version.max(1), part::VERSION);
                return Err(self.failed(LinkError::Incompatible { found, needs: known, low: known, high: known }));
            }
            let mut header = meta.header;
            if !self.agents_up_to(&mut header.agents, meta.agents).await? {
                return Ok(());
            }
            self.ready.push_back(Sight::Header(header.clone()));
            self.header = Some(header);
        }
        self.events_up_to(meta.events).await?;
        if quiet && meta.ended {
            // Frames that came while the run was asked go first.
            while let Some((_, body)) = self.agents.try_next() {
                self.frame(&body);
            }
            self.end(meta.ticks);
        }
        Ok(())
    }

    /// Fetches the agents that did not fit into the message about the run; `false` where it does not answer now.
    async fn agents_up_to(&self, agents: &mut Vec<AgentInfo>, count: u64) -> Result<bool, StreamError> {
        while (agents.len() as u64) < count {
            let ask = Ctl::Agents { from: agents.len() as u64 };
            let more: Vec<AgentInfo> = match call(&*self.bus, &keys::live_ctl(&self.run), KIND_CTL, &ask, TIMEOUT).await
            {
                Ok(more) => more,
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
            let ask = Ctl::Events { from: self.events };
            let events: Vec<Event> = match call(&*self.bus, &keys::live_ctl(&self.run), KIND_CTL, &ask, TIMEOUT).await {
                Ok(events) => events,
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
                Seen::Next => {}
                Seen::After(gap) => self.ready.push_back(Sight::Missing(gap)),
            }
            self.ready.push_back(Sight::Tick { tick, states: states.to_vec() });
        }
        None
    }

    fn end(&mut self, ticks: u64) {
        if self.ended {
            return;
        }
        self.ready.extend(self.order.up_to(ticks).map(Sight::Missing));
        self.ready.push_back(Sight::End { ticks });
        self.ended = true;
    }
}
