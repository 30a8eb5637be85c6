//! `index.csv`: every run of a folder of bundles, one row each, with the columns of every table of runs.
//!
//! Columns are known by their names. New ones stand behind those of earlier versions, and rows that an earlier version wrote have empty
//! cells there.

use serde::{Deserialize, Serialize};
use socrates_model::{Report, Run, ScenarioEnd};
use socrates_scoring::metrics::{KEY_FIGURES, key_figures};
use socrates_stream::csv::{joined, one_line};

use crate::bundle::FailedRun;

/// Name of the table.
pub(crate) const FILE: &str = "index.csv";
/// What a table of runs says of each, before the [`KEY_FIGURES`].
pub(crate) const COLUMNS: [&str; 8] = ["request", "location", "planner", "seed", "verdict", "reason", "kind", "path"];
/// Place of the kind among them.
const KIND: usize = 6;
/// What it says of each behind the [`KEY_FIGURES`]: which scenario, and what a library is asked to cover.
pub(crate) const COVERED: [&str; 7] = ["scenario", "pattern", "place", "people", "encounter", "context", DENSITY];
/// The density of people about the robot: the most within 2.5 m at once.
pub(crate) const DENSITY: &str = "density_2_5m_max";
/// Verdict of a scenario of which there is no run.
pub(crate) const FAILED: &str = ScenarioEnd::Failed.name();

/// What the runs of one scenario have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IndexedScenario<'a> {
    /// Its id.
    pub(crate) id: &'a str,
    /// Name of its request.
    pub(crate) request: &'a str,
    /// Name of its location.
    pub(crate) location: &'a str,
    /// Its folder or file, from where the table lies; empty where its bundle was not kept.
    pub(crate) path: &'a str,
    /// What it is, where it was made.
    pub(crate) traits: Option<&'a Traits>,
}

/// What a scenario is, as far as libraries are asked to cover it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Traits {
    /// Pattern of its proposal: the id of a card, where it follows one.
    pub(crate) pattern: String,
    /// Class of its place.
    pub(crate) place: String,
    /// People in it.
    pub(crate) people: usize,
    /// Sector of every meeting, with blanks between them.
    pub(crate) encounters: String,
    /// Social context of its request.
    pub(crate) context: String,
}

/// Rows of the runs of one scenario; whether it repeats another is said when they are added.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Rows(Vec<Vec<String>>);

impl Rows {
    /// A row per run, those without a result last.
    pub(crate) fn of(scenario: IndexedScenario<'_>, reports: &[Report], failed: &[FailedRun]) -> Self {
        let rows = reports.iter().map(|report| {
            let mut row = row(
                scenario,
                [report.planner.as_str(), &report.seed.to_string(), report.verdict.name(), &report.verdict_text],
            );
            row.extend(KEY_FIGURES.iter().map(|id| {
                let value = key_figures(report).find(|metric| metric.id == *id).and_then(|metric| metric.value);
                value.map_or_else(String::new, |value| value.to_string())
            }));
            row.extend(covered(scenario, report.metric(DENSITY).and_then(|metric| metric.value)));
            row
        });
        let without = failed.iter().map(|failed| {
            let Run { planner, seed } = &failed.run;
            let cells = [planner.as_str(), &seed.to_string(), FAILED, &failed.told()];
            let mut row = row(scenario, cells);
            row.extend(KEY_FIGURES.iter().map(|_| String::new()));
            row.extend(covered(scenario, None));
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
            // Rows of an earlier version are shorter.
            row.resize(head().count(), String::new());
            row
        }));
    }

    /// Adds a scenario without a run, and why there is none.
    pub(crate) fn add_failed(&mut self, scenario: IndexedScenario<'_>, why: &str, repeats: bool) {
        let mut row = row(scenario, ["", "", FAILED, why]);
        row.extend(KEY_FIGURES.iter().map(|_| String::new()));
        row.extend(covered(scenario, None));
        self.add(Rows(vec![row]), repeats);
    }

    /// The table. A figure without a value is an empty cell.
    pub(crate) fn csv(&self) -> String {
        let mut text = joined(head()) + "\n";
        for row in &self.rows {
            text.push_str(&joined(row));
            text.push('\n');
        }
        text
    }
}

/// Names of all columns.
fn head() -> impl Iterator<Item = &'static str> {
    COLUMNS.into_iter().chain(KEY_FIGURES).chain(COVERED)
}

/// The last cells of a row, in the order of [`COVERED`].
fn covered(scenario: IndexedScenario<'_>, density: Option<f64>) -> [String; 7] {
    let IndexedScenario { id, traits, .. } = scenario;
    let told = traits.cloned().unwrap_or_default();
    let people = traits.map_or_else(String::new, |traits| traits.people.to_string());
    let density = density.map_or_else(String::new, |density| density.to_string());
    [id.to_owned(), told.pattern, told.place, people, told.encounters, one_line(&told.context), density]
}

/// Whether a scenario repeats an earlier one of the folder (P-DUP), in a word.
fn kind(repeats: bool) -> String {
    if repeats { "repeat" } else { "distinct" }.to_owned()
}

/// The first cells of a row, in the order of [`COLUMNS`]; its kind is said later.
fn row(scenario: IndexedScenario<'_>, [planner, seed, verdict, reason]: [&str; 4]) -> Vec<String> {
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
        let scenario =
            IndexedScenario { id: "hall-1", request: "hall", location: "office, west", path: "hall-1", traits: None };
        index.add_failed(scenario, "no author\n  T-NET \"gone\"", false);
        let text = index.csv();
        let table = socrates_stream::csv::Table::read(&text).unwrap();
        assert_eq!(table.rows.len(), 1, "{text}");
        assert_eq!((table.head.cells.len(), table.rows[0].cells.len()), (27, 27));
        let wanted = ["hall", "office, west", "", "", "failed", "no author T-NET \"gone\"", "distinct", "hall-1"];
        assert_eq!(table.rows[0].cells[..8], wanted);
        assert_eq!(table.rows[0].cells[20..], ["hall-1", "", "", "", "", "", ""]);
    }

    #[test]
    fn rows_of_an_earlier_version_have_empty_cells_in_new_columns() {
        let earlier: Vec<String> = (0..20).map(|cell| cell.to_string()).collect();
        let mut index = Index::default();
        index.add(serde_json::from_value(serde_json::json!([earlier])).unwrap(), true);
        let table = socrates_stream::csv::Table::read(&index.csv()).unwrap();
        let cells = &table.rows[0].cells;
        assert_eq!((cells.len(), cells[6].as_str(), cells[19].as_str()), (27, "repeat", "19"));
        assert!(cells[20..].iter().all(String::is_empty), "{cells:?}");
    }
}
