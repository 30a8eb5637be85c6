//! The tables of second opinions: a line for each fact of a run, and one for each answer to it.

use std::collections::BTreeSet;

use socrates_stream::csv::joined;

use super::super::door::Door;
use super::poll::{Held, Repeat};
use crate::exit::Diagnostic;

/// Name of the table of facts.
pub(in super::super) const FILE: &str = "second_opinion.csv";
/// Name of the table of answers.
pub(super) const ANSWERS: &str = "answers.csv";
const COLUMNS: [&str; 15] = [
    "name",
    "bundle",
    "run",
    "recording",
    "fact",
    "words",
    "quote",
    "planted",
    "program",
    "second_opinion",
    "agree",
    "repeats",
    "pictures",
    "judged",
    "differs",
];
const YES: &str = "yes";
const NO: &str = "no";
const SHOWN: &str = "shown";
const NOT_SHOWN: &str = "not_shown";

/// A fact of a run, and what is held of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in super::super) struct Row {
    /// `r01`: name of the sheet of pictures.
    pub(in super::super) name: String,
    pub(in super::super) bundle: String,
    pub(in super::super) run: String,
    pub(in super::super) recording: String,
    /// `f1`, `f2`, … in the order of the request; `p1`, … planted.
    pub(in super::super) fact: String,
    /// What was asked.
    pub(in super::super) words: String,
    /// The words of the request that it stands for; empty for a planted one.
    pub(in super::super) quote: String,
    pub(in super::super) planted: bool,
    /// What the program says; nothing where it does not.
    pub(in super::super) program: Option<bool>,
    pub(in super::super) held: Held,
    pub(in super::super) agree: usize,
    pub(in super::super) repeats: usize,
    pub(in super::super) pictures: Vec<u32>,
    /// Whether the run counts: the judge saw through what was planted.
    pub(in super::super) judged: bool,
}

impl Row {
    /// Whether judge and program say opposite things of a fact that counts.
    pub(in super::super) fn differs(&self) -> bool {
        self.judged && !self.planted && matches!((self.program, self.held.shown()), (Some(a), Some(b)) if a != b)
    }

    fn line(&self) -> String {
        let pictures: Vec<String> = self.pictures.iter().map(u32::to_string).collect();
        let program = self.program.map_or("", |shown| if shown { SHOWN } else { NOT_SHOWN });
        joined([
            self.name.as_str(),
            &self.bundle,
            &self.run,
            &self.recording,
            &self.fact,
            &self.words,
            &self.quote,
            yes(self.planted),
            program,
            self.held.word(),
            &self.agree.to_string(),
            &self.repeats.to_string(),
            &pictures.join(" "),
            yes(self.judged),
            yes(self.differs()),
        ])
    }
}

const fn yes(is: bool) -> &'static str {
    if is { YES } else { NO }
}

/// The table: facts on which judge and program differ first, the surest first, then all others in their order.
pub(super) fn write(rows: &[Row]) -> String {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted
        .sort_by_key(|row| (!row.differs(), if row.differs() { row.repeats - row.agree.min(row.repeats) } else { 0 }));
    let mut out = joined(COLUMNS);
    out.push('\n');
    for row in sorted {
        out.push_str(&row.line());
        out.push('\n');
    }
    out
}

/// A line for each answer to each fact: in which repeat, at which place of the question.
pub(super) fn answers(name: &str, facts: &[String], repeats: &[Repeat]) -> String {
    let mut out = String::new();
    for (number, repeat) in repeats.iter().enumerate() {
        for (index, fact) in facts.iter().enumerate() {
            let seen = repeat.seen.as_ref().and_then(|seen| seen.get(index));
            let word = seen.map_or(Held::NoAnswer.word(), |seen| seen.said.word());
            let pictures: Vec<String> =
                seen.map(|seen| seen.pictures.iter().map(u32::to_string).collect()).unwrap_or_default();
            let place = repeat.places.get(index).copied().unwrap_or_default().to_string();
            out.push_str(&joined([name, fact, &(number + 1).to_string(), &place, word, &pictures.join(" ")]));
            out.push('\n');
        }
    }
    out
}

/// The head of the table of answers.
pub(super) fn answers_head() -> String {
    joined(["name", "fact", "repeat", "place", "answer", "pictures"]) + "\n"
}

