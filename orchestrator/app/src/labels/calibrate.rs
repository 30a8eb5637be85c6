//! `labels calibrate`: second opinions held against labels by people: how often the judge errs, and the share of facts that is true in
//! the runs that nobody labeled. Refused where there are too few labels, or where the judge tells little better than chance.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use serde_json::{Value, json};
use socrates_stats::{
    Corrected, Count, Interval, LEAST_YOUDEN, StatsError, Z_95, can_correct, corrected_share, youden,
};

use super::answers::{self, Answer, Answers, Says};
use super::door::Door;
use super::key::Named;
use super::opinion::{self, Row};
use super::share;
use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;
use crate::words::plural;

/// A larger table is not read.
const MAX_BYTES: u64 = 64 * 1024 * 1024;
/// Fewer labels than this of either kind are too few.
const LEAST_LABELS: usize = 40;
/// Facts to be labeled are named up to so many.
const NAMED: usize = 12;

/// What `labels calibrate` is given.
#[derive(Debug, Clone)]
pub struct CalibrateOptions {
    /// Tables of answers of blind judges.
    pub labels: Vec<PathBuf>,
    /// The key that was written beside their page.
    pub key: PathBuf,
    /// The table of facts that `labels opinion` wrote.
    pub opinion: PathBuf,
}

/// Does the verb.
pub fn calibrate(talk: &Printer, options: &CalibrateOptions) -> Result<(), Diagnostic> {
    let hint = format!("--opinion names the {} that `labels opinion` wrote", opinion::FILE);
    let text = files::text(&options.opinion, MAX_BYTES, &hint)?;
    let rows = opinion::read(&text, &options.opinion.display().to_string())?;
    let mut door = Door::default();
    let (key, labels) = answers::judged(&mut door, &options.labels, &options.key)?;
    door.shut("the labels", &answers::hint(), ())?;
    let found = Calibration::of(&rows, &key, &labels);
    found.say_differences(talk, &rows);
    found.fit()?;
    let share = found.share()?;
    found.say(talk, &rows, share.as_ref());
    talk.result(&found.told(&rows, share.as_ref())?);
    Ok(())
}

/// The label of a fact by people: whether it is shown.
type Labels = BTreeMap<(String, String), bool>;

/// What labels say of a judge.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Calibration {
    /// Of facts that people call shown, and of those that they call not shown: how many the judge calls so, of those it decides.
    sensitivity: Count,
    specificity: Count,
    /// Labels of each kind, shown and not, that the judge leaves open.
    open: (usize, usize),
    /// Facts that count in runs that nobody labeled: shown, of those that the judge decides.
    said: Count,
    /// Of those facts, those that the judge leaves open.
    said_open: usize,
    /// Runs that nobody labeled and that count.
    free_runs: usize,
    /// Facts with a label, by run and fact.
    labeled: Labels,
}

impl Calibration {
    fn of(rows: &[Row], key: &[Named], answers: &Answers) -> Self {
        let seen: BTreeMap<(&str, &str), &str> =
            key.iter().map(|named| ((named.run.as_str(), named.recording.as_str()), named.name.as_str())).collect();
        let name_of = |row: &Row| seen.get(&(row.run.as_str(), row.recording.as_str())).copied();
        let counted = || rows.iter().filter(|row| row.judged && !row.planted);
        let mut labeled = Labels::new();
        for row in counted() {
            let Some(name) = name_of(row) else { continue };
            let facts: Vec<&str> = rows
                .iter()
                .filter(|other| other.name == row.name && !other.planted)
                .map(|other| other.quote.as_str())
                .collect();
            let said = answers.values().filter_map(|own| own.get(name));
            if let Some(label) = most(said.filter_map(|answer| label(answer, &row.quote, &facts))) {
                labeled.insert((row.name.clone(), row.fact.clone()), label);
            }
        }
        let mut found = Self {
            sensitivity: Count { hits: 0, of: 0 },
            specificity: Count { hits: 0, of: 0 },
            open: (0, 0),
            said: Count { hits: 0, of: 0 },
            said_open: 0,
            free_runs: 0,
            labeled,
        };
        let mut free: BTreeSet<&str> = BTreeSet::new();
        for row in counted() {
            let label = found.labeled.get(&(row.name.clone(), row.fact.clone())).copied();
            match (label, row.held.shown()) {
                (Some(true), Some(shown)) => add(&mut found.sensitivity, shown),
                (Some(false), Some(shown)) => add(&mut found.specificity, !shown),
                (Some(true), None) => found.open.0 += 1,
                (Some(false), None) => found.open.1 += 1,
                // Facts beside labeled ones were chosen by what people named; they are no sample.
                (None, _) if name_of(row).is_some() => {}
                (None, Some(shown)) => {
                    free.insert(&row.name);
                    add(&mut found.said, shown);
                }
                (None, None) => {
                    free.insert(&row.name);
                    found.said_open += 1;
                }
            }
        }
        found.free_runs = free.len();
        found
    }

