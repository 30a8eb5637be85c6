//! `library query`: the runs of a library that fulfill conditions, from its table alone.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde_json::{Value, json};
use socrates_stream::csv::{Row, Table, joined};

use crate::exit::{Code, Diagnostic};
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
    /// File that the rows are written to instead of being printed: `.csv`, or `.parquet` with the feature of this name.
    pub out: Option<PathBuf>,
}

/// The table of runs of a library.
///
/// # Errors
/// A folder without one, or one that cannot be read.
pub(crate) fn table(library: &Path) -> Result<Table, Diagnostic> {
    let path = library.join(index::FILE);
    let hint = "name a library; `socrates report FOLDER` writes the table of any folder of bundles";
    let text = files::text(&path, MAX_BYTES, hint)?;
    Table::read(&text).map_err(|why| {
        Diagnostic::input(format!("`{}`: {why}", path.display()), "`socrates report FOLDER` writes it anew")
    })
}

/// Prints the rows as a table of the same form, or the folders.
///
/// # Errors
/// A folder without a table, a table that cannot be read, a column that it lacks.
pub fn query(talk: &Printer, options: &QueryOptions) -> Result<Code, Diagnostic> {
    let form = options.out.as_deref().map(Written::of).transpose()?;
    let table = table(&options.library)?;
    let place = |name: &str| {
        let lacks = || {
            let all = table.head.cells.join(", ");
            let hint = if index::COVERED.contains(&name) {
                format!(
                    "`socrates library gallery {}` writes tables of earlier versions anew",
                    files::shell(&options.library)
                )
            } else {
                format!("columns: {all}")
            };
            Diagnostic::input(format!("the table has no column `{name}`"), hint)
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
    if let (Some(form), Some(out)) = (form, &options.out) {
        form.write(out, &table, &shown, &rows)?;
        talk.line(&format!("wrote      {}", out.display()));
    } else if options.paths {
        folders.iter().for_each(|path| talk.line(path));
    } else {
        talk.line(&line(&shown, &table.head));
        rows.iter().for_each(|row| talk.line(&line(&shown, row)));
    }
    // A library that keeps no bundles has no places to count.
    let within = if folders.is_empty() { String::new() } else { format!(" in {}", plural(folders.len(), "scenario")) };
    talk.warn(&format!("{} of {}{within}", plural(rows.len(), "run"), table.rows.len()));
    let object = |row: &&Row| -> Value {
        let cells = shown.iter().map(|at| (table.head.cell(*at), row.cell(*at)));
        cells
            .filter_map(|(name, cell)| Some((name?.to_owned(), json!(cell?))))
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    talk.result(&json!({ "runs": rows.iter().map(object).collect::<Vec<_>>(), "scenarios": folders }));
    Ok(Code::Ok)
}

/// The cells of these columns as a line of a table.
fn line(shown: &[usize], row: &Row) -> String {
    joined(shown.iter().map(|at| row.cell(*at).unwrap_or_default()))
}

/// A form in which rows are written to a file; the ending of its name says which.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Written {
    Csv,
    Parquet,
}

impl Written {
    fn of(out: &Path) -> Result<Self, Diagnostic> {
        match out.extension().and_then(|ending| ending.to_str()) {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") if cfg!(feature = "parquet") => Ok(Self::Parquet),
            Some("parquet") => Err(Diagnostic::input(
                format!("cannot write `{}`: this program was built without the feature `parquet`", out.display()),
                "use `.csv`, or build it with `cargo build --release -p socrates --features parquet`",
            )),
            _ => Err(Diagnostic::input(
                format!("cannot write `{}`: its ending says no form of a table", out.display()),
                "use `.csv` or `.parquet`",
            )),
        }
    }

    fn write(self, out: &Path, table: &Table, shown: &[usize], rows: &[&Row]) -> Result<(), Diagnostic> {
        match self {
            Self::Csv => {
                let lines = std::iter::once(&table.head).chain(rows.iter().copied());
                let text: String = lines.map(|row| line(shown, row) + "\n").collect();
                files::write(out, text.as_bytes())
            }
            Self::Parquet => parquet(out, table, shown, rows),
        }
    }
}

#[cfg(feature = "parquet")]
fn parquet(out: &Path, table: &Table, shown: &[usize], rows: &[&Row]) -> Result<(), Diagnostic> {
    let columns: Vec<(usize, &str)> = shown.iter().filter_map(|at| Some((*at, table.head.cell(*at)?))).collect();
    crate::parquet_file::write(out, &columns, rows)
}

#[cfg(not(feature = "parquet"))]
fn parquet(out: &Path, _: &Table, _: &[usize], _: &[&Row]) -> Result<(), Diagnostic> {
    Written::of(out).map(|_| ())
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
    fn the_ending_of_a_file_says_its_form() {
        assert_eq!(Written::of(Path::new("runs.csv")).unwrap(), Written::Csv);
        let odd = Written::of(Path::new("runs.xlsx")).unwrap_err();
        assert!(odd.what.contains("runs.xlsx") && odd.hint.contains(".parquet"), "{odd}");
        match Written::of(Path::new("runs.parquet")) {
            Ok(form) => assert!(form == Written::Parquet && cfg!(feature = "parquet")),
            Err(why) => assert!(why.hint.contains("--features parquet") && !cfg!(feature = "parquet"), "{why}"),
        }
    }

    #[test]
    fn what_is_no_condition_is_told_with_an_example() {
        for text in ["realised", "=1", "a!1", ""] {
            let told = text.parse::<Condition>().unwrap_err();
            assert!(told.contains(text) && told.contains("verdict=realised"), "{told}");
        }
    }
}
