//! Seeds and draws: where every number that looks like chance comes from.
//!
//! A seed is derived from another one and words that say what it is for ([`derive_seed`]); an attempt number never
//! enters, so that a job that is tried again repeats itself byte for byte. A generator of the crate that draws
//! (`rand_chacha`, or [`SplitMix64`] where a short fixed sequence is enough) turns a seed into bits, and the functions
//! here turn bits into numbers. Recordings and answers depend on every formula of this page: none may change.
//!
//! | seed | derived from | drives |
//! |---|---|---|
//! | base seed: `--seed`, 1 | given | all below |
//! | seed of a variant of a request: `--variants` | base seed + number of the chosen draw; 0, 1, 2 … where they may repeat | everything of that scenario |
//! | simulation seeds: `--seeds`, `run.seeds` | given; without them the base seed | speed and place of people (`Run::seed`) |
//! | seed of an authored job | base seed, stage, seed revision, reseeds | what the author draws, and a model's own seed |
//! | seed of a simulation or scoring job | base seed, stage, simulation seed | nothing; it tells jobs apart |
//! | a variant of an answer | job seed, `variant`, number | one of several proposals |
//! | a stream of the offline author | job seed and purpose ([`stream_seed`]) | cards, roles, durations of what is not said |
//! | an injected fault | job seed, `fault`, stage, scenario or human, attempt, kind | whether and where an answer is damaged |
//! | a case of `evaluate` | seed of the specification, `evaluate`, request, location, repeat | base seed of that scenario |
//! | a draw of `experiment` | seed of the specification, `experiment`, what is drawn, scenario, stage, revision, attempt | faults, answers and durations of a simulated attempt |
//! | a random location | its seed, `world`, kind | its floor plan |
//! | speed of a person | simulation seed, `speed`, human | N(1.2, 0.2) m/s |
//! | sway of a person | simulation seed, `sway`, human | where they stand beside their path |
//! | behavior of an agents file | seed, `behavior`, name, id | parameters of the reaction |
//! | chances of an agents file | seed, `chance`, name, id | leaves that ask chance while they run |
//! | pause before another attempt | attempt, job, `backoff` | when a job is handed out again |
//! | pause of a worker | digest of its instance, `pause`, count | when it asks or reports again |
//! | intervals of a table | fixed in `Bootstrap` | which runs are drawn again |
//! | cases of a tree's conditions | fixed | which truths are tried where there are too many |
//! | `socrates-dev fuzz` | number of the input, and the door as its stream ([`stream_seed`]) | which bytes are damaged |
//!
//! The names: a *seed revision* is the last revision in which this very stage was sent back, a *reseed* a rung of the
//! ladder on which the author is asked with other luck, a *simulation seed* the seed of a run.

use crate::hash::DigestWriter;

/// A seed for a part of a scenario: one base seed, and words that name the part.
///
/// The attempt number never enters, so that a retried job repeats itself byte for byte.
#[must_use]
pub fn derive_seed(base: u64, parts: &[&str]) -> u64 {
    let mut digest = DigestWriter::default();
    digest.write(&base.to_le_bytes());
    for part in parts {
        digest.write(&(part.len() as u64).to_le_bytes());
        digest.write(part.as_bytes());
    }
    digest.finish().seed()
}

/// A seed for one of the few streams of an author, by its purpose: the seed and the FNV-1a hash of the purpose,
/// bit by bit unlike. Purposes are few and ours, so any even spread does.
#[must_use]
pub fn stream_seed(base: u64, purpose: &str) -> u64 {
    let spread = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    base ^ purpose.bytes().fold(0xcbf2_9ce4_8422_2325, spread)
}

/// Between two neighbors of what [`unit`] may give.
const UNIT_STEP: f64 = 1.0 / 9_007_199_254_740_992.0;

/// A number from 0 to below 1, of the upper 53 bits.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "53 bits fit a double")]
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * UNIT_STEP
}

/// A number above 0 up to 1, of the upper 53 bits.
#[must_use]
pub fn unit_above_zero(bits: u64) -> f64 {
    unit(bits) + UNIT_STEP
}

/// A number of the standard normal distribution from two even ones: `sqrt(-2 ln radius) cos(2 pi turn)`, with `radius`
/// above 0 up to 1 and `turn` from 0 to 1 (Box and Muller 1958).
#[must_use]
pub fn standard_normal(radius: f64, turn: f64) -> f64 {
    libm::sqrt(-2.0 * libm::log(radius)) * libm::cos(std::f64::consts::TAU * turn)
}

/// A number below `n`, the remainder of the bits; 0 where `n` is 0.
#[must_use]
pub fn below(bits: u64, n: usize) -> usize {
    let wide = u64::try_from(n).unwrap_or(u64::MAX);
    bits.checked_rem(wide).and_then(|drawn| usize::try_from(drawn).ok()).unwrap_or(0)
}

/// SplitMix64 (Steele, Lea and Flood 2014): 64 bits of state, every seed good. For short fixed sequences and tests.
///
/// `workers/simulation/crowd` names no other room, so that others can take it alone, and has the same generator once more for
/// its published workload and its tests.
#[derive(Debug, Clone)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator with `seed` as its state.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub const fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number from 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        unit(self.next_u64())
    }

    /// The next number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        below(self.next_u64(), n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers that recordings and answers rest on; a formula that changes one changes what is published.
    #[test]
    fn derived_seeds_and_draws_are_what_they_have_always_been() {
        assert_eq!(derive_seed(1, &["speed", "human_1"]), 15_492_234_372_729_324_257);
        assert_eq!(stream_seed(1, ""), 0xcbf2_9ce4_8422_2324);
        assert_eq!(stream_seed(0, "a"), 0xaf63_dc4c_8601_ec8c);
        let mut random = SplitMix64::new(1_234_567);
        // The first numbers that the authors of the generator publish for this seed.
        assert_eq!([random.next_u64(), random.next_u64()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
        assert_eq!((unit(0), unit(u64::MAX) < 1.0), (0.0, true));
        assert_eq!((unit_above_zero(0) > 0.0, unit_above_zero(u64::MAX)), (true, 1.0));
        assert!(standard_normal(1.0, 0.25).abs() < f64::MIN_POSITIVE);
        assert!((standard_normal((-0.5_f64).exp(), 0.0) - 1.0).abs() < 1e-12);
        assert_eq!((below(17, 5), below(17, 0)), (2, 0));
    }

    #[test]
    fn parts_are_told_apart_from_each_other_and_from_the_base() {
        let all = [
            derive_seed(1, &["ab", "c"]),
            derive_seed(1, &["a", "bc"]),
            derive_seed(1, &["abc"]),
            derive_seed(2, &["abc"]),
            derive_seed(1, &[]),
        ];
        let apart: std::collections::BTreeSet<u64> = all.into_iter().collect();
        assert_eq!(apart.len(), all.len());
    }
}
