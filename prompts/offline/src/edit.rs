//! Edits in words: what stands, and a sentence; what is not spoken of stays as it is.
//!
//! What changes paths, speeds or who is there is told by a few words of its own (rows of the reader); everything else is read as the
//! text of a request is, with the people of the proposal as those of whom was spoken already, and what it says of them replaces what
//! they did.

use socrates_model::job::Stage;
use socrates_model::{Behaviors, Fault, Proposal, Reading};
use socrates_prompts::Question;
use socrates_reader::Edit;

use crate::desk::{Desk, Draft};
use crate::edit_whom::Crowd;
use crate::edit_wish::{Wish, wishes};
use crate::{edit_paths, edit_people, edit_settle, edit_together};

/// Whoever should be slower, or faster, walks at so much of their speed.
const SLOWER: f64 = 0.7;
const FASTER: f64 = 1.35;

/// What became of an edit.
#[derive(Debug, Clone, PartialEq)]
pub struct Edited {
    /// The artifacts; equal to those before, byte for byte, wherever the edit does not speak of them.
    pub draft: Draft,
    /// What was asked for now: facts that the edit overrules are changed, so that the checks hold the draft against them.
    pub reading: Reading,
    /// What was done, a sentence each.
    pub done: Vec<String>,
    /// Words that were not understood within what was done: the rest of their wish holds.
    pub left_out: Vec<String>,
    /// What was not done and why, with what can be said instead (P-READ, P-PLACE). Nothing of it was changed.
    pub not_done: Vec<Fault>,
}

/// Does what the words ask for, as far as they can be understood.
///
/// `question` gives request, reading, location and seed; its stage, feedback and proposal are not looked at. Deterministic;
/// never fails: what cannot be done stands in [`Edited::not_done`].
#[must_use]
pub fn edit(question: &Question, draft: &Draft, words: &str) -> Edited {
    let mut desk = Desk::of(question, draft);
    let mut crowd = Crowd::of(&draft.proposal);
    let found = wishes(words);
    if found.is_empty() {
        desk.refuse(words, "says nothing");
    }
    for wish in found {
        desk.grant(&wish, &mut crowd);
    }
    desk.finish(draft, &question.reading)
}

/// What follows from a proposal that was changed elsewhere: prose, clauses and trees of those whose part changed, given by
/// their places, and what is asked for now.
#[must_use]
pub fn settled(question: &Question, before: &Draft, proposal: Proposal, changed: &[usize]) -> Edited {
    let mut desk = Desk::of(question, before);
    desk.draft.proposal = proposal;
    desk.changed = changed.to_vec();
    desk.finish(before, &question.reading)
}

impl Desk {
    /// Does a wish, or nothing of it: what is said to be done is done, and for what is not nothing was changed.
    fn grant(&mut self, wish: &Wish, crowd: &mut Crowd) {
        let before = (self.draft.clone(), self.question.clone(), self.changed.clone(), crowd.clone());
        let (done, left_out, refused) = (self.done.len(), self.left_out.len(), self.not_done.len());
        self.try_wish(wish, crowd);
        let did = self.done.len() > done;
        if did && self.not_done.len() > refused {
            (self.draft, self.question, self.changed, *crowd) = before;
            self.done.truncate(done);
            self.left_out.truncate(left_out);
        } else if !did {
            for words in self.left_out.split_off(left_out) {
                self.refuse(&words, "was not understood");
            }
        }
    }

    fn try_wish(&mut self, wish: &Wish, crowd: &mut Crowd) {
        if crowd.is_guess(wish) {
            return self.refuse(&wish.quote, "does not say which of those who are there is meant");
        }
        match wish.edit {
            Edit::Longer | Edit::Shorter | Edit::Reverse | Edit::Avoid | Edit::Start | Edit::End | Edit::Move => {
                edit_paths::grant(self, wish, crowd);
            }
            Edit::Remove => edit_people::remove(self, wish, crowd),
            Edit::Slower => edit_people::pace(self, wish, crowd, SLOWER),
            Edit::Faster => edit_people::pace(self, wish, crowd, FASTER),
            Edit::NoGestures => edit_people::no_gestures(self, wish, crowd),
            Edit::Ungroup => edit_people::ungroup(self, wish),
            Edit::Group => edit_together::group(self, wish, crowd),
            Edit::Swap => edit_together::swap(self, wish, crowd),
            Edit::Gesture => edit_together::gesture(self, wish, crowd),
            Edit::Story => edit_people::story(self, wish, crowd),
        }
    }

    fn finish(mut self, before: &Draft, asked: &Reading) -> Edited {
        let mut reading = self.question.reading.clone();
        if self.draft.proposal != before.proposal {
            edit_settle::settle(&mut self, &before.proposal, &mut reading);
        }
        if let Err(faults) = self.behaviors(before) {
            // People whose trees cannot be written cannot do what was asked for.
            self.not_done.extend(faults);
            let (draft, reading) = (before.clone(), asked.clone());
            return Edited { draft, reading, done: Vec::new(), left_out: Vec::new(), not_done: self.not_done };
        }
        Edited { draft: self.draft, reading, done: self.done, left_out: self.left_out, not_done: self.not_done }
    }

    /// Trees of those whose part changed; everybody's where somebody left, because their numbers changed.
    fn behaviors(&mut self, before: &Draft) -> Result<(), Vec<Fault>> {
        let Some(known) = self.draft.behaviors.clone() else { return Ok(()) };
        let fewer = self.draft.proposal.humans.len() < before.proposal.humans.len();
        let ids: Vec<socrates_model::HumanId> = self
            .draft
            .proposal
            .humans
            .iter()
            .enumerate()
            .filter(|(place, human)| fewer || self.changed.contains(place) || !known.humans.contains_key(&human.id))
            .map(|(_, human)| human.id)
            .collect();
        if ids.is_empty() {
            return Ok(());
        }
        let ask = Question {
            stage: Stage::Behaviors,
            proposal: Some(self.draft.proposal.clone()),
            only: ids,
            ..self.question.clone()
        };
        let made = socrates_prompts::parse_behaviors(&crate::Offline::answer(&ask), &ask)?;
        let mut humans = if fewer { std::collections::BTreeMap::new() } else { known.humans };
        humans.extend(made.humans);
        self.draft.behaviors = Some(Behaviors { humans, ..known });
        Ok(())
    }
}
