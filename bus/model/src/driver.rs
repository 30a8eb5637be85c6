//! What passes between a simulation and a driver outside besides the steps: the mission before the first, the end after the last.
//!
//! JSON, so that a program in any language reads it in a line; `docs/wire.md` is the manual.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::drive::Command;
use crate::geometry::Pose;
use crate::grid::{Cell, Grid};
use crate::hash::Digest;
use crate::ids::{AgentId, HumanId, RunId};
use crate::lockstep::VERSION;
use crate::planner_name::PlannerName;
use crate::proposal::Relation;
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
    /// `external:` and the name of the driver that is asked.
    pub planner: PlannerName,
    /// The seed of the run.
    pub seed: u64,
    /// `step`, `wait` or `free`.
    pub mode: String,
    /// Body and limits of the one who is driven: the robot, or the person as an omnidirectional body.
    pub robot: RobotFile,
    /// The person who is driven; left out where that is the robot, as it was before people could be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub person: Option<MissionPerson>,
    /// End of the way, m.
    pub goal: At,
    /// Points that it leads through, start first, goal last, m.
    pub waypoints: Vec<At>,
    /// The shortest free way through them, m; shut doors and people are not looked at.
    pub plan: Vec<At>,
    /// Doors, in the order in which the steps tell whether they are open.
    pub doors: Vec<MissionDoor>,
    /// Everybody else who may be met.
    pub people: Vec<HumanId>,
    /// The map, without its cells.
    pub map: MissionMap,
}

/// The person who is driven.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MissionPerson {
    /// Their number and name.
    pub id: HumanId,
    /// Role word: `employee`, `visitor`, `nurse` …
    pub role: String,
    /// How they stand to the robot's way.
    pub relation: Relation,
    /// What they are meant to do, in sentences; the verdict judges whether it is seen.
    pub behavior: String,
    /// The pace at which they would walk by themselves, m/s; their limit is `v_max_mps` of `robot`.
    pub pace_mps: f64,
    /// Where they are to meet the robot, one after the other, m.
    pub meets: Vec<At>,
    /// The others of their group.
    pub group: Vec<HumanId>,
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

impl MissionMap {
    /// The facts of a map; `cells` are its [`map_cells`].
    #[must_use]
    pub fn of(grid: &Grid, cells: &[u8]) -> Self {
        Self {
            width: grid.width,
            height: grid.height,
            resolution_m: grid.resolution_m,
            origin: [grid.origin.x, grid.origin.y],
            yaw: grid.origin.yaw,
            digest: Digest::of(cells),
        }
    }
}

/// Cells of a map as they are told, row by row from the lower left: 0 free, 100 occupied, 255 unknown.
#[must_use]
pub fn map_cells(grid: &Grid) -> Vec<u8> {
    let told = |cell: &Cell| match cell {
        Cell::Free => 0,
        Cell::Occupied => 100,
        Cell::Unknown => 255,
    };
    // The grid has its upper row first.
    grid.cells.chunks(grid.width.max(1)).rev().flatten().map(told).collect()
}

/// The map that these facts and [`map_cells`] tell; unknown cells where there are none, a single one without facts.
#[must_use]
pub fn grid_of(map: Option<&MissionMap>, cells: &[u8]) -> Grid {
    let (width, height) = map.map_or((1, 1), |map| (map.width.max(1), map.height.max(1)));
    let cell = |told: &u8| match told {
        0 => Cell::Free,
        100 => Cell::Occupied,
        _ => Cell::Unknown,
    };
    let told = cells.chunks_exact(width).take(height);
    let mut rows: Vec<Vec<Cell>> = told.map(|row| row.iter().map(cell).collect()).collect();
    rows.resize(height, vec![Cell::Unknown; width]);
    Grid {
        width,
        height,
        resolution_m: map.map_or(1.0, |map| map.resolution_m),
        origin: map.map_or_else(
            || Pose::new(0.0, 0.0, 0.0),
            |map| {
                let [x, y] = map.origin;
                Pose::new(x, y, map.yaw)
            },
        ),
        // The grid has its upper row first.
        cells: rows.into_iter().rev().flatten().collect(),
    }
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
    /// How far ahead of the one who is driven the point of the plan is that each step tells, 0.1 to 20 m. Default 0.8.
    #[serde(default = "look_ahead")]
    pub look_ahead_m: f64,
    /// Which people it wants to be shown.
    #[serde(default)]
    pub people: ShownPeople,
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
pub enum ShownPeople {
    /// Those in sight of the one who is driven.
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
    /// Whether the one who is driven arrived at the end of their way.
    pub arrived: bool,
}

/// Every command that drivers outside gave in a run, in order: with them the run is played again without any driver.
///
/// The robot's stand where they stood before people could be driven, so that files of before are read, and a file without driven
/// people is the same to the byte. A reader of before passes over `people`; it refuses the request that names them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Commands {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// Steps per simulated second of the robot's driver; nothing where no driver outside drove it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// The robot's commands as they were applied, one for each step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub commands: Vec<Command>,
    /// Those of every person who was driven.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub people: BTreeMap<HumanId, Told>,
}

