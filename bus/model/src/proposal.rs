//! The proposal: the scenario in detail, before anybody has a path.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::act::ActWay;
use crate::clause::{Clause, Predicate};
use crate::gesture::Gesture;
use crate::ids::{GroupId, HumanId, NodeId};
use crate::place::PlaceClass;
use crate::rule::{RobotDo, RobotRule, RobotWhen, Rule, Trigger};

/// How a human stands to the robot's way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// Comes towards the robot on the same way.
    Frontal,
    /// Comes from behind, same way; follows or overtakes.
    Behind,
    /// Walks ahead of the robot, same way.
    Ahead,
    /// Crosses the robot's way at the encounter node.
    Crossing,
    /// Stands at the encounter node (path of one node).
    Static,
    /// Comes out of the room or car that the robot passes or enters.
    Leaving,
    /// Stays inside the room or car that the robot enters (path of one node).
    Staying,
    /// Walks beside the robot.
    Abreast,
    /// Stands beside the robot's way, and never in it (path of one node, no encounter).
    Aside,
}

impl Relation {
    /// Name, as written in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Frontal => "frontal",
            Self::Behind => "behind",
            Self::Ahead => "ahead",
            Self::Crossing => "crossing",
            Self::Static => "static",
            Self::Leaving => "leaving",
            Self::Staying => "staying",
            Self::Abreast => "abreast",
            Self::Aside => "aside",
        }
    }

    /// Whether somebody stands by it, and walks only where an act of theirs leads them.
    #[must_use]
    pub const fn stands(self) -> bool {
        matches!(self, Self::Static | Self::Staying | Self::Aside)
    }
}

/// A side of the robot's way as it drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// To the left of it.
    Left,
    /// To the right of it.
    Right,
}

impl Side {
    /// Somebody who stands or walks on a side does so as far beside the middle of the robot's way, as it is planned, m.
    pub const BESIDE_M: f64 = 0.55;
    /// A bystander stands as far beside the robot's way, as it is planned, at least, m.
    pub const ASIDE_M: f64 = 1.2;

    /// Name, as written in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// 1 for the left, -1 for the right: the sign of a distance to the left of a way.
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Where somebody faces who stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Facing {
    /// To where the robot comes from.
    Robot,
    /// Away from there.
    Away,
    /// To the left of the robot's way as it drives.
    Left,
    /// To the right of it.
    Right,
    /// To where another human is at first.
    Human(HumanId),
    /// To a node of the map.
    Node(NodeId),
}

impl Facing {
    /// What is faced, in words: `the robot`, `away from the robot`.
    #[must_use]
    pub fn phrase(&self) -> String {
        match self {
            Self::Robot => "the robot".to_owned(),
            Self::Away => "away from the robot".to_owned(),
            Self::Left => "to the left of the robot's way".to_owned(),
            Self::Right => "to the right of the robot's way".to_owned(),
            Self::Human(id) => id.to_string(),
            Self::Node(id) => format!("`{id}`"),
        }
    }
}

/// A part of the robot's way for which a place is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WayPart {
    /// Where it begins.
    Start,
    /// Where it ends.
    Goal,
    /// What it leads past, between its ends.
    Via,
    /// What it keeps out of.
    Avoid,
    /// Where it began: it leads to its goal and back again.
    Back,
}

impl WayPart {
    /// Name, as written in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Goal => "goal",
            Self::Via => "via",
            Self::Avoid => "avoid",
            Self::Back => "return",
        }
    }

    /// What the way does, before the name of the place.
    #[must_use]
    pub const fn does(self) -> &'static str {
        match self {
            Self::Start => "begins at",
            Self::Goal => "ends at",
            Self::Via => "leads past",
            Self::Avoid => "keeps out of",
            Self::Back => "comes back to",
        }
    }

    /// What it does not do then.
    #[must_use]
    pub const fn does_not(self) -> &'static str {
        match self {
            Self::Start => "does not begin at",
            Self::Goal => "does not end at",
            Self::Via => "does not lead past",
            Self::Avoid => "does not keep out of",
            Self::Back => "does not come back to",
        }
    }
}

/// One human of the proposal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HumanProposal {
    /// `human_1` .. `human_n`, in order.
    pub id: HumanId,
    /// Role word: employee, visitor, nurse …
    pub role: String,
    /// What this human does, in sentences that speak of this human alone.
    pub behavior: String,
    /// How it stands to the robot's way.
    pub relation: Relation,
    /// Side of the robot's way that they come from, stand on or walk on; drawn where absent. See [`crate::Predicate::OnSide`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// Where they face at first, who stand; drawn by the relation where absent. See [`crate::Predicate::Faces`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub facing: Option<Facing>,
    /// Reactions, earlier ones win.
    #[serde(default)]
    pub rules: Vec<Rule>,
    /// Group, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<GroupId>,
    /// Desired speed, m/s, 0.2 to 1.8; drawn from N(1.2, 0.2) where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_mps: Option<f64>,
    /// Class of the place where it starts, where that matters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<PlaceClass>,
    /// Class of the place where it goes, where that matters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<PlaceClass>,
}

