//! Frames over the bus: several ticks to a message, which may be lost, and a door where the lost can be fetched.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::Serialize;
use socrates_link::{Ask, Bus, LinkError, Publish, Qos, Serving, keys};
use socrates_model::live::{LiveEnd, LiveScene};
use socrates_model::recording::{AgentState, Event, RecordingHeader};
use socrates_model::{Onlooker, RunId};
use tokio::sync::Notify;
use tokio::task::JoinHandle;
use tokio::time::Instant;

use crate::corner::SharedMemory;
use crate::error::StreamError;
use crate::mcap::Tape;
use crate::part;
use crate::shelf::{Ctl, Shelf};

/// Ticks that go out together, where they come that fast.
const TOGETHER: u64 = 10;
/// Longest time that a tick waits for others, where they come slowly.
const GATHER: Duration = Duration::from_millis(50);
/// Time from one newest tick to the next: eyes see no more, and a run at full speed is hardly held up by telling it.
const LATEST_EVERY: Duration = Duration::from_millis(48);

/// How long a finished run stays on the bus: for a time, and of those that nobody watches only the last.
#[derive(Debug, Clone)]
pub struct Linger {
    time: Duration,
    most: usize,
    waiting: Arc<Mutex<VecDeque<Arc<Notify>>>>,
}

impl Linger {
    /// Every run for this time, of those that nobody watches at most so many.
    #[must_use]
    pub fn new(time: Duration, most: usize) -> Self {
        Self { time, most, waiting: Arc::default() }
    }

    fn waiting(&self) -> MutexGuard<'_, VecDeque<Arc<Notify>>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until a run may leave that nobody watches.
    async fn unwatched(&self) {
        let leave = Arc::new(Notify::new());
        {
            let mut waiting = self.waiting();
            waiting.push_back(Arc::clone(&leave));
            while waiting.len() > self.most {
                waiting.pop_front().into_iter().for_each(|oldest| oldest.notify_one());
            }
        }
        drop(tokio::time::timeout(self.time, leave.notified()).await);
        self.waiting().retain(|other| !Arc::ptr_eq(other, &leave));
    }
}

/// Puts a run on the bus.
///
/// The simulation only writes to memory; a task publishes from there at the bus's own pace, so nobody who
/// watches can slow a run. After the end, what was missed can be fetched for the linger time.
pub struct LiveSink {
    shelf: Arc<Shelf>,
    news: Arc<Notify>,
    publisher: Option<JoinHandle<()>>,
}

impl LiveSink {
    /// Opens the run's keys. Queries are served before it returns, so that the run can be asked about from tick 0 on. The
    /// last seconds are kept here; older ticks are read from `tape`, where somebody else records the run. Viewers are told the scene,
    /// and the cells of its map, see [`socrates_model::driver::map_cells`]; none where it has no map.
    ///
    /// # Errors
    /// [`StreamError::Link`].
    pub async fn open(
        bus: Arc<dyn Bus>,
        run: &RunId,
        (scene, cells): (LiveScene, Vec<u8>),
        tape: Tape,
        linger: &Linger,
    ) -> Result<Self, StreamError> {
        let failed = |why: LinkError| StreamError::Link { run: run.to_string(), why };
        let asked = bus.serve(&keys::live_served(run)).await.map_err(failed)?;
        let (shelf, news) = (Arc::new(Shelf::before(tape, scene, cells)), Arc::new(Notify::new()));
        let task = Publisher { bus, run: run.clone(), shelf: Arc::clone(&shelf), news: Arc::clone(&news) };
        let publisher = Some(tokio::spawn(task.publish(asked, linger.clone())));
        Ok(Self { shelf, news, publisher })
    }

    /// Tells viewers that its ticks are in shared memory, too.
    #[must_use]
    pub fn sharing(self, place: SharedMemory) -> Self {
        self.shelf.shares(place);
        self
    }

    /// Waits until the run is on the bus to its end and the linger time is over; a run without an end ends here.
    pub async fn finished(mut self) {
        self.shelf.end(&LiveEnd::default());
        self.news.notify_one();
        if let Some(Err(why)) = match self.publisher.take() {
            Some(publisher) => Some(publisher.await),
            None => None,
        } {
            tracing::warn!(%why, "the live stream broke");
        }
    }
}

/// A run that is given up in its midst ends for its watchers too, and its keys go after the linger time.
impl Drop for LiveSink {
    fn drop(&mut self) {
        self.shelf.end(&LiveEnd::default());
        self.news.notify_one();
    }
}

