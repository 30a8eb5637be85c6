//! Figures of a folder of bundles: what each planner did over all scenarios, and how stable their order is.

use serde_json::json;
use socrates_draw::Figures;
use socrates_scoring::metrics::{Aggregation, KEY_FIGURES, sheet};
use socrates_scoring::{Cell, Pool, PooledRun, Ranking, pool};

use crate::exit::Diagnostic;
use crate::output::Printer;

/// Said in place of an order.
const NOT_COMPARED: &str = "not compared: no run that all planners have";
/// Name of the table beside the page.
pub(crate) const FILE: &str = "planners.csv";

/// The reports of each scenario as one table, or why they are not put together.
pub(crate) fn of(reports: &[(String, Vec<socrates_model::Report>)]) -> Result<Pool, Diagnostic> {
    let runs: Vec<PooledRun<'_>> = reports
        .iter()
        .flat_map(|(scenario, reports)| reports.iter().map(move |report| PooledRun { scenario, report }))
        .collect();
    pool(&runs).map_err(|why| Diagnostic::input(format!("the figures are not put together: {why}"), why.hint()))
}

/// Robots among the planners: a run without one has no figures of its own.
fn planners(pool: &Pool) -> Vec<&str> {
    let all =
        pool.cells.iter().filter(|cell| Some(cell.metric) == sheet("robot_speed_mean") && cell.scenario.is_empty());
    all.filter(|cell| cell.values > 0).map(|cell| cell.planner.as_str()).collect()
}

/// `0.43 [0.40, 0.47] m`, and of how many runs where not all have a value.
fn told(cell: &Cell) -> String {
    let Some(estimate) = cell.estimate else { return "n/a".to_owned() };
    let unit =
        if cell.metric.aggregation() == Aggregation::Share { String::new() } else { format!(" {}", cell.metric.unit) };
    let interval = cell.interval.map_or_else(String::new, |(low, high)| format!(" [{low:.2}, {high:.2}]"));
    let of = if cell.values < cell.runs { format!(" · {} of {}", cell.values, cell.runs) } else { String::new() };
    format!("{estimate:.2}{interval}{unit}{of}")
}

/// `mppi > reference = reactive · tau 0.87 over 12`.
fn order(pool: &Pool, ranking: &Ranking) -> String {
    let figure = |planner: &str| pool.overall(planner, ranking.metric.id).and_then(|cell| cell.estimate);
    let mut text = String::new();
    let mut before: Option<f64> = None;
    for planner in &ranking.planners {
        let now = figure(planner);
        if let (Some(before), Some(now)) = (before, now) {
            text.push_str(if before.total_cmp(&now).is_eq() { " = " } else { " > " });
        }
        text.push_str(planner);
        before = now;
    }
    if ranking.scenarios < pool.scenarios {
        text.push_str(&format!(" · over the {} of {} scenarios that all ran", ranking.scenarios, pool.scenarios));
    }
    let tau = ranking.tau.map_or_else(String::new, |tau| format!(" · tau {tau:.2} over {}", ranking.parts));
    text + &tau
}

/// The order by a metric, or that there is none; `None` where nobody is to be compared.
fn ordered(pool: &Pool, metric: &str) -> Option<String> {
    let ranking = pool.ranking(metric).map(|ranking| order(pool, ranking));
    let have = |planner: &&str| pool.overall(planner, metric).is_some_and(|cell| cell.values > 0);
    let neutral = socrates_scoring::metrics::sheet(metric).is_none_or(|sheet| sheet.direction.sign() == 0);
    let several = planners(pool).iter().filter(|planner| have(planner)).count() > 1;
    ranking.or_else(|| (several && !neutral).then(|| NOT_COMPARED.to_owned()))
}

/// The table of the page.
pub(crate) fn table(pool: &Pool) -> Figures {
    let planners = planners(pool);
    let head = std::iter::once("figure").chain(planners.iter().copied()).chain(["order"]).map(str::to_owned).collect();
    let row = |metric: &str| {
        let cells = planners.iter().map(|planner| pool.overall(planner, metric).map_or_else(String::new, told));
        let order = ordered(pool, metric).unwrap_or_default();
        std::iter::once(metric.replace('_', " ")).chain(cells).chain([order]).collect()
    };
    Figures { head, rows: KEY_FIGURES.iter().map(|metric| row(metric)).collect(), thresholds: pool.thresholds.clone() }
}

/// Prints the figures, one line per metric and planner.
pub(crate) fn print(talk: &Printer, pool: &Pool) {
    for metric in KEY_FIGURES {
        for planner in planners(pool) {
            if let Some(cell) = pool.overall(planner, metric) {
                talk.line(&format!("figure     {metric} · {planner}: {}", told(cell)));
            }
        }
        if let Some(order) = ordered(pool, metric) {
            talk.line(&format!("order      {metric}: {order}"));
        }
    }
}

