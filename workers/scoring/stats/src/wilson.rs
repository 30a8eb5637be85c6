//! The score interval of a share.

use crate::{Interval, StatsError, float};

/// Two-sided 95 % point of the normal distribution.
pub const Z_95: f64 = 1.959_963_984_540_054;

/// Wilson score interval of a share `successes / trials` (Wilson 1927, without continuity correction):
/// `(p + z²/2n ± z √(p(1-p)/n + z²/4n²)) / (1 + z²/n)`. Stays inside 0 to 1 and is honest at 0 of n.
///
/// # Errors
/// No trial, more successes than trials, or a `z` that is not positive.
pub fn wilson(successes: usize, trials: usize, z: f64) -> Result<Interval, StatsError> {
    if trials == 0 {
        return Err(StatsError::TooFew { found: 0, needed: 1 });
    }
    if successes > trials {
        return Err(StatsError::OutOfRange {
            name: "successes",
            value: float(successes),
            allowed: "at most the number of trials",
        });
    }
    if !(z.is_finite() && z > 0.0) {
        return Err(StatsError::OutOfRange { name: "z", value: z, allowed: "above 0" });
    }
    let n = float(trials);
    let share = float(successes) / n;
    let spread = z * z / n;
    let middle = (share + spread / 2.0) / (1.0 + spread);
    let half = z / (1.0 + spread) * (share * (1.0 - share) / n + spread / (4.0 * n)).sqrt();
    Ok(Interval { estimate: share, low: (middle - half).max(0.0), high: (middle + half).min(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_eight_in_ten_is_the_published_one() {
        let found = wilson(8, 10, Z_95).unwrap();
        assert!((found.low - 0.490_162_47).abs() < 1e-6, "{found:?}");
        assert!((found.high - 0.943_317_8).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn none_of_twenty_does_not_mean_never() {
        let found = wilson(0, 20, Z_95).unwrap();
        assert!(found.low.abs() < 1e-12);
        assert!((found.high - 0.161_125).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn more_successes_than_trials_are_refused() {
        assert!(wilson(3, 2, Z_95).is_err());
        assert!(wilson(0, 0, Z_95).is_err());
    }
}
