//! Acts of people: one row for each, from which its words, its leaf and the lists of messages and questions are made.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{HumanId, NodeId};
use crate::rule::Trigger;

/// The argument of an act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// None.
    Nothing,
    /// Another person.
    Person,
    /// A place.
    Place,
    /// A speed, m/s, or the word of one.
    Pace,
    /// A distance, m.
    Meters,
}

/// The way along which somebody walks for an act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActWay {
    /// None of theirs: they stand, or go where the robot or another person leads them.
    None,
    /// Their way as it is.
    Own,
    /// Another way from then on, which they do not leave again.
    New,
}

/// What is said of an act, whoever does it.
#[derive(Debug, Clone, PartialEq)]
pub struct ActRow {
    /// Its word in a form, and its tag in JSON: `give_way`.
    pub word: &'static str,
    /// Its argument, as TOML and JSON write one; empty for an act without.
    pub argument: &'static str,
    /// What it means, for an author, where the word does not say so.
    pub meaning: &'static str,
    /// After a name: `gives way to the robot`; `{}` is the argument.
    pub does: &'static str,
    /// After `they`: `give way to the robot`.
    pub they: &'static str,
    /// Its leaf in recordings and in trees.
    pub leaf: &'static str,
    /// Number of the leaf in frames; 10 and 11 are those of recorded people.
    pub leaf_number: u16,
    /// Letters of which the name of a leaf, in whatever dialect, holds at least one.
    pub letters: &'static [&'static str],
    /// What its argument is; a leaf does not say which.
    pub takes: Takes,
    /// Whether it is done standing: as it is, or turned to the robot or to another human.
    pub stands: bool,
    /// The way along which they walk for it.
    pub way: ActWay,
    /// Whether it leads a person away from where they stand.
    pub leads_away: bool,
    /// What ends it as a step where nothing is said of that.
    pub ends: Option<Trigger>,
}

impl ActRow {
    const PLAIN: Self = Self {
        word: "",
        argument: "",
        meaning: "",
        does: "",
        they: "",
        leaf: "",
        leaf_number: 0,
        letters: &[],
        takes: Takes::Nothing,
        stands: false,
        way: ActWay::None,
        leads_away: false,
        ends: None,
    };
    const OF_SOMEBODY: Self = Self { argument: "\"human_2\"", takes: Takes::Person, ..Self::PLAIN };

    /// The number after the leaves of rules.
    pub const AFTER_RULES: u16 = 10;
    /// The first number of a leaf that only steps of a form have.
    const FIRST_OF_STEPS: u16 = Self::AFTER_RULES + 2;
    /// The number after all leaves of acts.
    #[expect(clippy::cast_possible_truncation, reason = "a few acts")]
    pub const AFTER_ALL: u16 = ACTS.len() as u16 + 3;

    /// The leaves of rules by their numbers, where 0 is none, or those that only steps of a form have.
    pub fn leaves(of_steps: bool) -> impl Iterator<Item = &'static str> {
        let mut rows: Vec<&Self> = ACTS.iter().filter(|row| row.is_of_steps() == of_steps).collect();
        rows.sort_by_key(|row| row.leaf_number);
        let none = (!of_steps).then_some("");
        none.into_iter().chain(rows.into_iter().map(|row| row.leaf))
    }

    /// Whether it is one of those that only steps of a form have.
    #[must_use]
    pub const fn is_of_steps(&self) -> bool {
        self.leaf_number >= Self::FIRST_OF_STEPS
    }
}

/// A place that somebody goes to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Destination {
    /// The place in words.
    pub place: String,
    /// Its nodes.
    pub nodes: Vec<NodeId>,
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.place)
    }
}

/// The arguments of an act, translated one by one.
pub(crate) trait Translate<P, T, N> {
    /// Of what a person becomes.
    type Person;
    /// Of what a place becomes.
    type Place;
    /// Of what a speed becomes.
    type Pace;

    fn person(&self, person: &P) -> Option<Self::Person>;
    fn place(&self, place: &T) -> Option<Self::Place>;
    fn pace(&self, pace: &N) -> Option<Self::Pace>;
    /// A distance is what it is, m.
    fn meters(&self, meters: &f64) -> Option<f64> {
        Some(*meters)
    }
}

