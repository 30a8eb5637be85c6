//! The figures of one metric: paired means, differences, the order of the planners and how stable it is.

use std::collections::{BTreeMap, BTreeSet};

use socrates_stats::{Bootstrap, Clusters, Interval, Z_95, wilson};

use super::{Entry, Key, Resampled, value};
use crate::metrics::{Aggregation, Sheet, count};

/// Figures nearer than this are the same: sums in another order differ by less.
const SAME: f64 = 1e-9;

/// The figures of one metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Metric.
    pub metric: &'static Sheet,
    /// Common runs in which every planner has a value: those that the means are of.
    pub runs: usize,
    /// Common runs in which a planner has no value, by planner.
    pub without: Vec<usize>,
    /// Means, by planner.
    pub means: Vec<Mean>,
    /// Differences to the first planner, by planner from the second.
    pub differences: Vec<Difference>,
    /// The order; `None` where neither more nor less is better, or nobody differs.
    pub order: Option<Order>,
}

/// A mean over scenarios, each of which weighs the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Mean {
    /// The mean.
    pub estimate: f64,
    /// Ends of its 95 % interval; needs two scenarios, or two seeds of one.
    pub interval: Option<(f64, f64)>,
    /// Means of what is resampled, in order of scenario and seed: the points of a plot.
    pub parts: Vec<f64>,
}

/// A mean paired difference.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The planner's figure less that of the first.
    pub estimate: f64,
    /// Ends of its 95 % interval.
    pub interval: Option<(f64, f64)>,
    /// Runs in which the planner's value is larger.
    pub larger: usize,
    /// Runs in which it is smaller.
    pub smaller: usize,
}

impl Difference {
    /// Whether the interval leaves out 0.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.interval.is_some_and(|(low, high)| low > 0.0 || high < 0.0)
    }
}

/// The order of the planners by a metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// Places of the planners in the comparison, the best first.
    pub places: Vec<usize>,
    /// Whether a planner is as good as the one before it in the order; the first never is.
    pub ties: Vec<bool>,
    /// Share of the resamples that turn no pair of the order round; `None` without resamples.
    pub stable: Option<f64>,
    /// Share of the resamples in which a planner is best, by planner; those that are best together share it.
    pub best: Vec<f64>,
}