    /// Refuses a judge of whom too little is known, or who tells little better than chance.
    fn fit(&self) -> Result<(), Diagnostic> {
        let (shown, not) = (self.sensitivity.of, self.specificity.of);
        if shown < LEAST_LABELS || not < LEAST_LABELS {
            let mut diagnostic = Diagnostic::input(
                format!(
                    "too few labels by people: {shown} facts shown and {not} not shown, of those that the judge decides"
                ),
                format!(
                    "{LEAST_LABELS} of each are needed: label more runs (`socrates labels page --films`), the facts that differ first; \
                     --mixed-in adds runs of which something did not happen"
                ),
            );
            diagnostic.causes = vec![
                format!("labels that the judge leaves open: {} shown, {} not shown", self.open.0, self.open.1),
                "a run that does not count, planted facts and facts of a run whose judges name other words have no label".to_owned(),
            ];
            return Err(diagnostic);
        }
        let youden = youden(self.specificity, self.sensitivity).map_err(|why| ours(&why))?;
        if !can_correct(youden) {
            let mut diagnostic = Diagnostic::input(
                format!(
                    "the judge tells little better than chance: q0 + q1 - 1 is {youden:.3}, less than {LEAST_YOUDEN}; no share is reported"
                ),
                "ask another model, with more stills (--stills 12), or leave the runs to people",
            );
            diagnostic.causes = vec![
                format!("q1, facts that people call shown and the judge too: {}", share::words(self.sensitivity)),
                format!("q0, facts that people call not shown and the judge too: {}", share::words(self.specificity)),
            ];
            return Err(diagnostic);
        }
        Ok(())
    }

    fn told(&self, rows: &[Row], share: Option<&Corrected>) -> Result<Value, Diagnostic> {
        let theta = share.map(|found| {
            json!({"raw": found.raw, "unclipped": found.unclipped, "share": found.share.estimate, "low": found.share.low,
                "high": found.share.high, "standard_error": found.standard_error, "variance": found.standard_error.powi(2)})
        });
        let (agree, asked) = agreement(rows);
        Ok(json!({
            "sensitivity": share::told(self.sensitivity), "specificity": share::told(self.specificity),
            "youden": youden(self.specificity, self.sensitivity).map_err(|why| ours(&why))?,
            "open": {"shown": self.open.0, "not_shown": self.open.1},
            "facts": {"shown": self.said.hits, "decided": self.said.of, "open": self.said_open, "runs": self.free_runs},
            "corrected": theta, "repeats_agree": {"count": agree, "of": asked},
        }))
    }

    /// The corrected share of the facts of runs that nobody labeled; nothing where there are none.
    fn share(&self) -> Result<Option<Corrected>, Diagnostic> {
        if self.said.of == 0 {
            return Ok(None);
        }
        corrected_share(self.said, self.specificity, self.sensitivity, Z_95).map(Some).map_err(|why| ours(&why))
    }

    /// Facts on which judge and program differ and that people have not labeled: those to look at first.
    fn say_differences(&self, talk: &Printer, rows: &[Row]) {
        let left: Vec<&Row> = rows
            .iter()
            .filter(|row| row.differs() && !self.labeled.contains_key(&(row.name.clone(), row.fact.clone())))
            .collect();
        for row in left.iter().take(NAMED) {
            let program = if row.program == Some(true) { "shown" } else { "not_shown" };
            talk.line(&format!(
                "to label   {} {} of {}: program {program}, opinion {} ({} of {}): \"{}\"",
                row.fact,
                row.run,
                row.bundle,
                row.held.word(),
                row.agree,
                row.repeats,
                row.words
            ));
        }
        if left.len() > NAMED {
            talk.line(&format!("to label   and {} more", left.len() - NAMED));
        }
    }

