//! The reading: what was understood of a request, and what was not.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::Fault;
use crate::gesture::Gesture;
use crate::ids::{AgentId, GroupId, HumanId, NodeId};
use crate::place::PlaceClass;
use crate::proposal::{Facing, Relation, Side, WayPart};
use crate::rule::{RobotRule, Rule};
use crate::scenario::Scenario;
use crate::statement::{Statement, TextKey};

/// One thing that the text asks for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fact {
    /// Short id, unique in the reading: `f1`, `f2`, …; clauses name it as their source.
    pub id: String,
    /// The words of the request it was read from; empty for a default.
    pub quote: String,
    /// What it says.
    pub kind: FactKind,
}

/// What a fact says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FactKind {
    /// There are so many humans.
    Humans(u32),
    /// These humans form a group.
    Group {
        /// The group.
        group: GroupId,
        /// Its members.
        members: Vec<HumanId>,
    },
    /// A human reacts by a rule.
    Reacts {
        /// The human.
        human: HumanId,
        /// How.
        rule: Rule,
    },
    /// A human stands to the robot's way like this.
    Relates {
        /// The human.
        human: HumanId,
        /// How.
        relation: Relation,
    },
    /// A human comes from, stands on or walks on this side of the robot's way.
    Side {
        /// The human.
        human: HumanId,
        /// Which side.
        side: Side,
    },
    /// A human who stands faces so before they react.
    Facing {
        /// The human.
        human: HumanId,
        /// Where.
        facing: Facing,
    },
    /// A human walks at this pace.
    Pace {
        /// The human.
        human: HumanId,
        /// The speed, m/s.
        mps: f64,
    },
    /// A human goes to a place.
    Goal {
        /// The human.
        human: HumanId,
        /// The place in the words of the request.
        name: String,
        /// The nodes that the map calls so.
        nodes: Vec<NodeId>,
    },
    /// A human meets the robot at a place of their own.
    MeetsAt {
        /// The human.
        human: HumanId,
        /// The place in the words of the request.
        name: String,
        /// Its class.
        class: PlaceClass,
        /// The nodes that the map calls so.
        nodes: Vec<NodeId>,
    },
    /// A human meets the robot several times.
    MeetsTimes {
        /// The human.
        human: HumanId,
        /// How often, from 2.
        times: u32,
        /// Class of the place of the last meeting, if said.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        place: Option<PlaceClass>,
    },
    /// One is there before the other: two humans where each of them meets the robot, or a human and the robot where they
    /// meet.
    Before {
        /// The agent that is there first.
        first: AgentId,
        /// The agent that is there later.
        then: AgentId,
        /// Whether at the door of the room or car of whoever leaves it, or of the robot's goal, instead: the first of them gets through it first.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        at_door: bool,
    },
    /// A human makes a gesture.
    Gestures {
        /// The human.
        human: HumanId,
        /// Which.
        gesture: Gesture,
    },
    /// A human makes a gesture to somebody: to the robot, or to another human.
    GesturesTo {
        /// The human.
        human: HumanId,
        /// Which.
        gesture: Gesture,
        /// To whom.
        to: AgentId,
    },
    /// It happens at a place of this class.
    Place(PlaceClass),
    /// The robot has to do this.
    RobotTask(String),
    /// The robot makes a gesture.
    RobotSays(Gesture),
    /// The robot starts at a place of this class.
    RobotStart(PlaceClass),
    /// The robot ends at a place of this class.
    RobotGoal(PlaceClass),
    /// The robot's way begins or ends at, leads past or keeps out of a place by name.
    RobotAt {
        /// Which part of the way.
        part: WayPart,
        /// The place in the words of the request.
        name: String,
        /// The nodes that the map calls so.
        nodes: Vec<NodeId>,
    },
    /// The robot does this, as a line of its script.
    RobotDoes(RobotRule),
    /// The scenario follows this card.
    Pattern(String),
    /// Words of the request, as an author that reads it itself gave them; the clauses that name the fact as their source say what they mean.
    Asked {
        /// The agent that does it; none for what holds of the whole scene.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        of: Option<AgentId>,
    },
}

impl FactKind {
    /// The human of whom alone it tells.
    #[must_use]
    pub const fn human(&self) -> Option<HumanId> {
        match self {
            Self::Asked { of: Some(AgentId::Human(human)) } => Some(*human),
            Self::Reacts { human, .. }
            | Self::Relates { human, .. }
            | Self::Gestures { human, .. }
            | Self::GesturesTo { human, .. }
            | Self::MeetsTimes { human, .. }
            | Self::MeetsAt { human, .. }
            | Self::Side { human, .. }
            | Self::Facing { human, .. }
            | Self::Pace { human, .. }
            | Self::Goal { human, .. } => Some(*human),
            Self::Humans(_) | Self::Group { .. } | Self::Before { .. } | Self::Place(_) | Self::Asked { .. } => None,
            Self::RobotTask(_) | Self::RobotSays(_) | Self::RobotDoes(_) | Self::Pattern(_) => None,
            Self::RobotStart(_) | Self::RobotGoal(_) | Self::RobotAt { .. } => None,
        }
    }

