//! Wilcoxon's signed-rank test of two conditions that everybody judged.

use super::rank::midranks;
use super::{NoValue, dist, float};

/// Largest number of differences for which the exact distribution is used, where there are no ties and no zeros.
const EXACT_UP_TO: usize = 25;

/// What becomes of people who make no difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Zeros {
    /// They are dropped before ranking (Wilcoxon 1945).
    Drop,
    /// They are ranked, and their ranks are dropped (Pratt 1959).
    Pratt,
}

/// Result of the signed-rank test.
#[derive(Debug, Clone, PartialEq)]
pub struct Wilcoxon {
    /// Differences that are not zero.
    pub used: usize,
    /// Sum of the ranks of positive differences.
    pub plus: f64,
    /// The smaller of both sums of ranks.
    pub t: f64,
    /// Normal deviate of the sum of positive ranks, without correction for continuity.
    pub z: f64,
    /// Two-sided p.
    pub p: f64,
    /// Whether p is exact: at most 25 differences without ties and zeros.
    pub exact: bool,
    /// `z / √n` over all people, zeros included.
    pub r: f64,
    /// Matched-pairs rank-biserial correlation, zeros dropped: (sum of positive − of negative ranks) / their total.
    pub rank_biserial: f64,
    /// Hodges–Lehmann shift: median of all means of two differences, zeros included.
    pub shift: f64,
    /// Its interval by the normal approximation of the signed ranks (Hollander and Wolfe 1999, section 3.3).
    pub shift_interval: (f64, f64),
}

/// The signed-rank test of paired differences; `confidence` is that of the interval of the shift.
///
/// # Errors
/// Fewer than two differences, or none that is not zero.
pub fn wilcoxon(differences: &[f64], zeros: Zeros, confidence: f64) -> Result<Wilcoxon, NoValue> {
    let all = differences.len();
    if all < 2 {
        return Err(NoValue::TooFew { what: "differences", found: all, needed: 2 });
    }
    let kept: Vec<f64> = differences.iter().copied().filter(|one| libm::fabs(*one) > 1e-12).collect();
    if kept.is_empty() {
        return Err(NoValue::Constant);
    }
    let none = all - kept.len();
    let sizes = |values: &[f64]| values.iter().map(|one| libm::fabs(*one)).collect::<Vec<f64>>();
    let (ranks, groups) = midranks(&grouped(&sizes(&kept)));
    let before = if zeros == Zeros::Pratt { float(none) } else { 0.0 };
    let plus: f64 = kept.iter().zip(&ranks).filter(|(one, _)| **one > 0.0).map(|(_, rank)| rank + before).sum();
    let total: f64 = ranks.iter().map(|rank| rank + before).sum();
    let (n, n0) = (float(kept.len()) + before, before);
    let pairs = |n: f64| n * (n + 1.0) * (2.0 * n + 1.0);
    let ties: f64 = groups.iter().map(|t| float(t * t * t) - float(*t)).sum();
    let sd = libm::sqrt((pairs(n) - pairs(n0) - ties / 2.0) / 24.0);
    let z = (plus - total / 2.0) / sd;
    let exact = kept.len() <= EXACT_UP_TO && none == 0 && groups.len() == kept.len();
    let p = if exact { exact_p(kept.len(), plus) } else { dist::normal_two_sided(z) };
    let own: f64 = kept.iter().zip(&ranks).map(|(one, rank)| if *one > 0.0 { *rank } else { -rank }).sum();
    let (shift, shift_interval) = hodges_lehmann(differences, confidence);
    Ok(Wilcoxon {
        used: kept.len(),
        plus,
        t: plus.min(total - plus),
        z,
        p,
        exact,
        r: z / libm::sqrt(float(all)),
        rank_biserial: own / ranks.iter().sum::<f64>(),
        shift,
        shift_interval,
    })
}

/// Sizes that differ by rounding alone are made equal: a mean of items is a sum of thirds.
fn grouped(sizes: &[f64]) -> Vec<f64> {
    sizes.iter().map(|size| libm::round(size * 1e9) / 1e9).collect()
}

/// Two-sided p of a sum of ranks, from the number of subsets of 1..=n with each sum.
fn exact_p(n: usize, plus: f64) -> f64 {
    let most = n * (n + 1) / 2;
    let mut ways = vec![0.0; most + 1];
    if let Some(first) = ways.first_mut() {
        *first = 1.0;
    }
    for rank in 1..=n {
        for sum in (rank..=most).rev() {
            let add = ways.get(sum - rank).copied().unwrap_or(0.0);
            if let Some(cell) = ways.get_mut(sum) {
                *cell += add;
            }
        }
    }
    let all: f64 = ways.iter().sum();
    let below: f64 = ways.iter().enumerate().filter(|(sum, _)| float(*sum) <= plus + 1e-9).map(|(_, w)| w).sum();
    let above: f64 = ways.iter().enumerate().filter(|(sum, _)| float(*sum) >= plus - 1e-9).map(|(_, w)| w).sum();
    (2.0 * below.min(above) / all).min(1.0)
}

fn hodges_lehmann(differences: &[f64], confidence: f64) -> (f64, (f64, f64)) {
    let mut walsh = Vec::with_capacity(differences.len() * (differences.len() + 1) / 2);
    for (at, first) in differences.iter().enumerate() {
        walsh.extend(differences.iter().skip(at).map(|second| 0.5 * (first + second)));
    }
    walsh.sort_by(f64::total_cmp);
    let n = float(differences.len());
    let z = dist::normal_quantile(0.5 + confidence / 2.0);
    let cut = n * (n + 1.0) / 4.0 - z * libm::sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 24.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rank within the list")]
    let cut = libm::floor(cut).max(1.0) as usize;
    let end = |at: usize| walsh.get(at.min(walsh.len().saturating_sub(1))).copied().unwrap_or(f64::NAN);
    let median = socrates_stats::median(&walsh).unwrap_or(f64::NAN);
    (median, (end(cut - 1), end(walsh.len().saturating_sub(cut))))
}
