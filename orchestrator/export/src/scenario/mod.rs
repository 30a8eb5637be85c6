//! Whole scenarios in the formats of simulators and data sets: what an exporter gets, and the table of formats.
//!
//! ```text
//! Scenario (location, proposal, paths, behaviors, one run) ─► Format.write ─► Package: files + Losses
//! ```
//!
//! Conventions that several formats share (numbers, times, names) stand in `frames.rs`.

mod arena;
mod boxes;
mod content;
mod eth_ucy;
mod frames;
mod humansim;
mod hunav;
mod isaac;
mod jupedsim;
mod jupedsim_scenarios;
mod map_files;
mod outline;
mod parquet;
mod pedpy;
mod rosbag;
mod routes;
mod sdf;
mod socnav3;
mod trajnet;
mod usd;

use std::collections::BTreeMap;

use socrates_model::{AgentId, Behaviors, Location, Paths, Proposal, Recording};

pub use self::content::Content;
pub use self::jupedsim::{Database, Table, Value};
pub use self::parquet::{Cells, Columns};
pub use self::rosbag::{Bag, Channel, Message};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// What an exporter gets: a scenario with one of its runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Name of the bundle, as people wrote it.
    pub name: String,
    /// Map, scene graph, doors and names.
    pub location: Location,
    /// The scenario in detail.
    pub proposal: Proposal,
    /// Intended ways and encounters.
    pub paths: Paths,
    /// Behavior trees.
    pub behaviors: Behaviors,
    /// Radius of the robot's disc by its model, m.
    pub robot_radius_m: f64,
    /// The run that is exported; `None` where the bundle keeps none.
    pub recording: Option<Recording>,
}

/// A file of a package.
#[derive(Debug, Clone, PartialEq)]
pub enum File {
    /// Text in UTF-8.
    Text(String),
    /// Bytes of another kind.
    Bytes(Vec<u8>),
    /// Tables of a database of SQLite, which the shell writes.
    Database(Database),
    /// Columns of a table, which the shell writes as Parquet.
    Columns(Columns),
    /// Messages of a bag of ROS 2, which the shell writes as MCAP.
    Bag(Bag),
}

/// Files by their path in the package.
pub type Files = BTreeMap<String, File>;

/// A scenario in a format of others.
#[derive(Debug, Clone, PartialEq)]
pub struct Package {
    /// The files.
    pub files: Files,
    /// What the format cannot hold.
    pub losses: Losses,
}

/// What software of others did with files of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Foreign {
    /// A simulator of others ran it.
    Run,
    /// A reader of others parsed it and found the same content.
    Parsed,
    /// Nothing of others has seen it here.
    Neither,
}

impl Foreign {
    /// The word in documents.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Run => "run",
            Self::Parsed => "parsed",
            Self::Neither => "neither",
        }
    }
}

/// A format as data: what it is, what it cannot hold, who checks it.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// Name in arguments; ends with the version where the format has one.
    pub name: &'static str,
    /// The name without the version.
    pub stem: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// What software of others did with it; held by the tests of `tests/foreign`.
    pub foreign: Foreign,
    /// Which software that is, or why there is none.
    pub checked_by: &'static str,
    /// Whether it cannot be written without a run.
    pub needs_run: bool,
    /// Cargo feature of the program without which its files cannot be written; none for the formats that every program writes.
    pub feature: Option<&'static str>,
    /// Kinds of content that it cannot hold, each with the reason; it holds every other kind.
    pub lacks: &'static [(Content, &'static str)],
    /// Writes the files; notes what is lost beyond `lacks`.
    write: fn(&Scenario, &mut Losses) -> Result<Files, Unusable>,
}

/// Every format, in the order of the documents.
pub const FORMATS: &[Format] = &[
    trajnet::FORMAT,
    eth_ucy::FORMAT,
    pedpy::FORMAT,
    jupedsim::FORMAT,
    jupedsim_scenarios::FORMAT,
    socnav3::FORMAT,
    parquet::FORMAT,
    sdf::FORMAT,
    usd::FORMAT,
    isaac::PEOPLE_5_1,
    isaac::PEOPLE_6_0,
    isaac::PEOPLE_6_1,
    rosbag::FORMAT,
    hunav::HUNAV_1_0,
    hunav::HUNAV_1_1,
    hunav::HUNAV_2_0,
    hunav::HUNAV_FORK,
    arena::ARENA_3,
    arena::ARENA_5,
    humansim::FORMAT,
];

