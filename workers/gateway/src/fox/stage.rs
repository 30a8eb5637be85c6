//! What viewers of one run see: who is drawn, how the doors stand, what a late viewer has to be given.

use std::collections::{BTreeMap, VecDeque};

use bytes::Bytes;
use socrates_model::recording::{AgentState, Event, EventKind};
use socrates_model::{Gesture, SimTime};

use super::channels::{Topic, Topics};
use super::encode;
use super::facts::{Facts, Frame, Message};
use super::scene::{self, DoorShape, Figure};

/// Most agents who all have a shape and a frame; of more people than that the nearest have, and all are points of `/crowd`. A
/// viewer's own cost decides: a thousand entities are 0.4 MB a message.
pub const ALL_DRAWN: usize = 200;
/// How many of the people nearest to the robot have a shape and a frame where they are too many.
pub const NEAREST: usize = 50;
/// How long those stay the nearest, ns: shapes then change once a second at most.
const NEAREST_NANOS: u64 = 1_000_000_000;
/// How many events a late viewer is given.
pub const EVENTS_KEPT: usize = 256;

/// What viewers of one run see.
///
/// One for a run that goes on, however many watch it; one for each viewer of something kept, which everybody plays by themselves.
/// In order of time: [`Stage::event`] and [`Stage::frame`]. Both are told which topics anybody wants and encode no other. After a
/// jump of the time: [`Stage::rewind`], then the events before it, wanted by nobody, then its frame.
#[derive(Debug, Clone)]
pub struct Stage {
    figures: BTreeMap<u32, Figure>,
    absent: Option<u16>,
    goal: Option<[f64; 2]>,
    doors_at_first: Vec<DoorShape>,
    map: Option<Bytes>,
    plan: Option<Bytes>,
    offers: Topics,
    /// Everything below is as of this time.
    time: SimTime,
    doors: Vec<DoorShape>,
    /// Numbers of those who are drawn, in order, each with the gesture that is being made.
    shown: Vec<(u32, Option<Gesture>)>,
    nearest: Option<Nearest>,
    events: VecDeque<Message>,
}

/// The people nearest to the robot.
#[derive(Debug, Clone)]
struct Nearest {
    since: SimTime,
    /// Their numbers in order.
    agents: Vec<u32>,
}

impl Stage {
    /// The stage before the first frame.
    #[must_use]
    pub fn new(facts: &Facts<'_>) -> Self {
        let figures: BTreeMap<u32, Figure> = facts
            .agents
            .iter()
            .enumerate()
            .map(|(place, info)| (info.agent.number(), Figure::of(info, place)))
            .collect();
        let doors: Vec<DoorShape> = facts.doors.iter().map(DoorShape::of).collect();
        let (map, plan) = (facts.grid.and_then(encode::map), encode::plan(facts.way));
        let has_robot = figures.contains_key(&ROBOT);
        let offers = [
            (Topic::Map, map.is_some()),
            (Topic::Scene, true),
            (Topic::Frames, true),
            (Topic::Crowd, figures.len() > ALL_DRAWN),
            (Topic::Scan, has_robot && facts.scans),
            (Topic::Plan, plan.is_some()),
            (Topic::Odometry, has_robot),
            (Topic::Events, true),
            (Topic::Labels, true),
        ];
        Self {
            offers: offers.into_iter().filter_map(|(topic, is)| is.then_some(topic)).collect(),
            figures,
            absent: facts.absent,
            goal: facts.goal,
            doors_at_first: doors.clone(),
            map,
            plan,
            time: SimTime::ZERO,
            doors,
            shown: Vec::new(),
            nearest: None,
            events: VecDeque::new(),
        }
    }

    /// Offers `/socrates/agents` too. Foxglove and Lichtblick then show an error, because they do not know the encoding; it is
    /// for programs, and only where they ask for it.
    #[must_use]
    pub const fn with_records(mut self) -> Self {
        self.offers = self.offers.with(Topic::Agents);
        self
    }

    /// What there is to subscribe to.
    #[must_use]
    pub const fn offers(&self) -> Topics {
        self.offers
    }

    /// Time of what was shown last.
    #[must_use]
    pub const fn time(&self) -> SimTime {
        self.time
    }

    /// Shows a moment: a message for each wanted topic that has something new, in order of the channels.
    pub fn frame(&mut self, frame: &Frame<'_>, wanted: Topics) -> Vec<Message> {
        let wanted = wanted & self.offers;
        self.time = frame.time;
        let absent = self.absent;
        let is_there = |state: &&AgentState| state.is_there(absent);
        let robot = self.state_of(ROBOT, frame.states).filter(is_there);
        self.look_around(robot, frame.states.iter().filter(is_there));
        let drawn = self.drawn();
        let drawn: Vec<&AgentState> =
            drawn.filter_map(|agent| self.state_of(agent, frame.states)).filter(is_there).collect();
        let shown = drawn.iter().map(|state| (state.agent, state.gesture())).collect();
        let before = std::mem::replace(&mut self.shown, shown);
        let who = |shown: &[(u32, Option<Gesture>)]| shown.iter().map(|(agent, _)| *agent).collect::<Vec<u32>>();
        let mut out = Vec::new();
        let mut tell = |topic, payload| out.push(Message { topic, time: frame.time, payload });
        if wanted.has(Topic::Scene) && who(&before) != who(&self.shown) {
            tell(Topic::Scene, self.scene());
        }
        if wanted.has(Topic::Frames) {
            let named =
                drawn.iter().filter_map(|state| Some((self.figures.get(&state.agent)?.body.name.as_str(), *state)));
            tell(Topic::Frames, encode::frames(named, frame.time));
        }
        if wanted.has(Topic::Crowd) {
            let people = frame.states.iter().filter(|state| state.agent != ROBOT && is_there(state));
            tell(Topic::Crowd, encode::crowd(people, frame.time));
        }
        if let Some(ranges) = frame.scan.filter(|_| wanted.has(Topic::Scan)) {
            tell(Topic::Scan, encode::scan(ranges, frame.time));
        }
        if let Some(robot) = robot.filter(|_| wanted.has(Topic::Odometry)) {
            tell(Topic::Odometry, encode::odometry(robot, frame.time));
        }
        if wanted.has(Topic::Labels) && made(&before).ne(made(&self.shown)) {
            tell(Topic::Labels, self.labels());
        }
        if wanted.has(Topic::Agents) {
            tell(Topic::Agents, encode::agents(frame.states));
        }
        out
    }

