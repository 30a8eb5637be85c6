//! The one gesture table, for humans and robot alike.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::BadId;

/// A message by gesture or speech. The codes are the same for every speaker. An agent that makes no gesture has none:
/// `Option<Gesture>`, whose empty value has the code 0 and the name `NONE` in trees, frames and files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[repr(u8)]
pub enum Gesture {
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

/// Name of no gesture in files.
const NONE: &str = "NONE";

impl Gesture {
    /// Largest distance at which a gesture is noticed, m.
    pub const SEEN_M: f64 = 12.0;

    /// Every gesture in order of its code.
    pub const ALL: [Self; 5] = [Self::Wait, Self::Proceed, Self::Acknowledged, Self::ExcuseMe, Self::FollowMe];

    /// Code used in trees and frames, 1 to 5.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Code of what is said, 0 to 5; 0 is no gesture.
    #[must_use]
    pub const fn code_of(said: Option<Self>) -> u8 {
        match said {
            Some(gesture) => gesture.code(),
            None => 0,
        }
    }

    /// What is said by a code.
    ///
    /// # Errors
    /// [`BadId`] for a code over 5.
    pub fn from_code(code: u8) -> Result<Option<Self>, BadId> {
        match Self::ALL.into_iter().find(|gesture| gesture.code() == code) {
            None if code != 0 => {
                Err(BadId { what: "gesture code", found: code.to_string(), allowed: "a whole number from 0 to 5" })
            }
            found => Ok(found),
        }
    }

    /// Name as written in requests and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wait => "WAIT",
            Self::Proceed => "PROCEED",
            Self::Acknowledged => "ACKNOWLEDGED",
            Self::ExcuseMe => "EXCUSE_ME",
            Self::FollowMe => "FOLLOW_ME",
        }
    }

    /// Name of what is said; `NONE` for no gesture.
    #[must_use]
    pub const fn name_of(said: Option<Self>) -> &'static str {
        match said {
            Some(gesture) => gesture.name(),
            None => NONE,
        }
    }

    /// Every code with its name, from `0 NONE` on.
    #[must_use]
    pub fn table() -> String {
        format!("0 {NONE}, {}", Self::messages())
    }

    /// Every gesture with its code, from `1 WAIT` on.
    #[must_use]
    pub fn messages() -> String {
        Self::ALL.map(|gesture| format!("{} {gesture}", gesture.code())).join(", ")
    }

    /// What is said by a name; no gesture for `NONE`.
    ///
    /// # Errors
    /// [`BadId`] for any other name.
    pub fn read(text: &str) -> Result<Option<Self>, BadId> {
        if text.trim().eq_ignore_ascii_case(NONE) { Ok(None) } else { text.parse().map(Some) }
    }
}

/// What is said as a name, `NONE` for no gesture: for fields `#[serde(with = "gesture::or_none")]`.
pub mod or_none {
    use super::{Gesture, NONE};
    use serde::de::{Deserialize as _, Deserializer, IntoDeserializer as _};
    use serde::ser::Serializer;

    /// Writes the name.
    ///
    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(said: &Option<Gesture>, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(Gesture::name_of(*said))
    }

    /// Reads a name, or nothing at all.
    ///
    /// # Errors
    /// For a name that no gesture has.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Gesture>, D::Error> {
        let text = Option::<String>::deserialize(from)?;
        match text.as_deref() {
            None | Some(NONE) => Ok(None),
            Some(name) => Gesture::deserialize(name.into_deserializer()).map(Some),
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
            allowed: "WAIT, PROCEED, ACKNOWLEDGED, EXCUSE_ME, FOLLOW_ME",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_gesture_has_one_value_one_code_and_one_name() {
        assert_eq!((Gesture::code_of(None), Gesture::name_of(None)), (0, "NONE"));
        assert_eq!(Gesture::from_code(0).unwrap(), None);
        assert_eq!(Gesture::read("none").unwrap(), None);
        for gesture in Gesture::ALL {
            assert_eq!(Gesture::from_code(gesture.code()).unwrap(), Some(gesture));
            assert_eq!(Gesture::read(gesture.name()).unwrap(), Some(gesture));
        }
        assert!(Gesture::from_code(6).is_err() && Gesture::read("BOW").is_err() && "NONE".parse::<Gesture>().is_err());
        assert_eq!(Gesture::table(), "0 NONE, 1 WAIT, 2 PROCEED, 3 ACKNOWLEDGED, 4 EXCUSE_ME, 5 FOLLOW_ME");
    }

    #[test]
    fn a_field_is_written_as_a_name_and_a_wrong_one_names_what_there_is() {
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        struct Holder(#[serde(with = "or_none")] Option<Gesture>);
        for (said, text) in [(None, "\"NONE\""), (Some(Gesture::Wait), "\"WAIT\"")] {
            assert_eq!(serde_json::to_string(&Holder(said)).unwrap(), text);
            assert_eq!(serde_json::from_str::<Holder>(text).unwrap(), Holder(said));
        }
        assert_eq!(serde_json::from_str::<Holder>("null").unwrap(), Holder(None));
        assert!(serde_json::from_str::<Holder>("\"BOW\"").unwrap_err().to_string().contains("`WAIT`"));
    }
}
