//! The bootstrap by cluster: values that belong together are drawn together.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;

use crate::bootstrap::{Bootstrap, below};
use crate::order::quantile_of_sorted;
use crate::{Interval, StatsError, finite, float};

/// The means of clusters, and what they were in each resample of the clusters.
///
/// Each row is one cluster (a scenario), each column one thing that is measured in all of them (a planner); every cluster weighs
/// the same, whatever the number of its values. Columns share their resamples, so that differences of columns are paired
/// (Davison and Hinkley 1997, section 3.8).
#[derive(Debug, Clone, PartialEq)]
pub struct Clusters {
    /// Mean of each column over the clusters.
    means: Vec<f64>,
    /// The same of each resample.
    resamples: Vec<Vec<f64>>,
    /// Confidence of the intervals, 0.5 to 0.999.
    confidence: f64,
}

impl Clusters {
    /// Resamples the rows; all of them are as long as the first.
    ///
    /// # Errors
    /// Fewer than two rows, rows of different lengths, a value that is not finite, or a setting out of range.
    pub fn new(rows: &[Vec<f64>], how: Bootstrap) -> Result<Self, StatsError> {
        how.check()?;
        let columns = rows.first().map_or(0, Vec::len);
        if rows.len() < 2 {
            return Err(StatsError::TooFew { found: rows.len(), needed: 2 });
        }
        for row in rows {
            if row.len() != columns {
                return Err(StatsError::Unequal { left: columns, right: row.len() });
            }
            finite(row, 0)?;
        }
        let mut random = ChaCha8Rng::seed_from_u64(how.seed);
        let resamples = (0..how.resamples)
            .map(|_| {
                let drawn: Vec<&Vec<f64>> =
                    (0..rows.len()).filter_map(|_| rows.get(below(&mut random, rows.len()))).collect();
                means(&drawn, columns)
            })
            .collect();
        Ok(Self { means: means(&rows.iter().collect::<Vec<_>>(), columns), resamples, confidence: how.confidence })
    }

    /// Mean of each column.
    #[must_use]
    pub fn means(&self) -> &[f64] {
        &self.means
    }

    /// Means of each column in each resample.
    pub fn resamples(&self) -> impl Iterator<Item = &[f64]> {
        self.resamples.iter().map(Vec::as_slice)
    }

    /// The mean of a column with its percentile interval; `None` where there is no such column.
    #[must_use]
    pub fn mean(&self, column: usize) -> Option<Interval> {
        self.of(|means| means.get(column).copied())
    }

    /// The mean of a column less that of another, with its percentile interval; `None` where there is no such column.
    #[must_use]
    pub fn difference(&self, column: usize, against: usize) -> Option<Interval> {
        self.of(|means| Some(means.get(column)? - means.get(against)?))
    }

    fn of(&self, statistic: impl Fn(&[f64]) -> Option<f64>) -> Option<Interval> {
        let mut found = self.resamples.iter().map(|means| statistic(means)).collect::<Option<Vec<f64>>>()?;
        found.sort_by(f64::total_cmp);
        let tail = (1.0 - self.confidence) / 2.0;
        Some(Interval {
            estimate: statistic(&self.means)?,
            low: quantile_of_sorted(&found, tail),
            high: quantile_of_sorted(&found, 1.0 - tail),
        })
    }
}

fn means(rows: &[&Vec<f64>], columns: usize) -> Vec<f64> {
    let mut sums = vec![0.0; columns];
    for row in rows {
        sums.iter_mut().zip(row.iter()).for_each(|(sum, value)| *sum += value);
    }
    sums.iter().map(|sum| sum / float(rows.len())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn how() -> Bootstrap {
        Bootstrap { resamples: 4000, ..Bootstrap::default() }
    }

    #[test]
    fn a_difference_is_paired_however_much_the_clusters_differ() {
        // The second column is the first and 0.5 more, in clusters that lie far apart.
        let rows: Vec<Vec<f64>> = (0..8).map(|k| f64::from(k * k)).map(|value| vec![value, value + 0.5]).collect();
        let found = Clusters::new(&rows, how()).unwrap();
        let difference = found.difference(1, 0).unwrap();
        assert!((difference.estimate - 0.5).abs() < 1e-12 && difference.high - difference.low < 1e-9, "{difference:?}");
        let alone = found.mean(0).unwrap();
        assert!(alone.high - alone.low > 10.0, "the column alone is as uncertain as its clusters: {alone:?}");
    }

    #[test]
    fn the_interval_of_a_mean_matches_theory() {
        // 0..=100: standard error sqrt(850 / 101) = 2.90, so about 50 ± 5.69.
        let rows: Vec<Vec<f64>> = (0..=100).map(|k| vec![f64::from(k)]).collect();
        let found = Clusters::new(&rows, how()).unwrap().mean(0).unwrap();
        assert!((found.estimate - 50.0).abs() < 1e-12);
        assert!((found.low - 44.31).abs() <= 0.6 && (found.high - 55.69).abs() <= 0.6, "{found:?}");
    }

    #[test]
    fn one_cluster_and_ragged_rows_have_no_interval() {
        assert!(matches!(Clusters::new(&[vec![1.0]], how()), Err(StatsError::TooFew { found: 1, needed: 2 })));
        assert!(matches!(Clusters::new(&[vec![1.0, 2.0], vec![1.0]], how()), Err(StatsError::Unequal { .. })));
        assert!(Clusters::new(&[vec![1.0], vec![f64::NAN]], how()).is_err());
        assert!(Clusters::new(&[vec![1.0], vec![2.0]], how()).unwrap().difference(0, 1).is_none());
    }
}
