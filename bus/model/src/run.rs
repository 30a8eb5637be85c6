//! A run: which planner drives the robot, and with which seed the simulation is drawn.
//!
//! ```text
//! reference-1       `Run`: planner, dash, seed      files of a bundle, `--run`, the column `item` of the job store
//! my-1.reference-1  `RunId`: scenario, dot, run     keys of the bus, headers of recordings
//! ```
//!
//! The text is written by [`Run`]'s `Display` and read by its `FromStr`, where it comes in; nothing else composes
//! or splits it.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{BadId, RunId, ScenarioId};
use crate::planner_name::PlannerName;

/// A planner with a simulation seed. Sorts the reference first, then by planner and seed.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct Run {
    /// The planner under test.
    pub planner: PlannerName,
    /// The simulation seed.
    pub seed: u64,
}

impl Run {
    /// The run of the reference planner with this seed.
    #[must_use]
    pub fn reference(seed: u64) -> Self {
        Self { planner: PlannerName::reference(), seed }
    }

    /// The run of the same people without a robot: the twin.
    #[must_use]
    pub fn without_robot(&self) -> Self {
        Self { planner: PlannerName::no_robot(), seed: self.seed }
    }

    /// The name of this run of a scenario.
    #[must_use]
    pub fn id(&self, scenario: &ScenarioId) -> RunId {
        RunId::of(scenario, self)
    }
}

impl Ord for Run {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let rank = |run: &Self| !run.planner.is_reference();
        (rank(self), &self.planner, self.seed).cmp(&(rank(other), &other.planner, other.seed))
    }
}

impl PartialOrd for Run {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Display for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.planner.in_runs(), self.seed)
    }
}

impl FromStr for Run {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let bad = || BadId {
            what: "run",
            found: text.chars().take(80).collect(),
            allowed: "a planner, a dash and a seed, such as reference-1",
        };
        let (planner, seed) = text.rsplit_once('-').ok_or_else(bad)?;
        let run = Self {
            planner: PlannerName::new(planner).map_err(|_planner| bad())?,
            seed: seed.parse().map_err(|_digits| bad())?,
        };
        // One spelling for each run: `reference-01` and `reference-+1` are none.
        if run.to_string() == text { Ok(run) } else { Err(bad()) }
    }
}

impl TryFrom<String> for Run {
    type Error = BadId;
    fn try_from(text: String) -> Result<Self, BadId> {
        text.parse()
    }
}

impl From<Run> for String {
    fn from(run: Run) -> Self {
        run.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_read_as_it_is_written_and_in_no_other_spelling() {
        for (planner, seed) in [("reference", 1), ("my-planner", 0), ("none", u64::MAX), ("a.b_2", 20)] {
            let run = Run { planner: planner.parse().unwrap(), seed };
            assert_eq!(run.to_string(), format!("{planner}-{seed}"));
            assert_eq!(run.to_string().parse::<Run>().unwrap(), run);
        }
        let driven = Run { planner: "external:mine".parse().unwrap(), seed: 4 };
        assert_eq!(driven.to_string(), "external.mine-4");
        assert_eq!("external.mine-4".parse::<Run>().unwrap(), driven);
        for text in [
            "",
            "external:mine-4",
            "reference",
            "reference-",
            "-1",
            "reference-01",
            "reference-+1",
            "reference--1x",
            "a b-1",
            "a/b-1",
        ] {
            let bad = text.parse::<Run>().unwrap_err();
            assert!(bad.to_string().contains(&format!("`{text}` is not a run")), "{bad}");
        }
        // The dash before the seed is the last one.
        assert_eq!("reference--1".parse::<Run>().unwrap().planner.as_str(), "reference-");
    }

    #[test]
    fn the_reference_sorts_first_and_seeds_by_number() {
        let read = |text: &str| text.parse::<Run>().unwrap();
        let mut runs = ["none-2", "mppi-10", "reference-10", "mppi-9", "reference-2"].map(read);
        runs.sort();
        assert_eq!(runs.map(|run| run.to_string()), ["reference-2", "reference-10", "mppi-9", "mppi-10", "none-2"]);
    }

    #[test]
    fn every_run_of_every_scenario_has_a_name() {
        let longest = Run { planner: PlannerName::new("p".repeat(40)).unwrap(), seed: u64::MAX };
        let id = longest.id(&ScenarioId::new("s".repeat(96)).unwrap());
        assert_eq!(RunId::new(id.as_str()).unwrap(), id);
        assert_eq!(Run::reference(3).id(&"my-1".parse().unwrap()).as_str(), "my-1.reference-3");
        assert!(PlannerName::new("p".repeat(41)).is_err());
    }
}
