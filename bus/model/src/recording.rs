//! Recordings: agent states per tick and events of one simulated run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::gesture::Gesture;
use crate::hash::{Digest, DigestWriter};
use crate::ids::{AgentId, HumanId, NodeId, RunId};
use crate::planner_name::PlannerName;
use crate::time::SimTime;

/// State of one agent at one tick: exactly 64 bytes on every wire, little endian.
///
/// ```text
/// tick u64 · agent u32 · flags u32 [kind 0-7, gesture 8-15, leaf 16-31] · x y yaw vx vy omega f64
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AgentState {
    /// Tick number from 0; one tick is 0.01 s.
    pub tick: u64,
    /// 0 for the robot, k for `human_k`.
    pub agent: u32,
    /// Kind (bits 0–7: 0 robot, 1 human), gesture code (8–15), index of the running leaf (16–31).
    pub flags: u32,
    /// x, m.
    pub x: f64,
    /// y, m.
    pub y: f64,
    /// Heading, rad.
    pub yaw: f64,
    /// Velocity along x, m/s.
    pub vx: f64,
    /// Velocity along y, m/s.
    pub vy: f64,
    /// Turning rate, rad/s.
    pub omega: f64,
}

/// Bytes of one [`AgentState`].
pub const AGENT_STATE_BYTES: usize = 64;

impl AgentState {
    /// Packs kind, gesture and leaf.
    #[must_use]
    pub const fn flags(agent: AgentId, said: Option<Gesture>, leaf: u16) -> u32 {
        let kind = match agent {
            AgentId::Robot => 0_u32,
            AgentId::Human(_) => 1,
        };
        kind | ((Gesture::code_of(said) as u32) << 8) | ((leaf as u32) << 16)
    }

    /// Who.
    #[must_use]
    pub const fn agent_id(&self) -> AgentId {
        AgentId::from_number(self.agent)
    }

    /// The gesture being made; none for a code that is not in the table.
    #[must_use]
    pub fn gesture(&self) -> Option<Gesture> {
        u8::try_from((self.flags >> 8) & 0xff).ok().and_then(|code| Gesture::from_code(code).ok()).flatten()
    }

    /// Index of the running leaf in [`RecordingHeader::leaves`].
    #[must_use]
    pub const fn leaf(&self) -> u16 {
        (self.flags >> 16) as u16
    }

    /// Speed, m/s.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.vx.hypot(self.vy)
    }

    /// Position.
    #[must_use]
    pub fn point(&self) -> crate::Point {
        crate::Point::new(self.x, self.y)
    }

    /// Whether the agent is there, at a place; `absent` is the leaf of those who are not, see [`RecordingHeader::absent`].
    #[must_use]
    pub fn is_there(&self, absent: Option<u16>) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.yaw.is_finite() && absent != Some(self.leaf())
    }

    /// The 64 bytes.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; AGENT_STATE_BYTES] {
        let mut bytes = [0_u8; AGENT_STATE_BYTES];
        let words = [
            self.tick.to_le_bytes(),
            (u64::from(self.agent) | (u64::from(self.flags) << 32)).to_le_bytes(),
            self.x.to_le_bytes(),
            self.y.to_le_bytes(),
            self.yaw.to_le_bytes(),
            self.vx.to_le_bytes(),
            self.vy.to_le_bytes(),
            self.omega.to_le_bytes(),
        ];
        for (slot, word) in bytes.chunks_exact_mut(8).zip(words) {
            slot.copy_from_slice(&word);
        }
        bytes
    }

    /// Reads 64 bytes; `None` when there are not exactly 64.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        if bytes.len() != AGENT_STATE_BYTES {
            return None;
        }
        let word = |index: usize| -> Option<[u8; 8]> { bytes.get(index * 8..index * 8 + 8)?.try_into().ok() };
        let float = |index: usize| word(index).map(f64::from_le_bytes);
        let packed = u64::from_le_bytes(word(1)?);
        Some(Self {
            tick: u64::from_le_bytes(word(0)?),
            agent: (packed & 0xffff_ffff) as u32,
            flags: (packed >> 32) as u32,
            x: float(2)?,
            y: float(3)?,
            yaw: float(4)?,
            vx: float(5)?,
            vy: float(6)?,
            omega: float(7)?,
        })
    }
}

