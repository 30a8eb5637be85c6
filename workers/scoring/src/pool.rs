//! Reports of many runs in one table: what each planner did in each scenario, and how stable the ranking of planners is.
//!
//! ```text
//! (scenario, report)… ─► pool ─┬─► cells: scenario × planner × metric, estimate and interval
//!                              └─► rankings: one per metric that has a better and a worse
//! ```
//!
//! Runs without a value are counted apart and never as 0. Figures made with different thresholds or formulas are
//! refused and not averaged. Planners are compared only over what all of them ran, the same scenario with the same
//! seed; where there is no such run they are not ranked.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::{PlannerName, Report};
use socrates_stats::{Bootstrap, Interval, Z_95, bootstrap_mean, bootstrap_median, kendall_tau, wilson};

use crate::metrics::{Aggregation, Direction, Sheet, sheet};

/// Of more scenarios than this there are no cells of single ones: 150 metrics of 10 000 scenarios would be a table of 150 MB.
const BY_SCENARIO: usize = 1_000;

/// One run of a batch.
#[derive(Debug, Clone, Copy)]
pub struct PooledRun<'a> {
    /// The scenario it is a run of.
    pub scenario: &'a str,
    /// Its report.
    pub report: &'a Report,
}

/// One figure of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Scenario; empty for all of them together: those runs that all planners with a value have, or where there are none,
    /// all runs of the planner.
    pub scenario: String,
    /// Planner.
    pub planner: PlannerName,
    /// Metric.
    pub metric: &'static Sheet,
    /// Runs.
    pub runs: usize,
    /// Runs that have a value.
    pub values: usize,
    /// Share, mean or median, see [`Sheet::aggregation`]; `None` where no run has a value.
    pub estimate: Option<f64>,
    /// Ends of the 95 % interval: Wilson's of a share, else by the bootstrap, which needs two values.
    pub interval: Option<(f64, f64)>,
}

/// The order of the planners by one metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// Metric.
    pub metric: &'static Sheet,
    /// Planners, the best first, by the figure over the runs that all of them have.
    pub planners: Vec<String>,
    /// Scenarios that all of them ran; of other scenarios nothing counts.
    pub scenarios: usize,
    /// Mean of Kendall's tau-b between the order over all parts and that of each part: 1 when every part ranks them
    /// alike. Parts are scenarios where there are several, else seeds. `None` where no two parts rank anybody.
    pub tau: Option<f64>,
    /// How many parts rank the planners.
    pub parts: usize,
}

/// Reports pooled.
#[derive(Debug, Clone, PartialEq)]
pub struct Pool {
    /// Signature of the thresholds of all of them.
    pub thresholds: String,
    /// Scenarios there are.
    pub scenarios: usize,
    /// Figures, by metric in report order, then scenario (all together first), then planner; of more than 1000 scenarios all together
    /// alone.
    pub cells: Vec<Cell>,
    /// Rankings in report order; empty with fewer than two planners.
    pub rankings: Vec<Ranking>,
}

/// Why reports are not pooled.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PoolFault {
    /// Two reports used different thresholds.
    #[error("{run} was scored with the thresholds `{found}`, {first} with `{wanted}`: what they count is not the same")]
    Thresholds {
        /// Run that differs.
        run: String,
        /// Its signature.
        found: String,
        /// First run.
        first: String,
        /// Its signature.
        wanted: String,
    },
    /// Two reports used different formulas of a metric.
    #[error("`{metric}` of {run} is of version `{found}`, that of {first} of version `{wanted}`: the formula changed")]
    Version {
        /// The metric.
        metric: String,
        /// Run that differs.
        run: String,
        /// Its version.
        found: u32,
        /// First run that has the metric.
        first: String,
        /// Its version.
        wanted: u32,
    },
}

impl PoolFault {
    /// What helps.
    #[must_use]
    pub const fn hint(&self) -> &'static str {
        "make the older runs again with `socrates run BUNDLE/request.toml`, or pool only those of one version"
    }
}

