//! The page of a comparison, filled a scenario and seed at a time.

use std::path::Path;

use socrates_draw::{Beside, ComparePage, Head, MeanRow, MetricRow, Part, PlannerRow};
use socrates_model::{PlannerName, Recording, Report, Run, Verdict};
use socrates_scoring::compare::{Cause, Comparison, Outcome, Row};

use super::found::{Found, FoundScenario};
use crate::bundle::{self, Bundle};
use crate::exit::Diagnostic;
use crate::files;
use crate::opaque;
use crate::output::Printer;
use crate::progress::Progress;

/// A comparison as the page and programs have it.
pub(super) struct Rows {
    /// What became of the runs, by planner.
    pub(super) planners: Vec<PlannerRow>,
    /// Figures, by metric.
    pub(super) metrics: Vec<MetricRow>,
}

impl Rows {
    pub(super) fn of(comparison: &Comparison) -> Self {
        Self {
            planners: comparison.outcomes.iter().map(planner_row).collect(),
            metrics: comparison.rows.iter().map(metric_row).collect(),
        }
    }
}

/// Writes the page and says how many scenarios and seeds are not played on it.
pub(super) fn write(
    talk: &Printer,
    file: &Path,
    found: &Found,
    comparison: &Comparison,
    rows: &Rows,
) -> Result<usize, Diagnostic> {
    let mut page = ComparePage::default();
    let mut wanted: Vec<(usize, u64, &FoundScenario)> = Vec::new();
    for scenario in &found.scenarios {
        let mut seeds: Vec<u64> = scenario.entries().map(|entry| entry.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        wanted.extend(seeds.into_iter().enumerate().map(|(turn, seed)| (turn, seed, scenario)));
    }
    // The first seed of every scenario before the second of any.
    wanted.sort_by_key(|(turn, _, _)| *turn);
    let all = wanted.len();
    let mut progress = Progress::new(*talk, "drawing", all);
    let mut played = 0;
    for (turn, (_, seed, scenario)) in wanted.into_iter().enumerate() {
        progress.at(turn, "");
        if !add(&mut page, file, scenario, seed, &comparison.planners)? {
            break;
        }
        played += 1;
    }
    drop(progress);
    let left_out = all - played;
    let names: Vec<&str> = comparison.planners.iter().map(PlannerName::as_str).collect();
    let title = format!("{} compared", names.join(", "));
    let head = Head {
        basis: &comparison.basis(),
        thresholds: &comparison.thresholds,
        common: comparison.common,
        left_out,
        planners: &rows.planners,
        rows: &rows.metrics,
    };
    files::write(file, page.html(&title, &head).as_bytes())?;
    Ok(left_out)
}

/// Adds the runs of a scenario and seed; `false` where the page is full.
fn add(
    page: &mut ComparePage,
    file: &Path,
    scenario: &FoundScenario,
    seed: u64,
    planners: &[PlannerName],
) -> Result<bool, Diagnostic> {
    let shown = |run: &Run| run.seed == seed && planners.contains(&run.planner);
    let bundle: Bundle = bundle::read_some(&scenario.dir, |_, entry| shown(&entry.run()))?;
    let read: Vec<Run> = bundle.manifest.runs.iter().map(bundle::RunEntry::run).filter(shown).collect();
    let of = |planner: &PlannerName| -> Option<(&Recording, &Report)> {
        let mut runs = read.iter().zip(&bundle.runs);
        runs.find(|(run, _)| run.planner == *planner).map(|(_, (recording, report))| (recording, report))
    };
    let runs: Vec<Option<(&Recording, &Report)>> = planners.iter().map(of).collect();
    if runs.iter().all(Option::is_none) {
        return Ok(true);
    }
    // The page of a bundle, or the file of a packed one.
    let folder = files::relative(file, &bundle::archive(&scenario.dir).unwrap_or_else(|| scenario.dir.clone()));
    Ok(page.add(&Beside {
        title: &bundle.proposal.title,
        folder,
        seed,
        location: &bundle.location,
        way: bundle.location.graph.polyline(&bundle.paths.robot),
        runs,
        hidden_order: hidden(&bundle.manifest.scenario, seed, planners),
    }))
}

/// An order of the planners that tells nothing of them and is the same every time.
fn hidden(scenario: &str, seed: u64, planners: &[PlannerName]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..planners.len()).collect();
    let run = |place: &usize| planners.get(*place).map(|planner| Run { planner: planner.clone(), seed });
    order.sort_by_key(|place| run(place).map(|run| opaque::rank(scenario, &run)));
    order
}

