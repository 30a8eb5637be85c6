//! The bias-corrected and accelerated bootstrap over clusters.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

use super::{dist, float};

/// How clusters are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clustered {
    /// Resamples.
    pub resamples: usize,
    /// Confidence, such as 0.95.
    pub confidence: f64,
    /// Seed.
    pub seed: u64,
}

/// The interval of a statistic of clusters, which are drawn whole (Efron 1987; Davison and Hinkley 1997, section 3.8). The
/// statistic gets the numbers of the drawn clusters; none where it has no value. None below five clusters.
pub fn clustered_bca(
    clusters: usize,
    how: Clustered,
    statistic: impl Fn(&[usize]) -> Option<f64>,
) -> Option<(f64, f64)> {
    if clusters < 5 {
        return None;
    }
    let all: Vec<usize> = (0..clusters).collect();
    let found = statistic(&all)?;
    let mut random = ChaCha8Rng::seed_from_u64(how.seed);
    let mut drawn = vec![0; clusters];
    let mut values = Vec::with_capacity(how.resamples);
    for _ in 0..how.resamples {
        for place in &mut drawn {
            let product = u128::from(random.next_u64()) * clusters as u128;
            *place = usize::try_from(product >> 64).unwrap_or(0);
        }
        values.extend(statistic(&drawn));
    }
    values.sort_by(f64::total_cmp);
    // Half of those equal to the estimate count as below it: medians of points are often equal.
    let below = float(values.iter().filter(|value| **value < found - 1e-12).count());
    let equal = float(values.iter().filter(|value| libm::fabs(**value - found) <= 1e-12).count());
    let share = ((below + equal / 2.0) / float(values.len())).clamp(1e-6, 1.0 - 1e-6);
    let bias = dist::normal_quantile(share);
    let without: Vec<f64> = all
        .iter()
        .filter_map(|left| statistic(&all.iter().copied().filter(|one| one != left).collect::<Vec<_>>()))
        .collect();
    let mean = without.iter().sum::<f64>() / float(without.len());
    let (mut square, mut cube) = (0.0, 0.0);
    for value in &without {
        square += (mean - value) * (mean - value);
        cube += (mean - value) * (mean - value) * (mean - value);
    }
    let pull = if square > 1e-20 { cube / (6.0 * square * libm::sqrt(square)) } else { 0.0 };
    let end = |p: f64| {
        let z = bias + dist::normal_quantile(p);
        let share = dist::normal_cdf(bias + z / (1.0 - pull * z));
        socrates_stats::quantile(&values, share.clamp(0.0, 1.0)).ok()
    };
    let tail = (1.0 - how.confidence) / 2.0;
    Some((end(tail)?, end(1.0 - tail)?))
}
