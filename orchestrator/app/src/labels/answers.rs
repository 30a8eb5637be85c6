//! What judges answered: one line for each run and judge.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::door::{Door, Line};
use super::key::{self, Named};
use crate::exit::Diagnostic;
use crate::files;

/// The columns, in any order.
pub(super) const COLUMNS: [&str; 4] = ["run", "rater", "as_asked", "sentence"];
/// A file of answers, or a key, larger than this is not read.
const MAX_BYTES: u64 = 16 * 1024 * 1024;
/// Runs without an answer are named up to so many.
const NAMED: usize = 12;

/// An answer, the best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Says {
    /// Every sentence happened.
    AsAsked,
    /// A sentence did not happen.
    Partly,
    /// What the request is about did not happen.
    Not,
}

impl Says {
    pub(super) const ALL: [Self; 3] = [Self::AsAsked, Self::Partly, Self::Not];

    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::AsAsked => "as_asked",
            Self::Partly => "partly",
            Self::Not => "not",
        }
    }

    fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|says| says.word() == word)
    }
}

/// What one judge says of one run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    pub(super) says: Says,
    /// The words that did not happen; empty where all did.
    pub(super) sentence: String,
}

/// Answers by judge, by run.
pub(super) type Answers = BTreeMap<String, BTreeMap<String, Answer>>;

/// Tables of answers, read one after the other: that of a judge may come in several files.
#[derive(Debug, Default)]
pub(super) struct Tables {
    answers: Answers,
    /// By judge: the files that name them, and the runs of which they say anything, be it wrong.
    seen: BTreeMap<String, (BTreeSet<String>, BTreeSet<String>)>,
}

impl Tables {
    /// Reads one table more; `runs` are those that were on the page.
    pub(super) fn read(&mut self, door: &mut Door, text: &str, file: &str, runs: &BTreeSet<&str>) {
        for line in door.rows(text, file, &COLUMNS) {
            let (run, rater) = (door.filled(&line, "run"), door.filled(&line, "rater"));
            let (Some(run), Some(rater)) = (run, rater) else { continue };
            if !runs.contains(run.as_str()) {
                let (first, last) = (runs.first().copied().unwrap_or("none"), runs.last().copied().unwrap_or("none"));
                door.wrong(&line, &format!("the run `{run}` is not in the key; allowed: {first} to {last}"));
                continue;
            }
            let (files, answered) = self.seen.entry(rater.clone()).or_default();
            files.insert(file.to_owned());
            if !answered.insert(run.clone()) {
                door.wrong(&line, &format!("`{rater}` has answered `{run}` twice; allowed: one answer for each run"));
                continue;
            }
            if let Some(answer) = answer(door, &line) {
                self.answers.entry(rater).or_default().insert(run, answer);
            }
        }
    }

    /// The answers; whoever left out a run is told.
    pub(super) fn whole(self, door: &mut Door, runs: &BTreeSet<&str>) -> Answers {
        for (rater, (files, answered)) in &self.seen {
            let missing: Vec<&str> = runs.iter().copied().filter(|run| !answered.contains(*run)).collect();
            if missing.is_empty() {
                continue;
            }
            let more = if missing.len() > NAMED { ", …" } else { "" };
            let named = missing.iter().take(NAMED).copied().collect::<Vec<_>>().join(", ");
            let files = files.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
            door.say(format!(
                "{files}: `{rater}` has no answer for {} of {} runs: {named}{more}; allowed: an answer for each",
                missing.len(),
                runs.len()
            ));
        }
        self.answers
    }
}

/// Reads a key and the tables of answers of its page; what is wrong with the tables stands in the door.
pub(super) fn judged(door: &mut Door, labels: &[PathBuf], key: &Path) -> Result<(Vec<Named>, Answers), Diagnostic> {
    let text = files::text(key, MAX_BYTES, "--key names the key.csv that was written beside the page")?;
    let key = key::read(&text, &key.display().to_string())?;
    let runs: BTreeSet<&str> = key.iter().map(|named| named.name.as_str()).collect();
    let mut tables = Tables::default();
    for file in labels {
        let text = files::text(file, MAX_BYTES, &wanted())?;
        tables.read(door, &text, &file.display().to_string(), &runs);
    }
    let answers = tables.whole(door, &runs);
    Ok((key, answers))
}

fn wanted() -> String {
    format!("a table with the columns {}", COLUMNS.join(","))
}