/// A run in words.
fn named(run: &PooledRun<'_>) -> String {
    format!("`{}` with {} and seed {}", run.scenario, run.report.planner, run.report.seed)
}

/// Refuses figures that do not mean the same.
pub(crate) fn alike(runs: &[PooledRun<'_>]) -> Result<String, PoolFault> {
    let Some(first) = runs.first() else { return Ok(String::new()) };
    let wanted = &first.report.thresholds;
    if let Some(other) = runs.iter().find(|run| run.report.thresholds != *wanted) {
        let signed = |text: &str| if text.is_empty() { "none".to_owned() } else { text.to_owned() };
        return Err(PoolFault::Thresholds {
            run: named(other),
            found: signed(&other.report.thresholds),
            first: named(first),
            wanted: signed(wanted),
        });
    }
    let mut versions: BTreeMap<&str, (u32, &PooledRun<'_>)> = BTreeMap::new();
    for run in runs {
        for metric in &run.report.metrics {
            let (wanted, first) = *versions.entry(&metric.id).or_insert((metric.version, run));
            if metric.version != wanted {
                return Err(PoolFault::Version {
                    metric: metric.id.clone(),
                    run: named(run),
                    found: metric.version,
                    first: named(first),
                    wanted,
                });
            }
        }
    }
    Ok(wanted.clone())
}

/// The figure of some values with its interval.
fn figure(sheet: &Sheet, values: &[f64]) -> (Option<f64>, Option<(f64, f64)>) {
    let how = Bootstrap::default();
    let found: Option<Interval> = match sheet.aggregation() {
        Aggregation::Share => wilson(values.iter().filter(|value| **value > 0.5).count(), values.len(), Z_95).ok(),
        Aggregation::Count => bootstrap_mean(values, how).ok(),
        Aggregation::Median => bootstrap_median(values, how).ok(),
    };
    match (found, values) {
        (Some(found), _) => (Some(found.estimate), Some((found.low, found.high))),
        (None, [one]) => (Some(*one), None),
        (None, _) => (None, None),
    }
}

/// Values of one metric of some runs.
fn values<'r>(runs: impl Iterator<Item = &'r PooledRun<'r>>, id: &str) -> Vec<f64> {
    runs.filter_map(|run| run.report.metrics.iter().find(|metric| metric.id == id)?.value).collect()
}

/// Pools reports.
///
/// # Errors
/// Reports that used different thresholds or formulas.
pub fn pool(runs: &[PooledRun<'_>]) -> Result<Pool, PoolFault> {
    let thresholds = alike(runs)?;
    let scenarios: BTreeSet<&str> = runs.iter().map(|run| run.scenario).collect();
    let planners: BTreeSet<&PlannerName> = runs.iter().map(|run| &run.report.planner).collect();
    let mut by_scenario: BTreeMap<&str, Vec<&PooledRun<'_>>> = BTreeMap::new();
    // One scenario is all of them.
    if (2..=BY_SCENARIO).contains(&scenarios.len()) {
        runs.iter().for_each(|run| by_scenario.entry(run.scenario).or_default().push(run));
    }
    let (mut cells, mut rankings) = (Vec::new(), Vec::new());
    for metric in crate::metrics::sheets() {
        let shared = Shared::of(metric, runs, &planners);
        let together: Vec<&PooledRun<'_>> = runs.iter().filter(|run| shared.counts(run)).collect();
        for (scenario, part) in
            std::iter::once(("", &together)).chain(by_scenario.iter().map(|(name, part)| (*name, part)))
        {
            for planner in &planners {
                let own = || part.iter().copied().filter(|run| run.report.planner == **planner);
                let count = own().count();
                if count == 0 {
                    continue;
                }
                let values = values(own(), metric.id);
                let (estimate, interval) = figure(metric, &values);
                cells.push(Cell {
                    scenario: scenario.to_owned(),
                    planner: (*planner).clone(),
                    metric,
                    runs: count,
                    values: values.len(),
                    estimate,
                    interval,
                });
            }
        }
        rankings.extend(ranking(metric, runs, &shared));
    }
    Ok(Pool { thresholds, scenarios: scenarios.len(), cells, rankings })
}

/// The runs over which planners are compared by one metric.
struct Shared<'r> {
    /// Planners that have a value at all: who never has one, such as the run without a robot, is not compared.
    planners: BTreeSet<&'r PlannerName>,
    /// Scenario and seed of the runs that all of them have.
    keys: BTreeSet<(&'r str, u64)>,
}

impl<'r> Shared<'r> {
    fn of(metric: &Sheet, runs: &'r [PooledRun<'r>], planners: &BTreeSet<&'r PlannerName>) -> Self {
        let planners: BTreeSet<&PlannerName> = planners
            .iter()
            .copied()
            .filter(|planner| !values(of_planner(runs, planner), metric.id).is_empty())
            .collect();
        let keys = planners.iter().copied().map(|planner| of_planner(runs, planner).map(key).collect::<BTreeSet<_>>());
        let keys = keys.reduce(|all, own| all.intersection(&own).copied().collect()).unwrap_or_default();
        Self { planners, keys }
    }

    /// Whether a run counts where all scenarios are taken together.
    fn counts(&self, run: &PooledRun<'_>) -> bool {
        let compared = self.planners.contains(&run.report.planner) && !self.keys.is_empty();
        !compared || self.keys.contains(&key(run))
    }
}

/// The runs of a planner.
fn of_planner<'r>(runs: &'r [PooledRun<'r>], planner: &'r PlannerName) -> impl Iterator<Item = &'r PooledRun<'r>> {
    runs.iter().filter(move |run| run.report.planner == *planner)
}

/// What two planners have in common where they ran the same.
fn key<'r>(run: &PooledRun<'r>) -> (&'r str, u64) {
    (run.scenario, run.report.seed)
}

