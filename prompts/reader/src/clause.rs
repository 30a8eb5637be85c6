//! Clauses: who does what, when, where, for how long; with the words of which nothing was made.

use std::ops::Range;

use socrates_model::{Gesture, PlaceClass};

use crate::noun::Noun;

/// How a clause follows the one before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Join {
    /// A sentence begins.
    #[default]
    Start,
    /// `and`, a comma.
    And,
    /// `but`, `whereas`.
    But,
    /// `then`, an arrow.
    Then,
    /// A colon, a bracket: what follows tells of what stands before.
    Colon,
}

/// How a condition is tied to its clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tie {
    When,
    Until,
    Before,
    After,
    While,
    Unless,
}

/// A subordinate clause that says when.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Condition {
    pub(crate) tie: Tie,
    pub(crate) clause: Clause,
}

impl Condition {
    /// Whether it names people and tells what they do.
    pub(crate) fn tells_of_people(&self) -> bool {
        !self.clause.subject.is_empty() && !self.clause.acts.is_empty()
    }
}

/// One act of a clause, or another phrase that matches a row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Predicate {
    /// Number of the row among the frames.
    pub(crate) row: usize,
    pub(crate) object: Option<Noun>,
    pub(crate) owner: Option<Noun>,
    pub(crate) not: bool,
    /// Whether the subject is the one to whom it is done.
    pub(crate) passive: bool,
    /// Whether it goes on from the start: `is standing`.
    pub(crate) ongoing: bool,
    /// What is asked for, or said.
    pub(crate) sign: Option<Gesture>,
    pub(crate) tokens: Range<usize>,
}

impl Predicate {
    /// A row that these tokens match, and nothing more.
    pub(crate) const fn bare(row: usize, tokens: Range<usize>) -> Self {
        let (object, owner, sign) = (None, None, None);
        Self { row, object, owner, not: false, passive: false, ongoing: false, sign, tokens }
    }
}

/// A place with how it is spoken of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct At {
    pub(crate) class: Option<PlaceClass>,
    pub(crate) to: bool,
    pub(crate) from: bool,
    /// Whether the way leads past it.
    pub(crate) via: bool,
    /// Its tokens: the first, and the one behind it.
    pub(crate) tokens: (usize, usize),
}

/// An amount with the tokens that say it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measure {
    pub(crate) value: f64,
    /// Its first token.
    pub(crate) from: usize,
    /// The token behind it.
    pub(crate) to: usize,
}

/// A heading has no more words than this.
const HEADING: usize = 6;

/// A clause.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Clause {
    pub(crate) join: Join,
    /// Whether what comes next in it is denied.
    pub(crate) not: bool,
    /// Whether it is asked.
    pub(crate) asks: bool,
    /// Whether what is denied in it never happens: `never`, `at no time`.
    pub(crate) never: bool,
    /// Whether its subject stands in it.
    pub(crate) own: bool,
    /// The people whose acts these are; of an ellipsis, those of the clause before. Empty where nobody was named yet.
    pub(crate) subject: Vec<Noun>,
    pub(crate) acts: Vec<Predicate>,
    /// Others who are named beside: `with her son`.
    pub(crate) also: Vec<Noun>,
    /// Tokens that go with it: whose goal or way it is, what somebody is.
    pub(crate) goes: Vec<Range<usize>>,
    /// By whom, in the passive.
    pub(crate) agent: Option<Noun>,
    /// Whether its subjects are a group.
    pub(crate) group: bool,
    /// Whether it happens `there`.
    pub(crate) there: bool,
    /// Whether it says `does`, or `does not`, and not what.
    pub(crate) does: Option<bool>,
    pub(crate) lasts_s: Option<Measure>,
    pub(crate) after_s: Option<Measure>,
    pub(crate) within_m: Option<Measure>,
    pub(crate) pace_mps: Option<Measure>,
    pub(crate) places: Vec<At>,
    pub(crate) conditions: Vec<Condition>,
    /// Tokens of words that deny: `not`, `refuses to`.
    pub(crate) denials: Vec<Range<usize>>,
    /// Whether one of those of which nothing was made may be a verb: `yodels`.
    pub(crate) verbal: bool,
    /// Tokens of which nothing was made.
    pub(crate) left: Vec<usize>,
    /// Those of them that ask for nothing where they stand.
    pub(crate) described: Vec<usize>,
    /// Tokens that tell how somebody looks, or what they have with them.
    pub(crate) looks: Vec<usize>,
    pub(crate) tokens: Range<usize>,
}

impl Clause {
    pub(crate) fn new(join: Join, at: usize) -> Self {
        Self {
            join,
            not: false,
            asks: false,
            never: false,
            own: false,
            subject: Vec::new(),
            acts: Vec::new(),
            also: Vec::new(),
            goes: Vec::new(),
            agent: None,
            group: false,
            there: false,
            does: None,
            lasts_s: None,
            after_s: None,
            within_m: None,
            pace_mps: None,
            places: Vec::new(),
            conditions: Vec::new(),
            denials: Vec::new(),
            verbal: false,
            left: Vec::new(),
            described: Vec::new(),
            looks: Vec::new(),
            tokens: at..at,
        }
    }

    /// Whether its subject may follow: `in the corridor stands a nurse`.
    pub(crate) fn is_turned(&self) -> bool {
        let alone = |act: &Predicate| act.object.is_none() && act.sign.is_none();
        !self.acts.is_empty() && self.acts.iter().all(alone) && !self.own && matches!(self.join, Join::Start)
    }

    /// Whether it names nobody and no place, and nothing that is known is done in it.
    pub(crate) fn is_silent(&self) -> bool {
        !self.own
            && self.acts.is_empty()
            && self.also.is_empty()
            && self.places.is_empty()
            && self.conditions.is_empty()
            && self.denials.is_empty()
            && self.within_m.is_none()
            && self.lasts_s.is_none()
            && self.after_s.is_none()
    }

    /// Whether it names a text, and tells of nobody and nothing: a few words of which nothing is known.
    pub(crate) fn is_heading(&self) -> bool {
        self.is_silent() && !self.left.is_empty() && self.left.len() <= HEADING
    }

    pub(crate) fn is_bare(&self) -> bool {
        // What a word before the role says is no act of the clause yet.
        self.acts.iter().all(|act| self.subject.iter().any(|noun| noun.tokens == act.tokens))
            && self.places.is_empty()
            && self.within_m.is_none()
            && self.lasts_s.is_none()
            && self.after_s.is_none()
    }
}