    fn say(&self, talk: &Printer, rows: &[Row], share: Option<&Corrected>) {
        talk.line(&format!("q1         facts that people call shown, called so: {}", share::words(self.sensitivity)));
        talk.line(&format!(
            "q0         facts that people call not shown, called so: {}",
            share::words(self.specificity)
        ));
        talk.line(&format!(
            "open       {} shown and {} not shown that the judge leaves open",
            self.open.0, self.open.1
        ));
        let (agree, asked) = agreement(rows);
        talk.line(&format!("repeats    {agree} of {asked} answers are those of the majority"));
        match share {
            Some(found) => {
                let Interval { estimate, low, high } = found.share;
                talk.line(&format!(
                    "share      {:.1} % of the facts of {} that nobody labeled hold ({:.1} to {:.1} %; the judge says {:.1} %, \
                     unclipped {:.1} %)",
                    estimate * 100.0,
                    plural(self.free_runs, "run"),
                    low * 100.0,
                    high * 100.0,
                    found.raw * 100.0,
                    found.unclipped * 100.0
                ));
            }
            None => talk.line("share      none: people have labeled every run that counts"),
        }
    }
}

fn ours(why: &StatsError) -> Diagnostic {
    Diagnostic::input(why.to_string(), "please report the tables").with_code(crate::exit::Code::Ours)
}

const fn add(count: &mut Count, hit: bool) {
    count.of += 1;
    if hit {
        count.hits += 1;
    }
}

/// Answers that are those of the majority of their fact, of all that were asked for.
fn agreement(rows: &[Row]) -> (usize, usize) {
    let counted = rows.iter().filter(|row| row.judged && !row.planted);
    counted.fold((0, 0), |(agree, asked), row| (agree + row.agree, asked + row.repeats))
}

/// What a judge's answer says of one fact among those of its run; nothing where it does not tell. `as_asked` says that all happened; else
/// the words that did not are named, and of the others nothing is known.
fn label(answer: &Answer, quote: &str, facts: &[&str]) -> Option<bool> {
    match answer.says {
        Says::AsAsked => Some(true),
        Says::Partly | Says::Not => {
            let named = plain(&answer.sentence);
            let meant = |fact: &str| {
                let fact = plain(fact);
                !fact.is_empty() && (fact.contains(&named) || named.contains(&fact))
            };
            // Words that stand in several facts do not tell which of them did not happen, unless they hold each of them whole.
            let several = facts.iter().filter(|fact| meant(fact)).count() > 1;
            let whole = named.contains(&plain(quote));
            (meant(quote) && (whole || !several)).then_some(false)
        }
    }
}

/// Small letters, single blanks, no punctuation at the end.
fn plain(words: &str) -> String {
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase();
    words.trim_end_matches(['.', '!', '?', ';', ',']).to_owned()
}

/// What most say; nothing where nobody says anything, or as many say the one as the other.
fn most(labels: impl Iterator<Item = bool>) -> Option<bool> {
    let (shown, not) =
        labels.fold((0_usize, 0_usize), |(shown, not), label| if label { (shown + 1, not) } else { (shown, not + 1) });
    (shown != not).then_some(shown > not)
}

#[cfg(test)]
mod tests {
    use socrates_stats::wilson;

    use super::super::opinion::stub::{ByPlace, Judge, Stub, rows};
    use super::*;

    /// Runs; people label the first half.
    const RUNS: usize = 440;
    /// Share of facts that hold.
    const SHARE: f64 = 0.8;

    fn named(row: &Row) -> Named {
        Named {
            name: format!("label-{}", row.name),
            bundle: row.bundle.clone(),
            run: row.run.clone(),
            recording: row.recording.clone(),
            control: false,
        }
    }

    /// The key and the answers of somebody who is never wrong about the first runs; of several false sentences they name the first.
    fn people(rows: &[Row], most: usize) -> (Vec<Named>, Answers) {
        let mut runs: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
        for row in rows.iter().filter(|row| !row.planted) {
            runs.entry(row.name.clone()).or_default().push(row);
        }
        let labeled = || runs.values().take(most);
        let key = labeled().filter_map(|rows| rows.first()).map(|row| named(row)).collect();
        let answer = |rows: &Vec<&Row>| {
            let wrong = rows.iter().find(|row| row.words.starts_with("false"));
            wrong.map_or(Answer { says: Says::AsAsked, sentence: String::new() }, |row| Answer {
                says: Says::Partly,
                sentence: row.quote.clone(),
            })
        };
        let own = labeled().map(|rows| (format!("label-{}", rows[0].name), answer(rows))).collect();
        (key, Answers::from([("ann".to_owned(), own)]))
    }

    async fn calibrated(judge: &dyn Judge, runs: usize, seed: u64) -> Calibration {
        let rows = rows(judge, runs, SHARE, seed).await;
        let (key, answers) = people(&rows, runs / 2);
        Calibration::of(&rows, &key, &answers)
    }