/// Scores of the planners by one metric, larger is better; `None` unless everybody has one.
fn scores(metric: &Sheet, runs: &[&PooledRun<'_>], planners: &BTreeSet<&PlannerName>) -> Option<Vec<f64>> {
    let one = |planner: &&PlannerName| {
        let own = runs.iter().copied().filter(|run| run.report.planner == **planner);
        let (estimate, _) = figure(metric, &values(own, metric.id));
        estimate.map(|estimate| estimate * f64::from(metric.direction.sign()))
    };
    planners.iter().map(one).collect()
}

fn ranking(metric: &'static Sheet, runs: &[PooledRun<'_>], shared: &Shared<'_>) -> Option<Ranking> {
    if metric.direction == Direction::Neutral || shared.planners.len() < 2 {
        return None;
    }
    let all: Vec<&PooledRun<'_>> = runs.iter().filter(|run| shared.keys.contains(&key(run))).collect();
    let whole = scores(metric, &all, &shared.planners)?;
    let mut order: Vec<(&PlannerName, f64)> = shared.planners.iter().copied().zip(whole.iter().copied()).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(b.0)));
    let scenarios = all.iter().map(|run| run.scenario).collect::<BTreeSet<_>>().len();
    let mut parts: BTreeMap<(&str, u64), Vec<&PooledRun<'_>>> = BTreeMap::new();
    for run in all {
        let part = if scenarios > 1 { (run.scenario, 0) } else { ("", run.report.seed) };
        parts.entry(part).or_default().push(run);
    }
    let taus: Vec<f64> =
        parts.values().filter_map(|part| kendall_tau(&whole, &scores(metric, part, &shared.planners)?).ok()).collect();
    #[expect(clippy::cast_precision_loss, reason = "parts of a batch are far below 2^53")]
    let tau = (taus.len() > 1).then(|| taus.iter().sum::<f64>() / taus.len() as f64);
    let planners = order.into_iter().map(|(planner, _)| planner.to_string()).collect();
    Some(Ranking { metric, planners, scenarios, tau, parts: taus.len() })
}