fn planner_row(outcome: &Outcome) -> PlannerRow {
    let of = |verdict: Verdict| outcome.verdicts.get(&verdict).copied().unwrap_or_default();
    let seen = [
        (of(Verdict::Realised), "realised", "realised", "the scenario happened as asked"),
        (of(Verdict::RealisedLate), "late", "realised late", "the scenario happened, some of it with a shift in time"),
        (
            outcome.without_result,
            "failed",
            "no result",
            "the driver failed, or the simulation was refused; counted as no success",
        ),
    ];
    let causes = Cause::ALL.map(|cause| (outcome.causes.get(&cause).copied().unwrap_or_default(), cause));
    let lost = causes.into_iter().map(|(count, cause)| {
        let (key, words) = in_words(cause);
        (count, key, words, cause.told())
    });
    let [realised, late, failed] = seen;
    let parts = [realised, late].into_iter().chain(lost).chain([failed]);
    PlannerRow {
        name: outcome.planner.to_string(),
        runs: outcome.runs,
        parts: parts.map(|(count, key, words, about)| Part { key, words, about, count }).collect(),
        success: outcome.success,
        contact: outcome.contact,
    }
}

/// Color and name of a cause on the page.
const fn in_words(cause: Cause) -> (&'static str, &'static str) {
    match cause {
        Cause::HeldPeople => ("robot", "prevented: people held up"),
        Cause::Elsewhere => ("robot", "prevented: robot elsewhere"),
        Cause::Robot => ("robot", "prevented by the robot"),
        Cause::Scenario => ("scenario", "nor with the reference"),
        Cause::Unknown => ("scenario", "not realised, no reference"),
    }
}

fn metric_row(row: &Row) -> MetricRow {
    let differences = std::iter::once(None).chain(row.differences.iter().map(|it| Some((it.estimate, it.interval))));
    let means = row.means.iter().zip(differences).map(|(mean, difference)| MeanRow {
        mean: mean.estimate,
        interval: mean.interval,
        parts: mean.parts.clone(),
        difference,
    });
    let order = row.order.as_ref();
    MetricRow {
        id: row.metric.id,
        unit: row.metric.unit_shown().unwrap_or_default(),
        about: row.metric.about,
        sign: row.metric.direction.sign(),
        runs: row.runs,
        without: row.without.clone(),
        means: means.collect(),
        order: order
            .map_or_else(Vec::new, |order| order.places.iter().copied().zip(order.ties.iter().copied()).collect()),
        stable: order.and_then(|order| order.stable),
        best: order.map_or_else(Vec::new, |order| order.best.clone()),
        marked: row.best(),
        decimals: row.decimals(),
        unordered: order.map_or_else(Vec::new, |order| {
            (0..row.means.len()).filter(|place| !order.places.contains(place)).collect()
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hidden_order_is_the_same_every_time_and_not_always_that_of_the_names() {
        let planners: Vec<PlannerName> = ["mppi", "nav2can", "orca"].iter().map(|name| name.parse().unwrap()).collect();
        let of = |seed| hidden("hall", seed, &planners);
        assert_eq!(of(1), of(1));
        let orders: std::collections::BTreeSet<Vec<usize>> = (1..=20).map(of).collect();
        assert!(orders.len() > 3, "{orders:?}");
        let mut sorted = of(3);
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2]);
    }
}
