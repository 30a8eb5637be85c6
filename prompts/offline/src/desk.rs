//! The artifacts while they are being edited in words, and what is said of what was not done.

use socrates_model::job::Stage;
use socrates_model::{Behaviors, Fault, FaultCode, Paths, Proposal};
use socrates_prompts::Question;

/// What can be said, for those whose words were not understood.
const SAYABLE: &str = "what can be said: make a path longer or shorter, reverse it, start or end it somewhere, avoid a place, move \
                       the meeting to another place; add, remove, slow down or speed up somebody; let two swap places; \
                       make some a group or break it up; what somebody does, when, how long and how near; add, change or \
                       remove a gesture";

/// What there is to edit.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// The proposal as it stands.
    pub proposal: Proposal,
    /// The paths, if there are any yet.
    pub paths: Option<Paths>,
    /// The behaviors, if there are any yet.
    pub behaviors: Option<Behaviors>,
}

/// The artifacts while they are being edited.
pub(crate) struct Desk {
    pub(crate) question: Question,
    pub(crate) draft: Draft,
    pub(crate) done: Vec<String>,
    pub(crate) left_out: Vec<String>,
    pub(crate) not_done: Vec<Fault>,
    /// Humans whose part changed, by place in the proposal.
    pub(crate) changed: Vec<usize>,
}

impl Desk {
    pub(crate) fn of(question: &Question, draft: &Draft) -> Self {
        Self {
            question: Question {
                stage: Stage::Paths,
                feedback: Vec::new(),
                refused: None,
                only: Vec::new(),
                ..question.clone()
            },
            draft: draft.clone(),
            done: Vec::new(),
            left_out: Vec::new(),
            not_done: Vec::new(),
            changed: Vec::new(),
        }
    }

    /// Says that something was not done.
    pub(crate) fn refuse(&mut self, quote: &str, why: &str) {
        let message = format!("`{}` {why}; nothing was changed for it; {SAYABLE}", quote.trim());
        self.not_done.push(Fault::new(FaultCode::PRead, "edit", message));
    }

    /// Says that the map has no such place.
    pub(crate) fn no_place(&mut self, quote: &str, why: &str) {
        let message = format!("`{}` {why}; it has: {}", quote.trim(), crate::place::listed(&self.question.location));
        self.not_done.push(Fault::new(FaultCode::PPlace, "edit", message));
    }

    /// Remembers that somebody's part changed.
    pub(crate) fn touch(&mut self, who: usize) {
        if !self.changed.contains(&who) {
            self.changed.push(who);
        }
    }
}
