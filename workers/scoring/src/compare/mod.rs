//! Planners compared over the runs that all of them had: paired figures, their order and how stable it is, what became of every run.
//!
//! ```text
//! (scenario, planner, seed, report or none)… ─► compare ─┬─► outcomes: what became of each planner's runs, and by whose doing
//!                                                        └─► rows: one per metric, paired means, differences, order
//! ```
//!
//! Nothing is dropped: a run without a result counts among the outcomes and as no success, and a metric says in how many of the
//! common runs it has a value for everybody and which planners have none in the others. Scenarios weigh the same, whatever the
//! number of their seeds; intervals come from resampling scenarios, or seeds where there is one scenario.

mod outcome;
mod rows;
mod write;

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::{PlannerName, Report};

use crate::metrics::{KEY_FIGURES, Sheet, count, sheet};
use crate::pool::{PoolFault, PooledRun, alike};

use outcome::References;
pub use outcome::{Cause, Outcome};
pub use rows::{Difference, MARKED, Mean, Order, Row};
pub use write::runs_csv;

/// Metrics of a comparison beside the key figures, where they have values: groups and what the robot costs people.
const BESIDE: [&str; 5] = ["o_space_seconds", "o_space_entries", "group_splits", "people_deviation", "flow_delay_mean"];

/// Metrics that describe a completed trip: a robot that stood still would have the shortest way. They have a value of arrivals alone.
const OF_TRIP: [&str; 1] = ["path_length"];
/// Metrics of the tables that have a value of arrivals alone, by these tables or by their own formula.
const OF_ARRIVALS: [&str; 3] = ["time_to_goal", "path_length", "path_efficiency"];
/// A planner with fewer arrivals than this share of the most arrivals of a planner is not ordered, and never marked as best, except
/// in success.
pub const LEAST_ARRIVALS: f64 = 0.9;

/// A run that was wanted.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'a> {
    /// The scenario it is a run of; the same for all planners.
    pub scenario: &'a str,
    /// Name of the scenario's request.
    pub request: &'a str,
    /// Name of its location.
    pub location: &'a str,
    /// What drove the robot.
    pub planner: &'a PlannerName,
    /// The seed of the simulation.
    pub seed: u64,
    /// The report, or why there is none.
    pub result: Result<&'a Report, &'a str>,
}

impl<'a> Entry<'a> {
    /// What two planners have in common where they ran the same.
    const fn key(&self) -> Key<'a> {
        (self.scenario, self.seed)
    }
}

/// Scenario and seed.
type Key<'a> = (&'a str, u64);

/// What is drawn again and again for the intervals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resampled {
    /// Scenarios, each with all its seeds.
    Scenarios(usize),
    /// Seeds: there is one scenario, and what is found holds for it alone.
    Seeds(usize),
}

/// Planners compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Signature of the thresholds of all reports.
    pub thresholds: String,
    /// The planners; differences are against the first.
    pub planners: Vec<PlannerName>,
    /// Scenarios there are.
    pub scenarios: usize,
    /// Runs that the planners have in common, the same scenario and seed.
    pub common: usize,
    /// What the intervals are made of.
    pub resampled: Resampled,
    /// What became of the runs, by planner.
    pub outcomes: Vec<Outcome>,
    /// Whether a planner arrived too seldom to be marked as best, by planner ([`LEAST_ARRIVALS`]).
    pub seldom: Vec<bool>,
    /// Key figures without a row: some planners have values, and no common run has one of every planner.
    pub unpaired: Vec<&'static Sheet>,
    /// Figures, by metric in the order of the tables.
    pub rows: Vec<Row>,
}

/// Why planners are not compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompareFault {
    /// There is nobody to compare with.
    #[error("{found} cannot be compared; at least two planners are needed")]
    Few {
        /// Planners there are, in words.
        found: String,
    },
    /// A planner has no run at all.
    #[error("`{planner}` has no run here; those that have are {known}")]
    Unknown {
        /// The planner.
        planner: PlannerName,
        /// Planners there are.
        known: String,
    },
    /// There is no scenario and seed that all of them ran.
    #[error("the planners have no run in common: no scenario and seed was run with {planners}")]
    Apart {
        /// Planners asked for.
        planners: String,
    },
    /// The figures do not mean the same.
    #[error(transparent)]
    Unlike(#[from] PoolFault),
}

