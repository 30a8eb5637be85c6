//! What passes between a simulated world and whoever drives the robot, or a person, in it.

use serde::{Deserialize, Serialize};

use crate::geometry::{Point, Pose, Vector};
use crate::gesture::Gesture;
use crate::ids::HumanId;
use crate::time::SimTime;

/// Somebody the robot has in line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenPerson {
    /// Who.
    pub id: HumanId,
    /// Center, m.
    pub at: Point,
    /// Velocity, m/s.
    pub velocity: Vector,
    /// Heading, rad.
    pub yaw: f64,
    /// Body radius, m.
    pub radius_m: f64,
    /// Gesture being made.
    pub gesture: Option<Gesture>,
}

/// The robot as a person sees it who is driven from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenRobot {
    /// Center, m.
    pub at: Point,
    /// Velocity, m/s.
    pub velocity: Vector,
    /// Heading, rad.
    pub yaw: f64,
    /// Radius of its body, m.
    pub radius_m: f64,
    /// Gesture being made.
    pub gesture: Option<Gesture>,
    /// Whether the person has it in sight.
    pub in_sight: bool,
}

/// A door as the robot sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenDoor {
    /// Name.
    pub id: String,
    /// One end, m.
    pub from: Point,
    /// The other end, m.
    pub to: Point,
    /// Whether it is open.
    pub open: bool,
}

/// What only an actor may know: the `reference` planner plays a script, planners under test do not look here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cues<'a> {
    /// Humans who will come out of the place the robot wants to enter or pass, or go in before it, and have not yet.
    pub leavers_inside: u32,
    /// How far everybody is with their steps.
    pub people: &'a [HumanCue],
}

/// How far a person is with the steps of their sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HumanCue {
    /// The person.
    pub human: HumanId,
    /// Number of the last step that has ended; 0 for none.
    pub steps_ended: u32,
    /// Whether all have, as [`Trigger::Done`](crate::Trigger::Done) says.
    pub is_done: bool,
}

impl HumanCue {
    /// Whether this is the person, and that step of theirs has ended.
    #[must_use]
    pub fn has_ended(&self, human: HumanId, step: u32) -> bool {
        self.human == human && self.steps_ended >= step
    }
}

/// The world at the start of a call, from the place of the one who is driven: the robot, or a person.
pub struct Observation<'a> {
    /// Time of the run.
    pub time: SimTime,
    /// Pose of the one who is driven.
    pub pose: Pose,
    /// Forward speed, m/s.
    pub v: f64,
    /// Speed to the left, m/s; 0 for a robot unless its base is omnidirectional.
    pub vy: f64,
    /// Turning rate, rad/s.
    pub omega: f64,
    /// Other people in line of sight, by id.
    pub people: &'a [SeenPerson],
    /// The robot, for a person who is driven; nothing for the robot itself, and where there is none.
    pub robot: Option<SeenRobot>,
    /// Everybody else on the floor, in line of sight or not, by id; made when asked for.
    pub everybody: &'a dyn Fn() -> Vec<SeenPerson>,
    /// Doors of the location.
    pub doors: &'a [SeenDoor],
    /// One lidar scan: 360 ranges in m, beam 0 straight ahead, counter-clockwise by one degree; made when asked for.
    pub lidar: &'a dyn Fn() -> Vec<f64>,
    /// For actors only.
    pub cues: Cues<'a>,
}

/// What a planner wants.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Command {
    /// Forward speed, m/s.
    pub v: f64,
    /// Speed to the left, m/s; of no effect on a robot unless its base is omnidirectional.
    #[serde(default)]
    pub vy: f64,
    /// Turning rate, rad/s.
    pub omega: f64,
    /// A gesture to begin now; it is held for 2 s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gesture: Option<Gesture>,
    /// Whether the robot, or the person, stands on purpose (a stated wait), so that they do not count as stuck.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub waiting: bool,
}

/// Whoever drives the robot, or a person.
pub trait RobotDriver {
    /// Calls per simulated second; called at the first tick at or after n divided by this.
    fn rate_hz(&self) -> f64 {
        20.0
    }

    /// The next command; it holds until the next call.
    fn drive(&mut self, seen: &Observation<'_>) -> Command;

    /// Whether it drives no more: the run ends then. Default: it always drives.
    fn is_gone(&self) -> bool {
        false
    }
}