/// Something that happened at a tick.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// When.
    pub time: SimTime,
    /// What.
    pub kind: EventKind,
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum EventKind {
    /// An agent begins a gesture (`NONE` ends one).
    Gesture {
        /// Who.
        agent: AgentId,
        /// Which.
        #[serde(with = "crate::gesture::or_none")]
        #[schemars(with = "String")]
        gesture: Option<Gesture>,
        /// To whom, where it is made to one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<AgentId>,
    },
    /// Another leaf of a human's tree runs.
    Leaf {
        /// Who.
        human: HumanId,
        /// Name of the leaf, such as `FollowRobot`.
        leaf: String,
    },
    /// A step of a human's sequence has ended.
    StepEnded {
        /// Who.
        human: HumanId,
        /// Which step, from 1.
        step: u32,
    },
    /// A human sees the robot for the first time, or again after 2 s without sight.
    Sees {
        /// Who.
        human: HumanId,
        /// Distance, m.
        distance_m: f64,
    },
    /// Robot and human are both within 1.5 m of their encounter node, or nearest to each other near it.
    Encounter {
        /// Who.
        human: HumanId,
        /// Where.
        node: NodeId,
        /// Difference of arrival times, s; positive: the human came later.
        gap_s: f64,
        /// Which of the human's encounters, counted from 1; left out for the first.
        #[serde(default = "first", skip_serializing_if = "is_first")]
        nth: u32,
    },
    /// Two agents touch.
    Contact {
        /// One.
        a: AgentId,
        /// The other.
        b: AgentId,
        /// Depth, m.
        depth_m: f64,
    },
    /// An agent touches a wall or closed door.
    WallContact {
        /// Who.
        agent: AgentId,
        /// Depth, m.
        depth_m: f64,
    },
    /// A door opens or closes.
    Door {
        /// Which.
        door: String,
        /// Whether it is open now.
        open: bool,
    },
    /// An agent reaches a node of its path.
    Node {
        /// Who.
        agent: AgentId,
        /// Which.
        node: NodeId,
    },
    /// The robot is at its goal.
    RobotArrived,
    /// An agent made no progress for 20 s outside a stated wait.
    Stuck {
        /// Who.
        agent: AgentId,
    },
    /// The run ends.
    End {
        /// Why: `done`, `time`, `stuck`.
        reason: String,
    },
}

/// Name of the leaf of an agent that is not there: it has not come yet, or has gone. Its position then is where it comes
/// or has left, and means nothing else.
pub const ABSENT_LEAF: &str = "absent";

/// Name of the leaf of somebody who is driven from outside: no tree moves them, and what they do shows in their motion alone.
pub const DRIVEN_LEAF: &str = "external";

/// What a reader needs to know before the first tick.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecordingHeader {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// The run.
    pub run: RunId,
    /// Planner name.
    pub planner: PlannerName,
    /// Simulation seed.
    pub seed: u64,
    /// Semantics profile: `native`, …
    pub profile: String,
    /// Step, s.
    pub step_s: f64,
    /// Agents in frame order, the robot first where there is one.
    pub agents: Vec<AgentInfo>,
    /// Names of leaves by index; 0 is none.
    pub leaves: Vec<String>,
}

impl RecordingHeader {
    /// Index of [`ABSENT_LEAF`] among the leaves; `None` where everybody is there all the time.
    #[must_use]
    pub fn absent(&self) -> Option<u16> {
        let index = self.leaves.iter().skip(1).position(|leaf| leaf == ABSENT_LEAF)?;
        u16::try_from(index + 1).ok()
    }
}

/// A constant fact sheet of one agent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AgentInfo {
    /// Who.
    pub agent: AgentId,
    /// Radius, m.
    pub radius_m: f64,
    /// Desired speed, m/s.
    pub speed_mps: f64,
    /// Role word, `robot` for the robot.
    pub role: String,
}

/// A whole recording in memory. `frames` holds every agent of tick 0, then of tick 1, …
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Header.
    pub header: RecordingHeader,
    /// States, `agents.len()` per tick.
    pub frames: Vec<AgentState>,
    /// Events in time order.
    pub events: Vec<Event>,
}

impl Recording {
    /// Number of ticks recorded.
    #[must_use]
    pub fn ticks(&self) -> usize {
        let agents = self.header.agents.len().max(1);
        self.frames.len() / agents
    }

    /// States of one tick.
    #[must_use]
    pub fn tick(&self, tick: usize) -> &[AgentState] {
        let agents = self.header.agents.len();
        self.frames.get(tick.saturating_mul(agents)..(tick + 1).saturating_mul(agents)).unwrap_or(&[])
    }

