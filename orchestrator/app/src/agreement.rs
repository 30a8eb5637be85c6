//! `dev agreement`: what people said of runs against what the judge says.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_model::Verdict;
use socrates_stream::csv::Table;

use crate::bundle;
use crate::exit::Diagnostic;
use crate::files;
use crate::labels::shown;
use crate::output::Printer;

/// A file of labels larger than this is not read.
const MAX_BYTES: u64 = 16 * 1024 * 1024;
/// The columns, in any order.
const COLUMNS: [&str; 5] = ["run", "rater", "simulable", "appropriate", "as_asked"];
/// The questions, as the columns spell them.
const QUESTIONS: [&str; 3] = ["simulable", "appropriate", "as_asked"];

/// One row of labels: run, rater, and the three answers; whoever was unsure gave none.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Label {
    run: String,
    rater: String,
    answers: [Option<bool>; 3],
}

/// Does `dev agreement`.
pub fn agreement(talk: &Printer, labels: &Path, bundles: &[PathBuf]) -> Result<(), Diagnostic> {
    let text = files::text(labels, MAX_BYTES, &format!("a CSV with the columns {}", COLUMNS.join(",")))?;
    let labels = read(&text, &labels.display().to_string())?;
    let mut verdicts: BTreeMap<String, Verdict> = BTreeMap::new();
    let dirs = crate::labels::folders(bundles)?;
    // A page for some of these bundles may have called a run by its own name alone; where two have it, that says too little.
    let mut double: BTreeSet<String> = BTreeSet::new();
    for (dir, names) in dirs.iter().zip(crate::labels::names(&dirs)?) {
        for report in
            bundle::manifest(dir).map_or_else(|| Ok(Vec::new()), |manifest| bundle::reports(dir, &manifest))?
        {
            let run = report.run.to_string();
            let name = names.get(&run).cloned().unwrap_or_else(|| run.clone());
            if name != run {
                double.insert(run);
            }
            verdicts.insert(name, report.verdict);
        }
    }
    if let Some(run) = labels.iter().map(|label| &label.run).find(|run| double.contains(*run)) {
        let fits: Vec<&str> = verdicts.keys().filter(|name| name.ends_with(run.as_str())).map(String::as_str).collect();
        return Err(Diagnostic::input(
            format!("several bundles hold a run `{run}`: {}", fits.join(", ")),
            "name only the bundles that were on the page, or write these names into the labels",
        ));
    }
    let unknown: BTreeSet<&str> =
        labels.iter().map(|label| label.run.as_str()).filter(|run| !verdicts.contains_key(*run)).collect();
    if unknown.len() == labels.iter().map(|label| &label.run).collect::<BTreeSet<_>>().len() {
        let known: Vec<&str> = verdicts.keys().map(String::as_str).take(8).collect();
        return Err(Diagnostic::input(
            "no labeled run is in the bundles",
            format!("runs there: {}", if known.is_empty() { "none".to_owned() } else { known.join(", ") }),
        ));
    }
    for run in &unknown {
        talk.warn(&format!("the run `{run}` is in no bundle and is left out"));
    }
    let rows = compare(&labels, &verdicts);
    talk.line(&format!(
        "{:<12} {:>5} {:>7}  {:<22} {:<18} judge and most people",
        "question", "runs", "raters", "Krippendorff's alpha", "Cohen's kappa"
    ));
    for row in &rows {
        talk.line(&format!(
            "{:<12} {:>5} {:>7}  {:<22} {:<18} {}",
            row.question,
            row.runs,
            row.raters,
            shown(row.alpha),
            shown(row.kappa),
            row.matrix()
        ));
    }
    let table: Vec<serde_json::Value> = rows
        .iter()
        .map(|row| {
            json!({ "question": row.question, "runs": row.runs, "raters": row.raters, "alpha": row.alpha,
                "kappa": row.kappa, "yes_yes": row.counts[0], "yes_no": row.counts[1], "no_yes": row.counts[2],
                "no_no": row.counts[3] })
        })
        .collect();
    talk.result(&json!({ "rows": table }));
    Ok(())
}

fn read(text: &str, name: &str) -> Result<Vec<Label>, Diagnostic> {
    let bad = |line: usize, what: String| {
        Diagnostic::input(
            format!("`{name}` line {line}: {what}"),
            format!("the columns are {}; answers are yes, no or unsure", COLUMNS.join(",")),
        )
    };
    let table = Table::read(text).map_err(|why| bad(1, why.to_string()))?;
    let mut places = BTreeMap::new();
    for column in COLUMNS {
        let missing = || bad(table.head.line, format!("the column `{column}` is missing"));
        places.insert(column, table.column(column).ok_or_else(missing)?);
    }
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for row in &table.rows {
        let cell = |column: &str| places.get(column).and_then(|place| row.cell(*place)).unwrap_or_default();
        let name = |column: &str| match cell(column) {
            "" => Err(bad(row.line, format!("`{column}` is empty"))),
            text => Ok(text.to_owned()),
        };
        let answer = |column: &str| match cell(column).to_lowercase().as_str() {
            "yes" | "y" | "1" | "true" => Ok(Some(true)),
            "no" | "n" | "0" | "false" => Ok(Some(false)),
            "unsure" | "" => Ok(None),
            other => Err(bad(row.line, format!("`{column}` is `{other}`; yes, no or unsure is expected"))),
        };
        let label = Label {
            run: name("run")?,
            rater: name("rater")?,
            answers: [answer("simulable")?, answer("appropriate")?, answer("as_asked")?],
        };
        if !seen.insert((label.run.clone(), label.rater.clone())) {
            return Err(bad(row.line, format!("`{}` has labeled `{}` twice", label.rater, label.run)));
        }
        found.push(label);
    }
    if found.is_empty() {
        return Err(bad(1, "there is no label under the head".to_owned()));
    }
    Ok(found)
}

