//! Values of a request that are written as text: parsed once, where the request is read.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::BadId;
use crate::rule::RobotWhen;

/// Gives a type its text form in serde: `Display` writes it, `FromStr` reads it.
macro_rules! as_text {
    ($name:ident) => {
        impl TryFrom<String> for $name {
            type Error = BadId;
            fn try_from(text: String) -> Result<Self, BadId> {
                text.parse()
            }
        }

        impl From<$name> for String {
            fn from(value: $name) -> Self {
                value.to_string()
            }
        }
    };
}
pub(super) use as_text;

/// Most seeds of one request.
const MAX_SEEDS: u64 = 10_000;
/// Shortest and longest fixed duration of a run, s.
const LIMIT_S: std::ops::RangeInclusive<f64> = 1.0..=600.0;
/// Seconds and meters that a moment may name.
const MOMENT: std::ops::RangeInclusive<f64> = 0.0..=600.0;

/// Simulation seeds of a request: `1`, `1..20`, `1,4,9`. Never empty; as text they stay as they were written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct Seeds {
    text: String,
    list: Vec<u64>,
}

impl Seeds {
    /// What is taken, for messages.
    pub const ALLOWED: &'static str = "\"1\", \"1..20\" or \"1,4,9\"";

    /// One seed.
    #[must_use]
    pub fn one(seed: u64) -> Self {
        Self { text: seed.to_string(), list: vec![seed] }
    }

    /// The seeds in order.
    #[must_use]
    pub fn list(&self) -> &[u64] {
        &self.list
    }
}

impl fmt::Display for Seeds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for Seeds {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let bad = || BadId { what: "list or range of seeds", found: shown(text), allowed: Self::ALLOWED };
        let number = |part: &str| part.trim().parse::<u64>().map_err(|_digits| bad());
        let list = if let Some((from, to)) = text.split_once("..") {
            let (from, to) = (number(from)?, number(to.trim_start_matches('='))?);
            if from > to || to - from >= MAX_SEEDS {
                return Err(bad());
            }
            (from..=to).collect()
        } else {
            text.split(',').map(number).collect::<Result<Vec<u64>, BadId>>()?
        };
        if list.len() as u64 > MAX_SEEDS {
            return Err(bad());
        }
        Ok(Self { text: text.trim().to_owned(), list })
    }
}

as_text!(Seeds);

/// How long a run lasts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum Duration {
    /// Until everybody is done, at most 120 s.
    #[default]
    Auto,
    /// So many seconds, 1 to 600.
    Fixed(f64),
}

impl Duration {
    /// The seconds of a fixed duration.
    #[must_use]
    pub const fn fixed_s(self) -> Option<f64> {
        match self {
            Self::Auto => None,
            Self::Fixed(secs) => Some(secs),
        }
    }
}

impl fmt::Display for Duration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Fixed(secs) => write!(f, "{secs}s"),
        }
    }
}

impl FromStr for Duration {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let spelled = text.trim();
        if spelled == "auto" {
            return Ok(Self::Auto);
        }
        let secs = spelled.strip_suffix('s').unwrap_or(spelled).trim_end().parse::<f64>();
        secs.ok().filter(|secs| LIMIT_S.contains(secs)).map(Self::Fixed).ok_or_else(|| BadId {
            what: "duration",
            found: shown(text),
            allowed: "\"auto\" or seconds such as \"60s\" (1 to 600 s)",
        })
    }
}

as_text!(Duration);

/// When the robot makes a gesture by itself: `start`, `blocked 3 s`, `human within 2 m`, `after 10 s`.
///
/// `blocked` without a time means 3 s, `human` without a distance 3 m; `human near 2 m` is `human within 2 m`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum Moment {
    /// From the start.
    Start,
    /// A human has been close ahead of it for this time, s.
    Blocked(f64),
    /// A human is within this distance, m.
    HumanWithin(f64),
    /// This time after the start, s.
    After(f64),
}

impl Moment {
    /// What is taken, for messages.
    pub const ALLOWED: &'static str =
        "`start`, `blocked 3 s`, `human within 2 m` or `after 10 s`, with 0 to 600 s or m";
    /// Time of `blocked` where none is written, s.
    const BLOCKED_S: f64 = 3.0;
    /// Distance of `human` where none is written, m.
    const WITHIN_M: f64 = 3.0;

