//! The typed question: everything an author may look at.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socrates_model::job::Stage;
use socrates_model::{Fault, HumanId, Location, Proposal, Reading, Request};

use crate::passing::Passing;
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
    /// How the author read the request before, by sentence: lines of an [`Account`](crate::Account) that go with a refused answer that is
    /// kept in full form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub account: Option<BTreeMap<String, Vec<String>>>,
    /// What would have passed in place of the refused answer, where the program can tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub passing: Option<Passing>,
    /// Seed of the answer.
    pub seed: u64,
}

impl Question {
    /// The first question of a scenario: a proposal is asked for, and nothing was refused yet.
    #[must_use]
    pub fn first(request: Request, reading: Reading, location: Location, seed: u64) -> Self {
        let (only, feedback) = (Vec::new(), Vec::new());
        let (proposal, refused, account, passing) = (None, None, None, None);
        Self {
            stage: Stage::Proposal,
            request,
            reading,
            location,
            proposal,
            only,
            feedback,
            refused,
            account,
            passing,
            seed,
        }
    }

    /// The question as it is put to an author who is told so much of its refused answer. Where it is told nothing the
    /// question is the first one again; where it is told vaguely, the refused answer stays and its reasons go.
    #[must_use]
    pub fn telling(mut self, telling: Telling) -> Self {
        if telling != Telling::Named {
            self.feedback.clear();
            self.passing = None;
        }
        if telling == Telling::Silent {
            self.refused = None;
        }
        self
    }
}
