//! Seeded draws.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use socrates_model::seeds;

/// A stream of draws that depends on its seed and name alone.
pub(crate) struct Draw(ChaCha8Rng);

impl Draw {
    /// The stream of this seed for this purpose.
    pub(crate) fn new(seed: u64, purpose: &str) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seeds::stream_seed(seed, purpose)))
    }

    /// 64 random bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number below `n`; 0 where `n` is 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        seeds::below(self.0.next_u64(), n)
    }

    /// One of the items.
    pub(crate) fn pick<'a, T>(&mut self, items: &'a [T]) -> Option<&'a T> {
        items.get(self.below(items.len()))
    }

    /// A value of the range, rounded to a tenth.
    pub(crate) fn tenths(&mut self, [least, most]: [f64; 2]) -> f64 {
        let (low, high) = (libm::round(least * 10.0), libm::round(most * 10.0));
        let steps = if high > low { (high - low) as usize } else { 0 };
        let drawn = u32::try_from(self.below(steps + 1)).unwrap_or(0);
        (low + f64::from(drawn)) / 10.0
    }
}
