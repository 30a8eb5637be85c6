//! One run as all its viewers share it: its scene, its newest frame, what happened, how it stands.
//!
//! A viewer waits for [`Run::news`] and takes what it lacks. Nothing waits for a viewer, and nothing is kept for one: frames of the past
//! come from the run itself while it goes on, then from its recording.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use async_trait::async_trait;
use bytes::Bytes;
use serde_json::{Value, json};
use socrates_draw::live_floor::LiveFloor;
use socrates_model::live::LiveEnd;
use socrates_model::{AgentState, Event, EventKind, Recording, RunId, SimTime};
use tokio::sync::watch;

use crate::frame::{Frame, Sights, encode};
use crate::scene::{Eyes, Scene};
use crate::staging::Staging;
use crate::words::event_json;

/// Bytes of one answer with frames.
pub const ANSWER_BYTES: usize = 4 * 1024 * 1024;

/// Whether a run goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// It goes on.
    Live,
    /// It ended while it was watched.
    Ended,
    /// It was read from a bundle.
    Kept,
}

impl Phase {
    /// The word of the page.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Live => "live",
            Self::Ended => "ended",
            Self::Kept => "kept",
        }
    }
}

/// Where the ticks of a live run come from.
#[async_trait]
pub trait Ticks: Send + Sync {
    /// The states of the ticks from one to another, every so many, in order and as many as are to be had at once. Each entry is a
    /// whole tick.
    async fn ticks(&self, from: u64, to: u64, every: u64) -> Vec<Vec<AgentState>>;
}

/// How a run stands: clauses and metrics, as the page is told.
#[derive(Debug, Clone, Default)]
pub struct Standing {
    /// Simulated time of the judgment, s.
    pub time_s: f64,
    /// Whether it is the last word.
    pub last: bool,
    /// The verdict; none before the end.
    pub verdict: Option<String>,
    /// The clauses, as JSON.
    pub clauses: Vec<Value>,
    /// The metrics, as JSON.
    pub metrics: Vec<Value>,
}

impl Standing {
    /// As the page is told.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "op": "standing", "time_s": self.time_s, "final": self.last, "verdict": self.verdict,
            "clauses": self.clauses, "metrics": self.metrics,
        })
    }
}

struct State {
    eyes: Eyes,
    newest: Option<Arc<Frame>>,
    ticks: u64,
    events: Vec<Event>,
    standing: Standing,
    /// Grows with every new standing.
    standings: u64,
    phase: Phase,
    end: LiveEnd,
    recording: Option<Arc<Recording>>,
    file: Option<Bytes>,
}

/// What is new of a run.
#[derive(Debug, Clone, Default)]
pub struct News {
    /// The newest frame.
    pub newest: Option<Arc<Frame>>,
    /// Events so far.
    pub events: usize,
    /// Standings so far.
    pub standings: u64,
    /// Whether the run is over.
    pub over: bool,
}

/// A run.
pub struct Run {
    /// What it is.
    pub scene: Scene,
    /// The drawing of its floor.
    pub floor: LiveFloor,
    /// What the page is told of the scene, written once: that of a crowd is long.
    told: String,
    /// Eyes before the first tick.
    eyes: Eyes,
    state: Mutex<State>,
    news: watch::Sender<News>,
    staging: Mutex<Staging>,
    older: Box<dyn Ticks>,
}

impl Run {
    /// A run that has not begun yet; `older` knows its ticks.
    #[must_use]
    pub fn live(scene: Scene, older: Box<dyn Ticks>) -> Self {
        let eyes = Eyes::of(&scene);
        let state = State {
            eyes: eyes.clone(),
            newest: None,
            ticks: 0,
            events: Vec::new(),
            standing: Standing::default(),
            standings: 0,
            phase: Phase::Live,
            end: LiveEnd::default(),
            recording: None,
            file: None,
        };
        let staging = Mutex::new(Staging::of(&scene));
        let floor = LiveFloor::of(&scene.location);
        let told = scene.json(&floor).to_string();
        let (state, news) = (Mutex::new(state), watch::Sender::new(News::default()));
        Self { scene, floor, told, eyes, state, news, staging, older }
    }

