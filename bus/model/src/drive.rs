//! What passes between a simulated world and the planner that drives the robot.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::geometry::{Point, Pose, Vector};
use crate::gesture::Gesture;
use crate::ids::{BadId, HumanId};
use crate::time::SimTime;

/// A robot body: a disc with the motion limits of its base.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(into = "String")]
#[schemars(with = "String")]
pub struct RobotModel {
    /// Name as in `robot.model` of a request.
    pub name: &'static str,
    /// Radius of the disc that covers the body, m.
    pub radius_m: f64,
    /// Largest forward speed, m/s; backward it is a quarter of it.
    pub v_max_mps: f64,
    /// Largest change of speed, m/s².
    pub a_max_mps2: f64,
    /// Largest turning rate, rad/s.
    pub omega_max_radps: f64,
    /// Range of its lidar, m.
    pub lidar_range_m: f64,
}

impl RobotModel {
    /// Every body, the default first.
    pub const ALL: [Self; 4] = [
        Self {
            name: "linorobot2",
            radius_m: 0.25,
            v_max_mps: 0.8,
            a_max_mps2: 1.0,
            omega_max_radps: 1.5,
            lidar_range_m: 12.0,
        },
        Self {
            name: "turtlebot4",
            radius_m: 0.18,
            v_max_mps: 0.46,
            a_max_mps2: 0.9,
            omega_max_radps: 1.9,
            lidar_range_m: 12.0,
        },
        Self {
            name: "jackal",
            radius_m: 0.30,
            v_max_mps: 1.2,
            a_max_mps2: 1.5,
            omega_max_radps: 2.0,
            lidar_range_m: 20.0,
        },
        Self {
            name: "tiago",
            radius_m: 0.27,
            v_max_mps: 1.0,
            a_max_mps2: 1.0,
            omega_max_radps: 1.5,
            lidar_range_m: 10.0,
        },
    ];

    /// The names, for messages.
    pub const ALLOWED: &'static str = "linorobot2, turtlebot4, jackal, tiago";
}

impl FromStr for RobotModel {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        Self::ALL.into_iter().find(|model| model.name == text).ok_or_else(|| BadId {
            what: "robot model",
            found: text.chars().take(80).collect(),
            allowed: Self::ALLOWED,
        })
    }
}

impl<'de> Deserialize<'de> for RobotModel {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        String::deserialize(from)?.parse().map_err(serde::de::Error::custom)
    }
}

impl From<RobotModel> for String {
    fn from(model: RobotModel) -> Self {
        model.name.to_owned()
    }
}

impl Default for RobotModel {
    fn default() -> Self {
        let [first, ..] = Self::ALL;
        first
    }
}

impl fmt::Display for RobotModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

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
pub struct Cues {
    /// Humans who will come out of the place the robot wants to enter or pass, or go in before it, and have not yet.
    pub leavers_inside: u32,
}

/// The world at the start of a planner call.
pub struct Observation<'a> {
    /// Time of the run.
    pub time: SimTime,
    /// Pose of the robot.
    pub pose: Pose,
    /// Forward speed, m/s.
    pub v: f64,
    /// Turning rate, rad/s.
    pub omega: f64,
    /// People in line of sight, by id.
    pub people: &'a [SeenPerson],
    /// Doors of the location.
    pub doors: &'a [SeenDoor],
    /// One lidar scan: 360 ranges in m, beam 0 straight ahead, counter-clockwise by one degree; made when asked for.
    pub lidar: &'a dyn Fn() -> Vec<f64>,
    /// For actors only.
    pub cues: Cues,
}

/// What a planner wants.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Forward speed, m/s.
    pub v: f64,
    /// Turning rate, rad/s.
    pub omega: f64,
    /// A gesture to begin now; it is held for 2 s.
    pub gesture: Option<Gesture>,
    /// Whether the robot stands on purpose (a stated wait), so that it does not count as stuck.
    pub waiting: bool,
}

/// Whoever drives the robot.
pub trait RobotDriver {
    /// Calls per simulated second; called at the first tick at or after n divided by this.
    fn rate_hz(&self) -> f64 {
        20.0
    }

    /// The next command; it holds until the next call.
    fn drive(&mut self, seen: &Observation<'_>) -> Command;
}
