//! Frames over the bus: several ticks to a message, which may be lost, and a door where the lost can be fetched.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use socrates_link::{Ask, Bus, Envelope, LinkError, Publish, Qos, Serving, encode, keys};
use socrates_model::RunId;
use socrates_model::recording::{AgentState, Event, RecordingHeader};
use tokio::sync::Notify;
use tokio::task::JoinHandle;

use crate::error::StreamError;
use crate::mcap::Tape;
use crate::part;
use crate::shelf::{Ctl, KIND_CTL, KIND_META, Shelf};
use crate::sink::FrameSink;

/// Ticks that go out together, where they come that fast.
const TOGETHER: u64 = 10;
/// Longest time that a tick waits for others, where they come slowly.
const GATHER: Duration = Duration::from_millis(50);

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
    /// last seconds are kept here; older ticks are read from `tape`, where somebody else records the run.
    ///
    /// # Errors
    /// [`StreamError::Link`].
    pub async fn open(bus: Arc<dyn Bus>, run: &RunId, tape: Tape, linger: &Linger) -> Result<Self, StreamError> {
        let failed = |why: LinkError| StreamError::Link { run: run.to_string(), why };
        let meta = bus.serve(&keys::live_meta(run)).await.map_err(failed)?;
        let ctl = bus.serve(&keys::live_ctl(run)).await.map_err(failed)?;
        let (shelf, news) = (Arc::new(Shelf::before(tape)), Arc::new(Notify::new()));
        let task = Publisher { bus, run: run.clone(), shelf: Arc::clone(&shelf), news: Arc::clone(&news) };
        let publisher = Some(tokio::spawn(task.publish(meta, ctl, linger.clone())));
        Ok(Self { shelf, news, publisher })
    }

    /// Waits until the run is on the bus to its end and the linger time is over; a run without an end ends here.
    pub async fn finished(mut self) {
        self.shelf.end();
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
        self.shelf.end();
        self.news.notify_one();
    }
}

impl FrameSink for LiveSink {
    fn announce(&mut self, header: &RecordingHeader) {
        self.shelf.announce(header);
        self.news.notify_one();
    }

    fn tick(&mut self, tick: u64, states: &[AgentState]) {
        self.shelf.tick(states);
        // Waking somebody costs more than a tick; who waits for fewer, or comes later, is looked for now and then.
        if tick % TOGETHER == TOGETHER - 1 && self.shelf.is_heard() {
            self.news.notify_one();
        }
    }

    fn event(&mut self, event: &Event) {
        self.shelf.event(event);
        if self.shelf.is_heard() {
            self.news.notify_one();
        }
    }

    fn end(&mut self) {
        self.shelf.end();
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
    async fn publish(self, mut meta: Serving, mut ctl: Serving, linger: Linger) {
        let served = async {
            loop {
                let answered = tokio::select! {
                    Some(ask) = meta.next() => self.answer_meta(ask).await,
                    Some(ask) = ctl.next() => self.answer_ctl(ask).await,
                    else => return,
                };
                if let Err(why) = answered {
                    tracing::debug!(run = %self.run, %why, "an answer about a run did not go out");
                }
            }
        };
        let told = async {
            if let Err(why) = self.tell().await {
                tracing::warn!(run = %self.run, %why, "the live stream ended early; the run goes on");
            }
            if self.shelf.is_heard() {
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

    /// Publishes what is new until the run is over.
    async fn tell(&self) -> Result<(), LinkError> {
        let meta = self.bus.publisher(&keys::live_meta(&self.run), Qos::Hint).await?;
        let agents = self.bus.publisher(&keys::live_agents(&self.run), Qos::Stream).await?;
        let (mut announced, mut told_ticks, mut told_events) = (false, 0_u64, 0_u64);
        loop {
            self.shelf.hears(agents.is_heard());
            let (ticks, events, ended) = self.shelf.standing();
            if !announced && self.shelf.meta().is_some() {
                self.say(&*meta).await?;
                announced = true;
            }
            self.tell_ticks(&*agents, told_ticks, ticks).await?;
            // What nobody hears is not sent: whoever comes later fetches it.
            told_ticks = ticks;
            if ended && !announced {
                return Ok(());
            }
            if told_events < events || ended {
                // Says how many there are; whoever wants them fetches them.
                self.say(&*meta).await?;
                told_events = events;
            }
            if ended {
                return if agents.is_heard() { agents.put(part::over(ticks)).await } else { Ok(()) };
            }
            // Whoever watches a slow run waits no longer than this for its ticks.
            drop(tokio::time::timeout(GATHER, self.news.notified()).await);
        }
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

    /// Tells how the run stands, where anybody listens.
    async fn say(&self, meta: &dyn Publish) -> Result<(), LinkError> {
        if meta.is_heard() { meta.put(self.meta_message()?).await } else { Ok(()) }
    }

    fn meta_message(&self) -> Result<Vec<u8>, LinkError> {
        match self.shelf.meta() {
            // A watcher of version 1 would take the messages of the frame key for something else.
            Some(meta) => encode(&Envelope::fresh(KIND_META, self.bus.name(), 0, meta).for_readers_of(part::VERSION)),
            None => Err(LinkError::NoReply { key: keys::live_meta(&self.run) }),
        }
    }

    async fn answer_meta(&self, ask: Ask) -> Result<(), LinkError> {
        // Before the announcement there is nothing to say: the asker hears no reply and asks again.
        ask.reply(self.meta_message()?).await
    }

    async fn answer_ctl(&self, ask: Ask) -> Result<(), LinkError> {
        let name = self.bus.name();
        match ask.read::<Ctl>(KIND_CTL) {
            Ok(envelope) => match envelope.body {
                Ctl::Frames { from, to, part } => {
                    let message = self.shelf.message(from, to, part).map(|(message, _)| message);
                    ask.reply(message.unwrap_or_default()).await
                }
                Ctl::Events { from } => ask.answer(KIND_CTL, name, 0, &self.shelf.events(from)).await,
                Ctl::Agents { from } => ask.answer(KIND_CTL, name, 0, &self.shelf.agents(from)).await,
            },
            Err(why) => ask.refuse(name, 0, &why.to_string()).await,
        }
    }
}
