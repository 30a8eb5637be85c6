//! The door for tables of labels: cells by the names of their columns, and everything that is wrong told at once.

use std::collections::BTreeMap;

use socrates_stream::csv::Table;

use crate::exit::Diagnostic;

/// Problems are listed up to so many.
const LISTED: usize = 40;

/// A line of a table.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// File and number, `labels.csv:3`.
    at: String,
    cells: BTreeMap<&'static str, String>,
}

impl Line {
    /// The cell of a column, which may be empty.
    pub(super) fn cell(&self, column: &str) -> &str {
        self.cells.get(column).map_or("", String::as_str)
    }
}

/// What is wrong with the tables so far.
#[derive(Debug, Default)]
pub(super) struct Door {
    problems: Vec<String>,
}

impl Door {
    /// The lines of a table with these columns, in any order; nothing where it has none of that kind.
    pub(super) fn rows(&mut self, text: &str, file: &str, columns: &[&'static str]) -> Vec<Line> {
        let table = match Table::read(text) {
            Ok(table) => table,
            Err(why) => {
                self.say(format!("{file}: {why}"));
                return Vec::new();
            }
        };
        let mut places = BTreeMap::new();
        for column in columns {
            match table.column(column) {
                Some(place) => {
                    places.insert(*column, place);
                }
                None => self.say(format!(
                    "{file}:{}: the column `{column}` is missing; allowed: {}",
                    table.head.line,
                    columns.join(",")
                )),
            }
        }
        if places.len() < columns.len() {
            return Vec::new();
        }
        if table.rows.is_empty() {
            self.say(format!("{file}:{}: there is no line under the head", table.head.line));
        }
        let line = |row: &socrates_stream::csv::Row| Line {
            at: format!("{file}:{}", row.line),
            cells: places
                .iter()
                .map(|(column, place)| (*column, row.cell(*place).unwrap_or_default().to_owned()))
                .collect(),
        };
        table.rows.iter().map(line).collect()
    }

    /// A cell that must not be empty.
    pub(super) fn filled(&mut self, line: &Line, column: &str) -> Option<String> {
        match line.cell(column) {
            "" => {
                self.wrong(line, &format!("`{column}` is empty"));
                None
            }
            text => Some(text.to_owned()),
        }
    }

    /// A problem of a line.
    pub(super) fn wrong(&mut self, line: &Line, what: &str) {
        self.say(format!("{}: {what}", line.at));
    }

    /// A problem.
    pub(super) fn say(&mut self, what: String) {
        self.problems.push(what);
    }

    /// What was read where nothing is wrong.
    pub(super) fn shut<T>(self, what: &str, hint: &str, found: T) -> Result<T, Diagnostic> {
        if self.problems.is_empty() {
            return Ok(found);
        }
        let count = self.problems.len();
        let mut diagnostic = Diagnostic::input(
            format!("{what} cannot be taken: {count} {}", if count == 1 { "problem" } else { "problems" }),
            hint,
        );
        diagnostic.causes = self.problems.into_iter().take(LISTED).collect();
        if count > LISTED {
            diagnostic.causes.push(format!("and {} more", count - LISTED));
        }
        Err(diagnostic)
    }
}