    /// Whether one test says the very same, so that no other shows it.
    #[must_use]
    pub const fn has_own_test(&self) -> bool {
        matches!(self, Self::MeetsTimes { .. } | Self::MeetsAt { .. } | Self::Side { .. } | Self::Facing { .. })
            || matches!(self, Self::Pace { .. } | Self::Goal { .. } | Self::Before { .. } | Self::RobotDoes(_))
    }

    /// Whether a clause of the setup has to show it. The rest is seen by others: how many there are and how they stand to the robot's way,
    /// and what the robot is asked to do is its task or an outcome.
    #[must_use]
    pub const fn needs_clause(&self) -> bool {
        match self {
            Self::Humans(_) | Self::Relates { .. } | Self::Pattern(_) | Self::RobotTask(_) => false,
            Self::RobotStart(_) | Self::RobotGoal(_) | Self::RobotAt { .. } => false,
            Self::Asked { of } => !matches!(of, Some(AgentId::Robot)),
            Self::Group { .. } | Self::Before { .. } | Self::Place(_) | Self::RobotSays(_) | Self::RobotDoes(_) => true,
            Self::Reacts { .. } | Self::Gestures { .. } | Self::GesturesTo { .. } | Self::MeetsTimes { .. } => true,
            Self::MeetsAt { .. } | Self::Side { .. } | Self::Facing { .. } | Self::Pace { .. } => true,
            Self::Goal { .. } => true,
        }
    }
}

/// The reader of a request's texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReadBy {
    /// The reader of the offline author.
    #[default]
    #[serde(alias = "small")]
    Grammar,
    /// The author, a language model; the grammar was held against what it calls no wish.
    Author,
    /// The author, a language model, in a language that the grammar does not know: nobody held anything against it.
    AuthorAlone,
}

impl ReadBy {
    /// Whether the author reads the texts, instead of the grammar.
    #[must_use]
    pub const fn is_author(self) -> bool {
        matches!(self, Self::Author | Self::AuthorAlone)
    }

    const fn is_grammar(&self) -> bool {
        matches!(self, Self::Grammar)
    }
}

/// One human as read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReadHuman {
    /// The human.
    pub id: HumanId,
    /// Role word: person, nurse, employee …
    pub role: String,
    /// What this human does, in a few words for the reading line.
    pub summary: String,
    /// How it stands to the robot's way, if said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relation: Option<Relation>,
    /// Reactions, earlier ones first.
    #[serde(default)]
    pub rules: Vec<Rule>,
    /// Group, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<GroupId>,
}

/// What was understood of a request.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// The reader of the texts. Default the grammar.
    #[serde(default, skip_serializing_if = "ReadBy::is_grammar")]
    pub by: ReadBy,
    /// Card id of the pattern the text was recognized as, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pattern: Option<String>,
    /// Humans; empty for an unguided request.
    pub humans: Vec<ReadHuman>,
    /// Place of the encounter, if said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<PlaceClass>,
    /// The robot's task in a few words.
    pub task: String,
    /// Everything asked for, one by one.
    pub facts: Vec<Fact>,
    /// What became of every clause of the texts, in their order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub statements: Vec<Statement>,
    /// The scenario as its author states it, where the author reads the texts: what is said above follows from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    /// What the author of `scenario` said of each sentence, a line each, by the sentence's number.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub account: BTreeMap<String, Vec<String>>,
    /// Assumptions that were made, in sentences.
    pub notes: Vec<String>,
    /// Wishes that cannot be read, placed or simulated.
    pub problems: Vec<Fault>,
}

impl Reading {
    /// The wishes that are not in the run and that nobody has given up, in the words of the request: pieces of its texts that were
    /// not read or are not played, and problems of its other keys, each once.
    #[must_use]
    pub fn missing(&self) -> Vec<String> {
        let mut quotes: Vec<String> = Vec::new();
        let pieces =
            self.statements.iter().filter(|statement| statement.is_missing()).map(|statement| statement.quote.clone());
        let others = self.problems.iter().filter(|problem| !self.accounts_for(problem));
        let words = |problem: &Fault| {
            let key = problem.quotes.is_empty().then(|| problem.at.to_string());
            problem.quotes.iter().cloned().chain(key).collect::<Vec<String>>()
        };
        for quote in pieces.chain(others.flat_map(words)) {
            if !quotes.contains(&quote) {
                quotes.push(quote);
            }
        }
        quotes
    }

    /// The wishes that are not in the run and were given up, in the words of the request.
    #[must_use]
    pub fn waived(&self) -> Vec<String> {
        self.statements.iter().filter(|statement| statement.waived).map(|statement| statement.quote.clone()).collect()
    }

    /// Whether a statement tells what became of the words of a problem.
    fn accounts_for(&self, problem: &Fault) -> bool {
        let of = |statement: &&Statement| {
            let of_person = problem.at.agent.is_some() && statement.at == TextKey::RoughScenario;
            (of_person || problem.at.is_key(statement.at.name()))
                && problem
                    .quotes
                    .iter()
                    .any(|quote| statement.quote.contains(&**quote) || quote.contains(&*statement.quote))
        };
        self.statements.iter().any(|statement| of(&statement))
    }
}
