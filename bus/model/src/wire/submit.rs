//! Submission: scenarios one by one, or series of those that differ by name and seed alone, and what a batch may take.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::hash::Digest;
use crate::ids::ScenarioId;
use crate::planner_name::PlannerName;
use crate::priority::Priority;
use crate::role::Role;

/// One scenario to be made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScenarioSpec {
    /// Name, also of its bundle.
    pub id: ScenarioId,
    /// Content address of the request (canonical JSON).
    pub request: Digest,
    /// Content address of the location.
    pub location: Digest,
    /// Content address of the reading.
    pub reading: Digest,
    /// Base seed.
    pub seed: u64,
    /// Planners, `reference` first.
    pub planners: Vec<PlannerName>,
    /// Simulation seeds.
    pub run_seeds: Vec<u64>,
    /// Pinned artifacts by role (`proposal`, `paths`, `behaviors`); their stages are not asked.
    #[serde(default)]
    pub pinned: BTreeMap<Role, Digest>,
    /// Further settings handed to the jobs (`author`, `pace`, `live`, `profile`).
    #[serde(default)]
    pub settings: BTreeMap<String, String>,
    /// Whether a person looks at the proposal before it goes on.
    #[serde(default)]
    pub review: bool,
    /// Content address of what else its bundle is written from; none where whoever submits writes it themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<Digest>,
}

/// A client submits scenarios under one batch name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Submit {
    /// Batch name; the same batch and scenario id again is taken as the same wish.
    pub batch: String,
    /// How urgent they are beside other batches.
    #[serde(default, skip_serializing_if = "Priority::is_normal")]
    pub priority: Priority,
    /// Scenarios, at most as many as fit a message; call again for more.
    pub scenarios: Vec<ScenarioSpec>,
    /// Series of scenarios; an orchestrator of before does not know them, and says so by [`Submitted::Accepted::held`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub series: Vec<Series>,
    /// What the batch may take. Where it sets none, the limits stay that an earlier submission of the batch has set.
    #[serde(default, skip_serializing_if = "Limits::are_none")]
    pub limits: Limits,
}

impl Submit {
    /// Scenarios one by one, without limits.
    #[must_use]
    pub fn new(batch: impl Into<String>, priority: Priority, scenarios: Vec<ScenarioSpec>) -> Self {
        Self { batch: batch.into(), priority, scenarios, series: Vec::new(), limits: Limits::default() }
    }
}

/// What all scenarios of a batch together may take. 0 sets no limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Limits {
    /// Time in which an orchestrator runs and the batch is not done, ms. What is open then fails.
    pub deadline_ms: u64,
    /// Tokens of its authors, in and out. Then no further scenario is begun, and no author is asked again; what was begun is finished.
    pub tokens: u64,
    /// Money that its authors cost, in millionths; as with tokens.
    pub money: u64,
}

impl Limits {
    /// Whether none is set.
    #[must_use]
    pub const fn are_none(&self) -> bool {
        self.deadline_ms == 0 && self.tokens == 0 && self.money == 0
    }
}

/// Scenarios that differ by name and seed alone. Only those are made that are begun soon, so that a million of them are one row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Series {
    /// The first. Its name ends with a number of at most nine digits, and that of each further one with a number one higher.
    pub first: ScenarioSpec,
    /// Their seeds.
    pub seeds: Seeds,
}

/// Seeds of a series.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Seeds {
    /// That of the first and the numbers after it: how many scenarios there are.
    Next(u32),
    /// Each of its own; the first is that of the first scenario.
    Listed(Vec<u64>),
}

impl Series {
    /// How many scenarios there are.
    #[must_use]
    pub fn count(&self) -> u32 {
        match &self.seeds {
            Seeds::Next(count) => *count,
            Seeds::Listed(seeds) => u32::try_from(seeds.len()).unwrap_or(u32::MAX),
        }
    }

