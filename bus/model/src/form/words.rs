//! Words of a form with several forms: places, where somebody faces, paces.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::place::PlaceClass;
use crate::proposal::Side;

/// A place as a form writes it: a class, or a place of this map in its own words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "String", into = "String")]
#[schemars(with = "String")]
pub enum PlaceWord {
    /// Any place of the class.
    Class(PlaceClass),
    /// `packing area`, `ward 2`.
    Name(String),
}

impl From<String> for PlaceWord {
    fn from(text: String) -> Self {
        text.parse().map_or(Self::Name(text), Self::Class)
    }
}

impl From<PlaceWord> for String {
    fn from(place: PlaceWord) -> Self {
        place.to_string()
    }
}

impl fmt::Display for PlaceWord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Class(class) => f.write_str(class.name()),
            Self::Name(name) => f.write_str(name),
        }
    }
}

/// Where somebody faces, as a form writes it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "String", into = "String")]
#[schemars(with = "String")]
pub enum FacingWord {
    /// To where the robot comes from.
    Robot,
    /// Away from there.
    Away,
    /// To the left or right of the robot's way as it drives.
    To(Side),
    /// To somebody of the form, or to a place of this map in its own words.
    Name(String),
}

impl From<String> for FacingWord {
    fn from(text: String) -> Self {
        match text.as_str() {
            "robot" => Self::Robot,
            "away" => Self::Away,
            "left" => Self::To(Side::Left),
            "right" => Self::To(Side::Right),
            _ => Self::Name(text),
        }
    }
}

impl From<FacingWord> for String {
    fn from(facing: FacingWord) -> Self {
        facing.to_string()
    }
}

impl fmt::Display for FacingWord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Robot => f.write_str("robot"),
            Self::Away => f.write_str("away"),
            Self::To(side) => f.write_str(side.name()),
            Self::Name(name) => f.write_str(name),
        }
    }
}

/// How fast somebody walks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Pace {
    /// By a word.
    Word(PaceWord),
    /// Desired speed, m/s, 0.2 to 1.8.
    Mps(f64),
}

/// A pace by its word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PaceWord {
    /// 0.6 m/s.
    Slow,
    /// As people walk: drawn by the seed.
    Normal,
    /// 1.5 m/s.
    Brisk,
}

impl Pace {
    /// What a number may be, m/s.
    pub(crate) const MPS: [f64; 2] = [0.2, 1.8];
    /// What a number may be, and the words.
    pub const ALLOWED: &str = "\"slow\", \"normal\", \"brisk\", or 0.2 to 1.8 (m/s)";

    /// Desired speed, m/s; nothing where it is drawn.
    #[must_use]
    pub const fn mps(self) -> Option<f64> {
        match self {
            Self::Word(PaceWord::Slow) => Some(0.6),
            Self::Word(PaceWord::Normal) => None,
            Self::Word(PaceWord::Brisk) => Some(1.5),
            Self::Mps(mps) => Some(mps),
        }
    }
}