impl Onlooker for LiveSink {
    fn announce(&mut self, header: &RecordingHeader) {
        self.shelf.announce(header);
        self.news.notify_one();
    }

    fn tick(&mut self, states: &[AgentState], events: &[Event]) {
        self.shelf.tick(states);
        let tick = states.first().map_or(0, |state| state.tick);
        // Waking somebody costs more than a tick; who waits for fewer, or comes later, is looked for now and then.
        if tick % TOGETHER == TOGETHER - 1 && self.shelf.is_heard() {
            self.news.notify_one();
        }
        events.iter().for_each(|event| self.shelf.event(event));
        if !events.is_empty() && self.shelf.is_heard() {
            self.news.notify_one();
        }
    }

    fn end(&mut self, end: &LiveEnd) {
        self.shelf.end(end);
        self.news.notify_one();
    }
}

struct Publisher {
    bus: Arc<dyn Bus>,
    run: RunId,
    shelf: Arc<Shelf>,
    news: Arc<Notify>,
}

impl Publisher {
    async fn publish(self, mut asked: Serving, linger: Linger) {
        let served = async {
            while let Some(ask) = asked.next().await {
                if let Err(why) = self.answer(ask).await {
                    tracing::debug!(run = %self.run, %why, "an answer about a run did not go out");
                }
            }
        };
        let told = async {
            let watched = self.tell().await.unwrap_or_else(|why| {
                tracing::warn!(run = %self.run, %why, "the live stream ended early; the run goes on");
                false
            });
            if watched {
                tokio::time::sleep(linger.time).await;
            } else {
                linger.unwatched().await;
            }
        };
        tokio::select! {
            () = served => {}
            () = told => {}
        }
    }

    /// Publishes what is new until the run is over; gives whether anybody watches it then.
    async fn tell(&self) -> Result<bool, LinkError> {
        let topics = Topics::declare(&*self.bus, &self.run).await?;
        let mut told = Told::default();
        loop {
            self.shelf.hears(topics.agents.is_heard());
            let now = self.shelf.standing();
            if now.announced && !told.announced {
                told.announced = true;
                self.say(&*topics.meta, &self.shelf.meta()).await?;
                self.say(&*topics.doors, &self.shelf.doors()).await?;
            }
            self.tell_ticks(&*topics.agents, told.ticks, now.ticks).await?;
            // What nobody hears is not sent: whoever comes later fetches it.
            told.ticks = now.ticks;
            self.tell_events(&*topics.events, told.events, now.events).await?;
            told.events = now.events;
            if told.turns < now.turns {
                told.turns = now.turns;
                self.say(&*topics.doors, &self.shelf.doors()).await?;
            }
            let is_due = told.latest_at.is_none_or(|at| at.elapsed() >= LATEST_EVERY);
            if told.latest < now.ticks && (is_due || now.ended) && topics.latest.is_heard() {
                (told.latest, told.latest_at) = (now.ticks, Some(Instant::now()));
                for part in self.shelf.latest() {
                    topics.latest.put(part).await?;
                }
            }
            if now.ended {
                return self.tell_end(&topics, now.announced, now.ticks).await;
            }
            // Whoever watches a slow run waits no longer than this for its ticks.
            drop(tokio::time::timeout(GATHER, self.news.notified()).await);
        }
    }

    /// Tells that the run is over, on every key that somebody may be waiting at.
    async fn tell_end(&self, topics: &Topics, announced: bool, ticks: u64) -> Result<bool, LinkError> {
        let watched = topics.agents.is_heard() || topics.latest.is_heard();
        if !announced {
            return Ok(watched);
        }
        self.say(&*topics.meta, &self.shelf.meta()).await?;
        for frames in [&topics.agents, &topics.latest] {
            if frames.is_heard() {
                frames.put(part::over(ticks)).await?;
            }
        }
        Ok(watched)
    }

    /// Publishes the ticks from one on, as long as anybody listens.
    async fn tell_ticks(&self, agents: &dyn Publish, mut from: u64, ticks: u64) -> Result<(), LinkError> {
        let mut part = 0;
        while from < ticks && agents.is_heard() {
            let together = from.saturating_add(TOGETHER).min(ticks) - 1;
            // One that is nowhere is missing, and whoever watches will know.
            let Some((message, whole)) = self.shelf.message(from, together, part) else {
                (from, part) = (from + 1, 0);
                continue;
            };
            agents.put(message).await?;
            (from, part) = if whole == 0 { (from, part + 1) } else { (from + whole, 0) };
        }
        Ok(())
    }

