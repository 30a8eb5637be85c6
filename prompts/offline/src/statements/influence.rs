//! Which words of a task or context were read: those of which their reader made something, where their clause changes a line.

use super::text::{Token, masked};
use super::words::Kind;
use crate::lines::Line;

/// What the words of a text do to the reading.
pub(super) struct Influence {
    /// Per clause: the lines of the whole reading that it changes, by their numbers; nothing where it changes none.
    pub(super) lines: Vec<Vec<usize>>,
    /// Per word: whether it was read.
    pub(super) read: Vec<bool>,
}

impl Influence {
    /// Whether a word was read.
    pub(super) fn is_read(&self, place: usize) -> bool {
        self.read.get(place).copied().unwrap_or(false)
    }
}

/// A text, and how it is read again.
pub(super) struct Text<'a> {
    pub(super) text: &'a str,
    pub(super) tokens: &'a [Token],
    pub(super) kinds: &'a [Kind],
    /// Per word: whether a rule took it.
    pub(super) used: Vec<bool>,
    /// The lines of the whole reading.
    pub(super) whole: &'a [Line],
    /// The lines of another text in its place.
    pub(super) read: &'a dyn Fn(&str) -> Vec<Line>,
}

impl Text<'_> {
    fn kind(&self, place: usize) -> Kind {
        self.kinds.get(place).copied().unwrap_or(Kind::Connective)
    }

    fn says(&self, place: usize) -> bool {
        self.kind(place) != Kind::Connective
    }

    fn is_used(&self, place: usize) -> bool {
        self.used.get(place).copied().unwrap_or(false)
    }

    fn without(&self, hidden: &dyn Fn(usize) -> bool) -> Vec<Line> {
        (self.read)(&masked(self.text, self.tokens, hidden))
    }

    /// The words of a clause that say something.
    fn of_clause(&self, clause: usize) -> Vec<usize> {
        let own =
            |place: &usize| self.tokens.get(*place).is_some_and(|token| token.clause == clause) && self.says(*place);
        (0..self.tokens.len()).filter(own).collect()
    }

    /// What was read of a text of which it is known of which words something was made. Not `surely`: they are read where their clause
    /// changes something.
    pub(super) fn by_clause(&self, surely: bool) -> Influence {
        let clauses = self.tokens.last().map_or(0, |last| last.clause + 1);
        let mut found = Influence { lines: vec![Vec::new(); clauses], read: vec![false; self.tokens.len()] };
        for (clause, lines) in found.lines.iter_mut().enumerate() {
            let used: Vec<usize> = self.of_clause(clause).into_iter().filter(|place| self.is_used(*place)).collect();
            if used.is_empty() {
                continue;
            }
            let other = self.without(&|n| used.contains(&n));
            let lost = |n: &usize| self.whole.get(*n).is_some_and(|line| !other.contains(line));
            *lines = (0..self.whole.len()).filter(lost).collect();
            for place in used.into_iter().filter(|_| surely || other != self.whole) {
                if let Some(read) = found.read.get_mut(place) {
                    *read = true;
                }
            }
        }
        found
    }
}
