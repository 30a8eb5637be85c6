//! What passes between a simulation and a driver outside besides the steps: the mission before the first, the end after the last.
//!
//! JSON, so that a program in any language reads it in a line; `docs/wire.md` is the manual.

use serde::{Deserialize, Serialize};

use crate::drive::Command;
use crate::hash::Digest;
use crate::ids::{HumanId, RunId};
use crate::lockstep::VERSION;
use crate::planner_name::PlannerName;
use crate::robot::RobotFile;

/// A point of the map, m.
pub type At = [f64; 2];

/// The task of one run, sent before its first step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MissionMessage {
    /// Always `mission`.
    pub socrates: String,
    /// Version of the bytes of the steps, see [`VERSION`].
    pub version: u16,
    /// Number of the run among those of this driver; every step repeats it.
    pub session: u64,
    /// The run.
    pub run: RunId,
    /// The planner's name: `external:` and that of the driver.
    pub planner: PlannerName,
    /// The seed of the run.
    pub seed: u64,
    /// `step`, `wait` or `free`.
    pub mode: String,
    /// Body and limits of the robot.
    pub robot: RobotFile,
    /// End of the robot's way, m.
    pub goal: At,
    /// Points that it has to pass, start first, goal last, m.
    pub waypoints: Vec<At>,
    /// The shortest free way through them, m; shut doors and people are not looked at.
    pub plan: Vec<At>,
    /// Doors, in the order in which the steps tell whether they are open.
    pub doors: Vec<MissionDoor>,
    /// Everybody who may be met.
    pub people: Vec<HumanId>,
    /// The map, without its cells.
    pub map: MissionMap,
}

/// A door of the map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MissionDoor {
    /// Its name.
    pub id: String,
    /// One end, m.
    pub from: At,
    /// The other end, m.
    pub to: At,
}

/// The map, without its cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MissionMap {
    /// Cells from left to right.
    pub width: usize,
    /// Cells from bottom to top.
    pub height: usize,
    /// Side of a cell, m.
    pub resolution_m: f64,
    /// Lower left corner of the first cell, m.
    pub origin: At,
    /// By how much the rows are turned round that corner, rad.
    pub yaw: f64,
    /// Digest of the cells: a driver that has them already need not ask for them again.
    pub digest: Digest,
}

/// What the driver answers to its mission. What it leaves out has the default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MissionAnswer {
    /// Version of the bytes that it reads and writes.
    pub version: u16,
    /// Steps per simulated second, 1 to 100. Default 10.
    #[serde(default = "ten")]
    pub rate_hz: f64,
    /// How far ahead of the robot the point of the plan is that each step tells, 0.1 to 20 m. Default 0.8.
    #[serde(default = "look_ahead")]
    pub look_ahead_m: f64,
    /// Which people it wants to be shown.
    #[serde(default)]
    pub people: Shown,
    /// Whether it wants the lidar scan with every step.
    #[serde(default)]
    pub lidar: bool,
    /// Whether it wants the cells of the map before the first step.
    #[serde(default)]
    pub map: bool,
    /// Why it does not drive this run, if it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

const fn ten() -> f64 {
    10.0
}

const fn look_ahead() -> f64 {
    0.8
}

/// Which people a driver is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shown {
    /// Those in the robot's line of sight.
    #[default]
    Seen,
    /// Everybody.
    All,
}

/// An answer that no mission can have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BadAnswer {
    /// It is no JSON of this form.
    #[error("the answer to the mission cannot be read: {why}; the least is {{\"version\": {VERSION}}}")]
    Form {
        /// The reader's words.
        why: String,
    },
    /// Another version.
    #[error("the driver speaks version {found}; this program speaks version {VERSION}")]
    Version {
        /// Its version.
        found: u16,
    },
    /// A rate that cannot be kept.
    #[error("`rate_hz` is {found}; allowed: 1 to 100")]
    Rate {
        /// The rate.
        found: f64,
    },
    /// A point that is too near or too far.
    #[error("`look_ahead_m` is {found}; allowed: 0.1 to 20")]
    LookAhead {
        /// The distance, m.
        found: f64,
    },
    /// The driver does not drive this run.
    #[error("the driver does not take this run: {why}")]
    Refused {
        /// Its reason.
        why: String,
    },
}

impl MissionAnswer {
    /// Reads the answer to a mission.
    ///
    /// # Errors
    /// [`BadAnswer`].
    pub fn read(bytes: &[u8]) -> Result<Self, BadAnswer> {
        let answer: Self = serde_json::from_slice(bytes).map_err(|why| BadAnswer::Form { why: why.to_string() })?;
        if let Some(why) = answer.error {
            return Err(BadAnswer::Refused { why: why.chars().take(2000).collect() });
        }
        if answer.version != VERSION {
            return Err(BadAnswer::Version { found: answer.version });
        }
        if !(1.0..=100.0).contains(&answer.rate_hz) {
            return Err(BadAnswer::Rate { found: answer.rate_hz });
        }
        if !(0.1..=20.0).contains(&answer.look_ahead_m) {
            return Err(BadAnswer::LookAhead { found: answer.look_ahead_m });
        }
        Ok(answer)
    }
}

/// The end of a run, sent after its last step; what is answered is not looked at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EndMessage {
    /// Always `end`.
    pub socrates: String,
    /// The run, see [`MissionMessage::session`].
    pub session: u64,
    /// Why it ended: `done`, `time`, `stuck`, or `driver`.
    pub reason: String,
    /// When it ended, simulated, s.
    pub time_s: f64,
    /// Whether the robot arrived.
    pub arrived: bool,
}

/// Every command that a driver outside gave in a run, in order: with them the run is played again without it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Commands {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// Steps per simulated second.
    pub rate_hz: f64,
    /// The commands as they were applied, one for each step.
    pub commands: Vec<Command>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_answer_is_a_version() {
        let answer = MissionAnswer::read(br#"{"version": 1}"#).unwrap();
        assert_eq!((answer.rate_hz, answer.people, answer.lidar, answer.map), (10.0, Shown::Seen, false, false));
    }

    #[test]
    fn a_wrong_answer_says_what_is_wrong_with_it() {
        for (text, said) in [
            ("", "cannot be read: EOF"),
            ("{}", "missing field `version`"),
            (r#"{"version": 2}"#, "speaks version 2; this program speaks version 1"),
            (r#"{"version": 1, "rate_hz": 0}"#, "`rate_hz` is 0; allowed: 1 to 100"),
            (r#"{"version": 1, "rate_hz": 1e9}"#, "`rate_hz` is 1000000000"),
            (r#"{"version": 1, "look_ahead_m": 0}"#, "`look_ahead_m` is 0; allowed: 0.1 to 20"),
            (r#"{"version": 1, "rates": 3}"#, "unknown field `rates`"),
            (r#"{"version": 1, "error": "no map"}"#, "does not take this run: no map"),
        ] {
            let bad = MissionAnswer::read(text.as_bytes()).unwrap_err().to_string();
            assert!(bad.contains(said), "{said}: {bad}");
        }
    }
}