/// One question: how far people agree with each other and with the judge.
struct Row {
    question: &'static str,
    runs: usize,
    raters: usize,
    alpha: Option<f64>,
    kappa: Option<f64>,
    /// Judge and people: yes yes, yes no, no yes, no no.
    counts: [usize; 4],
}

impl Row {
    fn matrix(&self) -> String {
        let [both, judge, people, none] = self.counts;
        if self.kappa.is_none() {
            return "the judge has no opinion".to_owned();
        }
        format!("both yes {both}, judge alone {judge}, people alone {people}, both no {none}")
    }
}

/// What the judge says to a question, if it says anything: whether it is a fit scenario for the place is nothing
/// that a recording shows.
fn opinion(question: &str, verdict: Verdict) -> Option<bool> {
    match question {
        "simulable" => Some(verdict != Verdict::Invalid),
        "as_asked" => Some(crate::labels::meets(verdict)),
        _ => None,
    }
}

fn compare(labels: &[Label], verdicts: &BTreeMap<String, Verdict>) -> Vec<Row> {
    QUESTIONS
        .iter()
        .enumerate()
        .map(|(index, question)| {
            let mut units: BTreeMap<&str, Vec<bool>> = BTreeMap::new();
            for label in labels.iter().filter(|label| verdicts.contains_key(&label.run)) {
                units.entry(&label.run).or_default().extend(label.answers.get(index).copied().flatten());
            }
            let raters: BTreeSet<&str> = labels.iter().map(|label| label.rater.as_str()).collect();
            let (mut judge, mut people) = (Vec::new(), Vec::new());
            for (run, answers) in &units {
                let yes = answers.iter().filter(|answer| **answer).count();
                // A tie decides nothing.
                if yes * 2 == answers.len() {
                    continue;
                }
                if let Some(says) = verdicts.get(*run).and_then(|verdict| opinion(question, *verdict)) {
                    judge.push(says);
                    people.push(yes * 2 > answers.len());
                }
            }
            let mut counts = [0; 4];
            for (judge, people) in judge.iter().zip(&people) {
                let place = usize::from(!judge) * 2 + usize::from(!people);
                if let Some(slot) = counts.get_mut(place) {
                    *slot += 1;
                }
            }
            let lists: Vec<Vec<bool>> = units.values().cloned().collect();
            Row {
                question,
                runs: units.len(),
                raters: raters.len(),
                alpha: socrates_stats::krippendorff_alpha(&lists).ok(),
                kappa: socrates_stats::cohen_kappa(&judge, &people).ok(),
                counts,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_compared_with_each_other_and_with_the_verdicts() {
        let text = "run,rater,simulable,appropriate,as_asked\na,x,yes,yes,yes\na,y,yes,no,yes\nb,x,yes,yes,no\n\
                    b,y,yes,yes,no\nc,x,no,no,no\nc,y,no,yes,no\nd,x,yes,yes,yes\nd,y,yes,yes,yes\n";
        let labels = read(text, "labels.csv").unwrap();
        let verdicts: BTreeMap<String, Verdict> = [
            ("a".to_owned(), Verdict::Realised),
            ("b".to_owned(), Verdict::Contradicted),
            ("c".to_owned(), Verdict::Invalid),
            ("d".to_owned(), Verdict::NotTriggered),
        ]
        .into();
        let rows = compare(&labels, &verdicts);
        assert_eq!((rows[0].counts, rows[0].kappa), ([3, 0, 0, 1], Some(1.0)));
        assert_eq!(rows[1].kappa, None);
        // One of four differs: p_o = 0.75, p_e = 0.25 * 0.5 + 0.75 * 0.5 = 0.5.
        assert_eq!(rows[2].counts, [1, 0, 1, 2]);
        assert!((rows[2].kappa.unwrap() - 0.5).abs() < 1e-12);
        assert!((rows[2].alpha.unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn who_is_unsure_gives_no_answer_and_names_may_hold_commas() {
        let labels =
            read("rater,run,simulable,as_asked,appropriate\n\"Ann \"\"A\"\", B\",r,yes,unsure,\n", "l.csv").unwrap();
        let wanted = Label { run: "r".into(), rater: "Ann \"A\", B".into(), answers: [Some(true), None, None] };
        assert_eq!(labels, [wanted]);
        let rows = compare(&labels, &[("r".to_owned(), Verdict::Realised)].into());
        assert_eq!((rows[0].counts, rows[2].counts), ([1, 0, 0, 0], [0; 4]));
    }

    #[test]
    fn a_bad_label_is_named_with_its_line() {
        let head = "run,rater,simulable,appropriate,as_asked\n";
        for (text, wanted) in [
            (String::new(), "empty"),
            ("run,rater,simulable,appropriate\na,b,yes,no".to_owned(), "`as_asked` is missing"),
            (format!("{head}a,b,yes,no,perhaps"), "line 2: `as_asked` is `perhaps`"),
            (format!("{head}a,b,yes,no,no\na,b,yes,no,no"), "twice"),
            (format!("{head}a,,yes,no,no"), "`rater` is empty"),
            (head.to_owned(), "no label"),
        ] {
            let diagnostic = read(&text, "l.csv").unwrap_err();
            assert!(diagnostic.what.contains(wanted), "{}", diagnostic.what);
        }
    }
}
