//! Makes statements: says what a piece of a clause is, by its tokens.

use std::collections::BTreeSet;
use std::ops::Range;

use socrates_model::statement::Background;

use crate::clause::Clause;
use crate::lexicon::Lexicon;
use crate::noun::{Head, Noun};
use crate::statement::{Named, Says, Statement};

/// The statements that were made, and of what kind of clause the next one is.
pub(crate) struct Maker<'a> {
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) found: Vec<Statement<Named>>,
    pub(crate) first: bool,
    pub(crate) tells: bool,
    pub(crate) partly: bool,
    pub(crate) asks: bool,
    /// Tokens of conditions for which somebody does something.
    pub(crate) answered: BTreeSet<(usize, usize)>,
}

impl<'a> Maker<'a> {
    pub(crate) fn new(lexicon: &'a Lexicon) -> Self {
        let (found, answered) = (Vec::new(), BTreeSet::new());
        Self { lexicon, found, first: false, tells: false, partly: false, asks: false, answered }
    }
}

impl Maker<'_> {
    pub(crate) fn say(&mut self, tokens: Range<usize>, says: Says<Named>) {
        let (partly, first, tells, asks) = (self.partly, self.first, self.tells, self.asks);
        self.found.push(Statement { partly, tokens, first, tells, asks, says });
        self.first = false;
    }

    /// Words that go with what is said of their clause.
    pub(crate) fn goes(&mut self, tokens: Range<usize>) {
        self.say(tokens, Says::Goes);
    }

    /// Noun phrases that go with what is said of their clause.
    pub(crate) fn nouns_go(&mut self, nouns: &[Noun]) {
        for noun in nouns {
            self.goes(noun.tokens.clone());
        }
    }

    /// `an oncoming nurse`: a word before the role that says how they move.
    pub(crate) fn modified(&mut self, nouns: &[Noun]) {
        for noun in nouns {
            let mut rows = noun.modifiers.iter().rev().filter_map(|word| {
                let pattern = self.lexicon.frame_patterns.beginning(word).find(|pattern| pattern.slots.len() == 1)?;
                self.lexicon.frames.get(pattern.row)?.relate
            });
            if let Some(relation) = rows.next() {
                self.say(noun.tokens.clone(), Says::Relate(vec![noun.clone()], Some(relation), None));
            }
        }
    }

    /// Some people are there.
    pub(crate) fn are_there(&mut self, nouns: Named) {
        self.nouns_go(nouns.get(1..).unwrap_or_default());
        if let Some(tokens) = nouns.first().map(|noun| noun.tokens.clone()) {
            self.say(tokens, Says::Introduce(nouns.clone()));
        }
        self.modified(&nouns);
    }

    /// Whether a noun phrase means the robot where it is a subject: `it sees the robot` does not.
    pub(crate) fn is_robot(&self, noun: &Noun, clause: &Clause) -> bool {
        let object = clause.acts.iter().any(|act| act.object.as_ref().is_some_and(|object| object.head == Head::Robot));
        match noun.head {
            Head::Robot => true,
            Head::It => !object,
            Head::He | Head::They | Head::Who | Head::Role(_) | Head::Name(_) | Head::Bare => false,
        }
    }

    /// Whether a statement since that number says more than who is there, and where.
    pub(crate) fn tells_since(&self, start: usize) -> bool {
        let says_no_more = |statement: &Statement<Named>| {
            matches!(
                statement.says,
                Says::Introduce(_) | Says::Background(_) | Says::Goes | Says::NotRead | Says::Happens(..) | Says::There
            )
        };
        !self.found.get(start..).unwrap_or_default().iter().all(says_no_more)
    }

    /// The words of a clause of which nothing was made; those that describe may be an act all the same in a clause that says nothing else
    /// of people (`idle`).
    pub(crate) fn rest(&mut self, clause: &Clause, idle: bool) {
        let robot = clause.subject.iter().any(|noun| noun.head == Head::Robot);
        let reason = if robot { Background::Errand } else { Background::Looks };
        for run in runs(&clause.looks) {
            self.say(run, Says::Background(reason));
        }
        let described = if idle { &[][..] } else { &clause.described[..] };
        for run in runs(described) {
            self.say(run, Says::Background(if robot { Background::Errand } else { Background::Setting }));
        }
        let left: Vec<usize> = clause.left.iter().copied().filter(|at| !described.contains(at)).collect();
        for run in runs(&left) {
            self.say(run, Says::NotRead);
        }
    }
}

/// Numbers that follow each other, together.
fn runs(places: &[usize]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for place in places {
        match runs.last_mut() {
            Some(last) if last.end == *place => last.end += 1,
            Some(_) | None => runs.push(*place..place + 1),
        }
    }
    runs
}
