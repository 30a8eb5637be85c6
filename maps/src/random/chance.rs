//! Seeded draws of whole numbers.

use socrates_model::seeds::{SplitMix64, derive_seed};

/// The draws of one world, in the order in which they are asked for.
#[derive(Debug)]
pub(super) struct Chance(SplitMix64);

impl Chance {
    /// The draws of a kind and a seed.
    pub(super) fn new(seed: u64, kind: &str) -> Self {
        Self(SplitMix64::new(derive_seed(seed, &["world", kind])))
    }

    /// A whole number from the first to the second, both included; the first where the second is smaller.
    pub(super) fn between(&mut self, (least, most): (i32, i32)) -> i32 {
        let span = usize::try_from(most.saturating_sub(least)).unwrap_or(0);
        let drawn = self.0.below(span.saturating_add(1));
        least.saturating_add(i32::try_from(drawn).unwrap_or(0))
    }

    /// Whether something of this chance happens, percent.
    pub(super) fn happens(&mut self, percent: i32) -> bool {
        self.between((0, 99)) < percent
    }

    /// One of a list.
    pub(super) fn pick<'a, T>(&mut self, of: &'a [T]) -> Option<&'a T> {
        let place = self.0.below(of.len());
        of.get(place)
    }

    /// The place of one of a list, each as likely as its weight; nothing where no weight is above 0.
    pub(super) fn weighted(&mut self, weights: &[i32]) -> Option<usize> {
        let total: i32 = weights.iter().filter(|weight| **weight > 0).sum();
        if total <= 0 {
            return None;
        }
        let mut left = self.between((0, total - 1));
        weights.iter().position(|weight| {
            left -= (*weight).max(0);
            left < 0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_a_range_is_drawn_and_no_other() {
        let mut chance = Chance::new(1, "test");
        let drawn: std::collections::BTreeSet<i32> = (0..200).map(|_| chance.between((-1, 3))).collect();
        assert_eq!(drawn.into_iter().collect::<Vec<_>>(), [-1, 0, 1, 2, 3]);
        assert_eq!(chance.between((4, 2)), 4);
        let drawn: std::collections::BTreeSet<_> = (0..200).map(|_| chance.weighted(&[0, 2, -3, 1])).collect();
        assert_eq!(drawn.into_iter().collect::<Vec<_>>(), [Some(1), Some(3)]);
        assert_eq!((chance.weighted(&[0]), chance.pick::<i32>(&[])), (None, None));
    }
}
