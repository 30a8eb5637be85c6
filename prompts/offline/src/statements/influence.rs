//! Which words of a text were read: those without which something else would have been understood.
//!
//! Words are exchanged for one that nobody knows, and the text is read again. Where every line of the reading stays as it is, nothing
//! was made of them, whatever rule may have touched them. That holds for any reader.
//!
//! A clause is looked at as a whole: a rule reads phrases, and `comes` of `comes towards the robot` changes nothing alone. Of a clause
//! that changes something, the words that a rule took for a phrase are read; those that none took, and those that say a side, a
//! number, an order or a denial, have to change something by themselves.

use super::lines::Line;
use super::text::{Token, exchanged, masked};
use super::words::{Kind, others};

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

    fn mark(&mut self, place: usize) {
        if let Some(read) = self.read.get_mut(place) {
            *read = true;
        }
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

    /// Whether a word is read with the phrase that it stands in.
    fn goes_along(&self, place: usize) -> bool {
        self.kind(place).joins_phrases() && self.is_used(place)
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

    /// Whether a word by itself changes the reading. Where another word would say the opposite, that one must: `from the left` may
    /// say that somebody crosses without a word being read of the side, and `two nurses` are two as `nurses` are.
    fn changes(&self, place: usize) -> bool {
        let Some(token) = self.tokens.get(place) else { return false };
        let others = others(&token.lower);
        if others.is_empty() {
            return self.without(&|n| n == place) != self.whole;
        }
        others.iter().any(|word| (self.read)(&exchanged(self.text, token, word)) != self.whole)
    }

    /// Which words were read, and what each clause became.
    pub(super) fn influence(&self) -> Influence {
        let clauses = self.tokens.last().map_or(0, |last| last.clause + 1);
        let mut found = Influence { lines: vec![Vec::new(); clauses], read: vec![false; self.tokens.len()] };
        let mut idle = Vec::new();
        for clause in 0..clauses {
            let words = self.of_clause(clause);
            if words.is_empty() {
                continue;
            }
            let other = self.without(&|n| words.contains(&n));
            let is_idle = other == self.whole;
            if is_idle {
                idle.push(clause);
            }
            let lost = |n: &usize| self.whole.get(*n).is_some_and(|line| !other.contains(line));
            if let Some(lines) = found.lines.get_mut(clause) {
                *lines = (0..self.whole.len()).filter(lost).collect();
            }
            for place in words {
                let read = if self.goes_along(place) {
                    !is_idle
                } else {
                    // Without a number the usual one is taken: only another number shows whether it was read.
                    (!is_idle || self.kind(place) == Kind::Number) && self.changes(place)
                };
                if read {
                    found.mark(place);
                }
            }
        }
        self.ranges(&mut found);
        self.sides_of_a_way(&mut found);
        self.said_twice(&idle, &mut found);
        self.said_before(&idle, &mut found);
        found
    }

    /// The same of a text of which it is known which words something was made of. Not `surely`: they are read where their clause
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

    /// `two or three people`: both ends of a range are read where one is.
    fn ranges(&self, found: &mut Influence) {
        let joins = |place: usize| {
            let join = self.tokens.get(place).is_some_and(|token| matches!(token.lower.as_str(), "or" | "to" | "and"));
            join && place.checked_sub(1).is_some_and(|before| self.kind(before) == Kind::Number)
                && self.kind(place + 1) == Kind::Number
        };
        for place in (0..self.tokens.len()).filter(|place| joins(*place)) {
            let ends = [place - 1, place + 1];
            let read = ends.iter().any(|end| found.is_read(*end));
            for end in ends.into_iter().filter(|_| read) {
                found.mark(end);
            }
        }
    }

    /// `from its right to its left`: the one side follows from the other.
    fn sides_of_a_way(&self, found: &mut Influence) {
        let is = |place: usize, word: &str| self.tokens.get(place).is_some_and(|token| token.lower == word);
        let side = |place: usize, table: &[&str]| table.iter().any(|word| is(place, word));
        for to in (0..self.tokens.len()).filter(|place| is(*place, "to")) {
            let near = |range: std::ops::Range<usize>| range.into_iter().find(|place| side(*place, &["left", "right"]));
            let (Some(first), Some(then)) = (near(to.saturating_sub(2)..to), near(to + 1..to + 4)) else { continue };
            let opposite = side(first, &["left"]) != side(then, &["left"]);
            let from = (first.saturating_sub(2)..first).any(|place| is(place, "from"));
            if opposite && from && (found.is_read(first) || found.is_read(then)) {
                found.mark(first);
                found.mark(then);
            }
        }
    }

    /// Clauses that change nothing because what they say is a part of what the others say: alone, they are read as nothing else.
    fn said_before(&self, idle: &[usize], found: &mut Influence) {
        let says = |place: usize| self.says(place);
        let none = if idle.is_empty() { Vec::new() } else { self.without(&says) };
        for clause in idle {
            let own = self.of_clause(*clause);
            let alone = self.without(&|n| says(n) && !own.contains(&n));
            let more: Vec<&Line> = alone.iter().filter(|line| !none.contains(line)).collect();
            let same = !more.is_empty() && more.iter().all(|line| !line.shown || self.whole.contains(line));
            for place in own.into_iter().filter(|place| same && self.goes_along(*place)) {
                found.mark(place);
            }
        }
    }

    /// Clauses that change nothing because another says the same: of two, each alone with the rest of the text.
    fn said_twice(&self, idle: &[usize], found: &mut Influence) {
        if idle.len() < 2 {
            return;
        }
        let all: Vec<usize> = idle.iter().flat_map(|clause| self.of_clause(*clause)).collect();
        let none = self.without(&|n| all.contains(&n));
        for clause in idle {
            let own = self.of_clause(*clause);
            let alone = self.without(&|n| all.contains(&n) && !own.contains(&n));
            for place in own.into_iter().filter(|place| alone != none && self.goes_along(*place)) {
                found.mark(place);
            }
        }
    }
}
