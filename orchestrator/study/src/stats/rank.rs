//! Ranks.

use super::{NoValue, dist, float};

/// Ranks from 1, those of equal values averaged; and the sizes of the groups of equal values.
#[must_use]
pub fn midranks(values: &[f64]) -> (Vec<f64>, Vec<usize>) {
    let mut order: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (mut ranks, mut groups, mut before) = (vec![0.0; values.len()], Vec::new(), 0);
    for group in order.chunk_by(|a, b| a.1.total_cmp(&b.1).is_eq()) {
        let rank = float(before) + (float(group.len()) + 1.0) / 2.0;
        for (at, _) in group {
            if let Some(cell) = ranks.get_mut(*at) {
                *cell = rank;
            }
        }
        before += group.len();
        groups.push(group.len());
    }
    (ranks, groups)
}

/// Spearman's rank correlation and its two-sided p by Student's t with `n − 2` degrees of freedom.
///
/// # Errors
/// Fewer than four pairs, or values that are all alike.
pub fn spearman(pairs: &[(f64, f64)]) -> Result<(f64, f64), NoValue> {
    if pairs.len() < 4 {
        return Err(NoValue::TooFew { what: "pairs", found: pairs.len(), needed: 4 });
    }
    let (first, second): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    let rho = pearson(&midranks(&first).0, &midranks(&second).0).ok_or(NoValue::Constant)?;
    let df = float(pairs.len()) - 2.0;
    let t = rho * libm::sqrt(df / (1.0 - rho * rho).max(1e-300));
    Ok((rho, 2.0 * dist::t_upper(libm::fabs(t), df)))
}

/// Kendall's τ-b, corrected for ties on both sides (Kendall 1945).
///
/// # Errors
/// Fewer than two pairs, or values that are all alike.
pub fn kendall(pairs: &[(f64, f64)]) -> Result<f64, NoValue> {
    if pairs.len() < 2 {
        return Err(NoValue::TooFew { what: "pairs", found: pairs.len(), needed: 2 });
    }
    let sign = |a: f64, b: f64| if a.total_cmp(&b).is_eq() { 0.0 } else { (a - b).signum() };
    let (mut both, mut first, mut second) = (0.0, 0.0, 0.0);
    for (at, a) in pairs.iter().enumerate() {
        for b in pairs.iter().skip(at + 1) {
            let (x, y) = (sign(a.0, b.0), sign(a.1, b.1));
            both += x * y;
            first += x * x;
            second += y * y;
        }
    }
    let size = libm::sqrt(first * second);
    if size > 0.0 { Ok(both / size) } else { Err(NoValue::Constant) }
}

/// Product-moment correlation; none where one side does not vary.
pub(super) fn pearson(first: &[f64], second: &[f64]) -> Option<f64> {
    let n = float(first.len());
    let (ma, mb) = (first.iter().sum::<f64>() / n, second.iter().sum::<f64>() / n);
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in first.iter().zip(second) {
        ab += (a - ma) * (b - mb);
        aa += (a - ma) * (a - ma);
        bb += (b - mb) * (b - mb);
    }
    (aa > 1e-12 && bb > 1e-12).then(|| ab / libm::sqrt(aa * bb))
}
