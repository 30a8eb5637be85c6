//! The key of a page for observers: what each question is about, and to which side a belief should go.

use socrates_draw::LookKind;
use socrates_stream::csv::joined;

use super::door::Door;
use crate::exit::Diagnostic;

/// Its name beside the page.
pub(super) const FILE: &str = "observe-key.csv";
const COLUMNS: [&str; 9] = ["task", "kind", "film", "run", "planner", "other", "other_run", "other_planner", "truth"];

/// The place that was the robot's goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Truth {
    A,
    B,
}

impl Truth {
    const fn word(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::B => "b",
        }
    }
}

/// A question of the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Task {
    /// `t001`.
    pub(super) id: String,
    pub(super) kind: LookKind,
    pub(super) film: String,
    pub(super) run: String,
    pub(super) planner: String,
    /// The film on the right of a pair; empty else.
    pub(super) other: String,
    pub(super) other_run: String,
    pub(super) other_planner: String,
    /// Of a belief.
    pub(super) truth: Option<Truth>,
}

/// The key as a table.
pub(super) fn write(tasks: &[Task]) -> String {
    let mut out = joined(COLUMNS);
    out.push('\n');
    for task in tasks {
        let truth = task.truth.map_or("", Truth::word);
        let kind = task.kind.word();
        let Task { id, film, run, planner, other, other_run, other_planner, .. } = task;
        out.push_str(&joined([id.as_str(), kind, film, run, planner, other, other_run, other_planner, truth]));
        out.push('\n');
    }
    out
}

/// Reads a key; everything that is wrong with it is told at once.
pub(super) fn read(text: &str, file: &str) -> Result<Vec<Task>, Diagnostic> {
    let mut door = Door::default();
    let mut found: Vec<Task> = Vec::new();
    for row in door.rows(text, file, &COLUMNS) {
        let [Some(id), Some(word), Some(film), Some(run), Some(planner)] =
            ["task", "kind", "film", "run", "planner"].map(|column| door.filled(&row, column))
        else {
            continue;
        };
        let Some(kind) = LookKind::ALL.into_iter().find(|kind| kind.word() == word) else {
            let allowed = LookKind::ALL.map(LookKind::word).join(", ");
            door.wrong(&row, &format!("`kind` is `{word}`; allowed: {allowed}"));
            continue;
        };
        let truth = match row.cell("truth") {
            _ if kind != LookKind::Belief => None,
            "a" => Some(Truth::A),
            "b" => Some(Truth::B),
            other => {
                door.wrong(&row, &format!("`truth` of a belief is `{other}`; allowed: a, b"));
                continue;
            }
        };
        if found.iter().any(|known| known.id == id) {
            door.wrong(&row, &format!("the question `{id}` stands there twice"));
            continue;
        }
        let cell = |column: &str| row.cell(column).to_owned();
        let (other, other_run, other_planner) = (cell("other"), cell("other_run"), cell("other_planner"));
        if kind == LookKind::Pair && (other.is_empty() || other_planner.is_empty()) {
            door.wrong(&row, "a pair has an `other` film and an `other_planner`; one of them is empty");
            continue;
        }
        found.push(Task { id, kind, film, run, planner, other, other_run, other_planner, truth });
    }
    door.shut("the key", "take the observe-key.csv that was written beside the page, as it is", found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_read_as_it_was_written_and_what_is_wrong_is_told() {
        let task = |id: &str, kind: LookKind, other: &str, truth: Option<Truth>| Task {
            id: id.into(),
            kind,
            film: "r01".into(),
            run: "x-1.orca-1".into(),
            planner: "orca".into(),
            other: other.into(),
            other_run: if other.is_empty() { String::new() } else { "x-1.mppi-1".into() },
            other_planner: if other.is_empty() { String::new() } else { "mppi".into() },
            truth,
        };
        let all = [
            task("t001", LookKind::Rate, "", None),
            task("t002", LookKind::Belief, "", Some(Truth::B)),
            task("t003", LookKind::Pair, "r02", None),
        ];
        assert_eq!(read(&write(&all), "observe-key.csv").unwrap(), all);
        let head = write(&[]);
        let text = format!(
            "{head}t1,guess,r01,x,orca,,,,\nt2,belief,r01,x,orca,,,,\nt3,pair,r01,x,orca,,,,\nt4,rate,r01,x,orca,,,,\nt4,rate,r01,x,orca,,,,\n"
        );
        let told = read(&text, "k.csv").unwrap_err().to_string();
        for words in [
            "k.csv:2: `kind` is `guess`",
            "k.csv:3: `truth` of a belief is ``",
            "k.csv:4: a pair",
            "k.csv:6: the question `t4`",
        ] {
            assert!(told.contains(words), "{words}: {told}");
        }
    }
}
