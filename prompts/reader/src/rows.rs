//! The rows of `data/`: what a phrase means, as data with examples of its own. Every example is a test (`tests/rows.rs`).

use std::collections::BTreeSet;

use serde::Deserialize;
use socrates_model::statement::Background;
use socrates_model::{Gesture, PlaceClass, Relation, Side};

/// What somebody does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Act {
    /// Steps aside.
    GiveWay,
    /// Stays in front of the robot.
    Block,
    /// Looks at the robot.
    Look,
    /// Looks at it because it is startled: at first sight, and for longer.
    Startle,
    /// Stands still.
    StandStill,
    /// Hurries away.
    RunAway,
    /// Comes up to the robot.
    Approach,
    /// Follows the robot, or somebody.
    Follow,
    /// Walks on.
    Navigate,
    /// Turns and walks back.
    TurnBack,
    /// Makes a sign, and nothing else.
    Sign,
}

impl Act {
    /// Its name in the lines of a story: that of the action of a form as which it is played.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::GiveWay => "give_way",
            Self::Block => "block",
            Self::Look | Self::Startle => "look_at_robot",
            Self::StandStill => "stand_still",
            Self::RunAway => "run_away",
            Self::Approach => "approach",
            Self::Follow => "follow_robot",
            Self::Navigate => "navigate",
            Self::TurnBack => "turn_back",
            Self::Sign => "say",
        }
    }

    /// The sign by which somebody is asked for it.
    #[must_use]
    pub const fn asked_by(self) -> Option<Gesture> {
        match self {
            Self::GiveWay | Self::RunAway => Some(Gesture::ExcuseMe),
            Self::StandStill | Self::Block => Some(Gesture::Wait),
            Self::Follow | Self::Approach => Some(Gesture::FollowMe),
            Self::Navigate => Some(Gesture::Proceed),
            Self::Look | Self::Startle | Self::TurnBack | Self::Sign => None,
        }
    }
}

/// What something is as the reason for which somebody begins or ends something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cue {
    /// The robot is seen.
    Visible,
    /// The robot is near.
    Near,
    /// The robot is in the way.
    Blocking,
    /// The robot moves.
    Moving,
    /// The robot stands.
    Stopped,
    /// The robot has passed.
    Passed,
    /// A sign is made.
    Says,
    /// They meet.
    Encounter,
    /// The end of the way is reached.
    Goal,
    /// So long after the start.
    After,
}

/// A part of the robot's way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Part {
    /// Where it begins.
    Start,
    /// Where it ends.
    Goal,
    /// It ends in the room or car of which is spoken: `wants to get in`.
    There,
}

/// A row of `frames.toml`: a verb with what belongs to it, or another phrase that says how somebody moves.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Frame {
    /// Its name, for dumps and counts.
    pub(crate) id: String,
    /// Patterns, see [`crate::pattern`].
    pub(crate) phrases: Vec<String>,
    /// How a person of whom it is said stands to the robot's way.
    pub(crate) relate: Option<Relation>,
    /// On which side.
    pub(crate) side: Option<Side>,
    /// What the person does.
    pub(crate) act: Option<Act>,
    /// What the person does of whom it is denied: `does not move`.
    pub(crate) denied: Option<Act>,
    /// Whether those of whom it is said are a group.
    pub(crate) group: bool,
    /// Whether they stand in it one behind the other.
    pub(crate) queue: bool,
    /// Whether they meet the robot a second time by it.
    pub(crate) twice: bool,
    /// What it is as a reason, said of a person.
    pub(crate) cue: Option<Cue>,
    /// What it is as a reason, said of the robot.
    pub(crate) robot_cue: Option<Cue>,
    /// How the person to whom the robot does it stands to its way.
    pub(crate) robot_relate: Option<Relation>,
    /// A sign that the person, or the robot, makes by it.
    pub(crate) says: Option<Gesture>,
    /// Whether what is asked for follows: `asks the robot to …`.
    pub(crate) asks: bool,
    /// The sign by which somebody is asked to do it.
    pub(crate) asked: Option<Gesture>,
    /// Whether it does what was asked for, or what is told before.
    pub(crate) obeys: bool,
    /// Whether it denies what is said next: `refuses to`.
    pub(crate) denies: bool,
    /// Whether what it denies never happens.
    pub(crate) never: bool,
    /// Whether nothing is to be seen of it, and why.
    pub(crate) background: Option<Background>,
    /// Why it is not played.
    pub(crate) unplayed: Option<String>,
    /// Whether it says how somebody moves, and no more than another phrase beside it: `walks`.
    pub(crate) plain: bool,
    /// Whether the robot meets those of whom is spoken before they do anything more: `goes first`.
    pub(crate) robot_first: bool,
    /// Whether the robot drives by it: to where it ends, from where it begins.
    pub(crate) goes: bool,
    /// What a place in it is for the robot: `leaves the ward`, `reaches the exit`.
    pub(crate) part: Option<Part>,
    /// Texts, each read so.
    pub(crate) reads: Vec<String>,
    /// What every one of them gives: a line of the form.
    pub(crate) gives: String,
    /// Texts of which none gives it.
    pub(crate) not: Vec<String>,
}

/// A row of `places.toml`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlaceRow {
    /// The class; none: a place that no map can hold.
    pub(crate) class: Option<PlaceClass>,
    /// Patterns of words.
    pub(crate) phrases: Vec<String>,
    /// Texts, each read so.
    #[serde(default)]
    pub(crate) reads: Vec<String>,
    /// What every one of them gives.
    #[serde(default)]
    pub(crate) gives: String,
    /// Texts of which none gives it.
    #[serde(default)]
    pub(crate) not: Vec<String>,
}

