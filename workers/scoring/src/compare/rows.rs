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
    /// The order; `None` where neither more nor less is better, where nobody differs, or where fewer than two planners arrived often enough.
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

/// Share of the resamples in which a planner has to be best to be marked.
pub const MARKED: f64 = 0.95;
/// Decimals of a figure in tables, and the most where fewer do not tell the best planner from another.
const DECIMALS: (usize, usize) = (2, 4);

impl Row {
    /// The planner that every table marks as best: best in at least [`MARKED`] of the resamples, and its figure reads differently from
    /// those of the others.
    #[must_use]
    pub fn best(&self) -> Option<usize> {
        self.marked().map(|(place, _)| place)
    }

    /// Decimals of the figures in tables.
    #[must_use]
    pub fn decimals(&self) -> usize {
        self.marked().map_or(DECIMALS.0, |(_, decimals)| decimals)
    }

    /// The best planner, and the decimals that tell its figure from the others'.
    fn marked(&self) -> Option<(usize, usize)> {
        let place = self.order.as_ref()?.best.iter().position(|share| *share >= MARKED)?;
        let (fewest, most) = DECIMALS;
        let reads =
            |place: usize, decimals: usize| self.means.get(place).map(|mean| format!("{:.decimals$}", mean.estimate));
        let others = || (0..self.means.len()).filter(|other| *other != place);
        let tells = |decimals: &usize| others().all(|other| reads(other, *decimals) != reads(place, *decimals));
        (fewest..=most).find(tells).map(|decimals| (place, decimals))
    }
}

/// The order of the planners by a metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// Places of the ordered planners in the comparison, the best first; planners that arrived too seldom are not among them.
    pub places: Vec<usize>,
    /// Whether a planner is as good as the one before it in the order; the first never is.
    pub ties: Vec<bool>,
    /// Share of the resamples that turn no pair of the order round; `None` without resamples.
    pub stable: Option<f64>,
    /// Share of the resamples in which a planner is the best of the ordered ones, by planner; those that are best together share it.
    pub best: Vec<f64>,
}

/// Runs behind the figures.
#[derive(Clone, Copy)]
pub(super) struct Basis<'b, 'e> {
    /// Runs by planner.
    pub(super) planners: &'b [BTreeMap<Key<'e>, &'b Entry<'e>>],
    /// Runs that all planners had.
    pub(super) common: &'b BTreeSet<Key<'e>>,
    /// Unit of the resampling.
    pub(super) resampled: Resampled,
    /// Planners that arrived too seldom.
    pub(super) seldom: &'b [bool],
}

