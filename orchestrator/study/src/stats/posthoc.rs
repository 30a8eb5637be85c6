//! Pairs of conditions after Friedman's test, from the same ranks.

use nalgebra::DMatrix;

use super::rank::midranks;
use super::{NoValue, dist, float};

/// What the ranks of all conditions say of two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posthoc {
    /// The later condition.
    pub first: usize,
    /// The earlier condition.
    pub against: usize,
    /// p by Conover's t test, not adjusted for the number of pairs; none where every person has the same order and nothing is left over.
    pub conover: Option<f64>,
    /// p by Nemenyi's test, which holds for all pairs together.
    pub nemenyi: f64,
}

/// Both tests of every pair, from people (rows) by conditions (columns), ties by middle ranks (Conover 1999, section 5.8; Nemenyi 1963 by
/// the range of `k` normal values).
///
/// # Errors
/// Fewer than two people or conditions.
pub fn posthoc(table: &DMatrix<f64>) -> Result<Vec<Posthoc>, NoValue> {
    let (n, k) = table.shape();
    if n < 2 || k < 2 {
        return Err(NoValue::TooFew { what: "people or conditions", found: n.min(k), needed: 2 });
    }
    let mut sums = vec![0.0; k];
    let mut squares = 0.0;
    for row in table.row_iter() {
        let (ranks, _) = midranks(&row.iter().copied().collect::<Vec<_>>());
        squares += ranks.iter().map(|rank| rank * rank).sum::<f64>();
        sums.iter_mut().zip(&ranks).for_each(|(sum, rank)| *sum += rank);
    }
    let (people, all) = (float(n), float(k));
    let df = (people - 1.0) * (all - 1.0);
    let left = squares - sums.iter().map(|sum| sum * sum).sum::<f64>() / people;
    let spread = libm::sqrt(2.0 * people * left.max(0.0) / df);
    let mut found = Vec::new();
    for (first, a) in sums.iter().enumerate() {
        for (against, b) in sums.iter().enumerate().take(first) {
            let apart = libm::fabs(a - b);
            let conover = (spread > 1e-9).then(|| 2.0 * dist::t_upper(apart / spread, df));
            let range = apart / people / libm::sqrt(all * (all + 1.0) / (12.0 * people));
            found.push(Posthoc { first, against, conover, nemenyi: range_upper(range, k) });
        }
    }
    Ok(found)
}

/// Probability that the range of `k` independent standard normal values is at least this, by Simpson's rule.
fn range_upper(range: f64, k: usize) -> f64 {
    const STEPS: u32 = 2000;
    const TAIL: f64 = 8.5;
    let k = float(k);
    let density = |z: f64| libm::exp(-z * z / 2.0) / libm::sqrt(2.0 * std::f64::consts::PI);
    let at = |z: f64| density(z) * libm::pow((dist::normal_cdf(z) - dist::normal_cdf(z - range)).max(0.0), k - 1.0);
    let (low, high) = (-TAIL, TAIL);
    let step = (high - low) / f64::from(STEPS);
    let weight = |index: u32| match index {
        0 | STEPS => 1.0,
        odd if odd % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = (0..=STEPS).map(|index| weight(index) * at(low + step * f64::from(index))).sum();
    (1.0 - k * sum * step / 3.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_of_normal_values_is_that_of_r() {
        // R 4.2.2: ptukey(2.1, 3, Inf, lower.tail = FALSE).
        assert!((range_upper(2.1, 3) - 0.298_145_821_9).abs() < 1e-8);
        assert!((range_upper(0.0, 3) - 1.0).abs() < 1e-12 && range_upper(60.0, 5) < 1e-8);
    }

    #[test]
    fn who_all_agree_leave_conover_nothing_to_compare_with() {
        let table = DMatrix::from_fn(6, 3, |_, planner| planner as f64);
        let found = posthoc(&table).unwrap();
        assert_eq!((found.len(), found[0].conover), (3, None));
        assert!(found[1].nemenyi < 0.01, "{found:?}");
        assert!(posthoc(&DMatrix::from_element(1, 3, 1.0)).is_err());
    }
}
