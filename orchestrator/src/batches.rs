//! What is known of a batch as a whole: what it may take and has taken, and the series that its scenarios are drawn from.

use serde::{Deserialize, Serialize};
use socrates_model::ScenarioId;
use socrates_model::standing::ScenarioEnd;
use socrates_model::wire::{Limits, Priority, ScenarioSpec, Series};

use crate::state::Millis;

/// A batch: a row of the store.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Batch {
    /// Its name.
    pub name: String,
    /// What it may take.
    pub limits: Limits,
    /// Time in which it was not done and an orchestrator ran, ms; what passed since it was last saved is lost with the process.
    pub ran_ms: u64,
    /// Tokens and money that do not count: they were spent before it was allowed to go on.
    pub forgiven: (u64, u64),
    /// Why nothing more of it is begun; empty while it goes on.
    pub over: String,
    /// Tokens and money of its authors so far, as the attempts say.
    #[serde(skip)]
    pub spent: (u64, u64),
    /// Scenarios that have not ended, those of series that are not made yet among them.
    #[serde(skip)]
    pub(crate) open: u64,
    /// Up to when its time was counted, on this reign's clock.
    #[serde(skip)]
    pub(crate) counted_to: Millis,
    /// When its time is looked at next, on this reign's clock; none while nothing of it is open.
    #[serde(skip)]
    pub(crate) due: Option<Millis>,
}

impl Batch {
    /// What it has taken of what its limits are about.
    #[must_use]
    pub fn taken(&self) -> Limits {
        let (tokens, money) =
            (self.spent.0.saturating_sub(self.forgiven.0), self.spent.1.saturating_sub(self.forgiven.1));
        Limits { deadline_ms: self.ran_ms, tokens, money }
    }

    /// Lets a batch that was over go on: what it took does not count any more.
    pub(crate) fn anew(&mut self) {
        if !self.over.is_empty() {
            self.over.clear();
            self.ran_ms = 0;
            self.forgiven = self.spent;
        }
    }
}

/// A series that was submitted, and how far its scenarios are made: a row of the store.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Queue {
    /// Batch.
    pub batch: String,
    /// How urgent it is beside others.
    pub priority: Priority,
    /// Place of its first scenario in the order of submission; the others stand at the places after it.
    pub place: u64,
    /// Its scenarios.
    pub series: Series,
    /// How many of them, the last ones, are never made.
    pub left_out: u32,
    /// What those are counted as.
    pub left_as: ScenarioEnd,
    /// How many are made: as many as there are scenarios at its places.
    #[serde(skip)]
    pub(crate) made: u32,
    /// How many of those were neither begun nor ended.
    #[serde(skip)]
    pub(crate) waiting: u32,
}

impl Queue {
    /// How many are still to be made.
    #[must_use]
    pub fn unmade(&self) -> u32 {
        self.series.count().saturating_sub(self.made).saturating_sub(self.left_out)
    }

    /// The place after its last one.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.place.saturating_add(self.series.count().into())
    }

    /// The next scenario to be made and its place.
    pub(crate) fn next(&self) -> Option<(ScenarioSpec, u64)> {
        (self.unmade() > 0).then(|| Some((self.series.scenario(self.made)?, self.place + u64::from(self.made))))?
    }

    /// What the scenario of this name would be; none where the series has none of it.
    pub(crate) fn named(&self, id: &ScenarioId) -> Option<ScenarioSpec> {
        self.series.scenario(self.series.index_of(id)?)
    }
}