    /// States of one agent through the run, in tick order.
    pub fn track(&self, agent: AgentId) -> impl Iterator<Item = &AgentState> {
        let agents = self.header.agents.len().max(1);
        let start = self.header.agents.iter().position(|info| info.agent == agent).unwrap_or(usize::MAX);
        self.frames.iter().skip(start).step_by(agents)
    }

    /// The recording hash: over decoded frames and events, not over any file.
    #[must_use]
    pub fn hash(&self) -> Digest {
        let mut hash = RecordingHash::default();
        hash.states(&self.frames);
        self.events.iter().for_each(|event| hash.event(event));
        hash.finish()
    }
}

/// The recording hash of a run while it goes. It holds no frame: only the words of the events, which come after all frames.
#[derive(Debug, Clone, Default)]
pub struct RecordingHash {
    frames: DigestWriter,
    events: Vec<u8>,
}

impl RecordingHash {
    /// Takes the next states, in frame order.
    pub fn states(&mut self, states: &[AgentState]) {
        states.iter().for_each(|state| self.frames.write(&state.to_bytes()));
    }

    /// The same with the bytes of the states one after the other, as [`AgentState::to_bytes`] makes them.
    pub fn state_bytes(&mut self, bytes: &[u8]) {
        self.frames.write(bytes);
    }

    /// Takes the next event.
    pub fn event(&mut self, event: &Event) {
        // Events hold no map without order, so their JSON is canonical.
        if let Ok(text) = serde_json::to_vec(event) {
            self.events.extend_from_slice(&text);
        }
        self.events.push(b'\n');
    }

    /// The hash of all that was taken.
    #[must_use]
    pub fn finish(mut self) -> Digest {
        self.frames.write(&self.events);
        self.frames.finish()
    }
}

const fn first() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
const fn is_first(nth: &u32) -> bool {
    *nth == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_leaf_of_the_absent_is_never_the_first() {
        let header = |leaves: &[&str]| RecordingHeader {
            format: 1,
            run: RunId::new("test").unwrap(),
            planner: PlannerName::no_robot(),
            seed: 1,
            profile: "native".into(),
            step_s: 0.01,
            agents: vec![],
            leaves: leaves.iter().map(|leaf| (*leaf).to_owned()).collect(),
        };
        assert_eq!(header(&["", "track", ABSENT_LEAF]).absent(), Some(2));
        // Index 0 is none, whatever its name.
        assert_eq!((header(&[ABSENT_LEAF, "track"]).absent(), header(&[]).absent()), (None, None));
    }

    #[test]
    fn the_hash_of_a_run_that_goes_is_that_of_the_whole_recording() {
        let state = |tick, agent| AgentState {
            tick,
            agent,
            flags: agent,
            x: 0.5,
            y: -1.0,
            yaw: 0.1,
            vx: 0.2,
            vy: 0.3,
            omega: 0.0,
        };
        let frames: Vec<AgentState> = (0..50).flat_map(|tick| [state(tick, 0), state(tick, 1)]).collect();
        let event = |tick| Event { time: SimTime::at_tick(tick), kind: EventKind::RobotArrived };
        let events = vec![event(3), event(40)];
        let mut bytes: Vec<u8> = frames.iter().flat_map(AgentState::to_bytes).collect();
        for event in &events {
            bytes.extend(serde_json::to_vec(event).unwrap());
            bytes.push(b'\n');
        }
        // Events come between the ticks, as a run tells them.
        let mut hash = RecordingHash::default();
        for (tick, states) in frames.chunks(2).enumerate() {
            match tick % 2 {
                0 => hash.states(states),
                _ => hash.state_bytes(&states.iter().flat_map(AgentState::to_bytes).collect::<Vec<u8>>()),
            }
            events.iter().filter(|event| event.time.tick() == tick as u64).for_each(|event| hash.event(event));
        }
        assert_eq!(hash.finish(), Digest::of(&bytes));
    }

    #[test]
    fn a_state_is_64_bytes_and_comes_back_as_it_was() {
        let state = AgentState {
            tick: 7,
            agent: 2,
            flags: AgentState::flags(AgentId::from_number(2), Some(Gesture::Wait), 513),
            x: 1.5,
            y: -2.25,
            yaw: 0.1,
            vx: 0.3,
            vy: 0.4,
            omega: -1.0,
        };
        let back = AgentState::from_bytes(&state.to_bytes()).unwrap();
        assert_eq!(back, state);
        assert_eq!(back.gesture(), Some(Gesture::Wait));
        assert_eq!(back.leaf(), 513);
        assert!((back.speed() - 0.5).abs() < 1e-12);
    }
}
