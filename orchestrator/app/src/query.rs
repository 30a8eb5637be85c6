//! `library query`: the runs of a library that fulfill conditions, from its table alone.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde_json::{Value, json};
use socrates_stream::csv::{Table, joined};

use crate::exit::{Code, Complaint};
use crate::files;
use crate::index;
use crate::output::Printer;
use crate::words::plural;

/// A table larger than this is not read: some million runs.
const MAX_BYTES: u64 = 2 << 30;
/// Every way to compare, the longer sign before the one that it begins with.
const SIGNS: [(&str, Compare); 7] = [
    ("!=", Compare::Other),
    ("<=", Compare::AtMost),
    (">=", Compare::AtLeast),
    ("=", Compare::Same),
    ("<", Compare::Less),
    (">", Compare::More),
    ("~", Compare::Has),
];

/// How a cell is compared with a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Compare {
    Same,
    Other,
    Less,
    More,
    AtMost,
    AtLeast,
    /// The text has this one in it, whatever the case.
    Has,
}

/// A condition on one column of the table, `verdict=realised` or `human_distance_min<0.5`. Numbers are compared as such where both sides
/// are numbers; an empty cell is less than nothing and more than nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    column: String,
    compare: Compare,
    value: String,
}

impl FromStr for Condition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let at = text.find(['=', '!', '<', '>', '~']);
        let (column, rest) = text.split_at(at.unwrap_or(text.len()));
        let sign = SIGNS.iter().find_map(|(sign, compare)| Some((rest.strip_prefix(sign)?, *compare)));
        let Some((value, compare)) = sign.filter(|_| !column.trim().is_empty()) else {
            return Err(format!(
                "`{text}` is no condition; write verdict=realised or human_distance_min<0.5 (= != < <= > >= ~)"
            ));
        };
        Ok(Self { column: column.trim().to_owned(), compare, value: value.trim().to_owned() })
    }
}

impl Condition {
    /// Whether a cell fulfills it.
    fn holds(&self, cell: &str) -> bool {
        let numbers = cell.parse::<f64>().ok().zip(self.value.parse::<f64>().ok());
        let order = match numbers {
            Some((cell, value)) => cell.partial_cmp(&value),
            None => Some(cell.cmp(self.value.as_str())),
        };
        // Without a value nothing is smaller or larger.
        let ordered = order.filter(|_| !cell.is_empty());
        match self.compare {
            Compare::Same => order == Some(Ordering::Equal),
            Compare::Other => order != Some(Ordering::Equal),
            Compare::Less => ordered == Some(Ordering::Less),
            Compare::More => ordered == Some(Ordering::Greater),
            Compare::AtMost => ordered.is_some_and(Ordering::is_le),
            Compare::AtLeast => ordered.is_some_and(Ordering::is_ge),
            Compare::Has => cell.to_lowercase().contains(&self.value.to_lowercase()),
        }
    }
}

/// What is asked of a library.
#[derive(Debug, Clone)]
pub struct QueryOptions {
    /// Folder of the library.
    pub library: PathBuf,
    /// Conditions that all have to hold.
    pub conditions: Vec<Condition>,
    /// Columns that are printed; none for all.
    pub columns: Vec<String>,
    /// Whether only the folders are printed, each once.
    pub paths: bool,
}

/// Prints the rows as a table of the same form, or the folders.
///
/// # Errors
/// A folder without a table, a table that cannot be read, a column that it lacks.
pub fn query(talk: &Printer, options: &QueryOptions) -> Result<Code, Complaint> {
    let path = options.library.join(index::FILE);
    let text = files::text(
        &path,
        MAX_BYTES,
        "name a library; `socrates report FOLDER` writes the table of any folder of bundles",
    )?;
    let table = Table::read(&text).map_err(|why| {
        Complaint::input(format!("`{}`: {why}", path.display()), "`socrates report FOLDER` writes it anew")
    })?;
    let place = |name: &str| {
        let lacks = || {
            let all = table.head.cells.join(", ");
            Complaint::input(format!("the table has no column `{name}`"), format!("columns: {all}"))
        };
        table.column(name).ok_or_else(lacks)
    };
    let conditions =
        options.conditions.iter().map(|one| Ok((place(&one.column)?, one))).collect::<Result<Vec<_>, _>>()?;
    let shown = match options.columns.as_slice() {
        [] => (0..table.head.cells.len()).collect(),
        some => some.iter().map(|name| place(name)).collect::<Result<Vec<usize>, _>>()?,
    };
    let folder = place("path")?;
    let rows: Vec<_> = table
        .rows
        .iter()
        .filter(|row| conditions.iter().all(|(at, one)| one.holds(row.cell(*at).unwrap_or_default())))
        .collect();
    let folders = folders(&options.library, rows.iter().filter_map(|row| row.cell(folder)));
    if options.paths {
        folders.iter().for_each(|path| talk.line(path));
    } else {
        let line = |row: &socrates_stream::csv::Row| joined(shown.iter().map(|at| row.cell(*at).unwrap_or_default()));
        talk.line(&line(&table.head));
        rows.iter().for_each(|row| talk.line(&line(row)));
    }
    // A library that keeps no bundles has no places to count.
    let within = if folders.is_empty() { String::new() } else { format!(" in {}", plural(folders.len(), "scenario")) };
    talk.warn(&format!("{} of {}{within}", plural(rows.len(), "run"), table.rows.len()));
    let object = |row: &&socrates_stream::csv::Row| -> Value {
        let cells = shown.iter().map(|at| (table.head.cell(*at), row.cell(*at)));
        cells
            .filter_map(|(name, cell)| Some((name?.to_owned(), json!(cell?))))
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    talk.result(&json!({ "runs": rows.iter().map(object).collect::<Vec<_>>(), "scenarios": folders }));
    Ok(Code::Ok)
}

/// The folders as a shell finds them, each once, in the order of the table.
fn folders<'a>(library: &Path, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut folders: Vec<String> = Vec::new();
    for name in names.filter(|name| !name.is_empty()) {
        let path = library.join(name).display().to_string();
        // Runs of one scenario stand together.
        if folders.last() != Some(&path) {
            folders.push(path);
        }
    }
    folders
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(condition: &str, cell: &str) -> bool {
        condition.parse::<Condition>().unwrap().holds(cell)
    }

    #[test]
    fn numbers_are_compared_as_numbers_and_words_as_words() {
        assert!(holds("a<10", "9") && !holds("a<10", "10") && holds("a<=10", "10.0"));
        assert!(holds("seed=1", "1") && holds("seed=1", "1.0") && holds("verdict!=realised", "failed"));
        assert!(holds("reason~NO WAY", "there is no way") && !holds("reason~door", "there is no way"));
        assert!(!holds("a<10", "") && !holds("a>-10", ""), "what has no value is neither smaller nor larger");
        assert!(holds("reason=", "") && holds("a=x=y", "x=y"));
    }

    #[test]
    fn what_is_no_condition_is_told_with_an_example() {
        for text in ["realised", "=1", "a!1", ""] {
            let told = text.parse::<Condition>().unwrap_err();
            assert!(told.contains(text) && told.contains("verdict=realised"), "{told}");
        }
    }
}
