//! The typed question: everything an author may look at.

use serde::{Deserialize, Serialize};
use socrates_model::job::Stage;
use socrates_model::{Fault, HumanId, Location, Proposal, Reading, Request};

use crate::style::Telling;

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

impl Question {
    /// The first question of a scenario: a proposal is asked for, and nothing was refused yet.
    #[must_use]
    pub fn first(request: Request, reading: Reading, location: Location, seed: u64) -> Self {
        let (only, feedback) = (Vec::new(), Vec::new());
        Self { stage: Stage::Proposal, request, reading, location, proposal: None, only, feedback, refused: None, seed }
    }

    /// The question as it is put to an author who is told so much of its refused answer. Where it is told nothing the
    /// question is the first one again; where it is told vaguely, the refused answer stays and its reasons go.
    #[must_use]
    pub fn telling(mut self, telling: Telling) -> Self {
        if telling != Telling::Named {
            self.feedback.clear();
        }
        if telling == Telling::Silent {
            self.refused = None;
        }
        self
    }
}