/// Planners under test among the runs: neither the reference, which makes the scenario, nor the run without a robot; where only one
/// is under test, it is compared with the reference.
#[must_use]
pub fn under_test(entries: &[Entry<'_>]) -> Vec<PlannerName> {
    let all: BTreeSet<&PlannerName> =
        entries.iter().map(|entry| entry.planner).filter(|it| !it.is_no_robot()).collect();
    let tested = all.iter().filter(|planner| !planner.is_reference()).count();
    let chosen = all.into_iter().filter(|planner| tested < 2 || !planner.is_reference());
    chosen.cloned().collect()
}

/// Whether these can be compared.
///
/// # Errors
/// [`CompareFault::Few`].
pub fn enough(planners: &[PlannerName]) -> Result<(), CompareFault> {
    if planners.len() > 1 {
        return Ok(());
    }
    let found = if planners.is_empty() { "nobody".to_owned() } else { format!("{} alone", listed(planners)) };
    Err(CompareFault::Few { found })
}

/// Compares `planners` with the first of them.
///
/// # Errors
/// [`CompareFault`]: fewer than two planners, a planner without runs, none in common, or figures of other thresholds or formulas.
pub fn compare(entries: &[Entry<'_>], planners: &[PlannerName]) -> Result<Comparison, CompareFault> {
    let known: BTreeSet<&PlannerName> =
        entries.iter().map(|entry| entry.planner).filter(|planner| !planner.is_no_robot()).collect();
    if let Some(planner) = planners.iter().find(|planner| !known.contains(planner)) {
        return Err(CompareFault::Unknown { planner: planner.clone(), known: listed(known) });
    }
    enough(planners)?;
    let results =
        entries.iter().filter_map(|entry| Some(PooledRun { scenario: entry.scenario, report: entry.result.ok()? }));
    let thresholds = alike(&results.collect::<Vec<_>>())?;
    let by_planner: Vec<BTreeMap<Key<'_>, &Entry<'_>>> = planners
        .iter()
        .map(|planner| entries.iter().filter(|it| it.planner == planner).map(|it| (it.key(), it)).collect())
        .collect();
    let common: BTreeSet<Key<'_>> = by_planner
        .iter()
        .map(|own| own.keys().copied().collect::<BTreeSet<_>>())
        .reduce(|all, own| all.intersection(&own).copied().collect())
        .unwrap_or_default();
    if common.is_empty() {
        return Err(CompareFault::Apart { planners: listed(planners) });
    }
    let scenarios: BTreeSet<&str> = common.iter().map(|(scenario, _)| *scenario).collect();
    let resampled =
        if scenarios.len() > 1 { Resampled::Scenarios(scenarios.len()) } else { Resampled::Seeds(common.len()) };
    let references = References::of(entries);
    let seldom = seldom(&by_planner, &common);
    let wanted = KEY_FIGURES.iter().chain(&BESIDE).filter_map(|id| sheet(id));
    let figures = rows::Basis { planners: &by_planner, common: &common, resampled, seldom: &seldom };
    let rows: Vec<Row> = wanted.filter_map(|metric| rows::row(metric, &figures)).collect();
    let has_row = |metric: &&'static Sheet| rows.iter().any(|row| row.metric.id == metric.id);
    let has_value = |metric: &&'static Sheet| {
        let mut own = by_planner.iter().flat_map(BTreeMap::values);
        own.any(|entry| value(entry, metric).is_some())
    };
    let key = KEY_FIGURES.iter().filter_map(|id| sheet(id));
    let unpaired = key.filter(|metric| !has_row(metric) && has_value(metric)).collect();
    Ok(Comparison {
        thresholds,
        planners: planners.to_vec(),
        scenarios: entries.iter().map(|entry| entry.scenario).collect::<BTreeSet<_>>().len(),
        common: common.len(),
        resampled,
        outcomes: planners.iter().map(|planner| outcome::of(planner, entries, &references)).collect(),
        seldom,
        unpaired,
        rows,
    })
}

/// The value of a metric in a run. A run without a result is no success and no arrival; of anything else it has no value. A metric of a
/// completed trip has no value where the robot did not arrive.
fn value(entry: &Entry<'_>, metric: &Sheet) -> Option<f64> {
    match entry.result {
        Ok(_) if OF_TRIP.contains(&metric.id) && arrived(entry) == Some(false) => None,
        Ok(report) => report.metric(metric.id)?.value,
        Err(_) => matches!(metric.id, "success" | "arrived").then_some(0.0),
    }
}

/// Whether the robot arrived; `None` where its goal is not known.
fn arrived(entry: &Entry<'_>) -> Option<bool> {
    entry.result.map_or(Some(false), |report| report.metric("arrived")?.value.map(|value| value > 0.5))
}

/// Whether a planner arrived in too few of the common runs to be marked as best, by planner.
fn seldom(planners: &[BTreeMap<Key<'_>, &Entry<'_>>], common: &BTreeSet<Key<'_>>) -> Vec<bool> {
    let known = |own: &BTreeMap<Key<'_>, &Entry<'_>>| {
        let of: Vec<bool> = common.iter().filter_map(|key| arrived(own.get(key)?)).collect();
        (!of.is_empty()).then(|| count(of.iter().filter(|arrived| **arrived).count()) / count(of.len()))
    };
    let shares: Vec<Option<f64>> = planners.iter().map(known).collect();
    let most = shares.iter().flatten().copied().fold(0.0, f64::max);
    shares.iter().map(|share| share.is_some_and(|share| share < LEAST_ARRIVALS * most)).collect()
}

/// `mppi, nav2can and orca`.
fn listed<'a>(planners: impl IntoIterator<Item = &'a PlannerName>) -> String {
    let names: Vec<&str> = planners.into_iter().map(PlannerName::as_str).collect();
    match names.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
pub(crate) mod fixture {
    use super::*;
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, recording};

    /// A run of a robot that passes somebody so far aside, m; without a distance the run has no result.
    #[derive(Debug, Clone)]
    pub(crate) struct Made {
        pub(crate) scenario: &'static str,
        pub(crate) planner: PlannerName,
        pub(crate) seed: u64,
        pub(crate) report: Option<Report>,
    }

    pub(crate) fn made(scenario: &'static str, planner: &str, seed: u64, aside_m: Option<f64>) -> Made {
        let planner: PlannerName = planner.parse().unwrap();
        let report = aside_m.map(|aside_m| {
            let mut run = recording(&[Walk::robot(-4., 0., 0.8, 0.), Walk::human(1, 0., aside_m, 0., 0.)], 10.0, 0.1);
            run.header.planner = planner.clone();
            run.header.seed = seed;
            crate::score(&Evidence::of(&run))
        });
        Made { scenario, planner, seed, report }
    }

    /// Three scenarios, three seeds each: `wide` keeps 0.8 m more distance than `near`, whatever the scenario.
    pub(crate) fn batch() -> Vec<Made> {
        let mut all = Vec::new();
        for (scenario, more) in [("a", 0.0), ("b", 0.4), ("c", 1.5)] {
            for seed in 1..=3_u32 {
                let vary = 0.02 * f64::from(seed);
                all.push(made(scenario, "near", seed.into(), Some(0.8 + more + vary)));
                all.push(made(scenario, "wide", seed.into(), Some(1.6 + more + vary)));
            }
        }
        all
    }

    pub(crate) fn entries(made: &[Made]) -> Vec<Entry<'_>> {
        fn entry(one: &Made) -> Entry<'_> {
            let Made { scenario, planner, seed, report } = one;
            let result = report.as_ref().ok_or("J-DRIVER: it is gone");
            Entry { scenario, request: scenario, location: "hall", planner, seed: *seed, result }
        }
        made.iter().map(entry).collect()
    }

    pub(crate) fn names(names: &[&str]) -> Vec<PlannerName> {
        names.iter().map(|name| name.parse().unwrap()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::fixture::{batch, entries, made, names};
    use super::*;

    #[test]
    fn the_reference_is_compared_only_where_one_planner_is_under_test() {
        let mut all =
            vec![made("a", "reference", 1, Some(1.0)), made("a", "none", 1, Some(1.0)), made("a", "orca", 1, None)];
        assert_eq!(under_test(&entries(&all)), names(&["orca", "reference"]));
        all.push(made("a", "rpp", 1, Some(1.0)));
        assert_eq!(under_test(&entries(&all)), names(&["orca", "rpp"]));
    }

    #[test]
    fn what_cannot_be_compared_is_refused_by_name() {
        let all = batch();
        let said = |planners: &[&str]| compare(&entries(&all), &names(planners)).unwrap_err().to_string();
        assert_eq!(said(&["near"]), "near alone cannot be compared; at least two planners are needed");
        assert_eq!(said(&["near", "orca"]), "`orca` has no run here; those that have are near and wide");
        let apart = [made("a", "near", 1, Some(1.0)), made("a", "wide", 2, Some(1.0))];
        let found = compare(&entries(&apart), &names(&["near", "wide"])).unwrap_err();
        assert!(found.to_string().contains("no scenario and seed was run with near and wide"), "{found}");
        let mut all = batch();
        all[4].report.as_mut().unwrap().thresholds = "mine-0".into();
        assert!(matches!(compare(&entries(&all), &names(&["near", "wide"])), Err(CompareFault::Unlike(_))));
    }

    #[test]
    fn only_what_all_planners_ran_is_compared_and_what_others_ran_changes_nothing() {
        let of = |all: &[fixture::Made]| compare(&entries(all), &names(&["near", "wide"])).unwrap();
        let mut all = batch();
        let before = of(&all);
        assert_eq!((before.common, before.scenarios, before.resampled), (9, 3, Resampled::Scenarios(3)));
        // Alone in an easy scenario, `near` would be the one that keeps its distance.
        all.extend((1..=9).map(|seed| made("easy", "near", seed, Some(6.0))));
        let after = of(&all);
        assert_eq!((after.common, after.scenarios), (9, 4));
        assert_eq!(after.rows, before.rows);
        assert_eq!(after.outcomes[0].runs, 18, "the outcomes tell of all runs");
    }
}
