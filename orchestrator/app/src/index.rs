//! `index.csv`: every run of a folder of bundles, one row each, with the columns of every table of runs.

use std::path::Path;

use serde::{Deserialize, Serialize};
use socrates_model::{Report, Run, ScenarioEnd};
use socrates_scoring::metrics::{KEY_FIGURES, key_figures};
use socrates_stream::csv::{joined, one_line};

use crate::bundle::FailedRun;
use crate::exit::Complaint;
use crate::files;

/// Name of the table.
pub(crate) const FILE: &str = "index.csv";
/// What a table of runs says of each, before the [`KEY_FIGURES`].
pub(crate) const COLUMNS: [&str; 8] = ["request", "location", "planner", "seed", "verdict", "reason", "kind", "path"];
/// Place of the kind among them.
const KIND: usize = 6;
/// Verdict of a scenario of which there is no run.
pub(crate) const FAILED: &str = ScenarioEnd::Failed.name();

/// What the runs of one scenario have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scenario<'a> {
    /// Name of its request.
    pub(crate) request: &'a str,
    /// Name of its location.
    pub(crate) location: &'a str,
    /// Its folder or file, from where the table lies; empty where its bundle was not kept.
    pub(crate) path: &'a str,
}

/// Rows of the runs of one scenario; whether it repeats another is said when they are added.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Rows(Vec<Vec<String>>);

impl Rows {
    /// A row per run, those without a result last.
    pub(crate) fn of(scenario: Scenario<'_>, reports: &[Report], failed: &[FailedRun]) -> Self {
        let rows = reports.iter().map(|report| {
            let mut row = row(
                scenario,
                [report.planner.as_str(), &report.seed.to_string(), report.verdict.name(), &report.verdict_text],
            );
            row.extend(KEY_FIGURES.iter().map(|id| {
                let value = key_figures(report).find(|metric| metric.id == *id).and_then(|metric| metric.value);
                value.map_or_else(String::new, |value| value.to_string())
            }));
            row
        });
        let without = failed.iter().map(|failed| {
            let Run { planner, seed } = &failed.run;
            let cells = [planner.as_str(), &seed.to_string(), FAILED, &failed.told()];
            let mut row = row(scenario, cells);
            row.extend(KEY_FIGURES.iter().map(|_| String::new()));
            row
        });
        Self(rows.chain(without).collect())
    }
}

/// The table while it is being filled.
#[derive(Debug, Clone, Default)]
pub(crate) struct Index {
    rows: Vec<Vec<String>>,
}

impl Index {
    /// Adds the runs of a scenario.
    pub(crate) fn add(&mut self, rows: Rows, repeats: bool) {
        self.rows.extend(rows.0.into_iter().map(|mut row| {
            if let Some(cell) = row.get_mut(KIND) {
                *cell = kind(repeats);
            }
            row
        }));
    }

    /// Adds a scenario without a run, and why there is none.
    pub(crate) fn add_failed(&mut self, scenario: Scenario<'_>, why: &str, repeats: bool) {
        let mut row = row(scenario, ["", "", FAILED, why]);
        row.extend(KEY_FIGURES.iter().map(|_| String::new()));
        self.add(Rows(vec![row]), repeats);
    }

    /// The table. A figure without a value is an empty cell.
    pub(crate) fn csv(&self) -> String {
        let head = COLUMNS.into_iter().chain(KEY_FIGURES);
        let mut text = joined(head) + "\n";
        for row in &self.rows {
            text.push_str(&joined(row));
            text.push('\n');
        }
        text
    }

    /// Writes the table into a folder.
    pub(crate) fn write(&self, root: &Path) -> Result<(), Complaint> {
        files::write(&root.join(FILE), self.csv().as_bytes())
    }
}

/// Whether a scenario repeats an earlier one of the folder (P-DUP), in a word.
fn kind(repeats: bool) -> String {
    if repeats { "repeat" } else { "distinct" }.to_owned()
}

/// The first cells of a row, in the order of [`COLUMNS`]; its kind is said later.
fn row(scenario: Scenario<'_>, [planner, seed, verdict, reason]: [&str; 4]) -> Vec<String> {
    [scenario.request, scenario.location, planner, seed, verdict, &one_line(reason), "", scenario.path]
        .map(str::to_owned)
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_without_a_run_has_a_row_of_as_many_cells_as_the_head() {
        let mut index = Index::default();
        let scenario = Scenario { request: "hall", location: "office, west", path: "hall-1" };
        index.add_failed(scenario, "no author\n  T-NET \"gone\"", false);
        let text = index.csv();
        let table = socrates_stream::csv::Table::read(&text).unwrap();
        assert_eq!(table.rows.len(), 1, "{text}");
        assert_eq!((table.head.cells.len(), table.rows[0].cells.len()), (20, 20));
        let wanted = ["hall", "office, west", "", "", "failed", "no author T-NET \"gone\"", "distinct", "hall-1"];
        assert_eq!(table.rows[0].cells[..8], wanted);
    }
}
