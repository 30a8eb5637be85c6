//! Names of things. Each is a newtype that cannot hold an impossible value.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A name that could not be an id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{found}` is not a {what}; allowed: {allowed}")]
pub struct BadId {
    /// Kind of id that was expected.
    pub what: &'static str,
    /// Text that was found.
    pub found: String,
    /// What would have been taken.
    pub allowed: &'static str,
}

/// A pedestrian, `human_1` .. `human_n`, numbered from 1 in the order of the proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct HumanId(u32);

impl HumanId {
    /// The human with this number; the smallest is 1 (0 is taken as 1).
    #[must_use]
    pub const fn new(number: u32) -> Self {
        Self(if number == 0 { 1 } else { number })
    }

    /// Number of the human, from 1.
    #[must_use]
    pub const fn number(self) -> u32 {
        self.0
    }
}

impl fmt::Display for HumanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "human_{}", self.0)
    }
}

impl FromStr for HumanId {
    type Err = BadId;

    fn from_str(text: &str) -> Result<Self, BadId> {
        // `human1` and `Human 1` are the spellings of other tools; they are read, never written.
        let squeezed: String = text.chars().filter(|c| !matches!(c, ' ' | '_')).flat_map(char::to_lowercase).collect();
        squeezed
            .strip_prefix("human")
            .and_then(|digits| digits.parse::<u32>().ok())
            .filter(|number| *number > 0)
            .map(Self)
            .ok_or_else(|| BadId { what: "human id", found: text.to_owned(), allowed: "human_1, human_2, …" })
    }
}

impl TryFrom<String> for HumanId {
    type Error = BadId;
    fn try_from(text: String) -> Result<Self, BadId> {
        text.parse()
    }
}

impl From<HumanId> for String {
    fn from(id: HumanId) -> Self {
        id.to_string()
    }
}

/// Anybody who moves: the robot or a human. The robot sorts first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum AgentId {
    /// The robot under test.
    Robot,
    /// A pedestrian.
    Human(HumanId),
}

impl AgentId {
    /// Number used in frames: the robot is 0, `human_k` is k.
    #[must_use]
    pub const fn number(self) -> u32 {
        match self {
            Self::Robot => 0,
            Self::Human(id) => id.number(),
        }
    }

    /// The agent with this frame number.
    #[must_use]
    pub const fn from_number(number: u32) -> Self {
        if number == 0 { Self::Robot } else { Self::Human(HumanId(number)) }
    }
}

impl From<HumanId> for AgentId {
    fn from(id: HumanId) -> Self {
        Self::Human(id)
    }
}

impl fmt::Display for AgentId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Robot => f.write_str("robot"),
            Self::Human(id) => id.fmt(f),
        }
    }
}

impl FromStr for AgentId {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        if text.trim().eq_ignore_ascii_case("robot") { Ok(Self::Robot) } else { text.parse().map(Self::Human) }
    }
}

impl TryFrom<String> for AgentId {
    type Error = BadId;
    fn try_from(text: String) -> Result<Self, BadId> {
        text.parse()
    }
}

impl From<AgentId> for String {
    fn from(id: AgentId) -> Self {
        id.to_string()
    }
}

/// What every name written as text has: printing, reading by its `new`, and the way to and from a `String`.
macro_rules! text_traits {
    ($name:ident) => {
        impl $name {
            /// The name as text.
            #[must_use]
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }

        impl FromStr for $name {
            type Err = BadId;
            fn from_str(text: &str) -> Result<Self, BadId> {
                Self::new(text)
            }
        }

        impl TryFrom<String> for $name {
            type Error = BadId;
            fn try_from(text: String) -> Result<Self, BadId> {
                Self::new(text)
            }
        }

        impl From<$name> for String {
            fn from(id: $name) -> Self {
                id.0
            }
        }
    };
}
pub(crate) use text_traits;

macro_rules! text_id {
    ($(#[$doc:meta])* $name:ident, $what:literal, $max:literal, $allowed:literal, $ok:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
        #[serde(try_from = "String", into = "String")]
        #[schemars(with = "String")]
        pub struct $name(String);

        impl $name {
            /// Reads the id.
            ///
            /// # Errors
            /// [`BadId`] when the text is empty, too long or holds a character that is not allowed.
            pub fn new(text: impl Into<String>) -> Result<Self, BadId> {
                let text = text.into();
                let fits: fn(char) -> bool = $ok;
                if !text.is_empty() && text.chars().count() <= $max && text.chars().all(fits) {
                    Ok(Self(text))
                } else {
                    Err(BadId { what: $what, found: text.chars().take(80).collect(), allowed: $allowed })
                }
            }
        }

        text_traits!($name);
    };
}

text_id!(
    /// A node of the scene graph, spelled as the map spells it.
    NodeId, "node id", 64, "1 to 64 printable characters without blanks, quotes or backticks",
    |c| !c.is_control() && !c.is_whitespace() && !matches!(c, '"' | '`')
);
text_id!(
    /// A scenario of a batch; also the name of its bundle folder.
    ScenarioId, "scenario id", 96, "1 to 96 of a-z A-Z 0-9 . _ -",
    |c| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-')
);
text_id!(
    /// One simulated run: scenario, planner and seed in one word that is also a bus key chunk.
    RunId, "run id", 160, "1 to 160 of a-z A-Z 0-9 . _ -",
    |c| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-')
);

impl RunId {
    /// The name of a run of a scenario; the longest one fits.
    pub(crate) fn of(scenario: &ScenarioId, run: &crate::run::Run) -> Self {
        Self(format!("{scenario}.{run}"))
    }
}

/// A group of humans who stand or walk together; from 1, unique in a proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
pub struct GroupId(pub u32);

impl fmt::Display for GroupId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "group_{}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_human_is_read_in_three_spellings_and_written_in_one() {
        for text in ["human_2", "human2", "Human 2"] {
            assert_eq!(text.parse::<HumanId>().unwrap().to_string(), "human_2");
        }
        assert!("human_0".parse::<HumanId>().is_err());
        assert!("person_1".parse::<HumanId>().is_err());
    }

    #[test]
    fn frame_numbers_and_agents_are_one_to_one() {
        for number in 0..5 {
            assert_eq!(AgentId::from_number(number).number(), number);
        }
    }
}
