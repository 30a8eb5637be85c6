//! What an agents file says, whatever its dialect.

use std::fmt;

use socrates_model::Point;

use crate::problem::{Problem, nearest};

/// How an agents file is spelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Dialect {
    /// HuNavSim 1.0 and the SocRATES fork: `behavior` is a whole number.
    V1_0,
    /// HuNavSim 1.1: `behavior` is a section with `type` as a whole number.
    V1_1,
    /// HuNavSim 2.0: goals by number from `global_goals`, `behavior.type` as a word.
    V2_0,
}

impl Dialect {
    /// All, oldest first.
    pub const ALL: [Self; 3] = [Self::V1_0, Self::V1_1, Self::V2_0];

    /// Name in messages: `HuNavSim 1.1`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::V1_0 => "HuNavSim 1.0",
            Self::V1_1 => "HuNavSim 1.1",
            Self::V2_0 => "HuNavSim 2.0",
        }
    }
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How somebody takes the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Reaction {
    /// Walks on; the robot is one more person. Code 1.
    #[default]
    Regular,
    /// Walks on; the robot is an obstacle. Code 2.
    Impassive,
    /// Stops and looks at the robot. Code 3.
    Surprised,
    /// Keeps away from the robot. Code 4.
    Scared,
    /// Comes up to the robot. Code 5.
    Curious,
    /// Stands in the robot's way. Code 6.
    Threatening,
    /// A tree of its own, `LLMBT_<n>.xml` with n from 0 to 9. Codes 7 to 16 of the SocRATES fork.
    Custom(u8),
}

/// Words of the reactions with a fixed tree, by code from 1.
const WORDS: [(&str, Reaction); 6] = [
    ("Regular", Reaction::Regular),
    ("Impassive", Reaction::Impassive),
    ("Surprised", Reaction::Surprised),
    ("Scared", Reaction::Scared),
    ("Curious", Reaction::Curious),
    ("Threatening", Reaction::Threatening),
];

impl Reaction {
    /// The reaction of a code of HuNavSim 1.x or the fork, 1 to 16.
    #[must_use]
    pub fn from_code(code: i64) -> Option<Self> {
        match code {
            1..=6 => {
                let place = usize::try_from(code - 1).ok()?;
                WORDS.get(place).map(|(_, reaction)| *reaction)
            }
            7..=16 => u8::try_from(code - 7).ok().map(Self::Custom),
            _ => None,
        }
    }

    /// Code, 1 to 16.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Regular => 1,
            Self::Impassive => 2,
            Self::Surprised => 3,
            Self::Scared => 4,
            Self::Curious => 5,
            Self::Threatening => 6,
            Self::Custom(index) => index.saturating_add(7),
        }
    }

    /// The word of HuNavSim 2.0; a tree of its own counts as `Regular` there.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Regular | Self::Custom(_) => "Regular",
            Self::Impassive => "Impassive",
            Self::Surprised => "Surprised",
            Self::Scared => "Scared",
            Self::Curious => "Curious",
            Self::Threatening => "Threatening",
        }
    }

    /// The reaction of a word of HuNavSim 2.0.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        WORDS.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)).map(|(_, reaction)| *reaction)
    }

    /// The nearest word, for a message.
    pub(crate) fn nearest_word(word: &str) -> Option<&'static str> {
        nearest(word, WORDS.iter().map(|(name, _)| *name))
    }
}

/// Where the parameters of a reaction come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Configuration {
    /// Fixed values of the simulator. Code 0.
    #[default]
    Default,
    /// The values of the file, cut to their ranges. Code 1.
    Custom,
    /// Drawn from normal distributions. Code 2.
    RandomNormal,
    /// Drawn from uniform distributions. Code 3.
    RandomUniform,
}

impl Configuration {
    /// All, by code.
    pub const ALL: [Self; 4] = [Self::Default, Self::Custom, Self::RandomNormal, Self::RandomUniform];

    /// The configuration of a code, 0 to 3.
    #[must_use]
    pub fn from_code(code: i64) -> Option<Self> {
        Self::ALL.get(usize::try_from(code).ok()?).copied()
    }

    /// Code, 0 to 3.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Default => 0,
            Self::Custom => 1,
            Self::RandomNormal => 2,
            Self::RandomUniform => 3,
        }
    }
}

/// The behavior section of an agent, as written. Dialect 1.0 has the reaction alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BehaviorEntry {
    /// How it takes the robot. Default: regular.
    pub reaction: Reaction,
    /// Where the parameters come from. Default: fixed values.
    pub configuration: Configuration,
    /// Length of the reaction, s. Default 40.
    pub duration_s: f64,
    /// Whether the reaction happens once only. Default true.
    pub once: bool,
    /// Largest speed of the reaction, m/s; cut to 0–1.8. Default 1.0.
    pub vel_mps: f64,
    /// A distance whose meaning depends on the reaction, m. Default 0.
    pub dist_m: f64,
    /// Factor of the force to the goal; cut to 2–8 (2.0: 2–5). Default 2.
    pub goal_force_factor: f64,
    /// Factor of the force from obstacles; cut to 2–30 (2.0: 2–50). Default 10.
    pub obstacle_force_factor: f64,
    /// Factor of the force from other people; cut to 2.1–20 (2.0: 5–20). Default 5.
    pub social_force_factor: f64,
    /// Factor of the extra force from the robot on somebody scared; at least 0. Default 20.
    pub other_force_factor: f64,
}

