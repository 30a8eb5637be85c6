//! The seeded percentile bootstrap.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

use crate::order::quantile_of_sorted;
use crate::{Interval, StatsError, finite};

/// How to resample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bootstrap {
    /// Number of resamples, 100 to 1 000 000. Default 2000; more make the ends steadier.
    pub resamples: usize,
    /// Confidence, 0.5 to 0.999. Default 0.95.
    pub confidence: f64,
    /// Seed of the generator; the same seed is the same interval.
    pub seed: u64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self { resamples: 2000, confidence: 0.95, seed: 1 }
    }
}

impl Bootstrap {
    /// Refuses settings out of range.
    pub(crate) fn check(&self) -> Result<(), StatsError> {
        if !(100..=1_000_000).contains(&self.resamples) {
            return Err(StatsError::OutOfRange {
                name: "resamples",
                value: crate::float(self.resamples),
                allowed: "100 to 1000000",
            });
        }
        if !(0.5..=0.999).contains(&self.confidence) {
            return Err(StatsError::OutOfRange { name: "confidence", value: self.confidence, allowed: "0.5 to 0.999" });
        }
        Ok(())
    }
}

/// Median with its percentile bootstrap interval (Efron 1979).
///
/// # Errors
/// Fewer than two values, a value that is not finite, or a setting out of range.
pub fn bootstrap_median(values: &[f64], how: Bootstrap) -> Result<Interval, StatsError> {
    bootstrap(values, how, |values| {
        values.sort_by(f64::total_cmp);
        quantile_of_sorted(values, 0.5)
    })
}

/// Mean with its percentile bootstrap interval (Efron 1979): for counts, whose median hides the seldom ones.
///
/// # Errors
/// As [`bootstrap_median`].
pub fn bootstrap_mean(values: &[f64], how: Bootstrap) -> Result<Interval, StatsError> {
    bootstrap(values, how, |values| values.iter().sum::<f64>() / crate::float(values.len()))
}

/// A statistic with its interval; it may put the values in order.
fn bootstrap(values: &[f64], how: Bootstrap, statistic: impl Fn(&mut [f64]) -> f64) -> Result<Interval, StatsError> {
    finite(values, 2)?;
    how.check()?;
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut random = ChaCha8Rng::seed_from_u64(how.seed);
    let mut found = Vec::with_capacity(how.resamples);
    let mut sample = Vec::with_capacity(sorted.len());
    for _ in 0..how.resamples {
        sample.clear();
        sample.extend((0..sorted.len()).filter_map(|_| sorted.get(below(&mut random, sorted.len())).copied()));
        found.push(statistic(&mut sample));
    }
    found.sort_by(f64::total_cmp);
    let tail = (1.0 - how.confidence) / 2.0;
    Ok(Interval {
        estimate: statistic(&mut sorted),
        low: quantile_of_sorted(&found, tail),
        high: quantile_of_sorted(&found, 1.0 - tail),
    })
}

/// A number below `n` by the high half of a product: unbiased enough for n far below 2^32.
pub(crate) fn below(random: &mut ChaCha8Rng, n: usize) -> usize {
    let product = u128::from(random.next_u64()) * n as u128;
    usize::try_from(product >> 64).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_is_the_same_interval() {
        let values: Vec<f64> = (0..40).map(|k| f64::from(k * 7 % 40)).collect();
        let first = bootstrap_median(&values, Bootstrap::default()).unwrap();
        assert_eq!(first, bootstrap_median(&values, Bootstrap::default()).unwrap());
    }

    #[test]
    fn the_interval_holds_the_median_and_matches_theory() {
        // Ranks 0..=100: the exact binomial 95 % interval of the median is the order statistics 41 and 61.
        let values: Vec<f64> = (0..=100).map(f64::from).collect();
        let found = bootstrap_median(&values, Bootstrap { resamples: 5000, ..Bootstrap::default() }).unwrap();
        assert!((found.estimate - 50.0).abs() < 1e-12);
        assert!((found.low - 40.0).abs() <= 2.0 && (found.high - 60.0).abs() <= 2.0, "{found:?}");
    }

    #[test]
    fn the_interval_of_a_mean_matches_theory() {
        // 0..=100: standard error sqrt(850 / 101) = 2.90, so about 50 ± 5.69.
        let values: Vec<f64> = (0..=100).map(f64::from).collect();
        let found = bootstrap_mean(&values, Bootstrap { resamples: 5000, ..Bootstrap::default() }).unwrap();
        assert!((found.estimate - 50.0).abs() < 1e-12);
        assert!((found.low - 44.31).abs() <= 0.6 && (found.high - 55.69).abs() <= 0.6, "{found:?}");
    }

    #[test]
    fn equal_values_have_an_interval_of_no_width() {
        let found = bootstrap_median(&[3.0; 9], Bootstrap::default()).unwrap();
        assert_eq!((found.low, found.high), (3.0, 3.0));
        assert!(bootstrap_median(&[1.0], Bootstrap::default()).is_err());
    }
}
