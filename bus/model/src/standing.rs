//! How jobs and scenarios stand.

use std::fmt;
use std::str::FromStr;

use serde::de::value::MapAccessDeserializer;
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::ids::BadId;
use crate::report::Verdict;

/// Where a job stands. Spelled in lower case in stores, notices, status lines and provenances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// Waits for other jobs.
    Blocked,
    /// Waits for a worker.
    Ready,
    /// Waits for a time.
    Delayed,
    /// A worker has it.
    Leased,
    /// A worker has it and is told to stop.
    Canceling,
    /// Ended: it has a result.
    Succeeded,
    /// Ended: it cannot get better by itself, or a job before it did not succeed.
    Failed,
    /// Ended: its budget is spent, or it kills its workers.
    Dead,
    /// Ended: a client gave it up.
    Canceled,
    /// Ended: a newer revision took its place.
    Superseded,
}

impl JobState {
    /// Whether nothing more will happen (but for a requeue).
    #[must_use]
    pub const fn is_terminal(self) -> bool {
        match self {
            Self::Blocked | Self::Ready | Self::Delayed | Self::Leased | Self::Canceling => false,
            Self::Succeeded | Self::Failed | Self::Dead | Self::Canceled | Self::Superseded => true,
        }
    }

    /// Whether a job may go from this state to the next one; the arms below are the whole table.
    #[must_use]
    pub const fn may_become(self, next: Self) -> bool {
        match self {
            Self::Blocked | Self::Delayed => !matches!(next, Self::Leased | Self::Canceling),
            Self::Ready => !matches!(next, Self::Blocked | Self::Canceling),
            Self::Leased => !matches!(next, Self::Blocked),
            Self::Canceling => matches!(next, Self::Canceled),
            // Requeue, the one way back.
            Self::Failed | Self::Dead => matches!(next, Self::Blocked | Self::Ready),
            Self::Succeeded | Self::Canceled | Self::Superseded => false,
        }
    }

    /// Name in the store, in notices and status lines.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Blocked => "blocked",
            Self::Ready => "ready",
            Self::Delayed => "delayed",
            Self::Leased => "leased",
            Self::Canceling => "canceling",
            Self::Succeeded => "succeeded",
            Self::Failed => "failed",
            Self::Dead => "dead",
            Self::Canceled => "canceled",
            Self::Superseded => "superseded",
        }
    }
}

/// How a scenario ended. Written as one word, by which it is also sorted: that of the verdict, `failed` or `canceled`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScenarioEnd {
    /// It was simulated and judged.
    Judged(Verdict),
    /// No revision came to a verdict.
    Failed,
    /// Given up by a client.
    Canceled,
}

impl ScenarioEnd {
    /// Spelled as in every file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Judged(verdict) => verdict.name(),
            Self::Failed => "failed",
            Self::Canceled => "canceled",
        }
    }

    /// The verdict, where it was judged.
    #[must_use]
    pub const fn verdict(self) -> Option<Verdict> {
        match self {
            Self::Judged(verdict) => Some(verdict),
            Self::Failed | Self::Canceled => None,
        }
    }
}

impl Ord for ScenarioEnd {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.name().cmp(other.name())
    }
}

impl PartialOrd for ScenarioEnd {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Display for ScenarioEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ScenarioEnd {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let all = Verdict::ALL.into_iter().map(Self::Judged).chain([Self::Failed, Self::Canceled]);
        all.into_iter().find(|end| end.name() == text).ok_or_else(|| BadId {
            what: "end of a scenario",
            found: text.to_owned(),
            allowed: "a verdict, failed, canceled",
        })
    }
}

impl Serialize for ScenarioEnd {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for ScenarioEnd {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(EndVisitor)
    }
}

/// Reads the word, or the object `{"judged": VERDICT}` of stores before it.
struct EndVisitor;

impl<'de> Visitor<'de> for EndVisitor {
    type Value = ScenarioEnd;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("how a scenario ended: a verdict, `failed` or `canceled`")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<ScenarioEnd, E> {
        text.parse().map_err(E::custom)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ScenarioEnd, A::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Before {
            judged: Verdict,
        }
        Before::deserialize(MapAccessDeserializer::new(map)).map(|before| ScenarioEnd::Judged(before.judged))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_is_one_word_and_that_of_older_stores_is_read() {
        let late = ScenarioEnd::Judged(Verdict::RealisedLate);
        for (end, json) in [(late, "\"realised_late\""), (ScenarioEnd::Failed, "\"failed\"")] {
            assert_eq!(serde_json::to_string(&end).unwrap(), json);
            assert_eq!(serde_json::from_str::<ScenarioEnd>(json).unwrap(), end);
        }
        assert_eq!(serde_json::from_str::<ScenarioEnd>(r#"{"judged":"realised_late"}"#).unwrap(), late);
        for bad in ["\"done\"", r#"{"judged":"done"}"#, r#"{"failed":"realised"}"#, "1"] {
            serde_json::from_str::<ScenarioEnd>(bad).unwrap_err();
        }
        assert!(ScenarioEnd::Failed < late && ScenarioEnd::Canceled < ScenarioEnd::Failed, "sorted by name");
    }
}