impl HumanProposal {
    /// How many steps its sequence has.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.rules.iter().filter_map(|rule| rule.step).max().unwrap_or(0)
    }
}

impl Proposal {
    /// Whether the robot's script has it stand for a time, or until something comes.
    #[must_use]
    pub fn robot_stands(&self) -> bool {
        self.robot.script.iter().any(|line| matches!(line.act, RobotDo::Hold(_) | RobotDo::HoldUntil(_)))
    }

    /// Whether the robot waits until this human is through: by its script, or because another has it wait by a sign, and go on by one when
    /// they are done.
    #[must_use]
    pub fn is_let_through(&self, id: HumanId) -> bool {
        let ends = |until: &RobotWhen| matches!(until, RobotWhen::Did(who, _) | RobotWhen::Done(who) if *who == id);
        if self.robot.script.iter().any(|line| matches!(&line.act, RobotDo::HoldUntil(until) if ends(until))) {
            return true;
        }
        let waits_for = |trigger: &Trigger| matches!(trigger, Trigger::Done(who) | Trigger::Did(who, _) if *who == id);
        self.humans.iter().filter(|human| human.id != id).any(|human| {
            let says = |gesture: Gesture, rule: &&Rule| rule.gesture == Some(gesture) && rule.to != Some(id.into());
            let stops = human.rules.iter().any(|rule| says(Gesture::Wait, &rule));
            stops
                && human
                    .rules
                    .iter()
                    .filter(|rule| says(Gesture::Proceed, rule))
                    .any(|rule| rule.when.iter().any(waits_for))
        })
    }

    /// Whether a human leaves their path, for good, when the robot is still some way off.
    #[must_use]
    pub fn is_leaving_path(&self, id: HumanId) -> bool {
        let leaves = |rule: &Rule| {
            let off =
                rule.when.iter().any(|trigger| trigger.distance_m().is_some() || matches!(trigger, Trigger::Did(..)));
            off && rule.act.row().way == ActWay::New
        };
        self.human(id).is_some_and(|human| human.rules.iter().any(leaves))
    }
}

/// A group of the proposal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroupProposal {
    /// The group.
    pub id: GroupId,
    /// Members, two or more.
    pub members: Vec<HumanId>,
    /// Whether they stand in a circle (true) or walk together.
    pub standing: bool,
}

/// The robot's part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotProposal {
    /// What it has to do.
    pub task: String,
    /// Class of the place where it starts, if the task says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<PlaceClass>,
    /// Class of the place where it goes, if the task says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<PlaceClass>,
    /// Script that makes the scenario happen; the `reference` planner plays it.
    #[serde(default)]
    pub script: Vec<RobotRule>,
    /// What a good robot would do, in sentences.
    pub expected_behavior: String,
}

/// A scenario in detail.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Proposal {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// A few words.
    pub title: String,
    /// What happens, where, and where everybody is, in sentences that name place types, never node ids.
    pub description: String,
    /// Card id of the pattern, or `free`.
    pub pattern: String,
    /// Place class of the encounters.
    pub place: PlaceClass,
    /// Everybody, `human_1` first.
    pub humans: Vec<HumanProposal>,
    /// Groups.
    #[serde(default)]
    pub groups: Vec<GroupProposal>,
    /// The robot's part.
    pub robot: RobotProposal,
    /// What should be seen: `setup` clauses decide the verdict, `outcome` clauses judge the robot.
    pub expected_events: Vec<Clause>,
    /// Words of the request that the author did not understand.
    #[serde(default)]
    pub not_understood: Vec<String>,
    /// Assumptions, in sentences.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The author: `offline/1`, `openai:gpt-…`, `pinned`.
    pub author: crate::Signature,
}

impl Proposal {
    /// What [`Proposal::pattern`] is where no card is played.
    pub const FREE: &'static str = "free";

    /// Id of the card that is played; `None` for a scenario of its own.
    #[must_use]
    pub fn card(&self) -> Option<&str> {
        Some(self.pattern.as_str()).filter(|pattern| *pattern != Self::FREE)
    }

    /// The nodes at which a human meets the robot elsewhere than at [`Proposal::place`]; none where they meet it there.
    #[must_use]
    pub fn own_place(&self, human: HumanId) -> Option<&[NodeId]> {
        self.expected_events.iter().find_map(|clause| {
            if let Predicate::EncounterAt { nodes, human: Some(own), .. } = &clause.predicate {
                Some(nodes.as_slice()).filter(|_| *own == human)
            } else {
                None
            }
        })
    }

    /// The human of this id.
    #[must_use]
    pub fn human(&self, id: HumanId) -> Option<&HumanProposal> {
        self.humans.iter().find(|human| human.id == id)
    }
}
