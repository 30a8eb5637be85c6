//! Draws: every chance of an experiment is a hash of the seed and of what it is about, so that all policies meet the same ones.

use serde::{Deserialize, Serialize};
use socrates_model::job::Stage;
use socrates_model::seeds::{derive_seed, standard_normal, unit, unit_above_zero};

/// The 95 % point of the normal distribution, one-sided: what a log-normal duration is given by.
const Z_P95: f64 = 1.644_853_626_951_472_2;

/// One attempt, as every draw names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct At {
    /// Number of the scenario, from 0, in the whole experiment.
    pub scenario: u32,
    /// Stage.
    pub stage: Stage,
    /// Revision of the job, from 0.
    pub revision: u32,
    /// Attempt of the job, from 1; 0 stands for all of them together.
    pub attempt: u32,
}

impl At {
    /// What all attempts at this stage of this scenario have in common.
    #[must_use]
    pub const fn all(self) -> Self {
        Self { revision: 0, attempt: 0, ..self }
    }

    /// Bits for something of this attempt, named by a word.
    #[must_use]
    pub fn bits(self, seed: u64, what: &str) -> u64 {
        let numbers = [self.scenario, self.revision, self.attempt].map(|number| number.to_string());
        let [scenario, revision, attempt] = &numbers;
        derive_seed(seed, &["experiment", what, scenario, self.stage.name(), revision, attempt])
    }

    /// A number from 0 to below 1 for something of this attempt.
    #[must_use]
    pub fn draw(self, seed: u64, what: &str) -> f64 {
        unit(self.bits(seed, what))
    }

    /// Whether something that has this probability happens to this attempt. What happens at a rate happens at every higher one.
    #[must_use]
    pub fn happens(self, seed: u64, what: &str, rate: f64) -> bool {
        rate > 0.0 && self.draw(seed, what) < rate
    }
}

/// How long something takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Duration {
    /// Always so long, ms.
    Fixed(u64),
    /// Evenly between two times, ms.
    Uniform([u64; 2]),
    /// Log-normal, by its median and its 95th percentile, ms.
    Lognormal([u64; 2]),
}

/// No duration is longer, ms: a day.
pub const LONGEST_MS: u64 = 86_400_000;

impl Duration {
    /// The duration of this attempt, ms, at least 1.
    #[must_use]
    pub fn of(self, seed: u64, at: At) -> u64 {
        let ms = match self {
            Self::Fixed(ms) => ms,
            Self::Uniform([from, to]) => {
                let span = to.saturating_sub(from).saturating_add(1);
                from.saturating_add(at.bits(seed, "duration") % span.max(1))
            }
            Self::Lognormal([median, p95]) => {
                let normal =
                    standard_normal(unit_above_zero(at.bits(seed, "duration radius")), at.draw(seed, "duration turn"));
                let sigma = libm::log(float(p95.max(1)) / float(median.max(1))) / Z_P95;
                whole(float(median) * libm::exp(sigma * normal))
            }
        };
        ms.clamp(1, LONGEST_MS)
    }

    /// What cannot be meant.
    #[must_use]
    pub fn problem(self) -> Option<String> {
        match self {
            Self::Fixed(ms) if ms > LONGEST_MS => Some(format!("`fixed = {ms}`; allowed: at most {LONGEST_MS} ms")),
            Self::Uniform([from, to]) if from > to || to > LONGEST_MS => Some(format!(
                "`uniform = [{from}, {to}]`; allowed: from the smaller to the larger, at most {LONGEST_MS} ms"
            )),
            Self::Lognormal([median, p95]) if median == 0 || p95 < median || p95 > LONGEST_MS => Some(format!(
                "`lognormal = [{median}, {p95}]`; allowed: a median above 0 and a 95th percentile not below it, at most {LONGEST_MS} ms"
            )),
            Self::Fixed(_) | Self::Uniform(_) | Self::Lognormal(_) => None,
        }
    }
}

/// A share of a time, ms.
#[must_use]
pub(crate) fn part(ms: u64, share: f64) -> u64 {
    whole(float(ms) * share)
}

/// A count or a time as a float.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "times and counts of an experiment are far below 2^53")]
pub(crate) const fn float(count: u64) -> f64 {
    count as f64
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float casts into its nearest whole number, and what is none into 0"
)]
fn whole(value: f64) -> u64 {
    value.round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: At = At { scenario: 3, stage: Stage::Paths, revision: 0, attempt: 1 };

    #[test]
    fn draws_differ_by_everything_they_name_and_by_nothing_else() {
        let bits = |at: At, seed: u64, what: &str| at.bits(seed, what);
        let first = bits(AT, 1, "x");
        assert_eq!(first, bits(AT, 1, "x"));
        for other in [
            bits(AT, 2, "x"),
            bits(AT, 1, "y"),
            bits(At { scenario: 4, ..AT }, 1, "x"),
            bits(At { stage: Stage::Behaviors, ..AT }, 1, "x"),
            bits(At { revision: 1, ..AT }, 1, "x"),
            bits(At { attempt: 2, ..AT }, 1, "x"),
        ] {
            assert_ne!(first, other);
        }
    }

    #[test]
    fn what_happens_at_a_rate_happens_at_every_higher_one() {
        let count = |rate: f64| (0..2_000).filter(|n| At { scenario: *n, ..AT }.happens(1, "x", rate)).count();
        assert_eq!((count(0.0), count(1.0)), (0, 2_000));
        assert!((150..250).contains(&count(0.1)), "{}", count(0.1));
        for scenario in 0..2_000 {
            let at = At { scenario, ..AT };
            assert!(!at.happens(1, "x", 0.1) || at.happens(1, "x", 0.3));
        }
    }

    #[test]
    fn durations_are_as_they_are_said() {
        let drawn = |duration: Duration| -> Vec<u64> {
            let mut all: Vec<u64> = (0..4_000).map(|scenario| duration.of(1, At { scenario, ..AT })).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(drawn(Duration::Fixed(7))[..2], [7, 7]);
        let even = drawn(Duration::Uniform([100, 200]));
        assert!(even[0] == 100 && even[3_999] == 200 && (145..155).contains(&even[2_000]), "{:?}", even[2_000]);
        let long = drawn(Duration::Lognormal([4_000, 9_000]));
        assert!((3_850..4_150).contains(&long[2_000]), "{}", long[2_000]);
        assert!((8_500..9_500).contains(&long[3_800]), "{}", long[3_800]);
        for wrong in [Duration::Fixed(u64::MAX), Duration::Uniform([2, 1]), Duration::Lognormal([0, 1])] {
            assert!(wrong.problem().unwrap().contains("allowed"), "{wrong:?}");
        }
        assert_eq!(Duration::Lognormal([4_000, 9_000]).problem(), None);
    }
}
