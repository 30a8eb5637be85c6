//! Runs on the bus: one that is announced is listed; a viewer's question makes it followed.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use async_trait::async_trait;
use bytes::Bytes;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use socrates_kit::{Blobs, chain};
use socrates_link::{Bus, Overflow, keys};
use socrates_model::driver::grid_of;
use socrates_model::live::{LiveEnd, LiveMeta};
use socrates_model::{
    AgentState, Digest, FORMAT, Location, Recording, RecordingHeader, Role, RunId, SceneGraph, SimTime,
};
use socrates_stream::{Past, Sharpness, Sight, Watch};

use crate::hub::Shelf;
use crate::judge::Papers;
use crate::run::{Phase, Run, Ticks, ticks_of_an_answer};
use crate::scene::Scene;

/// Announcements that may wait unread.
const DEPTH: usize = 256;
/// Runs that are listed; of those that are over, the oldest names go.
const LISTED: usize = 2_000;
/// How often all runs are asked for: one that was announced before anybody listened is found so.
const LOOK: Duration = Duration::from_secs(2);
/// Limit of one question.
const TIMEOUT: Duration = Duration::from_secs(2);
/// How long a run may be silent before it is asked whether it is still there.
const SILENCE: Duration = Duration::from_secs(2);
/// How often a run is judged while it goes on.
const JUDGE: Duration = Duration::from_secs(1);
/// Runs with more agents are judged at their end alone: every tick of them would have to be fetched.
const JUDGED_AGENTS: usize = 50;
/// Ticks that are fetched at a time.
const FETCH_TICKS: u64 = 400;
/// First pause before the recording of a run that is over is asked for again, which its worker hands in a moment later, and how often it is
/// asked for; each pause is longer than the one before. The first come quickly: an orchestrator that has nothing else to do leaves soon.
const RECORDING: (Duration, u32) = (Duration::from_millis(20), 24);
/// Longest such pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(2);

/// The runs of a bus.
pub struct Air {
    bus: Arc<dyn Bus>,
    known: Arc<Mutex<BTreeMap<RunId, LiveMeta>>>,
}

impl Air {
    /// Listens for announcements from now on, until the bus is closed.
    ///
    /// # Errors
    /// Why the bus cannot be listened to.
    pub async fn listen(bus: Arc<dyn Bus>) -> Result<Self, String> {
        let known: Arc<Mutex<BTreeMap<RunId, LiveMeta>>> = Arc::default();
        let mut metas = bus.subscribe(keys::RUNS, DEPTH, Overflow::DropOldest).await.map_err(|why| why.to_string())?;
        let (asking, heard) = (Arc::clone(&bus), Arc::clone(&known));
        tokio::spawn(async move {
            let mut look = tokio::time::interval(LOOK);
            look.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
            loop {
                tokio::select! {
                    message = metas.next() => match message {
                        Some((_, body)) => note(&heard, &body),
                        None => return,
                    },
                    _ = look.tick() => {
                        let all = asking.query_all(keys::RUNS, Vec::new(), LISTED, TIMEOUT).await;
                        all.unwrap_or_default().iter().for_each(|body| note(&heard, body));
                    }
                }
            }
        });
        Ok(Self { bus, known })
    }

    fn known(&self) -> MutexGuard<'_, BTreeMap<RunId, LiveMeta>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Takes an announcement; what cannot be read is not listed.
fn note(known: &Mutex<BTreeMap<RunId, LiveMeta>>, body: &[u8]) {
    let meta: LiveMeta = match serde_json::from_slice(body) {
        Ok(meta) => meta,
        Err(why) => {
            tracing::debug!(%why, "an announcement cannot be read");
            return;
        }
    };
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    if known.len() >= LISTED
        && let Some(over) = known.iter().find(|(_, meta)| meta.ended.is_some()).map(|(run, _)| run.clone())
    {
        known.remove(&over);
    }
    known.insert(meta.header.run.clone(), meta);
}

/// Title of a run: the scenario without planner and seed.
fn title(run: &RunId) -> String {
    let name = run.as_str();
    name.rsplit_once('.').map_or(name, |(scenario, _)| scenario).to_owned()
}

#[async_trait]
impl Shelf for Air {
    async fn list(&self) -> Vec<(RunId, Value)> {
        let mut metas: Vec<LiveMeta> = self.known().values().cloned().collect();
        // The newest first.
        metas.sort_by(|a, b| (b.scene.started_ms, &a.header.run).cmp(&(a.scene.started_ms, &b.header.run)));
        let line = |meta: LiveMeta| {
            let header = &meta.header;
            let told = json!({
                "run": header.run, "state": if meta.ended.is_some() { "ended" } else { "live" }, "planner": header.planner,
                "seed": header.seed, "title": title(&header.run),
                "location": meta.scene.location.as_ref().map(|place| &place.name),
                "time_s": SimTime::of_last(meta.ticks).secs(), "agents": meta.agents, "verdict": null,
            });
            (meta.header.run, told)
        };
        metas.into_iter().map(line).collect()
    }

