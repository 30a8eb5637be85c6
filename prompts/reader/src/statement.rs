//! Statements: what the layers above and below share. A statement says one thing, and of whom: first as the text names them, then
//! as people (`discourse`).
//!
//! ```text
//! "the nurse steps aside when it is near" ─► The nurse: give_way when Near
//! ```

use std::ops::Range;

use socrates_model::statement::Background;
use socrates_model::{Gesture, PlaceClass, Relation, Side};

use crate::noun::Noun;
use crate::rows::{Act, Cue};

/// Why somebody begins or ends something.
#[derive(Debug, Clone, PartialEq)]
pub struct Reason<W> {
    /// Whose: nobody where it is the robot's, or their own.
    pub who: Option<W>,
    /// What.
    pub cue: Cue,
    /// Which sign.
    pub sign: Option<Gesture>,
    /// How far, m; how long, s.
    pub amount: Option<f64>,
}

/// What a statement says; `W` names people.
#[derive(Debug, Clone, PartialEq)]
pub enum Says<W> {
    /// Somebody is there.
    Introduce(W),
    /// Somebody does what leaves no trace in a form: walks, or pays no attention.
    Noted(W),
    /// Somebody walks, and no more is said of how: nothing but where something is told of them already.
    Walks(W),
    /// How somebody stands to the robot's way.
    Relate(W, Option<Relation>, Option<Side>),
    /// They are a group.
    Group(W),
    /// They stand one behind the other.
    Queue(W),
    /// They meet the robot a second time, where that is said.
    Twice(W, Option<PlaceClass>),
    /// How fast somebody walks, m/s.
    Pace(W, f64),
    /// Somebody does something, or does not.
    Do(Deed<W>),
    /// The robot makes a sign, to somebody.
    RobotSays(Option<Gesture>, Option<W>),
    /// Out of which room or car somebody comes.
    From(W, PlaceClass),
    /// Those before whom somebody comes, mostly those who were told last to come, and who comes after them.
    After(Option<W>, W),
    /// The robot is there before somebody, mostly those of whom is spoken.
    RobotFirst(Option<W>),
    /// Something happens to which people may react from then on; whether it is a condition, for which somebody has to wait.
    Then(Reason<W>, bool),
    /// Where it happens; the number ranks it: people are there (3), it stands alone (2), the robot is there (1).
    Happens(PlaceClass, u8),
    /// It happens where the robot's way ends, unless another place is told.
    There,
    /// The robot's way ends in the room or car of which is spoken.
    GoalThere,
    /// What the robot's way leads past.
    RobotVia(PlaceClass),
    /// Where the robot's way begins.
    RobotStart(PlaceClass),
    /// Where it ends.
    RobotGoal(PlaceClass),
    /// It asks for nothing.
    Background(Background),
    /// It goes with what the rest of its clause says.
    Goes,
    /// It is understood, and not played.
    NotPlayed(String),
    /// It is not understood.
    NotRead,
}

/// What somebody does.
#[derive(Debug, Clone, PartialEq)]
pub struct Deed<W> {
    /// The people who do it.
    pub who: W,
    /// What.
    pub act: Act,
    /// To whom, where it is not the robot.
    pub whom: Option<W>,
    /// Whether they do not.
    pub not: bool,
    /// Whether they do not do it in the whole run.
    pub never: bool,
    /// All of these have to hold.
    pub when: Vec<Reason<W>>,
    /// It ends when this holds.
    pub until: Vec<Reason<W>>,
    /// For how long, s.
    pub for_s: Option<f64>,
    /// A sign made with it.
    pub says: Option<Gesture>,
    /// Whether it goes on from the start, whatever else happens: `is standing`.
    pub ongoing: bool,
    /// Whether it is what was asked for just before: `does so`.
    pub obeys: bool,
    /// Whether it comes after what was told before: `and then`.
    pub then: bool,
}

impl<W> Deed<W> {
    /// Somebody does something, at once and to nobody.
    pub(crate) fn of(who: W, act: Act) -> Self {
        Self {
            who,
            act,
            whom: None,
            not: false,
            never: false,
            ongoing: false,
            when: Vec::new(),
            until: Vec::new(),
            for_s: None,
            says: None,
            obeys: false,
            then: false,
        }
    }
}

/// A statement with where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement<W> {
    /// Whether words of its clause were left over.
    pub(crate) partly: bool,
    /// Its tokens.
    pub(crate) tokens: Range<usize>,
    /// Whether a sentence begins with it.
    pub(crate) first: bool,
    /// Whether it tells of those named before a colon.
    pub(crate) tells: bool,
    /// Whether it is asked.
    pub(crate) asks: bool,
    /// What it says.
    pub says: Says<W>,
}

/// People as a text names them.
pub(crate) type Named = Vec<Noun>;
