//! Seeded draws.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

/// A stream of draws that depends on its seed and name alone.
pub(crate) struct Draw(ChaCha8Rng);

impl Draw {
    /// The stream of this seed for this purpose.
    pub(crate) fn new(seed: u64, purpose: &str) -> Self {
        // FNV-1a: the purposes are few and ours, so any even spread will do.
        let name = purpose
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        Self(ChaCha8Rng::seed_from_u64(seed ^ name))
    }

    /// A number below `n`; 0 where `n` is 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        let wide = u64::try_from(n).unwrap_or(u64::MAX);
        let drawn = self.0.next_u64();
        if wide == 0 { 0 } else { usize::try_from(drawn % wide).unwrap_or(0) }
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
