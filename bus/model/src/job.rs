//! Jobs: a stage to be done for one scenario.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::Fault;
use crate::hash::Digest;
use crate::ids::{BadId, ScenarioId};
use crate::role::Role;
use crate::run::Run;

/// Setting of a scenario that says what its behaviors are made from, where no author is asked for them.
pub const BEHAVIORS_BY: &str = "behaviors_by";
/// Behaviors are compiled from the rules of the proposal: what is wrong with them goes back to the proposal.
pub const BY_PROPOSAL: &str = "proposal";

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

/// What a person looks at in a job of stage `review`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Look {
    /// The proposal.
    Proposal,
    /// Proposal, paths and behaviors together.
    Draft,
}

impl Look {
    /// Every look in pipeline order.
    pub const ALL: [Self; 2] = [Self::Proposal, Self::Draft];

    /// Name as in files and logs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Proposal => "proposal",
            Self::Draft => "draft",
        }
    }
}

/// Which job of its stage: an authored stage has one, a review is a look, simulation and scoring are of a run.
///
/// As text, in files and in the job store, it is empty, `proposal` or `draft`, or a run such as `reference-1`.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum Item {
    /// The only one.
    #[default]
    Whole,
    /// A person's look.
    Look(Look),
    /// A run.
    Run(Run),
}

impl Item {
    /// The run, where it is of one.
    #[must_use]
    pub const fn run(&self) -> Option<&Run> {
        match self {
            Self::Run(run) => Some(run),
            Self::Whole | Self::Look(_) => None,
        }
    }

    /// The look, where it is one.
    #[must_use]
    pub const fn look(&self) -> Option<Look> {
        match self {
            Self::Look(look) => Some(*look),
            Self::Whole | Self::Run(_) => None,
        }
    }
}

impl From<Run> for Item {
    fn from(run: Run) -> Self {
        Self::Run(run)
    }
}

impl From<Look> for Item {
    fn from(look: Look) -> Self {
        Self::Look(look)
    }
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Look(look) => f.write_str(look.name()),
            Self::Run(run) => run.fmt(f),
        }
    }
}

impl FromStr for Item {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        if text.is_empty() {
            return Ok(Self::Whole);
        }
        let look = Look::ALL.into_iter().find(|look| look.name() == text);
        look.map_or_else(|| text.parse().map(Self::Run), |look| Ok(Self::Look(look)))
    }
}

impl TryFrom<String> for Item {
    type Error = BadId;
    fn try_from(text: String) -> Result<Self, BadId> {
        text.parse()
    }
}

impl From<Item> for String {
    fn from(item: Item) -> Self {
        item.to_string()
    }
}

/// Which job: a row of the store.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JobKey {
    /// Scenario.
    pub scenario: ScenarioId,
    /// Stage.
    pub stage: Stage,
    /// Which of the stage.
    #[serde(default)]
    pub item: Item,
    /// Revision, from 0.
    pub revision: u32,
}

impl fmt::Display for JobKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.scenario, self.stage)?;
        if self.item != Item::Whole {
            write!(f, "/{}", self.item)?;
        }
        write!(f, "/r{}", self.revision)
    }
}

/// Everything a worker needs to do a job. Inputs are content addresses by role.
///
/// Until message version 2 the run stood here twice more, as `planner` and `run_seed`; readers of today pass over
/// them, and a reader of then would take every run for the reference, so a grant needs a reader of version 3.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct JobSpec {
    /// Which job.
    pub key: JobKey,
    /// Inputs by role.
    pub inputs: BTreeMap<Role, Digest>,
    /// Seed of this job, derived from scenario seed, stage and revision; never from the attempt.
    pub seed: u64,
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
    /// The run that this job makes or judges.
    #[must_use]
    pub const fn run(&self) -> Option<&Run> {
        self.key.item.run()
    }

    /// Idempotency key: stage, inputs, versions, seed, feedback; the same key is the same result.
    #[must_use]
    pub fn idem_key(&self, code_version: &str) -> Digest {
        let (planner, seed) = self.run().map_or(("", 0), |run| (run.planner.as_str(), run.seed));
        let mut text = format!("{}|{}|{}|{}|{planner}|{seed}", crate::FORMAT, self.key.stage, code_version, self.seed);
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
    /// What it is.
    pub role: Role,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A job of before, as an orchestrator of message version 2 wrote it.
    const OF_VERSION_2: &str = r#"{"key": {"scenario": "a", "stage": "simulation", "item": "my-planner-3", "revision": 1},
        "inputs": {"paths": "0000000000000000000000000000000000000000000000000000000000000000"}, "seed": 5,
        "planner": "my-planner", "run_seed": 3}"#;

    #[test]
    fn a_job_of_before_is_read_and_its_run_is_that_of_its_key() {
        let spec: JobSpec = serde_json::from_str(OF_VERSION_2).unwrap();
        assert_eq!(spec.run().unwrap(), &Run { planner: "my-planner".parse().unwrap(), seed: 3 });
        assert_eq!(spec.inputs.keys().collect::<Vec<_>>(), [&Role::Paths]);
        let written = serde_json::to_value(&spec).unwrap();
        assert_eq!(written["key"]["item"], "my-planner-3");
        assert!(written.get("planner").is_none() && written.get("run_seed").is_none(), "a run stands in one place");
    }

    #[test]
    fn an_item_is_nothing_a_look_or_a_run() {
        for text in ["", "proposal", "draft", "reference-1"] {
            assert_eq!(text.parse::<Item>().unwrap().to_string(), text);
        }
        assert_eq!("draft".parse::<Item>().unwrap().look(), Some(Look::Draft));
        assert!("sketch".parse::<Item>().is_err());
    }
}
