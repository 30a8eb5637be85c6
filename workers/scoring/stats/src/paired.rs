//! The difference between two shares of the same things.

use crate::{Interval, StatsError, float};

/// Difference `(second - first) / pairs` of two ways of doing the same things, of which `first` succeeded only the first way and
/// `second` only the second way, with the adjusted Wald interval of Bonett and Price (2012): one pair of each kind is added, and
/// with `a` and `b` for the shares `(count + 1) / (n + 2)` the ends are `b - a ± z √((a + b - (b - a)²) / (n + 2))`.
///
/// # Errors
/// No pair, more different pairs than pairs, or a `z` that is not positive.
pub fn paired_difference(pairs: usize, first: usize, second: usize, z: f64) -> Result<Interval, StatsError> {
    if pairs == 0 {
        return Err(StatsError::TooFew { found: 0, needed: 1 });
    }
    if first.saturating_add(second) > pairs {
        let value = float(first.saturating_add(second));
        return Err(StatsError::OutOfRange { name: "different pairs", value, allowed: "at most the number of pairs" });
    }
    if !(z.is_finite() && z > 0.0) {
        return Err(StatsError::OutOfRange { name: "z", value: z, allowed: "above 0" });
    }
    let n = float(pairs) + 2.0;
    let (a, b) = ((float(first) + 1.0) / n, (float(second) + 1.0) / n);
    let half = z * ((a + b - (b - a) * (b - a)) / n).max(0.0).sqrt();
    let estimate = (float(second) - float(first)) / float(pairs);
    Ok(Interval { estimate, low: (b - a - half).max(-1.0), high: (b - a + half).min(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Z_95;

    #[test]
    fn the_interval_is_that_of_the_formula_and_holds_the_estimate() {
        // n = 50, only first 4, only second 14: a = 5/52, b = 15/52.
        let found = paired_difference(50, 4, 14, Z_95).unwrap();
        assert!((found.estimate - 0.2).abs() < 1e-12);
        let (a, b): (f64, f64) = (5.0 / 52.0, 15.0 / 52.0);
        let half = Z_95 * ((a + b - (b - a).powi(2)) / 52.0).sqrt();
        assert!((found.low - (b - a - half)).abs() < 1e-12 && (found.high - (b - a + half)).abs() < 1e-12, "{found:?}");
        assert!(found.low < found.estimate && found.estimate < found.high);
    }

    #[test]
    fn no_difference_has_an_interval_around_zero_and_nonsense_is_refused() {
        let found = paired_difference(1_000, 0, 0, Z_95).unwrap();
        assert!(found.estimate.abs() < 1e-12 && found.low < 0.0 && found.high > 0.0 && found.high < 0.01, "{found:?}");
        assert!(paired_difference(0, 0, 0, Z_95).is_err() && paired_difference(3, 2, 2, Z_95).is_err());
    }
}
