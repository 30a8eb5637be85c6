//! Noun phrases for people and for the robot: `the first two of the workers`, `an elderly man`, `both`, `it`.

use std::fmt;
use std::ops::Range;

use socrates_model::Relation;

/// What a noun phrase is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Head {
    Robot,
    /// `it`: mostly the robot.
    It,
    /// `he`, `she`.
    He,
    /// `they`.
    They,
    /// `who`, `which`: whoever was named just before.
    Who,
    /// A role word, in its base form.
    Role(String),
    /// Somebody by name.
    Name(String),
    /// A number, an ordinal or `others` without a noun.
    Bare,
}

/// How a noun phrase picks people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pick {
    /// No article: `worker`.
    Plain,
    /// `a`, `some`, a number.
    Some,
    /// `the`, `his`.
    The,
    /// `all`, `both`, `each`.
    All,
    /// `none`, `no`, `neither`.
    None,
    /// `the other`.
    Others,
    /// `another`.
    Another,
    /// `the former`.
    Former,
}

/// A noun phrase.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Noun {
    pub(crate) head: Head,
    pub(crate) pick: Pick,
    /// How many.
    pub(crate) count: Option<u32>,
    /// Which by number: `the second`, `worker 2`; 0 is the last.
    pub(crate) ordinal: Option<u32>,
    /// Whether it is more than one.
    pub(crate) several: bool,
    /// Whether they are said to be a group.
    pub(crate) group: bool,
    /// How fast they walk, where a word before the role says it, m/s.
    pub(crate) pace_mps: Option<f64>,
    /// What they are, where that is put beside their name: `Tom, a student`.
    pub(crate) beside: Option<String>,
    /// Their names, of several: `two colleagues, Ben and Carla`.
    pub(crate) names: Vec<String>,
    /// Whether it can be no object: `he`.
    pub(crate) nominative: bool,
    /// Whether a woman is meant, or a man.
    pub(crate) female: Option<bool>,
    /// Whether the role is that of anybody: `person`.
    pub(crate) generic: bool,
    /// Whether a word before the role compares them with others: `older`.
    pub(crate) compared: bool,
    /// Whether it says no more than the subject: `herself`.
    pub(crate) reflexive: bool,
    /// Whether the role says how somebody stands to others: `colleague`.
    pub(crate) mate: bool,
    /// Whether the role says no more than can be seen of anybody: `boy`.
    pub(crate) by_looks: bool,
    /// How they are known to stand to the robot's way: `the one who crosses`.
    pub(crate) known_by: Option<Relation>,
    /// Words before the role, in their base form.
    pub(crate) modifiers: Vec<String>,
    /// But for whom: `all but the last`.
    pub(crate) except: Option<Box<Noun>>,
    /// Of whom: `one of the workers`.
    pub(crate) of: Option<Box<Noun>>,
    /// The tokens of it.
    pub(crate) tokens: Range<usize>,
}

impl Noun {
    pub(crate) fn new(head: Head, tokens: Range<usize>) -> Self {
        Self {
            head,
            pick: Pick::Plain,
            count: None,
            ordinal: None,
            several: false,
            group: false,
            pace_mps: None,
            beside: None,
            names: Vec::new(),
            nominative: false,
            female: None,
            generic: false,
            compared: false,
            reflexive: false,
            mate: false,
            by_looks: false,
            known_by: None,
            modifiers: Vec::new(),
            except: None,
            of: None,
            tokens,
        }
    }

    /// Whether it can mean the robot.
    pub(crate) fn may_be_robot(&self) -> bool {
        matches!(self.head, Head::Robot | Head::It)
    }

    /// Whether it can mean somebody.
    pub(crate) fn may_be_person(&self) -> bool {
        self.head != Head::Robot
    }
}

impl fmt::Display for Noun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.pick)?;
        if let Some(count) = self.count {
            write!(f, " {count}")?;
        }
        if let Some(ordinal) = self.ordinal {
            write!(f, " #{ordinal}")?;
        }
        match &self.head {
            Head::Role(role) | Head::Name(role) => write!(f, " {role}")?,
            Head::Robot | Head::It | Head::He | Head::They | Head::Who | Head::Bare => write!(f, " {:?}", self.head)?,
        }
        if self.several {
            f.write_str("s")?;
        }
        self.of.as_ref().map_or(Ok(()), |of| write!(f, " of ({of})"))
    }
}

/// Walking speeds that words before a role mean, m/s: as the form's `slow` and `brisk`.
pub(crate) const SLOW_MPS: f64 = 0.6;
/// See [`SLOW_MPS`].
pub(crate) const BRISK_MPS: f64 = 1.5;
