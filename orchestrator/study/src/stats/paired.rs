//! Paired comparison, equivalence, and dominance.

use nalgebra::{DMatrix, DVector};

use super::{NoValue, dist, float};

/// Strengths by Bradley and Terry.
#[derive(Debug, Clone, PartialEq)]
pub struct BradleyTerry {
    /// Log strength of each condition; the first is the reference with 0.
    pub strengths: Vec<f64>,
    /// Standard errors; that of the reference is 0.
    pub errors: Vec<f64>,
}

/// Strengths of conditions from how often each (row) was preferred to each other (column), ties left out (Bradley and Terry 1952).
///
/// # Errors
/// Fewer than two conditions, or wins that join them in one direction alone.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
pub fn bradley_terry(wins: &DMatrix<f64>) -> Result<BradleyTerry, NoValue> {
    let k = wins.nrows();
    if k < 2 {
        return Err(NoValue::TooFew { what: "conditions", found: k, needed: 2 });
    }
    let reaches = |forward: bool| {
        let mut seen = vec![0_usize];
        let mut at = 0;
        while let Some(from) = seen.get(at).copied() {
            let won = |to: usize| if forward { wins[(from, to)] } else { wins[(to, from)] };
            let more: Vec<usize> = (0..k).filter(|to| won(*to) > 0.0 && !seen.contains(to)).collect();
            seen.extend(more);
            at += 1;
        }
        seen.len() == k
    };
    if !(reaches(true) && reaches(false)) {
        return Err(NoValue::NotConnected);
    }
    let mut at = DVector::zeros(k - 1);
    let mut information = DMatrix::zeros(k - 1, k - 1);
    for _ in 0..100 {
        let strength = |i: usize| if i == 0 { 0.0 } else { at[i - 1] };
        let mut slope = DVector::zeros(k - 1);
        information = DMatrix::zeros(k - 1, k - 1);
        for i in 0..k {
            for j in 0..i {
                let n = wins[(i, j)] + wins[(j, i)];
                let p = 1.0 / (1.0 + libm::exp(strength(j) - strength(i)));
                let (gain, weight) = (wins[(i, j)] - n * p, n * p * (1.0 - p));
                slope[i - 1] += gain;
                information[(i - 1, i - 1)] += weight;
                if j > 0 {
                    slope[j - 1] -= gain;
                    information[(j - 1, j - 1)] += weight;
                    information[(i - 1, j - 1)] -= weight;
                    information[(j - 1, i - 1)] -= weight;
                }
            }
        }
        let step: DVector<f64> = information.clone().cholesky().ok_or(NoValue::NoMaximum)?.solve(&slope);
        at += &step * (2.0 / step.amax().max(2.0));
        if step.amax() < 1e-12 {
            break;
        }
    }
    let covariance = information.cholesky().ok_or(NoValue::NoMaximum)?.inverse();
    let strengths = std::iter::once(0.0).chain(at.iter().copied()).collect();
    let errors = std::iter::once(0.0).chain(covariance.diagonal().iter().map(|v| libm::sqrt(*v))).collect();
    Ok(BradleyTerry { strengths, errors })
}

/// Two one-sided tests of equivalence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equivalence {
    /// Mean difference, points.
    pub mean: f64,
    /// Its interval of confidence `1 − 2 alpha`.
    pub interval: (f64, f64),
    /// The larger p of both tests: below alpha the difference is within the margin.
    pub p: f64,
}

/// Two one-sided t tests of paired differences against `± margin` (Schuirmann 1987).
///
/// # Errors
/// Fewer than three differences, or differences that are all alike.
pub fn equivalence(differences: &[f64], margin: f64, alpha: f64) -> Result<Equivalence, NoValue> {
    let count = differences.len();
    if count < 3 {
        return Err(NoValue::TooFew { what: "differences", found: count, needed: 3 });
    }
    let n = float(count);
    let mean = differences.iter().sum::<f64>() / n;
    let variance = differences.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>() / (n - 1.0);
    if variance < 1e-20 {
        return Err(NoValue::Constant);
    }
    let error = libm::sqrt(variance / n);
    let above = dist::t_upper((mean + margin) / error, n - 1.0);
    let below = dist::t_upper((margin - mean) / error, n - 1.0);
    let half = dist::t_quantile(1.0 - alpha, n - 1.0) * error;
    Ok(Equivalence { mean, interval: (mean - half, mean + half), p: above.max(below) })
}

/// Cliff's delta: how much more often a value of the first list is larger than one of the second than smaller, −1 to 1.
///
/// # Errors
/// An empty list.
pub fn cliffs_delta(first: &[f64], second: &[f64]) -> Result<f64, NoValue> {
    if first.is_empty() || second.is_empty() {
        return Err(NoValue::TooFew { what: "values", found: 0, needed: 1 });
    }
    let sign = |a: f64, b: f64| f64::from(i8::from(a > b) - i8::from(a < b));
    let sum: f64 = first.iter().map(|a| second.iter().map(|b| sign(*a, *b)).sum::<f64>()).sum();
    Ok(sum / float(first.len() * second.len()))
}