    /// Publishes the events from one on, as long as anybody listens.
    async fn tell_events(&self, to: &dyn Publish, mut from: u64, events: u64) -> Result<(), LinkError> {
        while from < events && to.is_heard() {
            let some = self.shelf.events(from);
            // One that fits no message is asked for as well in vain.
            from += (some.events.len() as u64).max(1);
            self.say(to, &some).await?;
        }
        Ok(())
    }

    /// Tells something in JSON, where anybody listens.
    async fn say<T: Serialize + Sync>(&self, to: &dyn Publish, what: &T) -> Result<(), LinkError> {
        if to.is_heard() { to.put(self.json(what)?).await } else { Ok(()) }
    }

    fn json<T: Serialize>(&self, what: &T) -> Result<Vec<u8>, LinkError> {
        serde_json::to_vec(what).map_err(|why| LinkError::Encode { kind: self.run.to_string(), why: why.to_string() })
    }

    async fn answer(&self, ask: Ask) -> Result<(), LinkError> {
        match keys::live_topic(ask.key()) {
            // Before the announcement there is nothing to say: the asker hears no reply and asks again.
            Some("meta") => match self.shelf.meta() {
                Some(meta) => ask.reply(self.json(&meta)?).await,
                None => Ok(()),
            },
            Some("doors") => ask.reply(self.json(&self.shelf.doors())?).await,
            Some("map") => match first_wanted(&ask) {
                Ok(first) => ask.reply(self.shelf.map(first).unwrap_or_default()).await,
                Err(why) => ask.reply(self.json(&why)?).await,
            },
            Some("events") => match first_wanted(&ask) {
                Ok(first) => ask.reply(self.json(&self.shelf.events(first))?).await,
                Err(why) => ask.reply(self.json(&why)?).await,
            },
            Some("ctl") => self.answer_ctl(ask).await,
            // Whatever else is under the run is not asked for.
            Some(_) | None => Ok(()),
        }
    }

    async fn answer_ctl(&self, ask: Ask) -> Result<(), LinkError> {
        match serde_json::from_slice(ask.body()) {
            Ok(Ctl::Frames { from, to, part }) => {
                let message = self.shelf.message(from, to, part).map(|(message, _)| message);
                ask.reply(message.unwrap_or_default()).await
            }
            Ok(Ctl::Events { from }) => ask.reply(self.json(&self.shelf.events(from))?).await,
            Ok(Ctl::Agents { from }) => ask.reply(self.json(&self.shelf.agents(from))?).await,
            Err(why) => {
                let error = serde_json::json!({
                    "error": format!("the question about `{}` cannot be read: {why}", self.run),
                    "hint": "allowed: {\"frames\": {\"from\": 0, \"to\": 9}}, {\"events\": {\"from\": 0}}, {\"agents\": {\"from\": 0}}",
                });
                ask.reply(self.json(&error)?).await
            }
        }
    }
}

/// The number of the first thing that is asked for: 8 bytes, or nothing for the first of all; else what is wrong, in JSON.
fn first_wanted(ask: &Ask) -> Result<u64, serde_json::Value> {
    if ask.body().is_empty() {
        return Ok(0);
    }
    ask.body().try_into().map(u64::from_le_bytes).map_err(|_other| {
        serde_json::json!({
            "error": format!("the question on `{}` has {} bytes", ask.key(), ask.body().len()),
            "hint": "the number of the first that is wanted as u64, little endian, in 8 bytes; none for the first of all",
        })
    })
}

/// What was told so far.
#[derive(Default)]
struct Told {
    announced: bool,
    ticks: u64,
    events: u64,
    turns: u64,
    latest: u64,
    latest_at: Option<Instant>,
}

/// The keys of a run that are published to.
struct Topics {
    meta: Box<dyn Publish>,
    agents: Box<dyn Publish>,
    latest: Box<dyn Publish>,
    events: Box<dyn Publish>,
    doors: Box<dyn Publish>,
}

impl Topics {
    async fn declare(bus: &dyn Bus, run: &RunId) -> Result<Self, LinkError> {
        Ok(Self {
            meta: bus.publisher(&keys::live_meta(run), Qos::Hint).await?,
            agents: bus.publisher(&keys::live_agents(run), Qos::Stream).await?,
            latest: bus.publisher(&keys::live_latest(run), Qos::Stream).await?,
            events: bus.publisher(&keys::live_events(run), Qos::Hint).await?,
            doors: bus.publisher(&keys::live_doors(run), Qos::Hint).await?,
        })
    }
}
