//! The tables: their columns, and the cells of a row as text.

use socrates_model::fault::FailureClass;
use socrates_model::wire::Recorded;

use crate::ledger::{AttemptRow, ScenarioRow};
use crate::results::{CellResult, Figures, Limited, Pairing};
use crate::spec::Cell;

/// Columns of `attempts.csv`. Times are of the level's clock, ms after the batch was submitted.
pub const ATTEMPTS: &str =
    "cell,scenario,stage,revision,attempt,begun_ms,ended_ms,outcome,recorded,tokens_in,tokens_out";
/// Columns of `scenarios.csv`.
pub const SCENARIOS: &str = "cell,scenario,result,realised,first_cut,begun_ms,ended_ms,attempts,asks,jobs,tokens_in,tokens_out,failed_stage,failed_class";
/// Columns of `cells.csv`.
pub const CELLS: &str = "cell,workload,fault,rate,tries,policy,scenarios,realised,success,success_low,success_high,first_cut,first_cut_low,first_cut_high,attempts,jobs,amplification,asks,tokens_in,tokens_out,tokens_per_realised,time_p50_s,time_p95_s,mean_asks,mean_asks_limit,mean_time_s,mean_time_limit_s,recoveries,recovery_p50_s,recovery_p95_s,recovery_p99_s,only_first_policy,only_this_policy,difference,difference_low,difference_high,mcnemar_p,faults_scheduled,faults_struck,lost,doubled,complaints,first_complaint";

/// A number with four digits after the point.
pub(crate) fn real(value: f64) -> String {
    format!("{value:.4}")
}

fn maybe<T>(value: Option<T>, show: impl Fn(T) -> String) -> String {
    value.map_or_else(String::new, show)
}

fn bit(value: bool) -> String {
    u8::from(value).to_string()
}

const fn said(recorded: Recorded) -> &'static str {
    match recorded {
        Recorded::Accepted => "accepted",
        Recorded::Duplicate => "duplicate",
        Recorded::Late => "late",
        Recorded::Busy => "busy",
    }
}

/// A class of failures, as tables and plots call it.
#[must_use]
pub const fn class_name(class: FailureClass) -> &'static str {
    match class {
        FailureClass::Transient => "transient",
        FailureClass::Overload => "overload",
        FailureClass::Semantic => "semantic",
        FailureClass::Unparsable => "unparsable",
        FailureClass::WorkerDeath => "worker lost",
        FailureClass::Poison => "poison",
        FailureClass::Permanent => "permanent",
    }
}

/// A row of `attempts.csv`.
#[must_use]
pub fn attempt(cell: usize, row: &AttemptRow) -> Vec<String> {
    let [tokens_in, tokens_out] = row.tokens.map(|tokens| tokens.to_string());
    vec![
        cell.to_string(),
        row.at.scenario.to_string(),
        row.at.stage.to_string(),
        row.at.revision.to_string(),
        row.at.attempt.to_string(),
        row.begun_ms.to_string(),
        maybe(row.ended_ms, |ms| ms.to_string()),
        row.outcome.to_owned(),
        maybe(row.recorded, |recorded| said(recorded).to_owned()),
        tokens_in,
        tokens_out,
    ]
}

/// A row of `scenarios.csv`.
#[must_use]
pub fn scenario(cell: usize, row: &ScenarioRow) -> Vec<String> {
    let [tokens_in, tokens_out] = row.tokens.map(|tokens| tokens.to_string());
    vec![
        cell.to_string(),
        row.scenario.to_string(),
        maybe(row.end, |end| end.name().to_owned()),
        bit(row.succeeded()),
        bit(row.first_cut),
        maybe(row.begun_ms, |ms| ms.to_string()),
        maybe(row.ended_ms, |ms| ms.to_string()),
        row.attempts.to_string(),
        row.asks.to_string(),
        row.jobs.to_string(),
        tokens_in,
        tokens_out,
        maybe(row.failed, |(stage, _)| stage.to_string()),
        maybe(row.failed, |(_, class)| class_name(class).to_owned()),
    ]
}

/// The first columns of a row about a cell: its number and what it has of each factor.
pub(crate) fn of_cell(cell: &Cell) -> [String; 6] {
    [
        cell.number.to_string(),
        cell.workload.name.clone(),
        cell.strike.shown(),
        cell.rate.to_string(),
        cell.tries.to_string(),
        cell.policy.name.clone(),
    ]
}

/// A row of `cells.csv`.
#[must_use]
pub fn cell(result: &CellResult, figures: &Figures, means: &Limited, pairing: Option<&Pairing>) -> Vec<String> {
    let [tokens_in, tokens_out] = figures.tokens.map(|tokens| tokens.to_string());
    let [p50, p95, p99] = figures.recovery_s.map_or_else(Default::default, |times| times.map(real));
    let paired = |of: &dyn Fn(&Pairing) -> String| pairing.map_or_else(String::new, of);
    let mut row = of_cell(&result.cell).to_vec();
    row.extend([
        result.scenarios.len().to_string(),
        figures.successes.to_string(),
        real(figures.success.estimate),
        real(figures.success.low),
        real(figures.success.high),
        real(figures.first_cut.estimate),
        real(figures.first_cut.low),
        real(figures.first_cut.high),
        figures.attempts.to_string(),
        figures.jobs.to_string(),
        real(figures.amplification()),
        figures.asks.to_string(),
        tokens_in,
        tokens_out,
        maybe(figures.tokens_per_success(), |tokens| format!("{tokens:.0}")),
        maybe(figures.time_s, |(p50, _)| real(p50)),
        maybe(figures.time_s, |(_, p95)| real(p95)),
        real(means.asks),
        real(means.asks_limit),
        real(means.time_s),
        real(means.time_limit_s),
        result.recoveries.len().to_string(),
        p50,
        p95,
        p99,
        paired(&|pair| pair.only_first.to_string()),
        paired(&|pair| pair.only_this.to_string()),
        paired(&|pair| real(pair.difference.estimate)),
        paired(&|pair| real(pair.difference.low)),
        paired(&|pair| real(pair.difference.high)),
        paired(&|pair| real(pair.p)),
        result.tally().scheduled.to_string(),
        result.tally().struck.to_string(),
        result.safety.lost.to_string(),
        result.safety.doubled.to_string(),
        result.safety.complaints.to_string(),
        result.safety.first.clone(),
    ]);
    row
}