/// The figures of a metric; `None` where no common run has a value for everybody.
pub(super) fn row(
    metric: &'static Sheet,
    planners: &[BTreeMap<Key<'_>, &Entry<'_>>],
    common: &BTreeSet<Key<'_>>,
    resampled: Resampled,
) -> Option<Row> {
    let of = |own: &BTreeMap<Key<'_>, &Entry<'_>>, key: &Key<'_>| value(own.get(key)?, metric);
    let without = planners.iter().map(|own| common.iter().filter(|key| of(own, key).is_none()).count()).collect();
    let whole: Vec<(Key<'_>, Vec<f64>)> = common
        .iter()
        .filter_map(|key| Some((*key, planners.iter().map(|own| of(own, key)).collect::<Option<Vec<f64>>>()?)))
        .collect();
    let clusters = clusters(&whole, resampled);
    let first = clusters.first()?;
    let found = Clusters::new(&clusters, Bootstrap::default()).ok();
    let mean = |column: usize| column_mean(&clusters, column);
    let parts = |column: usize| clusters.iter().filter_map(|row| row.get(column).copied()).collect::<Vec<f64>>();
    let means: Vec<Mean> = (0..first.len())
        .map(|column| {
            let interval = found
                .as_ref()
                .and_then(|found| found.mean(column))
                .map(|found| of_share(metric, found, clusters.len()));
            Mean { estimate: mean(column), interval: interval.map(ends), parts: parts(column) }
        })
        .collect();
    let differences = (1..first.len()).map(|column| difference(column, &whole, mean(column) - mean(0), found.as_ref()));
    Some(Row {
        metric,
        runs: whole.len(),
        without,
        differences: differences.collect(),
        order: order(metric, &means, found.as_ref()),
        means,
    })
}

/// Means of what is resampled: a scenario's over its seeds, or each seed's own value.
fn clusters(whole: &[(Key<'_>, Vec<f64>)], resampled: Resampled) -> Vec<Vec<f64>> {
    let mut parts: BTreeMap<Key<'_>, Vec<&Vec<f64>>> = BTreeMap::new();
    for ((scenario, seed), values) in whole {
        let part = match resampled {
            Resampled::Scenarios(_) => (*scenario, 0),
            Resampled::Seeds(_) => (*scenario, *seed),
        };
        parts.entry(part).or_default().push(values);
    }
    let mean = |part: &Vec<&Vec<f64>>| {
        let columns = part.first().map_or(0, |row| row.len());
        (0..columns).map(|column| column_mean(part, column)).collect()
    };
    parts.values().map(mean).collect()
}

fn column_mean(rows: &[impl AsRef<[f64]>], column: usize) -> f64 {
    rows.iter().filter_map(|row| row.as_ref().get(column)).sum::<f64>() / count(rows.len().max(1))
}

/// The interval of a share. Where every part has the same share the bootstrap has no width, although a few parts prove little:
/// then it is Wilson's, of so many parts as there are.
fn of_share(metric: &Sheet, found: Interval, parts: usize) -> Interval {
    if metric.aggregation() != Aggregation::Share || found.high - found.low > SAME {
        return found;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a few parts")]
    let yes = (found.estimate * count(parts)).round() as usize;
    wilson(yes, parts, Z_95).map_or(found, |wide| Interval { estimate: found.estimate, ..wide })
}

const fn ends(found: Interval) -> (f64, f64) {
    (found.low, found.high)
}

fn difference(column: usize, whole: &[(Key<'_>, Vec<f64>)], estimate: f64, found: Option<&Clusters>) -> Difference {
    let apart = || whole.iter().filter_map(|(_, values)| Some(values.get(column)? - values.first()?));
    Difference {
        estimate,
        interval: found.and_then(|found| found.difference(column, 0)).map(ends),
        larger: apart().filter(|apart| *apart > SAME).count(),
        smaller: apart().filter(|apart| *apart < -SAME).count(),
    }
}

/// The order by a metric that has a better and a worse.
fn order(metric: &Sheet, means: &[Mean], found: Option<&Clusters>) -> Option<Order> {
    let sign = f64::from(metric.direction.sign());
    let score = |means: &[f64], place: usize| means.get(place).map_or(f64::NAN, |mean| mean * sign);
    let whole: Vec<f64> = means.iter().map(|mean| mean.estimate).collect();
    let mut places: Vec<usize> = (0..means.len()).collect();
    places.sort_by(|a, b| score(&whole, *b).total_cmp(&score(&whole, *a)).then(a.cmp(b)));
    let steps = || places.iter().zip(places.iter().skip(1));
    let leads = |means: &[f64], (better, worse): (&usize, &usize)| score(means, *better) - score(means, *worse);
    let ties: Vec<bool> = std::iter::once(false).chain(steps().map(|step| leads(&whole, step) <= SAME)).collect();
    if sign == 0.0 || ties.iter().skip(1).all(|tie| *tie) {
        return None;
    }
    let strict = || steps().filter(|step| leads(&whole, *step) > SAME);
    let (mut kept, mut all) = (0_usize, 0_usize);
    let mut best = vec![0.0; means.len()];
    for sample in found.iter().flat_map(|found| found.resamples()) {
        all += 1;
        kept += usize::from(strict().all(|step| leads(sample, step) >= -SAME));
        let top = (0..sample.len()).map(|place| score(sample, place)).fold(f64::NEG_INFINITY, f64::max);
        let first: Vec<usize> = (0..sample.len()).filter(|place| top - score(sample, *place) <= SAME).collect();
        best.iter_mut()
            .enumerate()
            .filter(|(place, _)| first.contains(place))
            .for_each(|(_, sum)| *sum += 1.0 / count(first.len()));
    }
    best.iter_mut().for_each(|sum| *sum /= count(all.max(1)));
    Some(Order { places, ties, stable: (all > 0).then(|| count(kept) / count(all)), best })
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{batch, entries, made, names};
    use super::super::{Comparison, compare};
    use super::*;

    fn row_of<'c>(found: &'c Comparison, metric: &str) -> &'c Row {
        found.rows.iter().find(|row| row.metric.id == metric).unwrap()
    }

    #[test]
    fn a_difference_is_sharp_where_the_planners_differ_alike_in_scenarios_that_differ_much() {
        let all = batch();
        let found = compare(&entries(&all), &names(&["near", "wide"])).unwrap();
        let row = row_of(&found, "human_distance_min");
        let [difference] = row.differences.as_slice() else { panic!("{row:?}") };
        assert!((difference.estimate - 0.8).abs() < 0.01, "{difference:?}");
        let (low, high) = difference.interval.unwrap();
        assert!(high - low < 0.02 && difference.is_clear(), "{difference:?}");
        assert_eq!((difference.larger, difference.smaller), (9, 0));
        let (low, high) = row.means[0].interval.unwrap();
        assert!(high - low > 0.5, "the mean alone is as uncertain as its scenarios: {:?}", row.means[0]);
        let order = row.order.as_ref().unwrap();
        assert_eq!((order.places.as_slice(), order.stable), ([1, 0].as_slice(), Some(1.0)));
        assert_eq!(order.best, [0.0, 1.0]);
        assert_eq!(row.means[1].parts.len(), 3);
    }

    #[test]
    fn scenarios_weigh_the_same_whatever_the_number_of_their_seeds() {
        let mut all = batch();
        all.extend(
            (4..=30).flat_map(|seed| [made("a", "near", seed, Some(0.86)), made("a", "wide", seed, Some(1.66))]),
        );
        let found = compare(&entries(&all), &names(&["near", "wide"])).unwrap();
        let before = compare(&entries(&batch()), &names(&["near", "wide"])).unwrap().rows;
        let mean = |row: &Row| row.means[0].estimate;
        let old = before.iter().find(|row| row.metric.id == "human_distance_min").unwrap();
        assert!((mean(row_of(&found, "human_distance_min")) - mean(old)).abs() < 0.01);
    }

    #[test]
    fn a_run_without_a_result_is_no_success_and_takes_its_pair_out_of_the_other_figures() {
        let mut all = batch();
        let lost = all.iter_mut().find(|one| one.planner.as_str() == "wide" && one.scenario == "b").unwrap();
        lost.report = None;
        let found = compare(&entries(&all), &names(&["near", "wide"])).unwrap();
        let row = row_of(&found, "human_distance_min");
        assert_eq!((found.common, row.runs, row.without.as_slice()), (9, 8, [0, 1].as_slice()));
    }

    #[test]
    fn seeds_are_resampled_where_there_is_one_scenario() {
        let all: Vec<_> = batch().into_iter().filter(|one| one.scenario == "a").collect();
        let found = compare(&entries(&all), &names(&["wide", "near"])).unwrap();
        assert_eq!(found.resampled, Resampled::Seeds(3));
        let row = row_of(&found, "human_distance_min");
        assert!((row.differences[0].estimate + 0.8).abs() < 0.01, "against the first: {row:?}");
        assert_eq!(row.means[0].parts.len(), 3);
    }

    #[test]
    fn equal_shares_have_the_interval_of_their_number_and_no_order() {
        let all = batch();
        let found = compare(&entries(&all), &names(&["near", "wide"])).unwrap();
        let row = row_of(&found, "human_collisions");
        assert!(row.order.is_none(), "nobody touches anybody: {row:?}");
        let share =
            of_share(crate::metrics::sheet("success").unwrap(), Interval { estimate: 1.0, low: 1.0, high: 1.0 }, 3);
        assert!(share.low < 0.5 && share.high > 0.99, "three of three prove little: {share:?}");
    }
}
