//! The one gesture table, for humans and robot alike.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::BadId;

/// A message by gesture or speech. The codes are the same for every speaker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[repr(u8)]
pub enum Gesture {
    /// Says nothing.
    #[default]
    None = 0,
    /// Please wait.
    Wait = 1,
    /// Please go ahead.
    Proceed = 2,
    /// Understood.
    Acknowledged = 3,
    /// Please let me pass.
    ExcuseMe = 4,
    /// Please follow me.
    FollowMe = 5,
}

impl Gesture {
    /// Every gesture in order of its code.
    pub const ALL: [Self; 6] =
        [Self::None, Self::Wait, Self::Proceed, Self::Acknowledged, Self::ExcuseMe, Self::FollowMe];

    /// Code used in trees and frames, 0 to 5.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The gesture of a code.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// Name as written in requests and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "NONE",
            Self::Wait => "WAIT",
            Self::Proceed => "PROCEED",
            Self::Acknowledged => "ACKNOWLEDGED",
            Self::ExcuseMe => "EXCUSE_ME",
            Self::FollowMe => "FOLLOW_ME",
        }
    }
}

impl fmt::Display for Gesture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Gesture {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let spelled: String =
            text.trim().chars().map(|c| if c == ' ' || c == '-' { '_' } else { c.to_ascii_uppercase() }).collect();
        Self::ALL.into_iter().find(|gesture| gesture.name() == spelled).ok_or_else(|| BadId {
            what: "gesture",
            found: text.chars().take(40).collect(),
            allowed: "NONE, WAIT, PROCEED, ACKNOWLEDGED, EXCUSE_ME, FOLLOW_ME",
        })
    }
}