impl Pool {
    /// The figures as a table for spreadsheets and scripts:
    /// `scenario,planner,metric,unit,direction,how,runs,values,estimate,low,high,version,thresholds`. All scenarios
    /// together have an empty name; what is absent is an empty cell.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "scenario,planner,metric,unit,direction,how,runs,values,estimate,low,high,version,thresholds\n",
        );
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        for cell in &self.cells {
            let how = match cell.metric.aggregation() {
                Aggregation::Share => "share",
                Aggregation::Count => "mean",
                Aggregation::Median => "median",
            };
            let cells = [
                cell.scenario.clone(),
                cell.planner.to_string(),
                cell.metric.id.to_owned(),
                cell.metric.unit.to_owned(),
                cell.metric.direction.sign().to_string(),
                how.to_owned(),
                cell.runs.to_string(),
                cell.values.to_string(),
                number(cell.estimate),
                number(cell.interval.map(|(low, _)| low)),
                number(cell.interval.map(|(_, high)| high)),
                cell.metric.version().to_string(),
                self.thresholds.clone(),
            ];
            text.push_str(&socrates_stream::csv::joined(&cells));
            text.push('\n');
        }
        text
    }

    /// The figure of a planner over all scenarios.
    #[must_use]
    pub fn overall(&self, planner: &str, metric: &str) -> Option<&Cell> {
        self.cells
            .iter()
            .find(|cell| cell.scenario.is_empty() && cell.planner.as_str() == planner && cell.metric.id == metric)
    }

    /// The ranking by a metric.
    #[must_use]
    pub fn ranking(&self, metric: &str) -> Option<&Ranking> {
        self.rankings.iter().find(|ranking| sheet(metric) == Some(ranking.metric))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, recording};

    /// A report of a robot of some speed that passes somebody.
    fn report(planner: &str, seed: u64, mps: f64, aside_m: f64) -> Report {
        let mut run = recording(&[Walk::robot(-4., 0., mps, 0.), Walk::human(1, 0., aside_m, 0., 0.)], 10.0, 0.1);
        run.header.planner = planner.parse().unwrap();
        run.header.seed = seed;
        crate::score(&Evidence::of(&run))
    }

    fn batch() -> Vec<(String, Report)> {
        let mut all = Vec::new();
        for (scenario, more) in [("a", 0.0), ("b", 0.4), ("c", 0.5)] {
            for seed in 1..=5_u32 {
                let vary = 0.02 * f64::from(seed);
                all.push((scenario.to_owned(), report("near", seed.into(), 0.8, 0.8 + more + vary)));
                all.push((scenario.to_owned(), report("wide", seed.into(), 0.8, 1.6 + more + vary)));
            }
        }
        all
    }

    fn pooled(reports: &[(String, Report)]) -> Result<Pool, PoolFault> {
        let runs: Vec<PooledRun<'_>> =
            reports.iter().map(|(scenario, report)| PooledRun { scenario, report }).collect();
        pool(&runs)
    }

    #[test]
    fn of_very_many_scenarios_there_are_figures_of_all_together_alone() {
        let report = report("near", 1, 0.8, 0.8);
        let runs = |count: usize| -> Vec<(String, Report)> {
            (0..count).map(|number| (format!("s{number}"), report.clone())).collect()
        };
        let few = pooled(&runs(3)).unwrap();
        assert!(few.cells.iter().any(|cell| cell.scenario == "s1"));
        let many = pooled(&runs(BY_SCENARIO + 1)).unwrap();
        assert_eq!(many.scenarios, BY_SCENARIO + 1);
        assert!(many.cells.iter().all(|cell| cell.scenario.is_empty()));
        assert_eq!(many.overall("near", "success").unwrap().runs, BY_SCENARIO + 1);
    }

    #[test]
    fn figures_are_by_scenario_and_planner_with_an_interval() {
        let found = pooled(&batch()).unwrap();
        let cell = |scenario: &str, planner: &str| {
            let mut cells = found.cells.iter();
            let wanted = |cell: &&Cell| cell.scenario == scenario && cell.planner.as_str() == planner;
            cells.find(|cell| wanted(cell) && cell.metric.id == "human_distance_min").unwrap()
        };
        let near = cell("a", "near");
        assert_eq!((near.runs, near.values), (5, 5));
        assert!((near.estimate.unwrap() - (0.86 - 0.53)).abs() < 1e-3, "{near:?}");
        let (low, high) = near.interval.unwrap();
        assert!(low >= 0.82 - 0.531 && high <= 0.90 - 0.529 && low < high, "{near:?}");
        assert_eq!(cell("", "wide").runs, 15);
        // Without a goal nobody arrives: counted apart, and never as 0.
        let time = found.overall("near", "time_to_goal").unwrap();
        assert_eq!((time.runs, time.values, time.estimate), (15, 0, None));
        let csv = found.csv();
        assert!(
            csv.lines().count() == found.cells.len() + 1 && csv.contains(",near,time_to_goal,s,-1,median,15,0,,,,2,")
        );
    }

    #[test]
    fn a_ranking_that_every_scenario_shares_has_a_tau_of_one() {
        let found = pooled(&batch()).unwrap();
        let ranking = found.ranking("human_distance_min").unwrap();
        assert_eq!(ranking.planners, ["wide", "near"]);
        assert_eq!((ranking.tau, ranking.parts), (Some(1.0), 3));
        let mut turned = batch();
        for (_, report) in turned.iter_mut().filter(|(scenario, _)| scenario == "c") {
            report.planner = if report.planner.as_str() == "near" { "wide" } else { "near" }.parse().unwrap();
        }
        let found = pooled(&turned).unwrap();
        let tau = found.ranking("human_distance_min").unwrap().tau.unwrap();
        assert!((tau - 1.0 / 3.0).abs() < 1e-9, "two of three agree: {tau}");
        assert!(found.ranking("robot_speed_mean").is_none(), "neither more nor less is better");
    }

    #[test]
    fn figures_of_other_thresholds_or_formulas_are_refused() {
        let mut reports = batch();
        reports[3].1.thresholds = "mine-0".into();
        let fault = pooled(&reports).unwrap_err();
        let text = fault.to_string();
        assert!(text.contains("`a` with wide and seed 2") && text.contains("`mine-0`"), "{text}");
        assert!(!fault.hint().is_empty());
        let mut reports = batch();
        reports[1].1.metrics[0].version = 9;
        assert!(matches!(pooled(&reports), Err(PoolFault::Version { found: 9, .. })));
        // Reports from before there were signatures are pooled among themselves.
        let mut reports = batch();
        reports.iter_mut().for_each(|(_, report)| report.thresholds.clear());
        assert_eq!(pooled(&reports).unwrap().thresholds, "");
        assert!(pooled(&[]).unwrap().cells.is_empty());
    }

    #[test]
    fn planners_are_compared_only_over_what_all_of_them_ran() {
        // Alone in an easy scenario, `near` would be the one that keeps its distance.
        let mut reports = batch();
        for seed in 1..=9 {
            reports.push(("easy".to_owned(), report("near", seed, 0.8, 6.0)));
        }
        reports.push(("a".to_owned(), report("near", 77, 0.8, 6.0)));
        let found = pooled(&reports).unwrap();
        let ranking = found.ranking("human_distance_min").unwrap();
        assert_eq!(
            (ranking.planners.as_slice(), ranking.scenarios),
            (["wide".to_owned(), "near".to_owned()].as_slice(), 3)
        );
        assert_eq!(found.scenarios, 4);
        let overall = |planner: &str| found.overall(planner, "human_distance_min").unwrap().runs;
        assert_eq!((overall("near"), overall("wide")), (15, 15), "the seed that only one ran counts neither");
        let easy = found.cells.iter().find(|cell| cell.scenario == "easy" && cell.metric.id == "human_distance_min");
        assert_eq!(easy.unwrap().runs, 9, "the scenario has its own figures all the same");
        // Nothing in common: no order, and each has the figures of its own runs.
        let apart = [("a".to_owned(), report("near", 1, 0.8, 1.0)), ("b".to_owned(), report("wide", 1, 0.8, 2.0))];
        let found = pooled(&apart).unwrap();
        assert!(found.ranking("human_distance_min").is_none());
        assert_eq!(found.overall("near", "human_distance_min").unwrap().runs, 1);
    }
}
