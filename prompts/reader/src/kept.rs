//! What a text counts, measures and names has to be in the story. Words of which a statement was made, and whose amount or role
//! the story does not hold, are not read after all.
//!
//! ```text
//! "at 2 m … stops" and no step at 2 m ─► NotRead "2 m";  "a porter" and nobody of that role ─► NotRead "a porter"
//! ```

use std::ops::Range;

use crate::chunk::{Amount, Chunk, Is};
use crate::noun::{Head, Noun};
use crate::rows::Cue;
use crate::story::{Step, Story};

/// Tokens of amounts and of people that are not in the story.
pub(crate) fn missing(chunks: &[Chunk], story: &Story) -> Vec<Range<usize>> {
    let is_missing = |chunk: &&Chunk| match &chunk.is {
        Is::Amount(amount) => !holds_amount(story, *amount),
        Is::Noun(noun) | Is::Whose(noun) => !holds_role(story, noun),
        Is::Place(_) | Is::Mark(_) | Is::Word => false,
    };
    chunks.iter().filter(is_missing).map(|chunk| chunk.tokens.clone()).collect()
}

fn holds_amount(story: &Story, amount: Amount) -> bool {
    let same = |own: f64, said: f64| (own - said).abs() < 1e-6;
    if let Amount::Speed(mps) = amount {
        return story.people.iter().any(|person| person.pace_mps.is_some_and(|own| same(own, mps)));
    }
    let of = |step: &Step| {
        let reasons = || step.when.iter().chain(&step.until);
        match amount {
            Amount::Distance(m) => {
                reasons().any(|reason| reason.cue != Cue::After && reason.amount.is_some_and(|own| same(own, m)))
            }
            Amount::Speed(_) => false,
            Amount::Time(secs) => {
                let after = |own: f64| same(own, secs);
                step.for_s.is_some_and(after)
                    || reasons().any(|reason| reason.cue == Cue::After && reason.amount.is_some_and(after))
            }
        }
    };
    story.people.iter().flat_map(|person| &person.steps).any(of)
}

/// Whether somebody has the role. A word that can be said of anybody, or of whoever is with others, names nobody anew.
fn holds_role(story: &Story, noun: &Noun) -> bool {
    let Head::Role(role) = &noun.head else { return true };
    let anybody = noun.generic || noun.by_looks || noun.mate || noun.group;
    anybody || story.people.iter().any(|person| person.role == *role)
}