    /// The name of the first without its number, the number, and its digits.
    fn named(&self) -> Option<(&str, u64, usize)> {
        let id = self.first.id.as_str();
        let stem = id.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = id.get(stem.len()..).filter(|digits| (1..=9).contains(&digits.len()))?;
        Some((stem, digits.parse().ok()?, digits.len()))
    }

    /// The scenario with this index, from 0; none past the last, and where its name would be none.
    #[must_use]
    pub fn scenario(&self, index: u32) -> Option<ScenarioSpec> {
        let seed = match &self.seeds {
            Seeds::Next(count) => (index < *count).then(|| self.first.seed.wrapping_add(index.into()))?,
            Seeds::Listed(seeds) => *seeds.get(usize::try_from(index).ok()?)?,
        };
        let (stem, first, digits) = self.named()?;
        let number = first + u64::from(index);
        let id = ScenarioId::new(format!("{stem}{number:0digits$}")).ok()?;
        Some(ScenarioSpec { id, seed, ..self.first.clone() })
    }

    /// The index of the scenario of this name; none where no scenario of the series has it.
    #[must_use]
    pub fn index_of(&self, id: &ScenarioId) -> Option<u32> {
        let (stem, first, digits) = self.named()?;
        let number = id.as_str().strip_prefix(stem)?;
        // Not another spelling of the number.
        let plain = number.len() == digits || (number.len() > digits && !number.starts_with('0'));
        let number = number.bytes().all(|byte| byte.is_ascii_digit()).then(|| number.parse::<u64>().ok())??;
        let index = u32::try_from(number.checked_sub(first)?).ok()?;
        (plain && index < self.count()).then_some(index)
    }
}

/// Answer to [`Submit`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Submitted {
    /// Durable.
    Accepted {
        /// How many were new.
        new: u32,
        /// How many scenarios the series of this submission have; 0 from an orchestrator of before, which takes no series.
        #[serde(default, skip_serializing_if = "is_zero")]
        held: u32,
    },
    /// Not now.
    Busy {
        /// Try again after, ms.
        retry_after_ms: u64,
    },
    /// Never.
    Refused {
        /// Why.
        why: String,
    },
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
const fn is_zero(count: &u32) -> bool {
    *count == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(id: &str) -> ScenarioSpec {
        let digest = Digest::of(b"x");
        ScenarioSpec {
            id: ScenarioId::new(id).unwrap(),
            request: digest,
            location: digest,
            reading: digest,
            seed: 7,
            planners: Vec::new(),
            run_seeds: Vec::new(),
            pinned: BTreeMap::new(),
            settings: BTreeMap::new(),
            review: false,
            order: None,
        }
    }

    #[test]
    fn the_scenarios_of_a_series_are_numbered_and_found_by_their_names() {
        let series = Series { first: spec("lab-7-00099"), seeds: Seeds::Next(2) };
        let ids = |series: &Series| -> Vec<String> {
            (0..series.count() + 1).map_while(|at| series.scenario(at)).map(|one| one.id.to_string()).collect()
        };
        assert_eq!(ids(&series), ["lab-7-00099", "lab-7-00100"]);
        assert_eq!(series.scenario(1).unwrap().seed, 8);
        let listed = Series { first: spec("a-9"), seeds: Seeds::Listed(vec![3, 1, 4]) };
        assert_eq!(ids(&listed), ["a-9", "a-10", "a-11"]);
        assert_eq!(listed.scenario(2).unwrap().seed, 4);
        let at = |series: &Series, id: &str| series.index_of(&ScenarioId::new(id).unwrap());
        for (index, id) in (0..).zip(ids(&listed)) {
            assert_eq!(at(&listed, &id), Some(index));
        }
        for id in ["a-8", "a-12", "a-010", "a-09", "b-9", "a-9x", "a-"] {
            assert_eq!(at(&listed, id), None, "{id}");
        }
        assert_eq!(at(&series, "lab-7-0100"), None);
        // A name without a number names no series.
        assert_eq!(Series { first: spec("a"), seeds: Seeds::Next(3) }.scenario(0), None);
    }
}