/// What a table of answers may hold.
pub(super) fn hint() -> String {
    format!("{}; `as_asked` is one of {}", wanted(), Says::ALL.map(Says::word).join(", "))
}

fn answer(door: &mut Door, line: &Line) -> Option<Answer> {
    let allowed = Says::ALL.map(Says::word).join(", ");
    let word = line.cell("as_asked");
    let Some(says) = Says::of(word) else {
        let what = if word.is_empty() { "is empty".to_owned() } else { format!("is `{word}`") };
        door.wrong(line, &format!("`as_asked` {what}; allowed: {allowed}"));
        return None;
    };
    let sentence = line.cell("sentence").split_whitespace().collect::<Vec<_>>().join(" ");
    match (says, sentence.is_empty()) {
        (Says::AsAsked, false) => {
            door.wrong(
                line,
                &format!("`sentence` is `{sentence}` beside `as_asked`; allowed: nothing, for all of it happened"),
            );
            None
        }
        (Says::Partly | Says::Not, true) => {
            let word = says.word();
            door.wrong(
                line,
                &format!("`sentence` is empty beside `{word}`; allowed: the words of the request that did not happen"),
            );
            None
        }
        (Says::AsAsked, true) | (Says::Partly | Says::Not, false) => Some(Answer { says, sentence }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told of a table of these lines, over two runs.
    fn told(lines: &str) -> String {
        let (mut door, mut tables) = (Door::default(), Tables::default());
        let runs: BTreeSet<&str> = ["r01", "r02"].into();
        tables.read(&mut door, &format!("run,rater,as_asked,sentence\n{lines}"), "a.csv", &runs);
        tables.whole(&mut door, &runs);
        door.shut("it", "", ()).map_or_else(|diagnostic| diagnostic.to_string(), |()| String::new())
    }

    #[test]
    fn good_answers_are_taken() {
        assert_eq!(told("r01,ann,as_asked,\nr02,ann,not,\"A nurse, old, waits.\"\n"), "");
    }

    #[test]
    fn each_bad_answer_is_told_with_file_line_value_and_what_is_allowed() {
        let rest = "r02,ann,as_asked,\n";
        for (line, wanted) in [
            ("r01,ann,yes,\n", "a.csv:2: `as_asked` is `yes`; allowed: as_asked, partly, not"),
            ("r01,ann,,\n", "a.csv:2: `as_asked` is empty; allowed: as_asked, partly, not"),
            ("r09,ann,not,x\n", "a.csv:2: the run `r09` is not in the key; allowed: r01 to r02"),
            ("r01,,not,x\n", "a.csv:2: `rater` is empty"),
            ("r01,ann,partly,\n", "a.csv:2: `sentence` is empty beside `partly`"),
            ("r01,ann,as_asked,nobody waits\n", "a.csv:2: `sentence` is `nobody waits` beside `as_asked`"),
            ("", "a.csv: `ann` has no answer for 1 of 2 runs: r01"),
            ("r01,ann,as_asked,\nr01,ann,not,x\n", "a.csv:3: `ann` has answered `r01` twice"),
        ] {
            let told = told(&format!("{line}{rest}"));
            assert!(told.contains(wanted), "{wanted}: {told}");
        }
    }

    #[test]
    fn everything_is_told_at_once_and_a_wrong_answer_is_not_missing_besides() {
        let told = told("r01,ann,maybe,\nr07,bob,not,x\nr02,bob,nope,\n");
        assert_eq!(told.matches("a.csv").count(), 5, "{told}");
        assert!(told.contains("`ann` has no answer for 1 of 2 runs: r02"), "{told}");
        assert!(told.contains("`bob` has no answer for 1 of 2 runs: r01"), "{told}");
    }

    #[test]
    fn the_table_of_a_judge_may_come_in_two_files() {
        let (mut door, mut tables) = (Door::default(), Tables::default());
        let runs: BTreeSet<&str> = ["r01", "r02"].into();
        for (file, run) in [("a.csv", "r01"), ("b.csv", "r02")] {
            tables.read(&mut door, &format!("run,rater,as_asked,sentence\n{run},ann,as_asked,\n"), file, &runs);
        }
        assert_eq!(tables.whole(&mut door, &runs)["ann"].len(), 2);
        assert!(door.shut("it", "", ()).is_ok());
    }

    #[test]
    fn the_columns_are_those_of_the_page() {
        assert_eq!(socrates_draw::Asks::AsAsked.columns(), COLUMNS);
    }
}
