//! Order statistics and moments.

use crate::{StatsError, finite, float};

/// Quantile of the values by linear interpolation between order statistics (type 7, the default of
/// R and `NumPy`): `h = (n - 1) p`. `share` is 0 to 1.
///
/// # Errors
/// No value, a value that is not finite, or a share outside 0 to 1.
pub fn quantile(values: &[f64], share: f64) -> Result<f64, StatsError> {
    finite(values, 1)?;
    if !(0.0..=1.0).contains(&share) {
        return Err(StatsError::OutOfRange { name: "share", value: share, allowed: "0 to 1" });
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    Ok(quantile_of_sorted(&sorted, share))
}

/// The same of values that are sorted already; NaN for an empty list.
pub(crate) fn quantile_of_sorted(sorted: &[f64], share: f64) -> f64 {
    let place = float(sorted.len().saturating_sub(1)) * share;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to n - 1")]
    let below = place.floor() as usize;
    let low = sorted.get(below).copied().unwrap_or(f64::NAN);
    let high = sorted.get(below + 1).copied().unwrap_or(low);
    low + (high - low) * (place - float(below))
}

/// Median: the quantile at one half.
///
/// # Errors
/// As [`quantile`].
pub fn median(values: &[f64]) -> Result<f64, StatsError> {
    quantile(values, 0.5)
}

/// Arithmetic mean.
///
/// # Errors
/// No value, or a value that is not finite.
pub fn mean(values: &[f64]) -> Result<f64, StatsError> {
    finite(values, 1)?;
    Ok(values.iter().sum::<f64>() / float(values.len()))
}

/// Standard deviation of a sample (divided by n - 1).
///
/// # Errors
/// Fewer than two values, or a value that is not finite.
pub fn sample_sd(values: &[f64]) -> Result<f64, StatsError> {
    finite(values, 2)?;
    let middle = mean(values)?;
    let squares: f64 = values.iter().map(|value| (value - middle) * (value - middle)).sum();
    Ok((squares / (float(values.len()) - 1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_type_seven() {
        let values = [7.0, 1.0, 3.0, 5.0];
        assert!((median(&values).unwrap() - 4.0).abs() < 1e-12);
        assert!((quantile(&values, 0.25).unwrap() - 2.5).abs() < 1e-12);
        assert!((quantile(&values, 0.9).unwrap() - 6.4).abs() < 1e-12);
        assert!((quantile(&[2.0], 0.3).unwrap() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_value_that_is_not_finite_is_named() {
        let found = median(&[1.0, f64::NAN]).unwrap_err();
        assert!(matches!(found, StatsError::NotFinite { index: 1, .. }));
        assert_eq!(median(&[]).unwrap_err(), StatsError::TooFew { found: 0, needed: 1 });
        assert!(quantile(&[1.0], 1.5).is_err());
    }

    #[test]
    fn the_sample_deviation_divides_by_one_less() {
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        assert!((sample_sd(&values).unwrap() - (32.0_f64 / 7.0).sqrt()).abs() < 1e-12);
        assert!((mean(&values).unwrap() - 5.0).abs() < 1e-12);
    }
}
