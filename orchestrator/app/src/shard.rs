//! Shards: a batch split among machines that never speak with each other.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::exit::Diagnostic;

/// Shards of one batch, at most: as many as the largest job array that clusters commonly allow.
const MOST: u32 = 100_000;

/// One share of a batch: of its scenarios in their order every `of`th, from the one at place `index` on. What a scenario becomes
/// depends on its request and its place alone, so the number of shards changes nothing of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    index: u32,
    of: u32,
}

impl Shard {
    /// Which one, from 0.
    #[must_use]
    pub const fn index(self) -> u32 {
        self.index
    }

    /// How many there are.
    #[must_use]
    pub const fn of(self) -> u32 {
        self.of
    }

    /// The shard of this number beside this one.
    pub(crate) const fn beside(self, index: u32) -> Self {
        Self { index, of: self.of }
    }

    /// Whether the scenario at this place of the whole batch, from 0, belongs to it.
    pub(crate) fn holds(self, place: usize) -> bool {
        u32::try_from(place % self.step()).is_ok_and(|rest| rest == self.index)
    }

    /// How many of `whole` scenarios belong to it.
    pub(crate) fn share(self, whole: usize) -> usize {
        let before = usize::try_from(self.index).unwrap_or(usize::MAX);
        whole.saturating_sub(before).div_ceil(self.step())
    }

    fn step(self) -> usize {
        usize::try_from(self.of).unwrap_or(usize::MAX).max(1)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad =
            |why: &str| format!("`{text}` is no shard: {why}; for example 0/8, the first of eight, to 7/8, the last");
        let (index, of) = text.split_once('/').ok_or_else(|| bad("there is no `/`"))?;
        let number = |word: &str| word.parse::<u32>().map_err(|why| bad(&format!("`{word}`: {why}")));
        let (index, of) = (number(index)?, number(of)?);
        if of == 0 || of > MOST {
            return Err(bad(&format!("of 1 to {MOST} shards")));
        }
        if index >= of {
            return Err(bad(&format!("shards of {of} are numbered from 0 to {}", of - 1)));
        }
        Ok(Self { index, of })
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

/// What a shard cannot be asked for.
pub(crate) fn refused(option: &str, why: &str) -> Diagnostic {
    Diagnostic::input(format!("`{option}` does not go with `--shard`: {why}"), "leave one of them out")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_belongs_to_exactly_one_shard() {
        for (of, whole) in [(1, 7), (3, 10), (8, 5), (8, 64)] {
            let shards: Vec<Shard> = (0..of).map(|index| format!("{index}/{of}").parse().unwrap()).collect();
            for place in 0..whole {
                assert_eq!(shards.iter().filter(|shard| shard.holds(place)).count(), 1, "place {place} of {of} shards");
            }
            for shard in &shards {
                assert_eq!(
                    shard.share(whole),
                    (0..whole).filter(|place| shard.holds(*place)).count(),
                    "{shard} {whole}"
                );
            }
        }
    }

    #[test]
    fn what_is_no_shard_is_told_with_an_example() {
        for (text, why) in [
            ("3", "no `/`"),
            ("8/8", "from 0 to 7"),
            ("0/0", "1 to"),
            ("-1/4", "`-1`"),
            ("1/x", "`x`"),
            ("0/100001", "1 to"),
        ] {
            let told = text.parse::<Shard>().unwrap_err();
            assert!(told.contains(why) && told.contains(text) && told.contains("0/8"), "{told}");
        }
        let shard: Shard = "17/200".parse().unwrap();
        assert_eq!(serde_json::to_string(&shard).unwrap(), "\"17/200\"");
        assert_eq!(serde_json::from_str::<Shard>("\"17/200\"").unwrap(), shard);
    }
}