/// What one driver told one body in a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Told {
    /// Steps per simulated second.
    pub rate_hz: f64,
    /// The commands as they were applied, one for each step.
    pub commands: Vec<Command>,
}

impl Default for Commands {
    fn default() -> Self {
        Self { format: crate::FORMAT, rate_hz: None, commands: Vec::new(), people: BTreeMap::new() }
    }
}

impl Commands {
    /// The same with what the driver of one more told it.
    #[must_use]
    pub fn with(mut self, agent: AgentId, told: Told) -> Self {
        match agent {
            AgentId::Robot => (self.rate_hz, self.commands) = (Some(told.rate_hz), told.commands),
            AgentId::Human(id) => drop(self.people.insert(id, told)),
        }
        self
    }

    /// What was told to somebody; nothing where no driver outside drove them.
    #[must_use]
    pub fn of(&self, agent: AgentId) -> Option<Told> {
        match agent {
            AgentId::Robot => self.rate_hz.map(|rate_hz| Told { rate_hz, commands: self.commands.clone() }),
            AgentId::Human(id) => self.people.get(&id).cloned(),
        }
    }

    /// Whether nobody was driven.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rate_hz.is_none() && self.people.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_answer_is_a_version() {
        let answer = MissionAnswer::read(br#"{"version": 1}"#).unwrap();
        assert_eq!((answer.rate_hz, answer.people, answer.lidar, answer.map), (10.0, ShownPeople::Seen, false, false));
    }

    /// Commands as bundles of before hold them.
    const OF_BEFORE: &str = r#"{"format":1,"rate_hz":10.0,"commands":[{"v":0.5,"vy":0.0,"omega":0.1},{"v":0.0,"vy":0.0,"omega":0.0,"gesture":"WAIT","waiting":true}]}"#;

    #[test]
    fn commands_of_before_are_read_and_written_as_they_were() {
        let read: Commands = serde_json::from_str(OF_BEFORE).unwrap();
        let robot = read.of(AgentId::Robot).unwrap();
        assert_eq!((robot.rate_hz, robot.commands.len(), robot.commands[1].waiting), (10.0, 2, true));
        assert!(read.people.is_empty() && read.of(HumanId::new(1).into()).is_none());
        assert_eq!(serde_json::to_string(&read).unwrap(), OF_BEFORE);
    }

    #[test]
    fn commands_of_people_stand_beside_those_of_the_robot_or_alone() {
        let told = |rate_hz, v| Told { rate_hz, commands: vec![Command { v, ..Command::default() }] };
        let alone = Commands::default().with(HumanId::new(2).into(), told(20.0, 1.0));
        let text = r#"{"format":1,"people":{"human_2":{"rate_hz":20.0,"commands":[{"v":1.0,"vy":0.0,"omega":0.0}]}}}"#;
        assert_eq!(serde_json::to_string(&alone).unwrap(), text);
        assert_eq!(serde_json::from_str::<Commands>(text).unwrap(), alone);
        assert!(alone.of(AgentId::Robot).is_none() && !alone.is_empty() && Commands::default().is_empty());
        let both = alone.with(AgentId::Robot, told(10.0, 0.4));
        assert_eq!(both.of(AgentId::Robot), Some(told(10.0, 0.4)));
        assert_eq!(both.of(HumanId::new(2).into()), Some(told(20.0, 1.0)));
        let written = serde_json::to_string(&both).unwrap();
        assert!(written.starts_with(r#"{"format":1,"rate_hz":10.0,"commands":["#), "{written}");
        assert_eq!(serde_json::from_str::<Commands>(&written).unwrap(), both);
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