    /// A run that was recorded, with its file.
    #[must_use]
    pub fn kept(scene: Scene, recording: Recording, file: Bytes, standing: Standing) -> Self {
        let run = Self::live(scene, Box::new(Nothing));
        {
            let mut state = run.state();
            state.end = LiveEnd { recording: Some(recording.hash()), file: None };
            (state.phase, state.ticks, state.standing) = (Phase::Kept, recording.ticks() as u64, standing);
            state.standings = 1;
            state.events.clone_from(&recording.events);
            (state.recording, state.file) = (Some(Arc::new(recording)), Some(file));
        }
        run.tell();
        run
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Eyes that have seen nothing yet.
    #[must_use]
    pub fn eyes(&self) -> Eyes {
        self.eyes.clone()
    }

    /// What its viewers in Foxglove share.
    pub fn staging(&self) -> MutexGuard<'_, Staging> {
        self.staging.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tell(&self) {
        let news = {
            let state = self.state();
            News {
                newest: state.newest.clone(),
                events: state.events.len(),
                standings: state.standings,
                over: state.phase != Phase::Live,
            }
        };
        self.news.send_replace(news);
    }

    /// Its name.
    #[must_use]
    pub const fn id(&self) -> &RunId {
        &self.scene.header.run
    }

    /// Tells whenever there is something new.
    #[must_use]
    pub fn news(&self) -> watch::Receiver<News> {
        self.news.subscribe()
    }

    /// How many viewers wait for news.
    #[must_use]
    pub fn viewers(&self) -> usize {
        self.news.receiver_count()
    }

    /// Takes the newest tick.
    pub fn frame(&self, tick: u64, states: Vec<AgentState>) {
        {
            let mut state = self.state();
            let number = state.newest.as_ref().map_or(0, |frame| frame.number.wrapping_add(1));
            let sights = state.eyes.look(&states);
            let bytes = self.bytes(number, tick, &states, &sights).into();
            state.ticks = state.ticks.max(tick + 1);
            state.newest = Some(Arc::new(Frame { tick, number, states, sights, bytes }));
        }
        self.tell();
    }

    fn bytes(&self, number: u32, tick: u64, states: &[AgentState], sights: &Sights) -> Vec<u8> {
        encode(number, SimTime::at_tick(tick).secs(), states, self.scene.header.absent(), sights)
    }

    /// Takes an event.
    pub fn event(&self, event: Event) {
        {
            let mut state = self.state();
            state.eyes.happened(&event);
            state.events.push(event);
        }
        self.tell();
    }

    /// Takes a new standing.
    pub fn stand(&self, standing: Standing) {
        {
            let mut state = self.state();
            state.standing = standing;
            state.standings += 1;
        }
        self.tell();
    }

    /// The run is over after so many ticks. What it was recorded as can be handed in now or later.
    pub fn end(&self, ticks: u64, end: LiveEnd) {
        {
            let mut state = self.state();
            state.phase = Phase::Ended;
            state.ticks = state.ticks.max(ticks);
            state.end = end;
        }
        self.tell();
    }

    /// Takes the recording of a run that is over, as it was read and as a file.
    pub fn recorded(&self, recording: Recording, file: Bytes) {
        let mut state = self.state();
        state.ticks = recording.ticks() as u64;
        state.events.clone_from(&recording.events);
        (state.recording, state.file) = (Some(Arc::new(recording)), Some(file));
        drop(state);
        self.tell();
    }

    /// The newest frame; none before the first.
    #[must_use]
    pub fn newest(&self) -> Option<Arc<Frame>> {
        self.state().newest.clone()
    }

    /// Whether it goes on, and how it ended.
    #[must_use]
    pub fn phase(&self) -> (Phase, LiveEnd) {
        let state = self.state();
        (state.phase, state.end.clone())
    }

    /// Whether it is over and its recording is not here.
    #[must_use]
    pub fn is_bare(&self) -> bool {
        let state = self.state();
        state.phase == Phase::Ended && state.recording.is_none()
    }

    /// Why it ended, in its own word: `done`, `time`, `stuck`; `given up` for one that did not come to its end, none while it goes on.
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        let state = self.state();
        let told = state.events.iter().rev().find_map(|event| {
            let EventKind::End { reason } = &event.kind else { return None };
            Some(reason.clone())
        });
        (state.phase != Phase::Live).then(|| told.unwrap_or_else(|| "given up".to_owned()))
    }