    /// The moment as the robot script has it.
    #[must_use]
    pub const fn when(self) -> RobotWhen {
        match self {
            Self::Start => RobotWhen::Start,
            Self::Blocked(secs) => RobotWhen::Blocked(secs),
            Self::HumanWithin(meters) => RobotWhen::HumanNear(meters),
            Self::After(secs) => RobotWhen::AfterSecs(secs),
        }
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start => f.write_str("start"),
            Self::Blocked(secs) => write!(f, "blocked {secs} s"),
            Self::HumanWithin(meters) => write!(f, "human within {meters} m"),
            Self::After(secs) => write!(f, "after {secs} s"),
        }
    }
}

impl FromStr for Moment {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let bad = || BadId { what: "moment", found: shown(text), allowed: Self::ALLOWED };
        let words: Vec<&str> = text.split_whitespace().collect();
        let measured = |words: &[&str], unit: char| measure(words, unit).ok_or_else(bad);
        match words.as_slice() {
            ["start"] => Ok(Self::Start),
            ["blocked"] => Ok(Self::Blocked(Self::BLOCKED_S)),
            ["blocked", time @ ..] => measured(time, 's').map(Self::Blocked),
            ["human"] | ["human", "within" | "near"] => Ok(Self::HumanWithin(Self::WITHIN_M)),
            ["human", "within" | "near", distance @ ..] | ["human", distance @ ..] => {
                measured(distance, 'm').map(Self::HumanWithin)
            }
            ["after", time @ ..] => measured(time, 's').map(Self::After),
            _ => Err(bad()),
        }
    }
}

as_text!(Moment);

/// A number with or without its unit: `3`, `3s`, `3 s`.
fn measure(words: &[&str], unit: char) -> Option<f64> {
    let digits = match words {
        [number] => number.strip_suffix(unit).unwrap_or(number),
        [number, spelled] if spelled.chars().eq([unit]) => number,
        _ => return None,
    };
    digits.parse::<f64>().ok().filter(|value| MOMENT.contains(value))
}

/// A text as messages show it.
pub(super) fn shown(text: &str) -> String {
    text.trim().chars().take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_one_a_range_or_a_list_and_stay_as_they_were_written() {
        for (text, list) in
            [("3", vec![3]), ("1..4", vec![1, 2, 3, 4]), ("1..=2", vec![1, 2]), ("9, 4,4", vec![9, 4, 4])]
        {
            let seeds: Seeds = text.parse().unwrap();
            assert_eq!((seeds.list(), seeds.to_string().as_str()), (list.as_slice(), text));
        }
        for text in ["", "9..1", "1..20001", "one", "1,,2", "-1", "1.5", &vec!["1"; 10_001].join(",")] {
            assert!(text.parse::<Seeds>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_duration_is_auto_or_seconds() {
        for (text, secs) in [("auto", None), ("60s", Some(60.0)), ("60", Some(60.0)), ("1.5 s", Some(1.5))] {
            let read: Duration = text.parse().unwrap();
            assert_eq!(read.fixed_s(), secs);
            assert_eq!(read.to_string().parse::<Duration>().unwrap(), read);
        }
        for text in ["", "0s", "601", "60ss", "s", "NaN", "an hour"] {
            assert!(text.parse::<Duration>().is_err(), "{text}");
        }
    }

    #[test]
    fn every_spelling_of_a_moment_is_read_in_one_way_and_the_rest_is_refused() {
        for (text, moment, written) in [
            ("start", Moment::Start, "start"),
            ("blocked", Moment::Blocked(3.0), "blocked 3 s"),
            ("blocked 2.5s", Moment::Blocked(2.5), "blocked 2.5 s"),
            ("human within 2 m", Moment::HumanWithin(2.0), "human within 2 m"),
            ("human near 2m", Moment::HumanWithin(2.0), "human within 2 m"),
            ("human  2", Moment::HumanWithin(2.0), "human within 2 m"),
            ("human near", Moment::HumanWithin(3.0), "human within 3 m"),
            ("after 10 s", Moment::After(10.0), "after 10 s"),
        ] {
            let read: Moment = text.parse().unwrap();
            assert_eq!((read, read.to_string().as_str()), (moment, written), "{text}");
            assert_eq!(written.parse::<Moment>().unwrap(), moment);
        }
        for text in [
            "",
            "whenever",
            "after",
            "after noon",
            "blocked 3 m",
            "human within 2 s",
            "blocked 3 s please",
            "start 3 s",
            "human within -1 m",
            "after 601 s",
            "after inf",
            "after nan s",
            "human beside 2 m",
        ] {
            let bad = text.parse::<Moment>().unwrap_err().to_string();
            assert!(bad.contains("is not a moment; allowed: `start`"), "{text}: {bad}");
        }
    }
}
