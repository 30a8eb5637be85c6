//! Why a job stands where it does.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::Part;
use crate::ids::{BadId, ScenarioId};
use crate::job::{Item, JobKey, Stage};
use crate::standing::JobState;

/// Which jobs are meant: those of a scenario, of its stage, or a single one. As text it is written as a [`JobKey`] is, of which everything
/// behind the scenario may be left out: `s-1`, `s-1/paths`, `s-1/simulation/reference-1`, `s-1/paths/r2`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct JobAsk {
    /// Scenario.
    pub scenario: ScenarioId,
    /// Stage; none for all.
    #[serde(default)]
    pub stage: Option<Stage>,
    /// Which of the stage; none for all.
    #[serde(default)]
    pub item: Option<Item>,
    /// Revision; none for the newest ones.
    #[serde(default)]
    pub revision: Option<u32>,
}

impl JobAsk {
    /// All jobs of a scenario.
    #[must_use]
    pub const fn of(scenario: ScenarioId) -> Self {
        Self { scenario, stage: None, item: None, revision: None }
    }

    /// Whether this job is meant, if its revision is.
    #[must_use]
    pub fn means(&self, key: &JobKey) -> bool {
        self.scenario == key.scenario
            && self.stage.is_none_or(|stage| stage == key.stage)
            && self.item.as_ref().is_none_or(|item| *item == key.item)
            && self.revision.is_none_or(|revision| revision == key.revision)
    }
}

impl fmt::Display for JobAsk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.scenario)?;
        if let Some(stage) = self.stage {
            write!(f, "/{stage}")?;
        }
        if let Some(item) = self.item.as_ref().filter(|item| **item != Item::Whole) {
            write!(f, "/{item}")?;
        }
        self.revision.map_or(Ok(()), |revision| write!(f, "/r{revision}"))
    }
}

impl FromStr for JobAsk {
    type Err = BadId;

    fn from_str(text: &str) -> Result<Self, BadId> {
        let mut parts = text.split('/');
        let mut ask = Self::of(ScenarioId::new(parts.next().unwrap_or_default())?);
        for (place, part) in parts.enumerate() {
            let revision = part.strip_prefix('r').and_then(|digits| digits.parse::<u32>().ok());
            match (place, revision) {
                (0, _) => ask.stage = Some(part.parse()?),
                (_, Some(revision)) if ask.revision.is_none() => ask.revision = Some(revision),
                (1, None) => ask.item = Some(part.parse()?),
                _ => {
                    return Err(BadId {
                        what: "job",
                        found: text.chars().take(200).collect(),
                        allowed: "SCENARIO, SCENARIO/STAGE, SCENARIO/STAGE/ITEM, each with /rN behind the stage",
                    });
                }
            }
        }
        Ok(ask)
    }
}

/// How a job stands, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct JobWhy {
    /// Which.
    pub key: JobKey,
    /// Where it stands.
    pub state: JobState,
    /// Everything that keeps it there; empty where nothing does.
    pub why: Vec<Wait>,
}

/// One reason why a job stands where it does.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Wait {
    /// A client holds this back.
    Paused(Part),
    /// No worker serves its stage.
    NoWorker,
    /// Workers that came for its stage were turned away, because they are of this version and not of the wanted one.
    Version {
        /// The version that workers must have.
        wanted: String,
        /// The one that they had.
        found: String,
    },
    /// Every worker of the stage is leaving.
    Draining {
        /// How many there are.
        workers: u32,
    },
    /// Workers of the stage are there; jobs stand before it.
    Line {
        /// Ready jobs of the stage before it.
        before: u32,
        /// Workers of the stage.
        workers: u32,
        /// Those of them that hold a job.
        busy: u32,
    },
    /// The author's server may not be asked yet.
    Rate {
        /// Server and model.
        server: String,
        /// From when on, ms from now.
        in_ms: u64,
    },
    /// Attempts of the stage failed in passing too often; it rests, then one job shows whether it works again.
    Rests {
        /// From when on, ms from now.
        in_ms: u64,
    },
    /// As many questions are put to authors as may be at one time.
    Slots {
        /// How many that is now.
        most: u32,
    },
    /// As many scenarios are under way as may be: others are finished first.
    Begun {
        /// How many that is.
        most: u32,
    },
    /// Another job does the very same work; its result will be taken.
    Twin(JobKey),
    /// It is tried again after a pause.
    Backoff {
        /// When, ms from now.
        in_ms: u64,
        /// Codes of the faults for which it waits.
        after: String,
    },
    /// It needs what this job makes.
    Parent {
        /// Which.
        key: JobKey,
        /// Where that one stands.
        state: JobState,
    },
    /// A worker holds it.
    Held {
        /// UUID of the worker's process.
        instance: String,
        /// Its machine; empty where it did not say.
        host: String,
        /// Its process id; 0 where it did not say.
        pid: u32,
        /// Number of the attempt.
        attempt: u32,
        /// How long, ms.
        for_ms: u64,
        /// Time since it was last heard, ms.
        beat_ms: u64,
        /// Until the attempt is taken for too long, ms.
        deadline_ms: u64,
    },
    /// Nobody works on this store now.
    Unserved,
    /// It ended, for this reason; empty where it succeeded.
    Ended(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_named_as_its_key_is_written_or_in_part() {
        for text in [
            "s-1",
            "s-1/paths",
            "s-1/paths/r2",
            "s-1/simulation/reference-1",
            "s-1/scoring/mppi-3/r1",
            "a/review/draft/r0",
        ] {
            assert_eq!(text.parse::<JobAsk>().unwrap().to_string(), text);
        }
        let key = JobKey {
            scenario: "s-1".parse().unwrap(),
            stage: Stage::Simulation,
            item: "reference-1".parse().unwrap(),
            revision: 2,
        };
        let whole: JobAsk = key.to_string().parse().unwrap();
        assert!(whole.means(&key) && JobAsk::of(key.scenario.clone()).means(&key));
        assert!(!whole.means(&JobKey { revision: 1, ..key.clone() }));
        assert!(!"s-1/simulation/reference-2".parse::<JobAsk>().unwrap().means(&key));
        for bad in ["", "a b", "s-1/pths", "s-1/paths/r1/r2", "s-1/simulation/reference-1/r1/x", "s-1/paths/sketch"] {
            assert!(bad.parse::<JobAsk>().is_err(), "{bad}");
        }
        let told = "s-1/pths".parse::<JobAsk>().unwrap_err().to_string();
        assert!(told.contains("`pths`") && told.contains("paths"), "{told}");
    }
}