    /// Simulated time so far, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        SimTime::of_last(self.state().ticks).secs()
    }

    /// What the page is told first, as JSON: the scene, whether the run goes on, and how many ticks there are.
    #[must_use]
    pub fn scene_json(&self) -> String {
        let (word, ticks) = {
            let state = self.state();
            (state.phase.word(), state.ticks)
        };
        let scene = self.told.strip_suffix('}').unwrap_or_default();
        format!("{scene},\"state\":\"{word}\",\"ticks\":{ticks}}}")
    }

    /// One line of the list of runs.
    #[must_use]
    pub fn line(&self) -> Value {
        let state = self.state();
        let header = &self.scene.header;
        json!({
            "run": header.run, "state": state.phase.word(), "planner": header.planner, "seed": header.seed,
            "title": self.scene.title, "location": self.scene.location.name,
            "time_s": SimTime::of_last(state.ticks).secs(),
            "agents": header.agents.len(), "verdict": state.standing.verdict,
        })
    }

    /// Events from a number on.
    #[must_use]
    pub fn events(&self, from: usize) -> Vec<Event> {
        self.state().events.get(from..).unwrap_or_default().to_vec()
    }

    /// The same, as the page is told.
    #[must_use]
    pub fn events_json(&self, from: usize) -> Vec<Value> {
        self.state().events.get(from..).unwrap_or_default().iter().map(event_json).collect()
    }

    /// How it stands.
    #[must_use]
    pub fn standing(&self) -> Standing {
        self.state().standing.clone()
    }

    /// The recording and its file, once the run is over and they are here.
    #[must_use]
    pub fn recording(&self) -> Option<(Arc<Recording>, Bytes)> {
        let state = self.state();
        state.recording.clone().zip(state.file.clone())
    }

    /// Frames of the ticks from one to another, every so many, one after the other, at most [`ANSWER_BYTES`].
    pub async fn frames(&self, from: u64, to: u64, every: u64) -> Vec<u8> {
        let (every, mut eyes) = (every.max(1), self.eyes());
        let (recording, events) = {
            let state = self.state();
            (state.recording.clone(), state.events.clone())
        };
        let found: Vec<Vec<AgentState>> = match &recording {
            Some(recording) => some_ticks(recording, from, to, every),
            None => self.older.ticks(from, to, every).await,
        };
        let mut bytes = Vec::new();
        let mut doors = events.iter().peekable();
        for (number, states) in (0..).zip(&found) {
            let Some(tick) = states.first().map(|state| state.tick) else { continue };
            while let Some(event) = doors.next_if(|event| event.time.tick() <= tick) {
                eyes.happened(event);
            }
            bytes.extend(self.bytes(number, tick, states, &eyes.look(states)));
            if bytes.len() >= ANSWER_BYTES {
                break;
            }
        }
        bytes
    }
}

/// Ticks of so many agents that fill an answer.
#[must_use]
pub const fn ticks_of_an_answer(agents: usize) -> usize {
    let agents = if agents == 0 { 1 } else { agents };
    ANSWER_BYTES / (agents * crate::frame::RECORD_BYTES) + 1
}

/// Ticks of a recording, as many as an answer can hold.
fn some_ticks(recording: &Recording, from: u64, to: u64, every: u64) -> Vec<Vec<AgentState>> {
    let most = ticks_of_an_answer(recording.header.agents.len());
    let last = to.min((recording.ticks() as u64).saturating_sub(1));
    let step = usize::try_from(every).unwrap_or(usize::MAX);
    let wanted = (from..=last).step_by(step).take(most);
    wanted.filter_map(|tick| usize::try_from(tick).ok()).map(|tick| recording.tick(tick).to_vec()).collect()
}

/// Knows no ticks: those of a kept run are in its recording.
struct Nothing;

#[async_trait]
impl Ticks for Nothing {
    async fn ticks(&self, _from: u64, _to: u64, _every: u64) -> Vec<Vec<AgentState>> {
        Vec::new()
    }
}
