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
    if !connected(wins) {
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

/// Strengths by Davidson: with a share of ties.
#[derive(Debug, Clone, PartialEq)]
pub struct Davidson {
    /// Log strength of each condition; the first is the reference with 0.
    pub strengths: Vec<f64>,
    /// Standard errors; that of the reference is 0.
    pub errors: Vec<f64>,
    /// Log of the prevalence of ties ν: two equal conditions tie with `ν / (2 + ν)`.
    pub ties: f64,
    /// Its standard error.
    pub ties_error: f64,
}

/// Strengths of conditions from how often each (row) was preferred to each other (column) and how often two were called equal
/// (symmetric): with strengths π, `i` wins with `π_i / s`, both tie with `ν √(π_i π_j) / s`, `s` the sum of the three (Davidson 1970).
///
/// # Errors
/// Fewer than two conditions; comparisons that join them in one direction alone, ties counting as both; no tie at all, where
/// [`bradley_terry`] is the model.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
pub fn davidson(wins: &DMatrix<f64>, ties: &DMatrix<f64>) -> Result<Davidson, NoValue> {
    let k = wins.nrows();
    if k < 2 {
        return Err(NoValue::TooFew { what: "conditions", found: k, needed: 2 });
    }
    let tied: f64 = ties.sum() / 2.0;
    if tied <= 0.0 {
        return Err(NoValue::TooFew { what: "ties", found: 0, needed: 1 });
    }
    if !connected(&(wins + ties)) || wins.sum() <= 0.0 {
        return Err(NoValue::NotConnected);
    }
    // The last variable is log ν.
    let mut at = DVector::zeros(k);
    let mut information = DMatrix::zeros(k, k);
    for _ in 0..200 {
        let mut slope = DVector::zeros(k);
        information = DMatrix::zeros(k, k);
        let strength = |i: usize| if i == 0 { 0.0 } else { at[i - 1] };
        for i in 0..k {
            for j in 0..i {
                let told = [wins[(i, j)], wins[(j, i)], ties[(i, j)]];
                let n: f64 = told.iter().sum();
                let (a, b) = (strength(i), strength(j));
                let logs = [a, b, at[k - 1] + (a + b) / 2.0];
                let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let sizes = logs.map(|log| libm::exp(log - most));
                let shares = sizes.map(|size| size / sizes.iter().sum::<f64>());
                // What each outcome's logarithm grows by with each variable.
                let mut rows = [DVector::zeros(k), DVector::zeros(k), DVector::zeros(k)];
                rows[0][i - 1] = 1.0;
                rows[2][i - 1] = 0.5;
                if j > 0 {
                    rows[1][j - 1] = 1.0;
                    rows[2][j - 1] = 0.5;
                }
                rows[2][k - 1] = 1.0;
                let mean = rows.iter().zip(shares).fold(DVector::zeros(k), |sum, (row, share)| sum + row * share);
                for ((row, share), count) in rows.iter().zip(shares).zip(told) {
                    let off = row - &mean;
                    slope += row * count - row * (share * n);
                    information += &off * off.transpose() * (share * n);
                }
            }
        }
        let step: DVector<f64> = information.clone().cholesky().ok_or(NoValue::NoMaximum)?.solve(&slope);
        at += &step * (1.0 / step.amax().max(1.0));
        if step.amax() < 1e-12 {
            break;
        }
    }
    let covariance = information.cholesky().ok_or(NoValue::NoMaximum)?.inverse();
    let error = |place: usize| libm::sqrt(covariance[(place, place)]);
    let strengths = std::iter::once(0.0).chain(at.iter().take(k - 1).copied()).collect();
    let errors = std::iter::once(0.0).chain((0..k - 1).map(error)).collect();
    Ok(Davidson { strengths, errors, ties: at[k - 1], ties_error: error(k - 1) })
}

/// Whether a chain of wins leads from the first condition to every other and back (Ford 1957).
fn connected(wins: &DMatrix<f64>) -> bool {
    let k = wins.nrows();
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
    reaches(true) && reaches(false)
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
