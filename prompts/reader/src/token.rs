//! The one token type: a word, a number or a mark, with where it stands in the text. Tokens never change once made.

use std::fmt;
use std::ops::Range;

use serde::Deserialize;

/// The possessor's ending, or a short `is`: the chunker decides.
pub(crate) const OWNS: &str = "'s";

/// What a word can be. A word may be of several sorts: `that` is definite and begins a relative clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Sort {
    // Words that stand for people and things.
    Indefinite,
    Definite,
    Possessive,
    He,
    They,
    It,
    Every,
    Nobody,
    No,
    Somebody,
    Other,
    Former,
    Who,
    /// Never a person: `which`.
    Which,
    // Words that join.
    Be,
    Do,
    Have,
    Modal,
    Not,
    And,
    But,
    Or,
    Then,
    When,
    While,
    Until,
    Before,
    After,
    Unless,
    Cause,
    To,
    Of,
    By,
    At,
    From,
    Into,
    For,
    Later,
    Title,
    /// Ends a verb, and is never skipped: `aside`, `out`.
    Particle,
    /// Never an object: `he`.
    Nominative,
    Female,
    /// Before a name: `named`.
    Called,
    /// Takes back what was said: `no`, `sorry`.
    Regret,
    /// Before a number that tells which: `number five`, `#5`.
    Number,
    Male,
    With,
    // Words with a meaning of their own.
    Robot,
    People,
    Role,
    Group,
    Label,
    /// A role towards others: `colleague`.
    Mate,
    /// Tells beside whom somebody is: `behind him`.
    Beside,
    /// Says that it does not quite happen: `nearly`.
    Hedge,
    /// Denies it for the whole run: `never`.
    Never,
    /// Before what somebody is let do: `lets her go`.
    Lets,
    /// Before a word for a group that tells how people stand: `in a group`, `form a pair`.
    Forms,
    /// Where was spoken of: `there`.
    There,
    /// A role that can be seen of anybody: `boy`.
    Seen,
    Slow,
    Brisk,
    Looks,
    Thing,
    Fill,
    /// A noun that says nothing of its own: `way`, `moment`.
    Empty,
    Verb,
}

/// A set of sorts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Sorts(u128);

impl Sorts {
    pub(crate) const fn with(self, sort: Sort) -> Self {
        Self(self.0 | 1 << sort as u64)
    }

    pub(crate) const fn has(self, sort: Sort) -> bool {
        self.0 & (1 << sort as u64) != 0
    }

    pub(crate) const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether a word of these sorts says nothing of its own.
    pub(crate) fn say_nothing(self) -> bool {
        const SILENT: [Sort; 23] = [
            Sort::Possessive,
            Sort::But,
            Sort::Or,
            Sort::Fill,
            Sort::Empty,
            Sort::Be,
            Sort::Do,
            Sort::Have,
            Sort::Modal,
            Sort::Definite,
            Sort::Indefinite,
            Sort::To,
            Sort::Of,
            Sort::By,
            Sort::At,
            Sort::From,
            Sort::Then,
            Sort::Who,
            Sort::And,
            Sort::While,
            Sort::Later,
            Sort::After,
            Sort::Before,
        ];
        SILENT.iter().any(|sort| self.has(*sort))
    }

    pub(crate) const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// Marks that say something about how clauses stand to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    Comma,
    Stop,
    Colon,
    Dash,
    Open,
    Close,
    Quote,
    Arrow,
}

/// How a word is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bent {
    Base,
    /// `stops`, `workers`.
    S,
    /// `stopping`.
    Ing,
    /// `stopped`, `seen`.
    Ed,
}

/// What a token is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Kind {
    Word,
    Number(f64),
    Mark(Mark),
}

/// One token.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Token {
    /// Where it stands, in bytes of the text. A word put in by a rewrite stands where the words stand that it replaces.
    pub(crate) at: Range<usize>,
    /// In lower case.
    pub(crate) spelled: String,
    /// In its base form.
    pub(crate) lemma: String,
    pub(crate) kind: Kind,
    pub(crate) sorts: Sorts,
    pub(crate) bent: Bent,
    /// Whether it is written as a name: with a capital, and not all of it capitals.
    pub(crate) capital: bool,
}

impl Token {
    pub(crate) fn is(&self, sort: Sort) -> bool {
        self.sorts.has(sort)
    }

    pub(crate) fn is_mark(&self, mark: Mark) -> bool {
        self.kind == Kind::Mark(mark)
    }

    /// Whether it is a word or number.
    pub(crate) const fn is_said(&self) -> bool {
        !matches!(self.kind, Kind::Mark(_))
    }

    /// Whether a word says nothing of its own.
    pub(crate) fn says_nothing(&self) -> bool {
        self.kind == Kind::Word && (self.spelled == OWNS || self.sorts.say_nothing())
    }

    pub(crate) const fn number(&self) -> Option<f64> {
        if let Kind::Number(number) = self.kind { Some(number) } else { None }
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            Kind::Word if self.spelled == self.lemma => f.write_str(&self.spelled),
            Kind::Word => write!(f, "{}/{}", self.spelled, self.lemma),
            Kind::Number(number) => write!(f, "#{number}"),
            Kind::Mark(mark) => write!(f, "<{mark:?}>"),
        }
    }
}