/// What an act is done to or with, in words.
macro_rules! argument {
    () => {
        None
    };
    ($argument:ident) => {
        Some($argument.to_string())
    };
}

/// The acts: name, argument with the kind of it, row.
macro_rules! acts {
    ($($(#[$meta:meta])* $name:ident $(($argument:ty, $kind:ident))? = $row:expr;)*) => {
        /// What a human can do. Exactly one motion at a time. People, places and speeds are those of a run; a form names them in its own words.
        #[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case", deny_unknown_fields)]
        pub enum Action<P = HumanId, T = Destination, N = f64> {
            $($(#[$meta])* $name $(($argument))?,)*
        }

        /// Every act, in the order in which an author reads them.
        pub const ACTS: &[ActRow] = &[$($row),*];

        impl<P, T, N> Action<P, T, N> {
            /// What is said of it.
            #[must_use]
            pub const fn row(&self) -> &'static ActRow {
                match self {
                    $(Self::$name { .. } => const { &$row },)*
                }
            }

            /// What it is done to or with, in words: a person, a place, a number.
            fn argument(&self) -> Option<String>
            where
                P: fmt::Display,
                T: fmt::Display,
                N: fmt::Display,
            {
                match self {
                    $(Self::$name $(($kind))? => argument!($($kind)?),)*
                }
            }

            /// The same act of other people, places and speeds; nothing where one of them is not there.
            pub(crate) fn translated<R: Translate<P, T, N>>(&self, by: &R) -> Option<Action<R::Person, R::Place, R::Pace>> {
                Some(match self {
                    $(Self::$name $(($kind))? => Action::$name $((by.$kind($kind)?))?,)*
                })
            }
        }
    };
}

acts! {
    /// Walks on along the path.
    #[default]
    Navigate = ActRow {
        word: "navigate", meaning: "walks on", does: "walks on", they: "walk on",
        leaf: "RegularNav", leaf_number: 1, letters: &["regularnav", "navigate", "gotogoal", "updategoal"],
        way: ActWay::Own, ends: Some(Trigger::GoalReached), ..ActRow::PLAIN
    };
    /// Stands still.
    StandStill = ActRow {
        word: "stand_still", does: "stands still", they: "stand still",
        leaf: "StandStill", leaf_number: 9, letters: &["standstill", "stand", "stop", "wait"],
        stands: true, ..ActRow::PLAIN
    };
    /// Stops and turns to the robot.
    LookAtRobot = ActRow {
        word: "look_at_robot", meaning: "stands and turns to it",
        does: "stops and looks at the robot", they: "stop and look at the robot",
        leaf: "LookAtRobot", leaf_number: 7, letters: &["lookatrobot", "lookat", "surprised"],
        stands: true, ..ActRow::PLAIN
    };
    /// Stops and turns to another human.
    LookAt(P, person) = ActRow {
        word: "look_at", does: "stops and looks at {}", they: "stop and look at {}",
        leaf: "WatchHuman", leaf_number: 12, letters: &["watchhuman"],
        stands: true, ..ActRow::OF_SOMEBODY
    };
    /// Stops and turns their back to the robot.
    TurnAway = ActRow {
        word: "turn_away", meaning: "stands with their back to it",
        does: "stops and turns their back to the robot", they: "stop and turn their back to the robot",
        leaf: "TurnAway", leaf_number: 18, letters: &["turnaway"],
        stands: true, ..ActRow::PLAIN
    };
    /// Follows the robot at 1 to 2 m.
    FollowRobot = ActRow {
        word: "follow_robot", meaning: "at 1 to 2 m", does: "follows the robot", they: "follow the robot",
        leaf: "FollowRobot", leaf_number: 2, letters: &["followrobot", "followingrobot"],
        leads_away: true, ..ActRow::PLAIN
    };
    /// Follows another human at 1 to 2 m.
    FollowHuman(P, person) = ActRow {
        word: "follow_human", does: "follows {}", they: "follow {}",
        leaf: "FollowHuman", leaf_number: 3, letters: &["followhuman", "followagent"],
        leads_away: true, ..ActRow::OF_SOMEBODY
    };
    /// Hurries away from the robot.
    RunAway = ActRow {
        word: "run_away", does: "runs away from the robot", they: "run away from the robot",
        leaf: "RunAwayFromRobot", leaf_number: 4, letters: &["runaway", "scared", "flee"],
        leads_away: true, ..ActRow::PLAIN
    };
    /// Steps out of the robot's way and waits there.
    GiveWay = ActRow {
        word: "give_way", meaning: "steps aside", does: "gives way to the robot", they: "give way to the robot",
        leaf: "GiveWaytoRobot", leaf_number: 5, letters: &["giveway"],
        leads_away: true, ends: Some(Trigger::RobotPassed), ..ActRow::PLAIN
    };
    /// Steps out of the robot's way, and goes back to where they stood once it has passed.
    MakeRoom = ActRow {
        word: "make_room", meaning: "for those who stand: out of the robot's way, and back once it has passed",
        does: "makes room for the robot and comes back", they: "make room for the robot and come back",
        leaf: "MakeRoom", leaf_number: 16, letters: &["makeroom"],
        ends: Some(Trigger::RobotPassed), ..ActRow::PLAIN
    };
    /// Goes and stays in front of the robot.
    Block = ActRow {
        word: "block", meaning: "stays in front of it", does: "blocks the robot", they: "block the robot",
        leaf: "BlockRobot", leaf_number: 6, letters: &["blockrobot", "block"],
        leads_away: true, ..ActRow::PLAIN
    };
    /// Goes up to the robot, out of curiosity, and stops before it.
    Approach = ActRow {
        word: "approach", meaning: "comes up to it, to 1.2 m", does: "comes up to the robot", they: "come up to the robot",
        leaf: "ApproachRobot", leaf_number: 8, letters: &["approach", "curious"],
        leads_away: true, ..ActRow::PLAIN
    };
    /// Goes up to the robot as near as this, m, and keeps so near while it goes away.
    ApproachTo(f64, meters) = ActRow {
        word: "approach_to", argument: "0.8", meaning: "comes up to it as near as this, 0.7 to 2 m, and after it",
        does: "comes up to the robot, as near as {} m", they: "come up to the robot, as near as {} m",
        leaf: "ComeClose", leaf_number: 17, letters: &["comeclose"],
        takes: Takes::Meters, leads_away: true, ..ActRow::PLAIN
    };
    /// Turns and walks back along the path to where it began.
    TurnBack = ActRow {
        word: "turn_back", meaning: "walks back the way they came, from then on; for those who walk by their relation",
        does: "turns and walks back", they: "turn and walk back",
        leaf: "TurnBack", leaf_number: 13, letters: &["turnback"], way: ActWay::New,
        leads_away: true, ends: Some(Trigger::GoalReached), ..ActRow::PLAIN
    };
    /// Goes back to where they began, by the shortest way, and stays there.
    ComeBack = ActRow {
        word: "come_back", meaning: "goes back to where they began, and stays there",
        does: "goes back to where they began", they: "go back to where they began",
        leaf: "ComeBack", leaf_number: 19, letters: &["comeback"],
        way: ActWay::New, leads_away: true, ends: Some(Trigger::GoalReached), ..ActRow::PLAIN
    };
    /// Leaves the path, goes to the nearest of some nodes, and stays there.
    GoTo(T, place) = ActRow {
        word: "go_to", argument: "\"corridor\"", meaning: "leaves the way for such a place, and stays there",
        does: "goes to the {}", they: "go to the {}",
        leaf: "GoToPlace", leaf_number: 15, letters: &["gotoplace"], way: ActWay::New,
        takes: Takes::Place, leads_away: true, ends: Some(Trigger::GoalReached), ..ActRow::PLAIN
    };
    /// Walks on along the path, from then on at this speed, m/s.
    ChangePace(N, pace) = ActRow {
        word: "change_pace", argument: "\"slow\"", meaning: "walks on at this pace; for those who walk by their relation",
        does: "walks on at {} m/s", they: "walk on at {} m/s",
        leaf: "ChangePace", leaf_number: 14, letters: &["changepace"],
        takes: Takes::Pace, way: ActWay::Own, ..ActRow::PLAIN
    };
}

impl<P, T, N> Action<P, T, N> {
    /// The person whom it names.
    #[must_use]
    pub const fn names(&self) -> Option<&P> {
        if let Self::FollowHuman(id) | Self::LookAt(id) = self { Some(id) } else { None }
    }

    /// Whether it is done standing: as it is, or turned to the robot or to another human.
    #[must_use]
    pub const fn stands(&self) -> bool {
        self.row().stands
    }
}

impl Action {
    /// Largest distance beyond the asked one at which a person has come up to the robot, m.
    pub const CLOSE_M: f64 = 0.15;

    fn said(&self, form: &str) -> String {
        self.argument().map_or_else(|| form.to_owned(), |argument| form.replace("{}", &argument))
    }

    /// The action in words: `follows the robot`.
    #[must_use]
    pub fn phrase(&self) -> String {
        self.said(self.row().does)
    }

    /// What is done, after `they`: `run away from the robot`.
    #[must_use]
    pub fn they(&self) -> String {
        self.said(self.row().they)
    }

    /// Whether a leaf of this name does the action.
    ///
    /// Names are compared by their letters alone, so that the dialects of trees (`RunAwayFromRobot`, `run_away`) mean the same.
    /// A leaf whose name begins with `is` asks and does nothing. Whom a leaf follows is not in its name.
    #[must_use]
    pub fn is_leaf(&self, name: &str) -> bool {
        self.row().is_leaf(name)
    }
}

impl ActRow {
    /// Whether a leaf of this name does the act.
    #[must_use]
    pub fn is_leaf(&self, name: &str) -> bool {
        let letters: String = name.chars().filter(char::is_ascii_alphabetic).map(|c| c.to_ascii_lowercase()).collect();
        !letters.starts_with("is") && self.letters.iter().any(|word| letters.contains(word))
    }

    /// As a form writes it, in TOML: `{ look_at = "human_2" }`.
    #[must_use]
    pub fn toml(&self) -> String {
        toml(self.word, self.argument)
    }

    /// As an answer writes it, in JSON: `{"look_at": "human_2"}`.
    #[must_use]
    pub fn json(&self) -> String {
        json(self.word, self.argument)
    }
}

/// A word with its argument, if it has one, as TOML writes them.
pub(crate) fn toml(word: &str, argument: &str) -> String {
    if argument.is_empty() { format!("\"{word}\"") } else { format!("{{ {word} = {argument} }}") }
}

/// A word with its argument, if it has one, as JSON writes them.
pub(crate) fn json(word: &str, argument: &str) -> String {
    if argument.is_empty() { format!("\"{word}\"") } else { format!("{{\"{word}\":{argument}}}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_act_has_a_word_a_leaf_and_a_number_of_its_own() {
        let schema = serde_json::to_value(schemars::schema_for!(Action)).unwrap();
        let recorded: Vec<&str> =
            ActRow::leaves(false).chain(["track", "absent"]).chain(ActRow::leaves(true)).collect();
        assert_eq!(recorded.len(), usize::from(ActRow::AFTER_ALL));
        for (place, row) in ACTS.iter().enumerate() {
            assert!(schema.to_string().contains(&format!("\"{}\"", row.word)), "{}", row.word);
            assert!(row.is_leaf(row.leaf), "{}", row.leaf);
            assert_eq!(row.does.contains("{}"), !row.argument.is_empty(), "{}", row.word);
            let number = usize::from(row.leaf_number);
            assert_eq!(recorded.get(number), Some(&row.leaf), "{}", row.word);
            let others = ACTS.iter().take(place);
            let own = |other: &ActRow| {
                (other.word, other.leaf) != (row.word, row.leaf) && other.leaf_number != row.leaf_number
            };
            assert!(others.into_iter().all(own), "{}", row.word);
        }
    }

    #[test]
    fn leaf_names_of_several_dialects_mean_the_same_action() {
        assert!(Action::RunAway.is_leaf("RunAwayFromRobot"));
        assert!(Action::RunAway.is_leaf("run_away"));
        assert!(Action::GiveWay.is_leaf("GiveWaytoRobot"));
        assert!(!Action::Block.is_leaf("IsRobotBlocking"));
        assert!(!Action::Navigate.is_leaf("FollowRobot"));
    }
}
