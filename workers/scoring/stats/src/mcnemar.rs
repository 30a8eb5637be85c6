//! Two ways of doing the same things, pair by pair.

use crate::float;

/// Exact two-sided p of McNemar's test (McNemar 1947, the binomial form): of the pairs in which only one of the two
/// succeeded, `first` succeeded only the first way and `second` only the second way. 1 where there is no such pair.
#[must_use]
pub fn mcnemar(first: usize, second: usize) -> f64 {
    let (n, least) = (first + second, first.min(second));
    // Sum of the binomial probabilities up to the smaller count; each term from the one before, in logarithms, so
    // that thousands of pairs do not underflow.
    let mut term = -float(n) * std::f64::consts::LN_2;
    let mut sum = libm::exp(term);
    for k in 1..=least {
        term += libm::log(float(n - k + 1)) - libm::log(float(k));
        sum += libm::exp(term);
    }
    (2.0 * sum).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_p_of_one_against_nine_is_the_published_one() {
        // 2 (1 + 10) / 2^10.
        assert!((mcnemar(1, 9) - 22.0 / 1024.0).abs() < 1e-12);
        assert!((mcnemar(9, 1) - mcnemar(1, 9)).abs() < 1e-15);
    }

    #[test]
    fn no_difference_is_no_evidence_and_thousands_do_not_underflow() {
        assert!((mcnemar(0, 0) - 1.0).abs() < 1e-15 && (mcnemar(5, 5) - 1.0).abs() < 1e-15);
        let many = mcnemar(2_400, 2_600);
        assert!(many > 0.004 && many < 0.006, "{many}");
    }
}
