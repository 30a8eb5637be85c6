//! Jobs: a stage to be done for one scenario.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::Fault;
use crate::hash::Digest;
use crate::ids::{BadId, ScenarioId};

/// The stages, in pipeline order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Request to proposal.
    Proposal,
    /// Proposal to paths and encounters.
    Paths,
    /// Proposal to behavior trees.
    Behaviors,
    /// Everything to a recording.
    Simulation,
    /// Recording to a report.
    Scoring,
    /// A person's look at the proposal.
    Review,
}

impl Stage {
    /// Every stage that a worker process serves, in order.
    pub const WORKERS: [Self; 5] = [Self::Proposal, Self::Paths, Self::Behaviors, Self::Simulation, Self::Scoring];

    /// Name on the bus, in logs and in the config file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Proposal => "proposal",
            Self::Paths => "paths",
            Self::Behaviors => "behaviors",
            Self::Simulation => "simulation",
            Self::Scoring => "scoring",
            Self::Review => "review",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Stage {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        Self::WORKERS.into_iter().chain([Self::Review]).find(|stage| stage.name() == text).ok_or_else(|| BadId {
            what: "stage",
            found: text.chars().take(40).collect(),
            allowed: "proposal, paths, behaviors, simulation, scoring, review",
        })
    }
}

/// Which job: a row of the store. `item` is empty but for simulation and scoring, where it names
/// planner and seed (`reference-1`).
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JobKey {
    /// Scenario.
    pub scenario: ScenarioId,
    /// Stage.
    pub stage: Stage,
    /// Planner and seed, or empty.
    #[serde(default)]
    pub item: String,
    /// Revision, from 0.
    pub revision: u32,
}

impl fmt::Display for JobKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.scenario, self.stage)?;
        if !self.item.is_empty() {
            write!(f, "/{}", self.item)?;
        }
        write!(f, "/r{}", self.revision)
    }
}

/// Everything a worker needs to do a job. Inputs are content addresses by role:
/// `request`, `location`, `reading`, `proposal`, `paths`, `behaviors`, `recording`, `simulation`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct JobSpec {
    /// Which job.
    pub key: JobKey,
    /// Inputs by role.
    pub inputs: BTreeMap<String, Digest>,
    /// Seed of this job, derived from scenario seed, stage and revision; never from the attempt.
    pub seed: u64,
    /// Planner (simulation, scoring), else empty.
    #[serde(default)]
    pub planner: String,
    /// Simulation seed (simulation, scoring), else 0.
    #[serde(default)]
    pub run_seed: u64,
    /// Reasons why earlier attempts or revisions were refused; the author reads them.
    #[serde(default)]
    pub feedback: Vec<Fault>,
    /// The newest refused answer, for the author; content address of its text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<Digest>,
    /// Further settings by name (`pace`, `profile`, `author` …).
    #[serde(default)]
    pub settings: BTreeMap<String, String>,
}

impl JobSpec {
    /// Name of the run this job makes or judges: scenario, planner, seed.
    #[must_use]
    pub fn run_name(&self) -> String {
        format!("{}.{}-{}", self.key.scenario, self.planner, self.run_seed)
    }

    /// Idempotency key: stage, inputs, versions, seed, feedback; the same key is the same result.
    #[must_use]
    pub fn idem_key(&self, code_version: &str) -> Digest {
        let mut text = format!(
            "{}|{}|{}|{}|{}|{}",
            crate::FORMAT,
            self.key.stage,
            code_version,
            self.seed,
            self.planner,
            self.run_seed
        );
        for (role, digest) in &self.inputs {
            text.push_str(&format!("|{role}={digest}"));
        }
        for (name, value) in &self.settings {
            // The pace of a run and its name on the bus change nothing in the result.
            if name != "pace" && name != "live" {
                text.push_str(&format!("|{name}:{value}"));
            }
        }
        for fault in &self.feedback {
            text.push_str(&format!("|{fault}"));
        }
        Digest::of(text.as_bytes())
    }
}

/// An output of an attempt.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Artifact {
    /// Role: `proposal`, `paths`, `behaviors`, `recording`, `simulation`, `report`, `picture`, `exchange` …
    pub role: String,
    /// Content address.
    pub digest: Digest,
    /// Length, bytes.
    pub len: u64,
    /// Media type, such as `application/json`.
    pub media: String,
    /// The content itself when it is text of at most 16 KiB; else it is in the artifact store.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inline: Option<String>,
}

/// Largest content that travels inline, bytes.
pub const INLINE_BYTES: usize = 16 * 1024;
/// Largest message on the bus, bytes.
pub const MESSAGE_BYTES: usize = 64 * 1024;
