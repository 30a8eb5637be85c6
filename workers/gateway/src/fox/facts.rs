//! What is shown: the facts of a run before its first frame, the frames, and the messages that are made of them.

use bytes::Bytes;
use socrates_model::SimTime;
use socrates_model::grid::Grid;
use socrates_model::recording::{AgentInfo, AgentState};

use super::channels::Topic;

/// What is known of a run before its first frame.
#[derive(Debug, Clone, Copy, Default)]
pub struct Facts<'a> {
    /// Everybody, as the header of the recording has them; the robot is among them where there is one.
    pub agents: &'a [AgentInfo],
    /// Index of the leaf of those who are not there, see [`socrates_model::recording::RecordingHeader::absent`].
    pub absent: Option<u16>,
    /// The map; without it `/map` is not offered.
    pub grid: Option<&'a Grid>,
    /// The doors, as they stand before the first frame.
    pub doors: &'a [Door<'a>],
    /// The robot's intended way, start first, goal last, m in the map frame; without it `/robot/plan` is not offered.
    pub way: &'a [[f64; 2]],
    /// The robot's goal, m in the map frame.
    pub goal: Option<[f64; 2]>,
    /// Whether frames will carry scans; without them `/scan` is not offered.
    pub scans: bool,
}

/// A door.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Door<'a> {
    /// Its name, unique among the doors.
    pub id: &'a str,
    /// One end, m in the map frame.
    pub from: [f64; 2],
    /// The other end, m in the map frame.
    pub to: [f64; 2],
    /// Whether it is open.
    pub open: bool,
}

/// One moment of a run.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// When, simulated.
    pub time: SimTime,
    /// Everybody at that time, at best in the order of [`Facts::agents`]; somebody whom those do not name has no shape.
    pub states: &'a [AgentState],
    /// A scan of the robot's lidar: ranges in m, beam 0 straight ahead, counter-clockwise, evenly over the whole circle;
    /// infinite where nothing is in range.
    pub scan: Option<&'a [f32]>,
}

/// One message for every viewer that subscribes to its topic.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// On which topic.
    pub topic: Topic,
    /// When, simulated.
    pub time: SimTime,
    /// The message as the topic's schema has it; a clone shares the bytes.
    pub payload: Bytes,
}