    /// Shows an event with its text in sentences. A door that opens or shuts is drawn anew.
    pub fn event(&mut self, event: &Event, text: &str, wanted: Topics) -> Vec<Message> {
        let log = Message { topic: Topic::Events, time: event.time, payload: encode::log(event, text) };
        if self.events.len() >= EVENTS_KEPT {
            self.events.pop_front();
        }
        self.events.push_back(log.clone());
        let mut out = Vec::new();
        if let EventKind::Door { door: id, open } = &event.kind
            && let Some(door) = self.doors.iter_mut().find(|door| door.id == *id && door.open != *open)
        {
            door.open = *open;
            self.time = self.time.max(event.time);
            if wanted.has(Topic::Scene) {
                out.push(Message { topic: Topic::Scene, time: self.time, payload: self.scene() });
            }
        }
        if wanted.has(Topic::Events) {
            out.push(log);
        }
        out
    }

    /// What a viewer that subscribes to a topic now has to be given, oldest first; nothing for a topic that goes on by itself.
    #[must_use]
    pub fn latched(&self, topic: Topic) -> Vec<Message> {
        let whole = |payload: Bytes| vec![Message { topic, time: self.time, payload }];
        match topic {
            Topic::Map => self.map.clone().map(whole).unwrap_or_default(),
            Topic::Plan => self.plan.clone().map(whole).unwrap_or_default(),
            Topic::Scene => whole(self.scene()),
            Topic::Labels => whole(self.labels()),
            Topic::Events => self.events.iter().cloned().collect(),
            Topic::Frames | Topic::Crowd | Topic::Scan | Topic::Odometry | Topic::Agents => Vec::new(),
        }
    }

    /// Back to before the first frame: no event happened, every door stands as it did at first, nobody is drawn.
    pub fn rewind(&mut self) {
        self.time = SimTime::ZERO;
        self.doors.clone_from(&self.doors_at_first);
        self.shown.clear();
        self.nearest = None;
        self.events.clear();
    }

    fn scene(&self) -> Bytes {
        let figures = self.shown.iter().filter_map(|(agent, _)| self.figures.get(agent));
        scene::scene(self.time, figures, &self.doors, self.goal)
    }

    fn labels(&self) -> Bytes {
        let figures = made(&self.shown).filter_map(|(agent, gesture)| Some((self.figures.get(&agent)?, gesture)));
        scene::labels(self.time, figures)
    }

    /// Numbers of those who are drawn if they are there, in order.
    fn drawn(&self) -> impl Iterator<Item = u32> {
        let everybody = self.figures.keys().copied().filter(|_| self.figures.len() <= ALL_DRAWN);
        let robot = self.nearest.iter().map(|_| ROBOT);
        let people = self.nearest.iter().flat_map(|nearest| nearest.agents.iter().copied());
        everybody.chain(robot).chain(people)
    }

    /// The state of an agent: at its place in the header, where frames of a recording have it, else wherever it is.
    fn state_of<'a>(&self, agent: u32, states: &'a [AgentState]) -> Option<&'a AgentState> {
        let figure = self.figures.get(&agent)?;
        let at_place = states.get(figure.place).filter(|state| state.agent == agent);
        at_place.or_else(|| states.iter().find(|state| state.agent == agent))
    }

    /// Notes who is nearest to the robot, once a second, where they are too many.
    fn look_around<'a>(&mut self, robot: Option<&AgentState>, there: impl Iterator<Item = &'a AgentState>) {
        let Some(robot) = robot.filter(|_| self.figures.len() > ALL_DRAWN) else {
            self.nearest = None;
            return;
        };
        let age = |nearest: &Nearest| self.time.nanos().checked_sub(nearest.since.nanos());
        if self.nearest.as_ref().and_then(age).is_some_and(|age| age < NEAREST_NANOS) {
            return;
        }
        let far2 = |state: &AgentState| {
            let (dx, dy) = (state.x - robot.x, state.y - robot.y);
            dx * dx + dy * dy
        };
        let people = there.filter(|state| state.agent != ROBOT);
        let mut people: Vec<(f64, u32)> = people.map(|state| (far2(state), state.agent)).collect();
        if people.len() > NEAREST {
            // Equally far, the lower number: the same picture of the same frame.
            people.select_nth_unstable_by(NEAREST, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            people.truncate(NEAREST);
        }
        let mut agents: Vec<u32> = people.into_iter().map(|(_, agent)| agent).collect();
        agents.sort_unstable();
        self.nearest = Some(Nearest { since: self.time, agents });
    }
}

/// Frame number of the robot.
const ROBOT: u32 = 0;

/// The gestures that are being made, and by whom.
fn made(shown: &[(u32, Option<Gesture>)]) -> impl Iterator<Item = (u32, Gesture)> {
    shown.iter().filter_map(|(agent, gesture)| Some((*agent, (*gesture)?)))
}

#[cfg(test)]
mod tests;
