//! What reaches from clause to clause.

use socrates_model::Trigger;

use crate::cut::Joint;
use crate::deed::Around;
use crate::lexicon::Act;
use crate::order::Joiner;
use crate::story::Subject;

/// What reaches from clause to clause within a sentence.
#[derive(Default)]
pub(crate) struct Thread {
    pub(crate) subject: Subject,
    pub(crate) pending: Vec<usize>,
    pub(crate) waiting: Option<Trigger>,
    /// Words of the trigger that waits, until a deed takes it.
    pub(crate) untaken: Option<String>,
    /// Whether the trigger that waits names no distance.
    pub(crate) vague: bool,
    /// Rules of the clause before, by person and index, that a later `when` may still time.
    pub(crate) made: Vec<(usize, usize)>,
    /// The subject of the deed before in this sentence, for `stops and gestures`.
    pub(crate) doer: Option<Vec<usize>>,
    /// Whom somebody leads, and who: `A mother leads two children across`.
    pub(crate) led: Option<(Vec<usize>, Vec<usize>)>,
    /// What was said last, as what others may wait for.
    pub(crate) said: Option<Trigger>,
    /// The same, as long as nothing else was said to happen.
    pub(crate) fresh: Option<Trigger>,
    /// What the last acting clause said of its people, for `the other does not`.
    pub(crate) acts: Vec<(Act, Around)>,
    /// The clause before signals, or names the robot: a message alone is its message.
    pub(crate) speaks: bool,
    /// `does not move aside until …` says when it does.
    pub(crate) not_until: bool,
    /// What ended the deed before: `until it asks`.
    pub(crate) ended: Option<Trigger>,
    /// The clause before is a condition in which somebody does something.
    pub(crate) condition: bool,
    /// Who was named before `and`, beside other words.
    pub(crate) listed: Vec<usize>,
    /// To whom the last gesture was made.
    pub(crate) addressed: Vec<usize>,
    /// `not by himself, only after …`: who does not do what is denied, but then.
    pub(crate) only: Vec<usize>,
    /// The clause before is nothing but `only`.
    pub(crate) only_then: bool,
    /// What was said not to be done: `the first does not stop; the others do`.
    pub(crate) denied: Option<Act>,
    /// How long after what it waits for the deed begins, s.
    pub(crate) delay_s: Option<f64>,
    /// The clause before is nothing but those whom it names.
    pub(crate) bare: bool,
    /// As [`Self::bare`], of the clause before this one.
    pub(crate) bare_before: bool,
    /// The clause before names people who do nothing in it.
    pub(crate) paused: bool,
    /// Who was told apart by nothing but what the relative clause says: `the one who stays`.
    pub(crate) apart: Option<usize>,
    /// The word before this clause, and whether the one before it told of what the robot does only later.
    pub(crate) joiner: Option<Joiner>,
    pub(crate) before_robot: bool,
    /// Who met the robot in a clause after `after`.
    pub(crate) after: Option<Vec<usize>>,
    /// `One after another, four people …`
    pub(crate) in_turn: bool,
    /// The clause before only names some of those whose deeds were told: `the first when …`.
    pub(crate) renamed: bool,
    /// What a negated deed of this sentence is done at: `Unless the robot says excuse me, …`.
    pub(crate) unless: Option<Trigger>,
    /// The word before the next clause.
    pub(crate) next: Option<Joint>,
    /// The robot is to do several things: `is to fetch a client, say …`.
    pub(crate) robot_to: bool,
    /// Who walked on in the clause before, which a later `when` may still time.
    pub(crate) went_on: Vec<usize>,
}