impl Default for BehaviorEntry {
    fn default() -> Self {
        Self {
            reaction: Reaction::Regular,
            configuration: Configuration::Default,
            duration_s: 40.0,
            once: true,
            vel_mps: 1.0,
            dist_m: 0.0,
            goal_force_factor: 2.0,
            obstacle_force_factor: 10.0,
            social_force_factor: 5.0,
            other_force_factor: 20.0,
        }
    }
}

/// Where an agent starts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InitPose {
    /// x, m.
    pub x: f64,
    /// y, m.
    pub y: f64,
    /// Height of the body's middle, m; not simulated.
    pub z: f64,
    /// Heading, rad.
    pub h: f64,
}

/// A goal of an agent.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalEntry {
    /// Its name (1.x), or its number in `global_goals` (2.0).
    pub name: String,
    /// Where it is, m.
    pub at: Point,
    /// `h` of the file, rad; no simulator uses it and 2.0 does not have it.
    pub heading: f64,
}

/// One agent of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentEntry {
    /// Name of its section.
    pub name: String,
    /// Number, from 0, that trees know it by.
    pub id: i64,
    /// Look of its body, -1 to 9. Default -1 (any).
    pub skin: i64,
    /// Number of its group; -1 for none. Default -1.
    pub group_id: i64,
    /// Desired and largest speed, m/s. Default 1.0.
    pub max_vel_mps: f64,
    /// Radius of its body, m. Default 0.35.
    pub radius_m: f64,
    /// Start.
    pub start: InitPose,
    /// Within this distance of a goal it counts as reached (0.1 m more for the trees), m. Default 0.
    pub goal_radius_m: f64,
    /// Whether a goal that was reached is put behind the others. Default true.
    pub cyclic_goals: bool,
    /// Behavior.
    pub behavior: BehaviorEntry,
    /// Goals in order.
    pub goals: Vec<GoalEntry>,
}

impl AgentEntry {
    /// Where it starts.
    #[must_use]
    pub fn start_point(&self) -> Point {
        Point::new(self.start.x, self.start.y)
    }

    /// Its group, if it has one.
    #[must_use]
    pub fn group(&self) -> Option<u32> {
        u32::try_from(self.group_id).ok()
    }
}

/// An agents file.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentsFile {
    /// How it is spelled.
    pub dialect: Dialect,
    /// Name of the map or world. Default `map.yaml`.
    pub map: String,
    /// Whether the topic `people` is published. Default true.
    pub publish_people: bool,
    /// First part of the names of the agents' tree files (2.0).
    pub yaml_base_name: Option<String>,
    /// Simulator the file was made for (2.0).
    pub simulator: Option<String>,
    /// Goals by number: goal k is entry k - 1 (2.0).
    pub global_goals: Vec<Point>,
    /// Agents in list order.
    pub agents: Vec<AgentEntry>,
    /// What a reader should know although the file can be run: values that are cut, keys that are not used.
    pub warnings: Vec<Problem>,
}

impl AgentsFile {
    /// Name of the tree file of an agent: `LLMBT_3.xml` (fork), `<yaml_base_name>__agent_2_bt.xml` (2.0); `None`
    /// where the simulator's own tree of its reaction is meant.
    #[must_use]
    pub fn tree_file(&self, agent: &AgentEntry) -> Option<String> {
        match (self.dialect, agent.behavior.reaction) {
            (Dialect::V2_0, _) => self.yaml_base_name.as_ref().map(|base| format!("{base}__agent_{}_bt.xml", agent.id)),
            (Dialect::V1_0 | Dialect::V1_1, Reaction::Custom(index)) => Some(format!("LLMBT_{index}.xml")),
            (
                Dialect::V1_0 | Dialect::V1_1,
                Reaction::Regular
                | Reaction::Impassive
                | Reaction::Surprised
                | Reaction::Scared
                | Reaction::Curious
                | Reaction::Threatening,
            ) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_reactions_are_one_to_one() {
        for code in 1..=16_i64 {
            assert_eq!(i64::from(Reaction::from_code(code).unwrap().code()), code);
        }
        assert!(Reaction::from_code(0).is_none() && Reaction::from_code(17).is_none());
        for (place, configuration) in (0_i64..).zip(Configuration::ALL) {
            assert_eq!(Configuration::from_code(place), Some(configuration));
            assert_eq!(i64::from(configuration.code()), place);
        }
    }
}
