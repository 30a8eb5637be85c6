//! Tells frames and events of a run, each thing once.

use std::collections::BTreeMap;

use socrates_model::{AgentId, AgentState, Event, EventKind, HumanId, NodeId, Onlooker, Point, SimTime};

use crate::contacts::Touch;

/// A touch counts anew after so long without, s.
const TOUCH_AGAIN_S: f64 = 1.0;
/// Touches shallower than this are not told, m: forces bring shoulders together, not collisions.
const TOUCH_LEAST_M: f64 = 1e-3;
/// Sight counts anew after so long without, s.
const SIGHT_AGAIN_S: f64 = 2.0;
/// Both within this distance of the node meet there, m.
const MEET_M: f64 = 1.5;
/// Both within this distance of the node as they pass each other met near it, m.
const NEAR_M: f64 = 3.0;

/// How an encounter goes.
#[derive(Debug, Clone, Default)]
struct Meeting {
    robot_s: Option<(f64, f64)>,
    human_s: Option<(f64, f64)>,
    closest_m: f64,
    told: bool,
}

/// Tells a run while it goes: states per tick, and events each told once. It keeps no tick but the events of the last.
///
/// Per tick: [`Recorder::at`], then any of the events, then [`Recorder::frame`].
#[derive(Debug, Default)]
pub struct Recorder {
    now: SimTime,
    fresh: Vec<Event>,
    /// Those of the tick that ended last.
    last: Vec<Event>,
    touches: BTreeMap<(AgentId, Option<AgentId>), f64>,
    sights: BTreeMap<HumanId, f64>,
    meetings: BTreeMap<(HumanId, u32), Meeting>,
}

impl Recorder {
    /// One that has told nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Begins a tick: everything told from now on has this time.
    pub const fn at(&mut self, now: SimTime) {
        self.now = now;
    }

    /// Tells an event of this tick.
    pub fn tell(&mut self, kind: EventKind) {
        self.fresh.push(Event { time: self.now, kind });
    }

    /// Tells a contact, unless the same two touched within the last second or hardly (less than 1 mm).
    pub fn touch(&mut self, touch: Touch) {
        let (key, depth) = match touch {
            Touch::Agents(a, b, depth) => ((a, Some(b)), depth),
            Touch::Wall(a, depth) => ((a, None), depth),
        };
        let now = self.now.secs();
        let known = self.touches.insert(key, now);
        if depth < TOUCH_LEAST_M || known.is_some_and(|last| now - last < TOUCH_AGAIN_S) {
            return;
        }
        self.tell(match touch {
            Touch::Agents(a, b, depth_m) => EventKind::Contact { a, b, depth_m },
            Touch::Wall(agent, depth_m) => EventKind::WallContact { agent, depth_m },
        });
    }

    /// Tells that a human sees the robot, unless it did within the last 2 s.
    pub fn sight(&mut self, human: HumanId, distance_m: f64) {
        let now = self.now.secs();
        let known = self.sights.insert(human, now);
        if known.is_none_or(|last| now - last >= SIGHT_AGAIN_S) {
            self.tell(EventKind::Sees { human, distance_m });
        }
    }

    /// One tick of a human's nth encounter, from 1; true from the tick on at which it has happened. Who stands there is never late.
    pub fn meet(
        &mut self,
        (human, nth): (HumanId, u32),
        (node, spot): (&NodeId, &Point),
        robot: &Point,
        person: &Point,
        stands: bool,
    ) -> bool {
        let now = self.now.secs();
        let fresh = || Meeting { closest_m: f64::INFINITY, ..Meeting::default() };
        let meeting = self.meetings.entry((human, nth)).or_insert_with(fresh);
        if meeting.told {
            return true;
        }
        let (r, h) = ((robot - spot).norm(), (person - spot).norm());
        arrive(&mut meeting.robot_s, r, now);
        arrive(&mut meeting.human_s, h, now);
        let apart = (robot - person).norm();
        let near = r <= NEAR_M && h <= NEAR_M;
        if near {
            meeting.closest_m = meeting.closest_m.min(apart);
        }
        let met = r <= MEET_M && h <= MEET_M;
        // They pass each other near the node: nearest so far, and drawing apart.
        let passed = near && apart > meeting.closest_m + 0.3 && meeting.closest_m < NEAR_M;
        if !(met || passed) {
            return false;
        }
        meeting.told = true;
        let time = |arrival: &Option<(f64, f64)>| arrival.map_or(now, |(at, _)| at);
        let gap_s = if stands {
            0.0
        } else if met {
            now_or(&meeting.human_s, now) - now_or(&meeting.robot_s, now)
        } else {
            time(&meeting.human_s) - time(&meeting.robot_s)
        };
        self.tell(EventKind::Encounter { human, node: node.clone(), gap_s, nth });
        true
    }

    /// Ends a tick: hands its frame and fresh events on. `states` are in the header's order.
    pub fn frame(&mut self, states: &[AgentState], onlooker: &mut dyn Onlooker) {
        onlooker.tick(states, &self.fresh);
        std::mem::swap(&mut self.last, &mut self.fresh);
        self.fresh.clear();
    }

    /// Events of the tick that ended last.
    #[must_use]
    pub fn last_tick(&self) -> &[Event] {
        &self.last
    }
}

/// First time within [`MEET_M`], else the time of the nearest so far.
fn arrive(arrival: &mut Option<(f64, f64)>, distance: f64, now: f64) {
    match arrival {
        Some((_, nearest)) if *nearest <= MEET_M => {}
        Some((_, nearest)) if distance >= *nearest => {}
        Some(_) | None => *arrival = Some((now, distance)),
    }
}

fn now_or(arrival: &Option<(f64, f64)>, now: f64) -> f64 {
    arrival.map_or(now, |(at, _)| at)
}