/// A row of `signs.toml`: what is said for a gesture.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SignRow {
    /// The gesture.
    pub(crate) says: Gesture,
    /// Patterns.
    pub(crate) phrases: Vec<String>,
    /// Texts, each read so.
    pub(crate) reads: Vec<String>,
    /// What every one of them gives.
    pub(crate) gives: String,
    /// Texts of which none gives it.
    #[serde(default)]
    pub(crate) not: Vec<String>,
}

/// A row of `rewrites.toml`: words in place of others.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Rewrite {
    /// Its name.
    pub(crate) id: String,
    /// Patterns of words.
    pub(crate) phrases: Vec<String>,
    /// The words in their place.
    pub(crate) becomes: String,
    /// Texts, each read as `gives`.
    pub(crate) reads: Vec<String>,
    /// A text read the same way.
    pub(crate) gives: String,
    /// Texts read otherwise than `gives`.
    #[serde(default)]
    pub(crate) not: Vec<String>,
}

/// How much of a text a phrase makes background.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Extent {
    /// Its own words.
    Words,
    /// From it to the next comma or other mark.
    Clause,
    /// The sentence in which it stands.
    Sentence,
    /// The sentence up to its end, unless that tells of the robot or a place: `for my comparison I need`.
    Lead,
}

/// A row of `scopes.toml`: words that ask for nothing.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scope {
    /// Its name.
    pub(crate) id: String,
    /// Why they ask for nothing.
    pub(crate) reason: Background,
    /// How much of the text it is about.
    pub(crate) extent: Extent,
    /// Whether it holds where a sentence begins, and nowhere else.
    #[serde(default)]
    pub(crate) first: bool,
    /// Patterns of words.
    pub(crate) phrases: Vec<String>,
    /// Texts, each read as `gives`.
    pub(crate) reads: Vec<String>,
    /// A text without the words that ask for nothing.
    pub(crate) gives: String,
    /// Texts read otherwise than `gives`.
    #[serde(default)]
    pub(crate) not: Vec<String>,
}

/// What an edit asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Edit {
    /// A longer path.
    Longer,
    /// A shorter path.
    Shorter,
    /// The path the other way round.
    Reverse,
    /// A path that does not lead past a place.
    Avoid,
    /// A path from somewhere.
    Start,
    /// A path to somewhere.
    End,
    /// Another place of the meeting.
    Move,
    /// Somebody leaves the scenario.
    Remove,
    /// Somebody walks slower.
    Slower,
    /// Somebody walks faster.
    Faster,
    /// Nobody gestures.
    NoGestures,
    /// A group is no group any more.
    Ungroup,
    /// Some of those who are there form a group.
    Group,
    /// Two people change places.
    Swap,
    /// A gesture more, or another one instead.
    Gesture,
    /// Somebody new, or what somebody does.
    Story,
}

impl Edit {
    /// Its name in `edits.toml`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Longer => "longer",
            Self::Shorter => "shorter",
            Self::Reverse => "reverse",
            Self::Avoid => "avoid",
            Self::Start => "start",
            Self::End => "end",
            Self::Move => "move",
            Self::Remove => "remove",
            Self::Slower => "slower",
            Self::Faster => "faster",
            Self::NoGestures => "no_gestures",
            Self::Ungroup => "ungroup",
            Self::Group => "group",
            Self::Swap => "swap",
            Self::Gesture => "gesture",
            Self::Story => "story",
        }
    }
}

/// A row of `edits.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EditRow {
    /// What it asks for.
    pub(crate) edit: Edit,
    /// Words of which each line has one in the edit.
    pub(crate) has: Vec<String>,
    /// Words of which it has none.
    #[serde(default)]
    pub(crate) lacks: String,
    /// Whether the first of them begins it.
    #[serde(default)]
    pub(crate) first: bool,
    /// Whether it names a place.
    #[serde(default)]
    pub(crate) place: bool,
    /// Whether nobody does anything in it.
    #[serde(default)]
    pub(crate) still: bool,
    /// Whether it names nobody new.
    #[serde(default)]
    pub(crate) known: bool,
    /// Edits that ask for it.
    pub(crate) reads: Vec<String>,
    /// Edits that do not.
    pub(crate) not: Vec<String>,
}

/// The file as written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Edits {
    pub(crate) asks: String,
    pub(crate) adds: String,
    pub(crate) everybody: String,
    pub(crate) other: String,
    #[serde(rename = "row")]
    pub(crate) rows: Vec<EditRow>,
}

/// Some words.
#[derive(Debug, Default, Deserialize)]
#[serde(from = "String")]
pub(crate) struct Set(BTreeSet<String>);

impl From<String> for Set {
    fn from(words: String) -> Self {
        Self(words.split_whitespace().map(str::to_owned).collect())
    }
}

impl Set {
    pub(crate) fn contains(&self, word: &str) -> bool {
        self.0.contains(word)
    }
}

/// The words of `errands.toml`, which says what each list is for.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Errands {
    pub(crate) from: Set,
    pub(crate) to: Set,
    pub(crate) within: Set,
    pub(crate) past: Set,
    pub(crate) along: Set,
    pub(crate) ends: Set,
    pub(crate) joins: Set,
    pub(crate) nameless: Set,
    pub(crate) rides: Set,
    pub(crate) part: Set,
    pub(crate) any: Set,
    pub(crate) denies: Set,
    pub(crate) before_denial: Set,
    pub(crate) returns: Set,
    pub(crate) comes: Set,
    pub(crate) back: Set,
    pub(crate) returns_to: Set,
    pub(crate) fetches: Set,
    pub(crate) does: Set,
    pub(crate) outside: Set,
    pub(crate) front: Set,
    pub(crate) at_door: Set,
    pub(crate) door: Set,
}