/// Reads a table of facts; everything that is wrong with it is told at once.
pub(in super::super) fn read(text: &str, file: &str) -> Result<Vec<Row>, Diagnostic> {
    let mut door = Door::default();
    let mut found: Vec<Row> = Vec::new();
    let mut known: BTreeSet<(String, String)> = BTreeSet::new();
    for line in door.rows(text, file, &COLUMNS) {
        let [Some(name), Some(bundle), Some(run), Some(recording), Some(fact), Some(words)] =
            ["name", "bundle", "run", "recording", "fact", "words"].map(|column| door.filled(&line, column))
        else {
            continue;
        };
        let mut wrong = |column: &str, allowed: &str| {
            door.wrong(&line, &format!("`{column}` is `{}`; allowed: {allowed}", line.cell(column)));
        };
        let flag = |column: &str| match line.cell(column) {
            YES => Some(true),
            NO => Some(false),
            _ => None,
        };
        let Some(planted) = flag("planted") else {
            wrong("planted", "yes, no");
            continue;
        };
        let Some(judged) = flag("judged") else {
            wrong("judged", "yes, no");
            continue;
        };
        let program = match line.cell("program") {
            "" => None,
            SHOWN => Some(true),
            NOT_SHOWN => Some(false),
            _ => {
                wrong("program", "shown, not_shown, nothing");
                continue;
            }
        };
        let Some(held) = Held::ALL.into_iter().find(|held| held.word() == line.cell("second_opinion")) else {
            wrong("second_opinion", &Held::ALL.map(Held::word).join(", "));
            continue;
        };
        let (Ok(agree), Ok(repeats)) = (line.cell("agree").parse::<usize>(), line.cell("repeats").parse::<usize>())
        else {
            door.wrong(&line, "`agree` and `repeats` are counts; one of them is not");
            continue;
        };
        if agree > repeats {
            wrong("agree", "at most `repeats`");
            continue;
        }
        let Ok(pictures) = line.cell("pictures").split_whitespace().map(str::parse).collect::<Result<Vec<u32>, _>>()
        else {
            wrong("pictures", "numbers with blanks between them");
            continue;
        };
        if !known.insert((name.clone(), fact.clone())) {
            door.wrong(&line, &format!("the fact `{fact}` of `{name}` stands there twice"));
            continue;
        }
        let quote = line.cell("quote").to_owned();
        let row = Row {
            name,
            bundle,
            run,
            recording,
            fact,
            words,
            quote,
            planted,
            program,
            held,
            agree,
            repeats,
            pictures,
            judged,
        };
        found.push(row);
    }
    door.shut("the second opinions", "take the second_opinion.csv that `labels opinion` wrote, as it is", found)
}

#[cfg(test)]
mod tests {
    use socrates_prompts::opinion::Said;

    use super::*;

    fn row(fact: &str, program: Option<bool>, held: Held, agree: usize) -> Row {
        Row {
            name: "r01".into(),
            bundle: "/a, b".into(),
            run: "x-1.reference-1".into(),
            recording: "b3:00".into(),
            fact: fact.into(),
            words: "A nurse, old, \"waits\".".into(),
            quote: "A nurse, old, \"waits\".".into(),
            planted: fact.starts_with('p'),
            program,
            held,
            agree,
            repeats: 5,
            pictures: vec![1, 4],
            judged: true,
        }
    }

    #[test]
    fn a_table_is_read_as_it_was_written_with_differences_first() {
        let (shown, not) = (Held::Said(Said::Shown), Held::Said(Said::NotShown));
        let rows = [
            row("f1", Some(true), shown, 5),
            row("f2", Some(true), not, 3),
            row("f3", Some(false), shown, 5),
            row("f4", None, Held::NoAnswer, 0),
            row("p1", None, not, 4),
        ];
        let read = read(&write(&rows), "second_opinion.csv").unwrap();
        let order: Vec<&str> = read.iter().map(|row| row.fact.as_str()).collect();
        assert_eq!(order, ["f3", "f2", "f1", "f4", "p1"]);
        assert!(rows.iter().all(|row| read.contains(row)));
    }

    #[test]
    fn everything_wrong_with_a_table_is_told_with_line_and_value() {
        let head = COLUMNS.join(",");
        let line = |cells: &str| format!("r01,b,x,h,f1,w,q,{cells}\n");
        let text = [
            line("maybe,shown,shown,5,5,1,yes,no"),
            line("no,seen,shown,5,5,1,yes,no"),
            line("no,shown,yes,5,5,1,yes,no"),
            line("no,shown,shown,6,5,1,yes,no"),
            line("no,shown,shown,5,5,a,yes,no"),
            line("no,shown,shown,5,5,1,yes,no"),
            line("no,shown,shown,5,5,1,yes,no"),
        ]
        .concat();
        let told = read(&format!("{head}\n{text}"), "o.csv").unwrap_err().to_string();
        for words in [
            "o.csv:2: `planted` is `maybe`; allowed: yes, no",
            "o.csv:3: `program` is `seen`",
            "o.csv:4: `second_opinion` is `yes`; allowed: shown, not_shown, cannot_tell, no_majority, no_answer",
            "o.csv:5: `agree` is `6`",
            "o.csv:6: `pictures` is `a`",
            "o.csv:8: the fact `f1` of `r01` stands there twice",
        ] {
            assert!(told.contains(words), "{words}: {told}");
        }
    }
}