    async fn open(&self, run: &RunId) -> Result<Option<Run>, String> {
        let watch = Watch::open_as(Arc::clone(&self.bus), run, DEPTH, Sharpness::Newest);
        let watch = watch.await.map_err(|why| chain(&why))?;
        if let Some(meta) = watch.told().cloned() {
            let location = location(&self.bus, &meta, Some(&watch)).await;
            let scene = scene(&meta, location);
            let agents = scene.header.agents.len();
            let older = Older(Past::new(Arc::clone(&self.bus), run, agents));
            self.known().insert(run.clone(), meta);
            return Ok(Some(Run::live(scene, Box::new(older))));
        }
        // Gone from the bus; what was heard of its end tells where its recording is.
        let Some(meta) = self.known().get(run).filter(|meta| meta.ended.is_some()).cloned() else { return Ok(None) };
        let location = location(&self.bus, &meta, None).await;
        let older = Older(Past::new(Arc::clone(&self.bus), run, meta.header.agents.len()));
        Ok(Some(Run::live(scene(&meta, location), Box::new(older))))
    }

    async fn begin(&self, run: &Arc<Run>) {
        if run.phase().0 != Phase::Live {
            return;
        }
        let Some(meta) = self.known().get(run.id()).cloned() else { return };
        let header = run.scene.header.clone();
        let follower = Follower { bus: Arc::clone(&self.bus), run: Arc::downgrade(run), header, meta };
        tokio::spawn(follower.follow());
    }
}

/// An artifact that the orchestrator hands out, decoded.
async fn paper<T: DeserializeOwned>(bus: &Arc<dyn Bus>, meta: &LiveMeta, role: Role) -> Option<T> {
    let bytes = blob(bus, *meta.scene.inputs.get(&role)?).await?;
    serde_json::from_slice(&bytes).map_err(|why| tracing::debug!(%role, %why, "an input cannot be read")).ok()
}

async fn blob(bus: &Arc<dyn Bus>, digest: Digest) -> Option<Vec<u8>> {
    Blobs::Bus.get(bus, digest, TIMEOUT).await.map_err(|why| tracing::debug!(%why, "an artifact is not to be had")).ok()
}

/// The place of a run: as it was read, or else the map and doors that the run tells.
async fn location(bus: &Arc<dyn Bus>, meta: &LiveMeta, watch: Option<&Watch>) -> Location {
    if let Some(location) = paper(bus, meta, Role::Location).await {
        return location;
    }
    let cells = match watch {
        Some(watch) => watch.map().await.unwrap_or_default(),
        None => Vec::new(),
    };
    let place = meta.scene.location.as_ref();
    Location {
        name: place.map_or_else(|| "somewhere".to_owned(), |place| place.name.clone()),
        grid: grid_of(place.map(|place| &place.map), &cells),
        format: FORMAT,
        description: String::new(),
        graph: SceneGraph::default(),
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

fn scene(meta: &LiveMeta, location: Location) -> Scene {
    Scene::of(meta.header.clone(), title(&meta.header.run), location, &meta.scene)
}

/// Ticks of a run that goes on, from the run itself.
struct Older(Past);

#[async_trait]
impl Ticks for Older {
    async fn ticks(&self, from: u64, to: u64, every: u64) -> Vec<Vec<AgentState>> {
        let agents = self.0.agents();
        let most = ticks_of_an_answer(agents) as u64;
        let to = to.min(from.saturating_add(most.saturating_mul(every)));
        let mut found = Vec::new();
        // Where an answer of the run would hold one of them, each is asked for by itself.
        if every >= (self.0.ticks_at_once() as u64).max(2) {
            let mut tick = from;
            while tick <= to {
                let one = self.0.ticks(tick, tick).await.unwrap_or_default();
                if one.is_empty() {
                    break;
                }
                found.push(one);
                tick = tick.saturating_add(every);
            }
            return found;
        }
        let all = self.0.ticks(from, to).await.unwrap_or_default();
        let step = usize::try_from(every).unwrap_or(usize::MAX);
        found.extend(all.chunks_exact(agents).step_by(step).map(<[AgentState]>::to_vec));
        found
    }
}

/// Follows a run to its end.
struct Follower {
    bus: Arc<dyn Bus>,
    run: Weak<Run>,
    /// With all agents, of whom the announcement may name the first.
    header: RecordingHeader,
    meta: LiveMeta,
}

impl Follower {
    async fn follow(self) {
        let papers = self.papers().await;
        let end = match Watch::open_as(Arc::clone(&self.bus), &self.header.run, DEPTH, Sharpness::Newest).await {
            Ok(watch) if watch.told().is_some() => self.watch(watch, papers.as_ref()).await,
            Ok(_) | Err(_) => self.meta.ended.clone().map(|end| (self.meta.ticks, end)),
        };
        let Some((ticks, end)) = end else { return };
        let file = end.file;
        if let Some(run) = self.run.upgrade() {
            run.end(ticks, end);
        }
        if let Some(digest) = file {
            self.fetch(digest, papers.as_ref()).await;
        }
    }

    async fn papers(&self) -> Option<Papers> {
        Some(Papers {
            location: self.run.upgrade()?.scene.location.clone(),
            request: paper(&self.bus, &self.meta, Role::Request).await,
            reading: paper(&self.bus, &self.meta, Role::Reading).await,
            proposal: paper(&self.bus, &self.meta, Role::Proposal).await?,
            paths: paper(&self.bus, &self.meta, Role::Paths).await?,
        })
    }

    /// Hands every sight to the run; gives its end, or none where nobody holds the run any more.
    async fn watch(&self, mut watch: Watch, papers: Option<&Papers>) -> Option<(u64, LiveEnd)> {
        let mut so_far = SoFar::new(&self.bus, &self.header);
        let mut judge = tokio::time::interval(JUDGE);
        judge.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        let mut silent = 0;
        loop {
            let sight = tokio::select! {
                sight = watch.next(SILENCE) => sight.ok().flatten(),
                _ = judge.tick() => {
                    let run = self.run.upgrade()?;
                    if let Some(papers) = papers && run.viewers() > 0 && so_far.fits() {
                        so_far.catch_up(&run).await;
                        run.stand(papers.judge(&so_far.recording, false));
                    }
                    continue;
                }
            };
            let run = self.run.upgrade()?;
            match sight {
                Some(Sight::Header(_) | Sight::Missing(_)) => {}
                Some(Sight::Tick { tick, states }) => run.frame(tick, states),
                Some(Sight::Event(event)) => run.event(event),
                Some(Sight::End { ticks, end }) => return Some((ticks, end)),
                None => {
                    silent += 1;
                    if silent > 5 {
                        // The worker is gone; the orchestrator starts the run again under the same name.
                        return Some((self.meta.ticks, LiveEnd::default()));
                    }
                    continue;
                }
            }
            silent = 0;
        }
    }

    /// Fetches the recording of a run that is over, and judges it.
    async fn fetch(&self, digest: Digest, papers: Option<&Papers>) {
        let (mut pause, tries) = RECORDING;
        for _try in 0..tries {
            if let Some(bytes) = blob(&self.bus, digest).await {
                let read = tokio::task::spawn_blocking(move || {
                    socrates_stream::mcap::read(&bytes).map(|recording| (recording, Bytes::from(bytes)))
                });
                let Ok(Ok((recording, file))) = read.await else { return };
                // What could not be had when the run began may be there now.
                let late = if papers.is_none() { self.papers().await } else { None };
                let Some(run) = self.run.upgrade() else { return };
                if let Some(papers) = papers.or(late.as_ref()) {
                    run.stand(papers.judge(&recording, true));
                }
                run.recorded(recording, file);
                return;
            }
            tokio::time::sleep(pause).await;
            pause = pause.mul_f64(1.5).min(LONGEST_PAUSE);
        }
    }
}

/// What was seen of a run so far, every tick of it.
struct SoFar {
    past: Past,
    recording: Recording,
}

impl SoFar {
    fn new(bus: &Arc<dyn Bus>, header: &RecordingHeader) -> Self {
        let past = Past::new(Arc::clone(bus), &header.run, header.agents.len());
        let recording = Recording { header: header.clone(), frames: Vec::new(), events: Vec::new() };
        Self { past, recording }
    }

    const fn fits(&self) -> bool {
        self.past.agents() <= JUDGED_AGENTS
    }

    /// Takes what has come since.
    async fn catch_up(&mut self, run: &Run) {
        let Some(newest) = run.newest() else { return };
        let mut next = self.recording.ticks() as u64;
        while next <= newest.tick {
            let to = newest.tick.min(next + FETCH_TICKS - 1);
            let Ok(states) = self.past.ticks(next, to).await else { return };
            if states.is_empty() {
                return;
            }
            self.recording.frames.extend(states);
            next = self.recording.ticks() as u64;
        }
        let until = newest.tick;
        self.recording.events = run.events(0).into_iter().filter(|event| event.time.tick() <= until).collect();
    }
}
