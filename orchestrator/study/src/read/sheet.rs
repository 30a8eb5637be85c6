//! Tables with a head line.

use std::collections::BTreeMap;

use crate::problem::Problem;

/// Most lines of a table.
const MAX_LINES: usize = 2_000_000;

/// A table: its head, and its lines with their numbers.
#[derive(Debug)]
pub(crate) struct Sheet {
    /// Names of the columns.
    pub(crate) head: Vec<String>,
    /// Lines: number from 1, and cells.
    pub(crate) lines: Vec<(u64, Vec<String>)>,
    places: BTreeMap<String, usize>,
    file: String,
}

impl Sheet {
    /// Reads CSV whose first line is the head.
    pub(crate) fn read(text: &str, file: &str) -> Result<Self, Problem> {
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut lines: Vec<(u64, Vec<String>)> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|why| Problem::new(file, why.to_string(), "save it as CSV in UTF-8"))?;
            let line = record.position().map_or(0, csv::Position::line);
            lines.push((line, record.iter().map(str::to_owned).collect()));
            if lines.len() > MAX_LINES {
                return Err(Problem::new(file, "it has more than 2000000 lines", "split it"));
            }
        }
        if lines.is_empty() {
            return Err(Problem::new(file, "it is empty", "a CSV with a head line is expected"));
        }
        let (_, head) = lines.remove(0);
        let places = head.iter().enumerate().map(|(at, name)| (name.clone(), at)).collect();
        for (line, cells) in &lines {
            if cells.len() != head.len() && cells.iter().any(|cell| !cell.is_empty()) {
                let what = format!("{} cells under a head of {}", cells.len(), head.len());
                return Err(Problem::new(file, what, "export it again, or quote cells that hold a comma").line(*line));
            }
        }
        lines.retain(|(_, cells)| cells.iter().any(|cell| !cell.is_empty()));
        Ok(Self { head, lines, places, file: file.to_owned() })
    }

    /// Whether it has a column.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.places.contains_key(column)
    }

    /// A cell without blanks around it; empty where the column is missing.
    pub(crate) fn cell<'l>(&self, line: &'l [String], column: &str) -> &'l str {
        self.places.get(column).and_then(|at| line.get(*at)).map_or("", |cell| cell.trim())
    }

    /// Refuses a table without a column that it must have.
    pub(crate) fn need(&self, columns: &[&str]) -> Result<(), Problem> {
        let Some(missing) = columns.iter().find(|column| !self.has(column)) else { return Ok(()) };
        let what = format!("the column `{missing}` is missing");
        Err(Problem::new(&self.file, what, format!("its columns are {}", self.head.join(", "))).line(1))
    }

    /// A number that is not negative, or none where the cell is empty.
    pub(crate) fn number(&self, at: (u64, &[String]), column: &str) -> Result<Option<f64>, Problem> {
        let text = self.cell(at.1, column);
        if text.is_empty() {
            return Ok(None);
        }
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number >= 0.0);
        let bad = || Problem::new(&self.file, "no number of at least 0", "a number such as 12.5, or nothing");
        number.map(Some).ok_or_else(|| bad().line(at.0).column(column).value(text))
    }
}
