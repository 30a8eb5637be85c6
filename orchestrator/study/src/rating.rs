//! Ratings, the people who gave them, and the films that they were given of.

use serde::{Deserialize, Serialize};

/// An answer to one item about one film, in points of its instrument.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Rating {
    /// Never asked, skipped, or "does not fit": takes part in no statistic, and is not 0.
    #[default]
    Missing,
    /// The points that were chosen, as they were chosen: an item that is reversed is turned round when it is scored.
    Given(f64),
}

impl Rating {
    /// The points, where there are any.
    #[must_use]
    pub const fn points(self) -> Option<f64> {
        match self {
            Self::Missing => None,
            Self::Given(points) => Some(points),
        }
    }
}

/// A film that participants saw: one run of one planner in one scenario.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// Its opaque name, which is all that participants see of it.
    pub id: String,
    /// Scenario.
    pub scenario: String,
    /// Planner.
    pub planner: String,
    /// Seed of the run. Default 1.
    #[serde(default = "one")]
    pub seed: u64,
    /// Length, s; where it is unknown, nobody is excluded for leaving early.
    #[serde(default)]
    pub length_s: Option<f64>,
}

const fn one() -> u64 {
    1
}

/// A person who took part.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Participant {
    /// Keyed hash of the id under which they came.
    pub id: String,
    /// Which order of films they saw, as the survey calls it.
    pub order: Option<String>,
    /// Time from start to end, s.
    pub duration_s: Option<f64>,
    /// Attention checks: how many were answered, how many of these wrongly.
    pub checks: Option<(u32, u32)>,
    /// Standing of the submission at Prolific.
    pub status: Option<String>,
    /// Age in a band of ten years, such as `20-29`.
    pub age: Option<String>,
    /// Sex as it was told.
    pub sex: Option<String>,
}

/// One row: what one person said to one item about one film.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Participant, by [`Participant::id`].
    pub participant: String,
    /// Film, by [`Film::id`].
    pub film: String,
    /// Item, by its code.
    pub item: String,
    /// The answer.
    pub rating: Rating,
    /// Place of the film in the person's order, from 1.
    pub position: Option<u32>,
    /// Time to answer, s.
    pub rt_s: Option<f64>,
    /// How much of the film was played, s.
    pub watched_s: Option<f64>,
}

/// Origin of all answers of a table. A table never mixes both: reading refuses it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Origin {
    /// People gave them.
    #[default]
    People,
    /// `study simulate` made them: no person gave any of them.
    Simulated,
}

impl Origin {
    /// Marking of simulated answers, in a sentence that every report and table in words begins with.
    pub const MARK: &'static str =
        "SIMULATED ANSWERS: made by `socrates study simulate`; no person took part, and nothing here is evidence.";
    /// Column and key that mark simulated answers in tables and result files. Tables of answers by people lack it.
    pub const KEY: &'static str = "simulated";

    /// Whether the answers are simulated.
    #[must_use]
    pub const fn is_simulated(self) -> bool {
        matches!(self, Self::Simulated)
    }

    /// Origin that a cell states: `1` or `true` for a simulated answer; `0`, `false` or nothing for an answer by a person.
    pub(crate) fn of_cell(cell: &str) -> Option<Self> {
        match cell.trim() {
            "1" | "true" => Some(Self::Simulated),
            "" | "0" | "false" => Some(Self::People),
            _other => None,
        }
    }

    /// Word for the origin in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::People => "answers by people",
            Self::Simulated => "simulated answers",
        }
    }
}

/// Whether there is no mark to write.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
pub(crate) const fn is_by_people(origin: &Origin) -> bool {
    !origin.is_simulated()
}

impl Serialize for Origin {
    /// As the value of [`Origin::KEY`].
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bool(self.is_simulated())
    }
}

impl From<bool> for Origin {
    fn from(simulated: bool) -> Self {
        if simulated { Self::Simulated } else { Self::People }
    }
}

/// All ratings of a study and who gave them. Rows stand in the order of participant, film and item.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ratings {
    /// The participants, by id.
    pub participants: Vec<Participant>,
    /// What they said.
    pub rows: Vec<Row>,
    /// Origin of all of them, as their files state it.
    pub origin: Origin,
}
