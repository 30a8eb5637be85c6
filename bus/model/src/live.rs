//! What a run says of itself while it happens, in JSON, so that a program in any language reads it; `docs/wire.md` is the manual.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::driver::{At, MissionDoor, MissionMap};
use crate::hash::Digest;
use crate::recording::{Event, RecordingHeader};
use crate::robot::RobotFile;
use crate::role::Role;

/// Version of everything under `live/<run>/`. Before 3, the run was announced in MessagePack.
pub const VERSION: u32 = 3;
/// Points of the robot's way that are told, at most: the last is always the goal.
pub const WAY_POINTS: usize = 500;

/// A run, how far it is, and how it ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LiveMeta {
    /// Always `run`.
    pub socrates: String,
    /// See [`VERSION`].
    pub version: u32,
    /// The header, with as many agents as fit into a message.
    pub header: RecordingHeader,
    /// How many agents there are; the others are asked for.
    pub agents: u64,
    /// Where it happens and what is asked of the robot.
    #[serde(flatten)]
    pub scene: LiveScene,
    /// Ticks so far.
    pub ticks: u64,
    /// Events so far.
    pub events: u64,
    /// The service of shared memory that has its ticks; none where it has none, as when another run of its name was there first.
    #[serde(default)]
    pub shared_memory: Option<String>,
    /// How it ended; none while it goes on.
    #[serde(default)]
    pub ended: Option<LiveEnd>,
}

/// What a viewer needs to know before the first tick, besides the header.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct LiveScene {
    /// The place; none where nobody told it.
    pub location: Option<LivePlace>,
    /// Doors, all shut at first but those that always stand open.
    pub doors: Vec<LiveDoor>,
    /// Body of the robot; none in a run without one.
    pub robot: Option<RobotFile>,
    /// Where the robot is to go, m.
    pub goal: Option<At>,
    /// The way through its waypoints, m, at most [`WAY_POINTS`].
    pub way: Vec<At>,
    /// Simulated seconds per second; none: as fast as it goes.
    pub pace: Option<f64>,
    /// When the run began, ms since 1970. Shown, never decides.
    pub started_ms: u64,
    /// Digests of what the run was made from, by role: the orchestrator hands out the bytes.
    pub inputs: BTreeMap<Role, Digest>,
}

/// Where a run happens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LivePlace {
    /// Name of the location.
    pub name: String,
    /// The map, without its cells, which are on a key of their own.
    pub map: MissionMap,
}

/// A door and whether it stands open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LiveDoor {
    /// Name and line.
    #[serde(flatten)]
    pub door: MissionDoor,
    /// Whether it is open.
    pub open: bool,
}

/// The doors of a run at a tick.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LiveDoors {
    /// The tick at which one of them turned last; 0 before that.
    pub tick: u64,
    /// All of them, in the order of the scene.
    pub doors: Vec<LiveDoor>,
}

/// Events of a run that follow each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LiveEvents {
    /// Number of the first, from 0.
    pub first: u64,
    /// The events.
    pub events: Vec<Event>,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct LiveEnd {
    /// The recording hash: over frames and events. None for a run that was given up.
    pub recording: Option<Digest>,
    /// Digest of the recording as a file, by which the orchestrator hands it out.
    pub file: Option<Digest>,
}
