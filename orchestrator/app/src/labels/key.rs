//! The key of a blind page: which run of which bundle a name stands for.

use socrates_stream::csv::joined;

use super::door::Door;
use crate::exit::Diagnostic;

/// Its name beside the page.
pub(super) const FILE: &str = "key.csv";
/// Its columns.
const COLUMNS: [&str; 5] = ["name", "bundle", "run", "recording", "control"];
const YES: &str = "yes";
const NO: &str = "no";

/// What a name stands for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Named {
    /// `r01`.
    pub(super) name: String,
    /// Folder of the bundle.
    pub(super) bundle: String,
    /// Id of the run in it.
    pub(super) run: String,
    /// Hash of the recording that was seen.
    pub(super) recording: String,
    /// Whether it was mixed in to judge the judges.
    pub(super) control: bool,
}

/// The key as a table.
pub(super) fn write(rows: &[Named]) -> String {
    let mut out = joined(COLUMNS);
    out.push('\n');
    for row in rows {
        let control = if row.control { YES } else { NO };
        out.push_str(&joined([row.name.as_str(), &row.bundle, &row.run, &row.recording, control]));
        out.push('\n');
    }
    out
}

/// Reads a key; everything that is wrong with it is told at once.
pub(super) fn read(text: &str, file: &str) -> Result<Vec<Named>, Diagnostic> {
    let mut door = Door::default();
    let mut found: Vec<Named> = Vec::new();
    for row in door.rows(text, file, &COLUMNS) {
        let [Some(name), Some(bundle), Some(run), Some(recording)] =
            ["name", "bundle", "run", "recording"].map(|column| door.filled(&row, column))
        else {
            continue;
        };
        let control = match row.cell("control") {
            YES => true,
            NO => false,
            other => {
                door.wrong(&row, &format!("`control` is `{other}`; allowed: {YES}, {NO}"));
                continue;
            }
        };
        if found.iter().any(|known| known.name == name) {
            door.wrong(&row, &format!("the name `{name}` stands there twice"));
            continue;
        }
        found.push(Named { name, bundle, run, recording, control });
    }
    door.shut("the key", "take the key.csv that was written beside the page, as it is", found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_read_as_it_was_written() {
        let named = |name: &str, control: bool| Named {
            name: name.to_owned(),
            bundle: "/a, b/\"c\"".to_owned(),
            run: "x-1.reference-1".to_owned(),
            recording: "b3:00".to_owned(),
            control,
        };
        let rows = [named("r01", false), named("r02", true)];
        assert_eq!(read(&write(&rows), "key.csv").unwrap(), rows);
    }

    #[test]
    fn everything_wrong_with_a_key_is_told_with_file_line_and_value() {
        let head = "name,bundle,run,recording,control\n";
        let text = format!("{head}r01,a,x,h,maybe\nr02,,x,h,no\nr03,a,x,h,no\nr03,a,x,h,no\n");
        let told = read(&text, "key.csv").unwrap_err().to_string();
        for words in [
            "key.csv:2: `control` is `maybe`; allowed: yes, no",
            "key.csv:3: `bundle` is empty",
            "key.csv:5: the name `r03`",
        ] {
            assert!(told.contains(words), "{words}: {told}");
        }
        let told = read("name,bundle\nr01,a\n", "key.csv").unwrap_err().to_string();
        assert!(told.contains("key.csv:1: the column `run` is missing") && told.contains("`control`"), "{told}");
        assert!(read("", "key.csv").unwrap_err().to_string().contains("key.csv"));
        assert!(read(head, "key.csv").unwrap_err().to_string().contains("no line under the head"));
    }
}
