//! Figures of a folder of bundles: what each planner did over all scenarios, and how stable their order is.

use serde_json::json;
use socrates_draw::Figures;
use socrates_scoring::{Cell, Pool, PooledRun, Ranking, pool};

use crate::exit::Complaint;
use crate::talk::Talk;

/// Figures that are shown; `planners.csv` has all.
const SHOWN: [&str; 6] =
    ["success", "human_collisions", "human_distance_min", "space_compliance", "time_to_goal", "stalled_time"];
/// Name of the table beside the page.
pub(crate) const FILE: &str = "planners.csv";

/// The reports of each scenario as one table, or why they are not put together.
pub(crate) fn of(reports: &[(String, Vec<socrates_model::Report>)]) -> Result<Pool, Complaint> {
    let runs: Vec<PooledRun<'_>> = reports
        .iter()
        .flat_map(|(scenario, reports)| reports.iter().map(move |report| PooledRun { scenario, report }))
        .collect();
    pool(&runs).map_err(|why| Complaint::input(format!("the figures are not put together: {why}"), why.hint()))
}

/// Robots among the planners: a run without one has no figures of its own.
fn planners(pool: &Pool) -> Vec<&str> {
    let all = pool.cells.iter().filter(|cell| cell.metric.id == "robot_speed_mean" && cell.scenario.is_empty());
    all.filter(|cell| cell.values > 0).map(|cell| cell.planner.as_str()).collect()
}

/// `0.43 [0.40, 0.47] m`, and of how many runs where not all have a value.
fn told(cell: &Cell) -> String {
    let Some(estimate) = cell.estimate else { return "n/a".to_owned() };
    let unit = if cell.metric.unit == "0/1" { String::new() } else { format!(" {}", cell.metric.unit) };
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
    let tau = ranking.tau.map_or_else(String::new, |tau| format!(" · tau {tau:.2} over {}", ranking.parts));
    text + &tau
}

/// The table of the page.
pub(crate) fn table(pool: &Pool) -> Figures {
    let planners = planners(pool);
    let head = std::iter::once("figure").chain(planners.iter().copied()).chain(["order"]).map(str::to_owned).collect();
    let row = |metric: &str| {
        let cells = planners.iter().map(|planner| pool.overall(planner, metric).map_or_else(String::new, told));
        let order = pool.ranking(metric).map_or_else(String::new, |ranking| order(pool, ranking));
        std::iter::once(metric.replace('_', " ")).chain(cells).chain([order]).collect()
    };
    Figures { head, rows: SHOWN.iter().map(|metric| row(metric)).collect(), thresholds: pool.thresholds.clone() }
}

/// Prints the figures, one line per metric and planner.
pub(crate) fn print(talk: &Talk, pool: &Pool) {
    for metric in SHOWN {
        for planner in planners(pool) {
            if let Some(cell) = pool.overall(planner, metric) {
                talk.line(&format!("figure     {metric} · {planner}: {}", told(cell)));
            }
        }
        if let Some(ranking) = pool.ranking(metric) {
            talk.line(&format!("order      {metric}: {}", order(pool, ranking)));
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
            json!({ "metric": ranking.metric.id, "planners": ranking.planners, "tau": ranking.tau, "parts": ranking.parts })
        })
        .collect();
    json!({ "thresholds": pool.thresholds, "cells": cells, "rankings": rankings })
}
