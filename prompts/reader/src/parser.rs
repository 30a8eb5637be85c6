//! The parser of clauses: where it stands, and what it knows of the clause before. Its grammar is in `sentence`, `subject` and `predicate`.

use crate::chunk::{Chunk, Is};
use crate::clause::Clause;
use crate::lexicon::Lexicon;
use crate::noun::{Head, Noun};
use crate::token::OWNS;

pub(crate) struct Parser<'a> {
    pub(crate) chunks: &'a [Chunk],
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) at: usize,
    /// The subject of the clause before, for an ellipsis.
    pub(crate) subject: Vec<Noun>,
    /// The last subject that was no robot.
    pub(crate) person: Vec<Noun>,
    /// Whether the clause before was denied: `doesn't stop or look`.
    pub(crate) denied: bool,
    pub(crate) found: Vec<Clause>,
}

impl<'a> Parser<'a> {
    pub(crate) fn new(chunks: &'a [Chunk], lexicon: &'a Lexicon) -> Self {
        Self { chunks, lexicon, at: 0, subject: Vec::new(), person: Vec::new(), denied: false, found: Vec::new() }
    }

    pub(crate) fn peek(&self) -> Option<&Chunk> {
        self.chunks.get(self.at)
    }

    pub(crate) fn ahead(&self, chunks: usize) -> Option<&Chunk> {
        self.chunks.get(self.at + chunks)
    }

    pub(crate) fn token(&self) -> usize {
        self.peek().map_or_else(|| self.chunks.last().map_or(0, |last| last.tokens.end), |chunk| chunk.tokens.start)
    }

    /// The chunk before the next one.
    pub(crate) fn before(&self) -> Option<&Chunk> {
        self.at.checked_sub(1).and_then(|at| self.chunks.get(at))
    }
}

/// Whether a noun phrase names people anew: not a pronoun, and not the robot.
pub(crate) fn names_somebody(noun: &Noun) -> bool {
    matches!(noun.head, Head::Role(_) | Head::Name(_) | Head::Bare)
}

/// Whether a word says nothing of its own.
pub(crate) fn says_nothing(chunk: &Chunk) -> bool {
    chunk.is == Is::Word && (chunk.spelled == OWNS || chunk.sorts.say_nothing())
}