    fn holds(interval: Interval, value: f64) -> bool {
        interval.low <= value && value <= interval.high
    }

    #[tokio::test]
    async fn how_often_a_judge_errs_is_found_out_and_their_share_is_corrected() {
        let (mut q1, mut q0, mut theta, mut raw) = (0, 0, 0, 0);
        const STUDIES: u64 = 60;
        for seed in 0..STUDIES {
            let judge = Stub { sensitivity: 0.9, specificity: 0.8, seed };
            let found = calibrated(&judge, RUNS, seed).await;
            found.fit().unwrap();
            let interval = |count: Count| wilson(count.hits, count.of, Z_95).unwrap();
            q1 += u64::from(holds(interval(found.sensitivity), 0.9));
            q0 += u64::from(holds(interval(found.specificity), 0.8));
            let share = found.share().unwrap().unwrap();
            theta += u64::from(holds(share.share, SHARE));
            raw += u64::from((share.raw - SHARE).abs() < (share.share.estimate - SHARE).abs());
        }
        // 95 % are 57 of 60; fewer than 52 come about once in 50 000 such trials.
        for (what, held) in [("q1", q1), ("q0", q0), ("theta", theta)] {
            assert!(held >= 52, "{what}: {held} of {STUDIES}");
        }
        // The judge says 0.9 * 0.8 + 0.2 * 0.2 = 0.76: uncorrected it is mostly the worse figure.
        assert!(raw < STUDIES, "{raw}");
    }

    #[tokio::test]
    async fn a_judge_who_leans_to_shown_is_refused() {
        // They see through some planted facts, so that some of their runs count.
        let judge = Stub { sensitivity: 0.95, specificity: 0.3, seed: 5 };
        let found = calibrated(&judge, 3 * RUNS, 5).await;
        assert!(found.sensitivity.of >= LEAST_LABELS && found.specificity.of >= LEAST_LABELS, "{found:?}");
        let told = found.fit().unwrap_err().to_string();
        assert!(
            told.contains("the judge tells little better than chance") && told.contains("hint: ask another"),
            "{told}"
        );
    }

    #[tokio::test]
    async fn a_judge_who_answers_by_the_place_in_the_question_is_refused() {
        let found = calibrated(&ByPlace, 3 * RUNS, 7).await;
        assert!(found.sensitivity.of >= LEAST_LABELS && found.specificity.of >= LEAST_LABELS, "{found:?}");
        assert!(found.fit().unwrap_err().to_string().contains("little better than chance"), "{found:?}");
    }

    #[tokio::test]
    async fn too_few_labels_are_counted_and_refused() {
        let rows = rows(&Stub { sensitivity: 1.0, specificity: 1.0, seed: 1 }, 20, SHARE, 1).await;
        let (key, answers) = people(&rows, 20);
        let found = Calibration::of(&rows, &key, &answers);
        assert_eq!(found.said.of, 0, "every run is labeled");
        let told = found.fit().unwrap_err().to_string();
        let counts = format!("{} facts shown and {} not shown", found.sensitivity.of, found.specificity.of);
        assert!(told.contains(&counts) && told.contains("40 of each are needed"), "{told}");
    }

    #[test]
    fn a_label_is_taken_only_where_the_words_tell_which_fact_is_meant() {
        let facts = ["A nurse comes in.", "A nurse comes out and waves.", "They stop."];
        let said = |says: Says, sentence: &str| Answer { says, sentence: sentence.to_owned() };
        let labels = |answer: &Answer| facts.map(|fact| label(answer, fact, &facts));
        assert_eq!(labels(&said(Says::AsAsked, "")), [Some(true); 3]);
        assert_eq!(labels(&said(Says::Partly, "they stop")), [None, None, Some(false)]);
        assert_eq!(labels(&said(Says::Partly, "comes out and waves")), [None, Some(false), None]);
        assert_eq!(labels(&said(Says::Partly, "a nurse comes")), [None; 3], "which of two is not said");
        assert_eq!(labels(&said(Says::Not, "A nurse comes in. They stop.")), [Some(false), None, Some(false)]);
        assert_eq!(labels(&said(Says::Not, "Somebody sings.")), [None; 3]);
    }

    #[test]
    fn of_several_people_most_are_heard() {
        assert_eq!(most([true, true, false].into_iter()), Some(true));
        assert_eq!((most([true, false].into_iter()), most(std::iter::empty())), (None, None));
    }
}
