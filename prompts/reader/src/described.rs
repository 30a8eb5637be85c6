//! Words of which nothing was made, and that ask for nothing where they stand: descriptions.
//!
//! ```text
//! A porter waits near the aquarium ─► "aquarium": where, and nothing that anybody does
//! ```
//! A word that may be an act, or may name somebody, is none of them: it stays said to be not read.

use crate::chunk::{Chunk, Is};
use crate::clause::Clause;
use crate::noun::{Head, Noun};
use crate::parser::Parser;
use crate::token::{Bent, Sort};

/// Words that tell where or what for, before a noun. Behind `with`, `by`, `of` and `to` may be somebody.
const PREPOSITIONS: [Sort; 4] = [Sort::At, Sort::From, Sort::For, Sort::Into];

impl Parser<'_> {
    /// Notes which of the words that are left of a clause describe. `start` is its first chunk.
    pub(crate) fn describe(&self, start: usize, inner: bool, clause: &mut Clause) {
        let robot = !inner && !clause.subject.is_empty() && clause.subject.iter().all(Noun::may_be_robot);
        let finite = |chunk: &Chunk| chunk.is == Is::Word && chunk.bent == Bent::S;
        let heading =
            clause.subject.is_empty() && clause.acts.is_empty() && !self.chunks.get(start).is_some_and(finite);
        for (at, chunk) in self.chunks.iter().enumerate().take(self.at).skip(start) {
            if !chunk.tokens.clone().all(|token| clause.left.contains(&token)) {
                continue;
            }
            let describes = match &chunk.is {
                // What is done to the robot is told by its verb.
                Is::Noun(noun) if matches!(noun.head, Head::He | Head::They) => self.is_beside(at),
                Is::Noun(noun) => noun.may_be_robot() && !self.chunks.get(at + 1).is_some_and(begins_a_verb),
                // `nearly walks into it` is not done.
                Is::Word if chunk.word(Sort::Hedge) => false,
                Is::Word => robot || heading || is_adverb(chunk) || self.follows_a_preposition(at, start),
                Is::Whose(_) | Is::Place(_) | Is::Amount(_) | Is::Mark(_) => false,
            };
            if describes {
                clause.described.extend(chunk.tokens.clone());
            }
        }
    }

    /// `a guard stands beside him`, `next to her`: somebody who was named is there as well.
    fn is_beside(&self, at: usize) -> bool {
        let before = |back: usize| at.checked_sub(back).and_then(|at| self.chunks.get(at));
        let beside = |back: usize| before(back).is_some_and(|chunk| chunk.word(Sort::Beside) || chunk.word(Sort::With));
        // `the one behind him` is somebody else.
        let which = |back: usize| {
            before(back).and_then(Chunk::noun).is_some_and(|noun| noun.head == Head::Bare && noun.ordinal.is_none())
        };
        beside(1) && !which(2) || before(1).is_some_and(|chunk| chunk.word(Sort::To)) && beside(2)
    }

    /// `near the aquarium`, `with a pile of folders`: nothing but articles and words like it between a preposition and it.
    fn follows_a_preposition(&self, at: usize, start: usize) -> bool {
        let own = self.chunks.get(at).is_some_and(may_be_a_thing);
        let before = self.chunks.get(start..at).unwrap_or_default();
        let first = before.iter().rev().find(|chunk| !is_before_a_noun(chunk));
        let person = self.chunks.get(at).is_some_and(|chunk| self.lexicon.words.sounds_like_a_person(&chunk.lemma));
        // `for one who walks away`: a number may be somebody.
        let counts = self.chunks.get(at).is_some_and(|chunk| self.lexicon.words.numbers.contains_key(&chunk.lemma));
        own && !person && !counts && first.is_some_and(|chunk| PREPOSITIONS.iter().any(|sort| chunk.word(*sort)))
    }
}

/// `explicitly`: tells how.
fn is_adverb(chunk: &Chunk) -> bool {
    chunk.sorts.is_empty() && chunk.bent == Bent::Base && chunk.spelled.ends_with("ly")
}

/// `which the robot acknowledges`: whoever stands before a verb does it.
fn begins_a_verb(chunk: &Chunk) -> bool {
    let helps = [Sort::Be, Sort::Do, Sort::Have, Sort::Modal].iter().any(|sort| chunk.word(*sort));
    helps || chunk.word(Sort::Verb) && chunk.bent == Bent::S
}

/// Whether a word may be a noun for a thing: not known as a verb, and not bent as one.
fn may_be_a_thing(chunk: &Chunk) -> bool {
    !chunk.word(Sort::Verb) && chunk.bent != Bent::Ed
}

/// What may stand between a preposition and its noun.
fn is_before_a_noun(chunk: &Chunk) -> bool {
    let says = [Sort::Indefinite, Sort::Definite, Sort::Looks, Sort::Thing, Sort::Label, Sort::Empty];
    let unknown = chunk.is == Is::Word && chunk.sorts.is_empty() && chunk.bent == Bent::Base;
    unknown || matches!(chunk.is, Is::Whose(_)) || says.iter().any(|sort| chunk.word(*sort))
}
