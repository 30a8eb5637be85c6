//! Rank agreement.

use crate::{StatsError, finite, float};

/// Kendall's tau-b of two lists of scores of the same things: 1 same order, -1 opposite order.
///
/// Used to see whether the ranking of planners by one metric, seed set or scenario set is that by another.
///
/// # Errors
/// Fewer than two values, different lengths, a value that is not finite, or a list of equal values.
pub fn kendall_tau(first: &[f64], second: &[f64]) -> Result<f64, StatsError> {
    finite(first, 2)?;
    finite(second, 2)?;
    if first.len() != second.len() {
        return Err(StatsError::Unequal { left: first.len(), right: second.len() });
    }
    let (mut score, mut untied_first, mut untied_second) = (0_i64, 0_usize, 0_usize);
    let pairs: Vec<(f64, f64)> = first.iter().copied().zip(second.iter().copied()).collect();
    for (index, (a1, b1)) in pairs.iter().enumerate() {
        for (a2, b2) in pairs.iter().skip(index + 1) {
            let (a, b) = (a1.total_cmp(a2) as i64, b1.total_cmp(b2) as i64);
            score += a * b;
            untied_first += usize::from(a != 0);
            untied_second += usize::from(b != 0);
        }
    }
    if untied_first == 0 || untied_second == 0 {
        return Err(StatsError::TooFew { found: 1, needed: 2 });
    }
    #[expect(clippy::cast_precision_loss, reason = "pairs of planners are far below 2^53")]
    let score = score as f64;
    Ok(score / (float(untied_first).sqrt() * float(untied_second).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tau_of_a_small_ranking_is_as_counted_by_hand() {
        // Five pairs agree and one of six does not: (5 - 1) / 6.
        let tau = kendall_tau(&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 4.0, 3.0]).unwrap();
        assert!((tau - 4.0 / 6.0).abs() < 1e-12);
        assert!((kendall_tau(&[1.0, 2.0], &[9.0, 3.0]).unwrap() + 1.0).abs() < 1e-12);
        assert!(kendall_tau(&[1.0, 1.0], &[1.0, 2.0]).is_err());
    }
}