impl Scenario {
    /// Radius of the robot's disc in the run, or of its model where there is none, m.
    fn robot_radius(&self) -> f64 {
        let run = self.recording.as_ref();
        let robot = run.and_then(|run| run.header.agents.iter().find(|info| info.agent == AgentId::Robot));
        robot.map_or(self.robot_radius_m, |info| info.radius_m)
    }

    /// Its texts in one, as a string of JSON, which is one of YAML too.
    fn texts(&self) -> serde_json::Value {
        let proposal = &self.proposal;
        let texts = [&proposal.title, &proposal.description, &proposal.robot.task, &proposal.robot.expected_behavior];
        let texts = texts.into_iter().chain(proposal.humans.iter().map(|human| &human.behavior));
        let texts: Vec<&str> = texts.map(String::as_str).filter(|text| !text.is_empty()).collect();
        texts.join(" / ").into()
    }

    /// Notes the places of a kind that a format holds of the robot alone.
    fn note_people(&self, content: Content, what: &str, why: &str, losses: &mut Losses) {
        for place in content.places(self).into_iter().filter(|place| !place.ends_with("robot")) {
            losses.note(what, place, why);
        }
    }
}

impl Format {
    /// The format of a name; a name without its version means the only version.
    ///
    /// # Errors
    /// A name that is no format, or that several versions share.
    pub fn named(name: &str) -> Result<&'static Self, Unusable> {
        if let Some(format) = FORMATS.iter().find(|format| format.name == name) {
            return Ok(format);
        }
        let versions: Vec<&'static Self> = FORMATS.iter().filter(|format| format.stem == name).collect();
        match versions.as_slice() {
            [only] => Ok(only),
            [] => {
                let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
                let found: String = name.chars().take(60).collect();
                Err(Unusable::new(
                    "--to",
                    format!("`{found}` is no format"),
                    format!("choose one of: {}", names.join(", ")),
                ))
            }
            several => {
                let names: Vec<&str> = several.iter().map(|format| format.name).collect();
                Err(Unusable::new(
                    "--to",
                    format!("`{name}` has several versions"),
                    format!("choose one of: {}", names.join(", ")),
                ))
            }
        }
    }

    /// Whether the format holds a kind of content.
    #[must_use]
    pub fn carries(&self, content: Content) -> bool {
        !self.lacks.iter().any(|(lacked, _)| *lacked == content)
    }

    /// The row of the table in `docs/export.md`.
    #[must_use]
    pub fn row(&self) -> String {
        let carried: Vec<&str> =
            Content::ALL.into_iter().filter(|content| self.carries(*content)).map(Content::name).collect();
        format!(
            "| `{}` | {} | {} | {} | {} |",
            self.name,
            self.about,
            carried.join(", "),
            self.foreign.name(),
            self.checked_by
        )
    }

    /// Writes a scenario; the same scenario gives the same files.
    ///
    /// # Errors
    /// Where the scenario lacks what the format needs, or goes beyond its ranges.
    pub fn export(&self, scenario: &Scenario) -> Result<Package, Unusable> {
        let mut losses = Losses::default();
        for (content, why) in self.lacks {
            for place in content.places(scenario) {
                losses.note(content.name(), place, why);
            }
        }
        if scenario.recording.is_none() {
            let hint = "`socrates run BUNDLE/request.toml` makes a bundle with its recordings";
            if self.needs_run {
                let problem = format!("the bundle keeps no recording, of which `{}` is made", self.name);
                return Err(Unusable::new("recordings", problem, hint));
            }
            losses.note("the run", "recordings", "the bundle keeps no recording of the run");
        }
        let files = (self.write)(scenario, &mut losses)?;
        Ok(Package { files, losses })
    }
}
