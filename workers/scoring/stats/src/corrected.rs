//! The share of a judge who errs, corrected by how often they err.

use crate::{Interval, StatsError, float};

/// Least `specificity + sensitivity - 1` at which a share can be corrected: below it a judge tells true from false little better than
/// chance, and the interval is wider than the answer.
pub const LEAST_YOUDEN: f64 = 0.3;

/// How often something was found, of how many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    /// How often.
    pub hits: usize,
    /// Of how many.
    pub of: usize,
}

impl Count {
    /// The share, 0 to 1.
    fn share(self, name: &'static str) -> Result<f64, StatsError> {
        if self.of == 0 {
            return Err(StatsError::TooFew { found: 0, needed: 1 });
        }
        if self.hits > self.of {
            return Err(StatsError::OutOfRange {
                name,
                value: float(self.hits),
                allowed: "at most the number of trials",
            });
        }
        Ok(float(self.hits) / float(self.of))
    }
}

/// A corrected share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corrected {
    /// The share that the judge said, 0 to 1.
    pub raw: f64,
    /// `(raw + q0 - 1) / (q0 + q1 - 1)` before it is clipped; it may leave 0 to 1.
    pub unclipped: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// The corrected share with its interval, both clipped to 0 to 1.
    pub share: Interval,
}

/// `specificity + sensitivity - 1` (Youden 1950): 1 for a judge who never errs, 0 for one who guesses.
///
/// # Errors
/// No trial, or more hits than trials.
pub fn youden(specificity: Count, sensitivity: Count) -> Result<f64, StatsError> {
    Ok(specificity.share("specificity")? + sensitivity.share("sensitivity")? - 1.0)
}

/// Whether a judge of this [`youden`] tells enough for a share to be corrected.
#[must_use]
pub fn can_correct(youden: f64) -> bool {
    // Shares are quotients: one of exactly 0.3 may come out a little below.
    youden >= LEAST_YOUDEN - 1e-12
}

/// The true share θ behind the share `p` that an imperfect judge says, with `q0` for their specificity and `q1` for their sensitivity,
/// both counted on other things than `said` (Rogan and Gladen 1978; interval of Lee et al. 2025, arXiv 2511.21140):
/// `θ = (p + q0 - 1) / (q0 + q1 - 1)`, with the variance
/// `[p(1-p)/n + (1-θ)² q0(1-q0)/m0 + θ² q1(1-q1)/m1] / (q0 + q1 - 1)²` and the interval `θ ± z √variance`, with θ clipped to 0 to 1
/// in both, so that a share beyond 1 keeps an interval.
///
/// # Errors
/// No trial, more hits than trials, a `z` that is not positive, or a judge of less than [`LEAST_YOUDEN`].
pub fn corrected_share(said: Count, specificity: Count, sensitivity: Count, z: f64) -> Result<Corrected, StatsError> {
    if !(z.is_finite() && z > 0.0) {
        return Err(StatsError::OutOfRange { name: "z", value: z, allowed: "above 0" });
    }
    let youden = youden(specificity, sensitivity)?;
    if !can_correct(youden) {
        return Err(StatsError::OutOfRange {
            name: "specificity + sensitivity - 1",
            value: youden,
            allowed: "from 0.3",
        });
    }
    let (p, q0, q1) = (said.share("said")?, specificity.share("specificity")?, sensitivity.share("sensitivity")?);
    let unclipped = (p + q0 - 1.0) / youden;
    let theta = unclipped.clamp(0.0, 1.0);
    let part = |share: f64, of: usize| share * (1.0 - share) / float(of);
    let variance = (part(p, said.of)
        + (1.0 - theta) * (1.0 - theta) * part(q0, specificity.of)
        + theta * theta * part(q1, sensitivity.of))
        / (youden * youden);
    let standard_error = variance.sqrt();
    let half = z * standard_error;
    let share = Interval { estimate: theta, low: (theta - half).max(0.0), high: (theta + half).min(1.0) };
    Ok(Corrected { raw: p, unclipped, standard_error, share })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Z_95;

    const fn count(hits: usize, of: usize) -> Count {
        Count { hits, of }
    }

    #[test]
    fn the_published_example_comes_out() {
        // p .90 of 200, q0 .75 of 40, q1 .95 of 80: .929 [.841, 1.0].
        let found = corrected_share(count(180, 200), count(30, 40), count(76, 80), Z_95).unwrap();
        assert!((found.raw - 0.9).abs() < 1e-12);
        assert!((found.share.estimate - 0.65 / 0.7).abs() < 1e-12, "{found:?}");
        assert!((found.share.low - 0.841).abs() < 5e-4, "{found:?}");
        assert!((found.share.high - 1.0).abs() < 1e-12, "{found:?}");
        let variance = (0.9 * 0.1 / 200.0
            + (0.05_f64 / 0.7).powi(2) * 0.75 * 0.25 / 40.0
            + (0.65_f64 / 0.7).powi(2) * 0.95 * 0.05 / 80.0)
            / 0.49;
        assert!((found.standard_error - variance.sqrt()).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_judge_who_never_errs_is_not_corrected_and_a_share_beyond_one_is_clipped() {
        let sure = corrected_share(count(30, 50), count(40, 40), count(40, 40), Z_95).unwrap();
        assert!((sure.share.estimate - 0.6).abs() < 1e-12 && (sure.unclipped - 0.6).abs() < 1e-12);
        let beyond = corrected_share(count(50, 50), count(40, 40), count(36, 40), Z_95).unwrap();
        assert!(beyond.unclipped > 1.1 && (beyond.share.estimate - 1.0).abs() < 1e-12, "{beyond:?}");
        assert!(beyond.share.low > 0.8 && beyond.share.low < 1.0, "{beyond:?}");
    }

    #[test]
    fn a_judge_who_guesses_is_refused_and_so_is_nonsense() {
        // 0.65 + 0.65 - 1 is 0.3, which is enough.
        assert!(corrected_share(count(5, 10), count(26, 40), count(26, 40), Z_95).is_ok());
        assert!(corrected_share(count(5, 10), count(26, 40), count(25, 40), Z_95).is_err());
        assert!(corrected_share(count(5, 10), count(0, 40), count(40, 40), Z_95).is_err(), "says yes to everything");
        assert!(corrected_share(count(0, 0), count(40, 40), count(40, 40), Z_95).is_err());
        assert!(corrected_share(count(1, 2), count(41, 40), count(40, 40), Z_95).is_err());
        assert!(corrected_share(count(1, 2), count(40, 40), count(40, 40), 0.0).is_err());
    }
}
