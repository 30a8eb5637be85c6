//! The typed question: everything an author may look at.

use serde::{Deserialize, Serialize};
use socrates_model::job::Stage;
use socrates_model::{Fault, HumanId, Location, Proposal, Reading, Request};

/// One ask of an authoring stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Question {
    /// `Proposal`, `Paths` or `Behaviors`.
    pub stage: Stage,
    /// What the user gave.
    pub request: Request,
    /// What was read of it; the checks hold the answer against its facts.
    pub reading: Reading,
    /// The place.
    pub location: Location,
    /// The proposal (paths, behaviors).
    #[serde(default)]
    pub proposal: Option<Proposal>,
    /// Only these humans (a behaviors question that was split); empty for all.
    #[serde(default)]
    pub only: Vec<HumanId>,
    /// Why earlier answers were refused, newest last; empty on the first ask.
    #[serde(default)]
    pub feedback: Vec<Fault>,
    /// The newest refused answer.
    #[serde(default)]
    pub refused: Option<String>,
    /// Seed of the answer.
    pub seed: u64,
}