/// The same for programs.
pub(crate) fn result(pool: &Pool) -> serde_json::Value {
    let cells: Vec<_> = pool
        .cells
        .iter()
        .filter(|cell| cell.scenario.is_empty())
        .map(|cell| {
            json!({
                "planner": cell.planner, "metric": cell.metric.id, "runs": cell.runs, "values": cell.values,
                "estimate": cell.estimate, "interval": cell.interval,
            })
        })
        .collect();
    let rankings: Vec<_> = pool
        .rankings
        .iter()
        .map(|ranking| {
            json!({ "metric": ranking.metric.id, "planners": ranking.planners, "scenarios": ranking.scenarios, "tau": ranking.tau, "parts": ranking.parts })
        })
        .collect();
    json!({ "thresholds": pool.thresholds, "scenarios": pool.scenarios, "cells": cells, "rankings": rankings })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use socrates_model::{Digest, MetricValue, Report, RunId, Unit, Verdict};

    use super::*;

    /// A report with a speed, a distance and whether the goal was reached.
    fn report(planner: &str, seed: u64, values: [(&str, &str, Option<f64>); 3]) -> Report {
        let value = |(id, unit, value): (&str, &str, Option<f64>)| MetricValue {
            id: id.to_owned(),
            unit: Unit::new(unit),
            value,
            direction: 1,
            version: 1,
            missing: None,
            note: String::new(),
        };
        Report {
            format: socrates_model::FORMAT,
            run: RunId::new("a.run").unwrap(),
            planner: planner.parse().unwrap(),
            seed,
            recording: Digest::of(b"run"),
            verdict: Verdict::Realised,
            verdict_text: String::new(),
            score: 1.0,
            clauses: Vec::new(),
            metrics: values.map(value).to_vec(),
            thresholds: "standard-1".to_owned(),
            robot_text: String::new(),
            success: true,
            story: Vec::new(),
            encounter_gaps_s: BTreeMap::new(),
            simulated_s: 9.0,
            repair: None,
        }
    }

    fn batch() -> Vec<(String, Vec<Report>)> {
        let of = |planner: &str, seed: u64, meters: Option<f64>| {
            let moves = (planner != "none").then_some(0.6);
            let goal = moves.map(|_| 1.0);
            report(
                planner,
                seed,
                [("robot_speed_mean", "m/s", moves), ("human_distance_min", "m", meters), ("success", "0/1", goal)],
            )
        };
        let scenario = |name: &str, more: f64| {
            let runs = (1..=3).flat_map(|seed| {
                [
                    of("far", seed, Some(1.0 + more)),
                    of("near", seed, (seed > 1).then_some(0.5 + more)),
                    of("none", seed, None),
                ]
            });
            (name.to_owned(), runs.collect())
        };
        vec![scenario("a", 0.0), scenario("b", 0.2)]
    }

    #[test]
    fn figures_have_their_interval_their_order_and_how_stable_it_is() {
        let pool = of(&batch()).unwrap();
        let table = table(&pool);
        assert_eq!(table.head, ["figure", "far", "near", "order"]);
        let row = |name: &str| table.rows.iter().find(|row| row[0] == name).unwrap().clone();
        let distance = row("human distance min");
        assert_eq!(distance[1], "1.10 [1.00, 1.20] m");
        assert!(distance[2].starts_with("0.60 [") && distance[2].ends_with("] m · 4 of 6"), "{distance:?}");
        assert_eq!(distance[3], "far > near · tau 1.00 over 2");
        // Whoever is as good is no better, and no part of it ranks them.
        assert_eq!(row("success")[3], "far = near");
        assert_eq!(row("time to goal")[1], "n/a");
        assert_eq!(result(&pool)["thresholds"], "standard-1");
    }

    #[test]
    fn runs_of_other_thresholds_are_refused_by_name_and_with_help() {
        let mut reports = batch();
        reports[1].1[0].thresholds = "mine-2".to_owned();
        let why = of(&reports).unwrap_err();
        assert!(why.what.contains("`b` with far and seed 1") && why.what.contains("`mine-2`"), "{}", why.what);
    }

    #[test]
    fn planners_that_ran_other_scenarios_are_not_put_in_an_order() {
        let mut reports = batch();
        reports[0].1.retain(|report| report.planner.as_str() != "near");
        let some = of(&reports).unwrap();
        let row = |pool: &Pool| table(pool).rows.iter().find(|row| row[0] == "human distance min").unwrap()[3].clone();
        assert!(row(&some).contains("over the 1 of 2 scenarios that all ran"), "{}", row(&some));
        reports[1].1.retain(|report| report.planner.as_str() == "near");
        assert_eq!(row(&of(&reports).unwrap()), NOT_COMPARED);
    }
}