/// The figures of a metric; `None` where no common run has a value for everybody.
pub(super) fn row(metric: &'static Sheet, basis: &Basis<'_, '_>) -> Option<Row> {
    let Basis { planners, common, resampled, seldom } = *basis;
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
        order: order(metric, &means, found.as_ref(), seldom),
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

/// The order by a metric that has a better and a worse. Planners that arrived too seldom are in it for success alone: a robot that
/// stands still has no merit in anything else.
fn order(metric: &Sheet, means: &[Mean], found: Option<&Clusters>, seldom: &[bool]) -> Option<Order> {
    let is_success = matches!(metric.id, "success");
    let is_ordered = |place: &usize| is_success || seldom.get(*place) != Some(&true);
    let sign = f64::from(metric.direction.sign());
    let score = |means: &[f64], place: usize| means.get(place).map_or(f64::NAN, |mean| mean * sign);
    let whole: Vec<f64> = means.iter().map(|mean| mean.estimate).collect();
    let mut places: Vec<usize> = (0..means.len()).filter(is_ordered).collect();
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
        let top = places.iter().map(|place| score(sample, *place)).fold(f64::NEG_INFINITY, f64::max);
        let first: Vec<&usize> = places.iter().filter(|place| top - score(sample, **place) <= SAME).collect();
        best.iter_mut()
            .enumerate()
            .filter(|(place, _)| first.contains(&place))
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

    /// Three scenarios and three seeds: `stuck` drives less than half of the way and arrives in one run, `round` and `longer` always.
    fn one_stands_still() -> Vec<super::super::fixture::Made> {
        let mut all = Vec::new();
        for scenario in ["a", "b", "c"] {
            for seed in 1..=3_u32 {
                let arrives = scenario == "a" && seed == 1;
                let vary = 0.01 * f64::from(seed);
                let stuck = if arrives { (1.0, 12.0) } else { (0.0, 5.28) };
                all.push(arriving(scenario, "stuck", seed.into(), stuck));
                all.push(arriving(scenario, "round", seed.into(), (1.0, 17.02 + vary)));
                all.push(arriving(scenario, "longer", seed.into(), (1.0, 19.0 + vary)));
            }
        }
        all
    }

    fn arriving(
        scenario: &'static str,
        planner: &str,
        seed: u64,
        (arrived, length_m): (f64, f64),
    ) -> super::super::fixture::Made {
        let mut one = made(scenario, planner, seed, Some(1.0));
        for metric in &mut one.report.as_mut().unwrap().metrics {
            match metric.id.as_str() {
                "arrived" | "success" => metric.value = Some(arrived),
                "path_length" => metric.value = Some(length_m),
                _other => {}
            }
        }
        one
    }

    #[test]
    fn a_way_that_was_not_finished_is_no_path_length() {
        let all = one_stands_still();
        let found = compare(&entries(&all), &names(&["stuck", "round", "longer"])).unwrap();
        let row = row_of(&found, "path_length");
        assert_eq!((row.runs, row.without.as_slice()), (1, [8, 0, 0].as_slice()));
        let means: Vec<f64> = row.means.iter().map(|mean| mean.estimate).collect();
        assert!((means[0] - 12.0).abs() < 1e-9 && (means[1] - 17.03).abs() < 1e-9, "{means:?}");
    }

    #[test]
    fn a_planner_that_seldom_arrived_is_ordered_and_marked_in_success_alone() {
        let all = one_stands_still();
        let found = compare(&entries(&all), &names(&["stuck", "round", "longer"])).unwrap();
        assert_eq!(found.seldom, [true, false, false]);
        for row in found.rows.iter().filter(|row| row.metric.id != "success") {
            assert_ne!(row.best(), Some(0), "{row:?}");
            assert!(row.order.as_ref().is_none_or(|order| !order.places.contains(&0)), "{row:?}");
        }
        let success = row_of(&found, "success").order.as_ref().unwrap();
        assert_eq!(success.places, [1, 2, 0]);

        // The others are compared as without it, where it has values.
        let without: Vec<_> = all.iter().filter(|one| one.planner.as_str() != "stuck").cloned().collect();
        let found = compare(&entries(&without), &names(&["round", "longer"])).unwrap();
        let row = row_of(&found, "path_length");
        assert_eq!((row.runs, row.best()), (9, Some(0)), "{row:?}");
    }

    #[test]
    fn a_key_figure_that_no_run_has_of_every_planner_is_named() {
        let mut all = one_stands_still();
        for one in all.iter_mut().filter(|one| one.planner.as_str() == "stuck") {
            let metrics = &mut one.report.as_mut().unwrap().metrics;
            metrics
                .iter_mut()
                .filter(|it| it.id == "arrived" || it.id == "success")
                .for_each(|it| it.value = Some(0.0));
        }
        let found = compare(&entries(&all), &names(&["stuck", "round", "longer"])).unwrap();
        assert!(found.rows.iter().all(|row| row.metric.id != "path_length"));
        assert!(found.unpaired.iter().any(|metric| metric.id == "path_length"));
        assert!(
            found.basis().contains("no run has a value of every planner: ") && found.basis().contains("path length")
        );
    }

    #[test]
    fn figures_that_read_the_same_get_more_decimals_or_no_mark() {
        let of = |figures: &[f64]| {
            let mean = |estimate: &f64| Mean { estimate: *estimate, interval: None, parts: Vec::new() };
            let mut best = vec![0.0; figures.len()];
            best[0] = 1.0;
            let places = (0..figures.len()).collect();
            let order = Order { places, ties: vec![false; figures.len()], stable: Some(1.0), best };
            Row {
                metric: crate::metrics::sheet("space_compliance").unwrap(),
                runs: 9,
                without: vec![0; figures.len()],
                means: figures.iter().map(mean).collect(),
                differences: Vec::new(),
                order: Some(order),
            }
        };
        let marked = |figures: &[f64]| (of(figures).best(), of(figures).decimals());
        assert_eq!(marked(&[0.98, 0.91]), (Some(0), 2));
        assert_eq!(marked(&[0.984, 0.981, 0.5]), (Some(0), 3));
        assert_eq!(marked(&[0.980_01, 0.980_02]), (None, 2));
        let mut unsure = of(&[0.98, 0.91]);
        unsure.order.as_mut().unwrap().best = vec![0.94, 0.06];
        assert_eq!(unsure.best(), None);
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
