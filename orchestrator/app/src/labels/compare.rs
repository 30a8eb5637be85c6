//! `labels compare`: what blind judges said of runs against the verdicts, against each other, and of the controls.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_model::{ScenarioId, Verdict};
use socrates_stats::{Count, cohen_kappa, krippendorff_alpha};

use super::answers::{self, Answers, Says};
use super::door::Door;
use super::key::Named;
use super::share;
use super::{chunks, folders, meets, shown};
use crate::bundle;
use crate::exit::Diagnostic;
use crate::output::Printer;

/// A judge who passes more than this share of the controls is to be replaced: 4 of 20.
const MOST_PASSED: (usize, usize) = (4, 20);

/// What `labels compare` is given.
#[derive(Debug, Clone)]
pub struct CompareOptions {
    /// Tables of answers, of one judge or several each.
    pub labels: Vec<PathBuf>,
    /// The key that was written beside the page.
    pub key: PathBuf,
    /// Bundles, or folders of bundles, that hold the judged runs.
    pub bundles: Vec<PathBuf>,
}

/// Does the verb.
pub fn compare(talk: &Printer, options: &CompareOptions) -> Result<(), Diagnostic> {
    let mut door = Door::default();
    let (key, answers) = answers::judged(&mut door, &options.labels, &options.key)?;
    let verdicts = verdicts(&mut door, &options.key, &key, &folders(&options.bundles)?);
    door.shut("the comparison", &answers::hint(), ())?;
    let controls: BTreeSet<&str> = key.iter().filter(|named| named.control).map(|named| named.name.as_str()).collect();
    let figures = Figures::of(&answers, &verdicts, &controls);
    figures.say(talk);
    talk.result(&figures.told());
    Ok(())
}

/// A run of a bundle.
struct Stored {
    way: Vec<String>,
    run: String,
    recording: String,
    verdict: Verdict,
}

/// The verdict of every run of the key that is no control, as its bundle has it.
fn verdicts(door: &mut Door, file: &Path, key: &[Named], dirs: &[PathBuf]) -> BTreeMap<String, Verdict> {
    let mut stored = Vec::new();
    for dir in dirs {
        let Some(manifest) = bundle::manifest(dir) else { continue };
        let Ok(scenario) = ScenarioId::new(&manifest.scenario) else { continue };
        let way = chunks(dir);
        stored.extend(manifest.runs.iter().map(|entry| Stored {
            way: way.clone(),
            run: entry.run().id(&scenario).to_string(),
            recording: entry.recording_hash.to_string(),
            verdict: entry.verdict,
        }));
    }
    let file = file.display();
    let mut found = BTreeMap::new();
    for named in key.iter().filter(|named| !named.control) {
        let (name, run) = (&named.name, &named.run);
        let same: Vec<&Stored> = stored.iter().filter(|stored| stored.run == *run).collect();
        let seen: Vec<&Stored> = same.iter().copied().filter(|stored| stored.recording == named.recording).collect();
        if seen.is_empty() {
            let why = if same.is_empty() {
                format!("no bundle that was named holds the run `{run}` of `{}`", named.bundle)
            } else {
                format!("the run `{run}` was made anew since the page was written: its recording is another one")
            };
            door.say(format!("{file}: `{name}`: {why}; --bundles takes the folders that were on the page"));
            continue;
        }
        // The same recording may lie in several bundles with verdicts of their own: the one that is called most alike is meant.
        let own = chunks(Path::new(&named.bundle));
        let alike = |stored: &Stored| stored.way.iter().zip(&own).take_while(|(a, b)| a == b).count();
        let most = seen.iter().map(|stored| alike(stored)).max().unwrap_or(0);
        let verdicts: BTreeSet<&str> =
            seen.iter().filter(|stored| alike(stored) == most).map(|stored| stored.verdict.name()).collect();
        match seen.iter().find(|stored| alike(stored) == most) {
            Some(stored) if verdicts.len() == 1 => {
                found.insert(name.clone(), stored.verdict);
            }
            Some(_) | None => door.say(format!(
                "{file}: `{name}`: several bundles hold the run `{run}` with different verdicts; name only those that were on the page"
            )),
        }
    }
    found
}

/// Verdicts and answers: how often each answer was given to runs with the verdict `realised`, and to the others.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Confusion {
    realised: [usize; 3],
    others: [usize; 3],
}

impl Confusion {
    fn of<'a>(says: impl Iterator<Item = (&'a Verdict, Says)>) -> Self {
        let mut table = Self::default();
        for (verdict, says) in says {
            let row = if meets(*verdict) { &mut table.realised } else { &mut table.others };
            row.iter_mut().zip(Says::ALL).filter(|(_, column)| *column == says).for_each(|(count, _)| *count += 1);
        }
        table
    }

    /// Verdict `realised`, judged `partly` or `not`.
    fn false_realised(&self) -> Count {
        let [as_asked, partly, not] = self.realised;
        Count { hits: partly + not, of: as_asked + partly + not }
    }

    /// Of these, judged `not`.
    fn realised_but_not(&self) -> Count {
        let [_, _, not] = self.realised;
        Count { hits: not, of: self.realised.iter().sum() }
    }

    /// Another verdict, judged `as_asked`.
    fn false_refusals(&self) -> Count {
        let [as_asked, _, _] = self.others;
        Count { hits: as_asked, of: self.others.iter().sum() }
    }

    fn told(&self) -> Value {
        let row = |counts: &[usize; 3]| -> BTreeMap<&str, usize> {
            Says::ALL.into_iter().map(Says::word).zip(counts.iter().copied()).collect()
        };
        json!({ "realised": row(&self.realised), "others": row(&self.others), "false_realised": share::told(self.false_realised()),
            "false_realised_not": share::told(self.realised_but_not()), "false_refusals": share::told(self.false_refusals()) })
    }
}

/// Two judges.
#[derive(Debug, Clone, PartialEq)]
struct Pair {
    a: String,
    b: String,
    same: Count,
    kappa: Option<f64>,
}

/// Everything that is said.
#[derive(Debug, Clone, PartialEq)]
struct Figures {
    /// By judge, with the controls that they passed.
    judges: BTreeMap<String, (Confusion, Count)>,
    /// The worst answer of any judge to a run, and the best: `partly` or `not` there means that all say so.
    any: Confusion,
    all: Confusion,
    pairs: Vec<Pair>,
    alpha: Option<f64>,
    /// Words that did not happen, with the runs of which it was said, once for each judge.
    sentences: Vec<(String, Vec<String>)>,
}

impl Figures {
    fn of(answers: &Answers, verdicts: &BTreeMap<String, Verdict>, controls: &BTreeSet<&str>) -> Self {
        let of_judge = |own: &BTreeMap<String, answers::Answer>| {
            let confusion =
                Confusion::of(own.iter().filter_map(|(run, answer)| Some((verdicts.get(run)?, answer.says))));
            let spoiled = || own.iter().filter(|(run, _)| controls.contains(run.as_str()));
            let passed = spoiled().filter(|(_, answer)| answer.says == Says::AsAsked).count();
            (confusion, Count { hits: passed, of: spoiled().count() })
        };
        let judges = answers.iter().map(|(rater, own)| (rater.clone(), of_judge(own))).collect();
        let said = |run: &str| -> Vec<Says> {
            answers.values().filter_map(|own| own.get(run)).map(|answer| answer.says).collect()
        };
        let units: Vec<(&Verdict, Vec<Says>)> = verdicts.iter().map(|(run, verdict)| (verdict, said(run))).collect();
        let over = |pick: fn(&[Says]) -> Option<Says>| {
            Confusion::of(units.iter().filter_map(|(verdict, says)| Some((*verdict, pick(says)?))))
        };
        let lists: Vec<Vec<Says>> = units.iter().map(|(_, says)| says.clone()).collect();
        Self {
            judges,
            any: over(|says| says.iter().max().copied()),
            all: over(|says| says.iter().min().copied()),
            pairs: pairs(answers, verdicts),
            alpha: krippendorff_alpha(&lists).ok(),
            sentences: sentences(answers, controls),
        }
    }

    fn told(&self) -> Value {
        let judges: Vec<Value> = self
            .judges
            .iter()
            .map(|(rater, (confusion, controls))| {
                json!({ "rater": rater, "verdicts": confusion.told(), "controls_passed": share::told(*controls),
                    "replace": replace(*controls) })
            })
            .collect();
        let pairs: Vec<Value> = self
            .pairs
            .iter()
            .map(|pair| json!({ "a": pair.a, "b": pair.b, "same": share::told(pair.same), "kappa": pair.kappa }))
            .collect();
        let sentences: Vec<Value> = self
            .sentences
            .iter()
            .map(|(words, runs)| json!({ "sentence": words, "times": runs.len(), "runs": runs }))
            .collect();
        json!({ "judges": judges, "any": self.any.told(), "all": self.all.told(),
            "agreement": { "pairs": pairs, "alpha": self.alpha }, "sentences": sentences })
    }

    fn say(&self, talk: &Printer) {
        let cells = |[as_asked, partly, not]: [usize; 3]| format!("{as_asked:>8} {partly:>6} {not:>5}");
        talk.line(&format!("{:<16} {:<24} {:<24}", "", "verdict realised", "another verdict"));
        let names = format!("{:>8} {:>6} {:>5}", "as_asked", "partly", "not");
        talk.line(&format!("{:<16} {names:<24} {names}", "judge"));
        let any_all = [("any says so", &self.any), ("all say so", &self.all)];
        let judges = self.judges.iter().map(|(rater, (confusion, _))| (rater.as_str(), confusion));
        let rows: Vec<(&str, &Confusion)> = judges.chain(any_all).collect();
        for (rater, table) in &rows {
            talk.line(&format!("{rater:<16} {:<24} {}", cells(table.realised), cells(table.others)));
        }
        talk.line("false realised (verdict realised, judged partly or not) and false refusals (another verdict, judged as_asked), Wilson 95 %:");
        for (rater, table) in &rows {
            talk.line(&format!(
                "{rater:<16} false realised {}; judged not: {}; false refusals {}",
                share::words(table.false_realised()),
                share::words(table.realised_but_not()),
                share::words(table.false_refusals())
            ));
        }
        for pair in &self.pairs {
            talk.line(&format!(
                "agreement  {} and {}: {}, Cohen's kappa {}",
                pair.a,
                pair.b,
                share::words(pair.same),
                shown(pair.kappa)
            ));
        }
        if self.judges.len() > 2 {
            talk.line(&format!(
                "agreement  of all {} judges: Krippendorff's alpha {}",
                self.judges.len(),
                shown(self.alpha)
            ));
        }
        for (words, runs) in &self.sentences {
            talk.line(&format!("missing    {}× \"{words}\" ({})", runs.len(), runs.join(", ")));
        }
        self.say_controls(talk);
    }

    fn say_controls(&self, talk: &Printer) {
        if self.judges.values().all(|(_, controls)| controls.of == 0) {
            talk.line("controls   none were mixed in: nothing is known of the judges");
            return;
        }
        for (rater, (_, controls)) in &self.judges {
            let what = if replace(*controls) { ": to be replaced" } else { "" };
            talk.line(&format!("controls   {rater} passed {} of {} as as_asked{what}", controls.hits, controls.of));
        }
        let (most, of) = MOST_PASSED;
        talk.line(&format!("controls   a judge who passes more than {most} of {of} is to be replaced"));
    }
}

/// Whether a judge passes too many of the controls.
const fn replace(controls: Count) -> bool {
    controls.hits * MOST_PASSED.1 > MOST_PASSED.0 * controls.of
}

/// Every two judges over the runs that both have judged, controls apart.
fn pairs(answers: &Answers, verdicts: &BTreeMap<String, Verdict>) -> Vec<Pair> {
    let raters: Vec<&String> = answers.keys().collect();
    let mut found = Vec::new();
    for (index, a) in raters.iter().enumerate() {
        for b in raters.iter().skip(index + 1) {
            let says = |rater: &String, run: &String| Some(answers.get(rater)?.get(run)?.says);
            let (first, second): (Vec<Says>, Vec<Says>) =
                verdicts.keys().filter_map(|run| Some((says(a, run)?, says(b, run)?))).unzip();
            let same = first.iter().zip(&second).filter(|(a, b)| a == b).count();
            let kappa = cohen_kappa(&first, &second).ok();
            found.push(Pair { a: (*a).clone(), b: (*b).clone(), same: Count { hits: same, of: first.len() }, kappa });
        }
    }
    found
}

/// The words that did not happen, the most often named first; small letters and a last full stop make no difference.
fn sentences(answers: &Answers, controls: &BTreeSet<&str>) -> Vec<(String, Vec<String>)> {
    let mut named: BTreeMap<String, (String, Vec<String>)> = BTreeMap::new();
    for (run, answer) in answers.values().flatten() {
        if answer.sentence.is_empty() || controls.contains(run.as_str()) {
            continue;
        }
        let plain = answer.sentence.trim_end_matches(['.', '!', ';', ',']).to_lowercase();
        named.entry(plain).or_insert_with(|| (answer.sentence.clone(), Vec::new())).1.push(run.clone());
    }
    let mut found: Vec<(String, Vec<String>)> = named.into_values().collect();
    found.iter_mut().for_each(|(_, runs)| runs.sort());
    found.sort_by(|(a, runs_a), (b, runs_b)| runs_b.len().cmp(&runs_a.len()).then_with(|| a.cmp(b)));
    found
}

#[cfg(test)]
mod tests {
    use super::answers::Answer;
    use super::*;

    fn answers(table: &[(&str, &str, Says, &str)]) -> Answers {
        let mut found = Answers::new();
        for (run, rater, says, sentence) in table {
            let answer = Answer { says: *says, sentence: (*sentence).to_owned() };
            found.entry((*rater).to_owned()).or_default().insert((*run).to_owned(), answer);
        }
        found
    }

    /// Four judged runs and two controls, by two judges: what follows was counted by hand.
    fn figures() -> Figures {
        use Says::{AsAsked, Not, Partly};
        let verdicts = [
            ("r01", Verdict::Realised),
            ("r02", Verdict::RealisedLate),
            ("r03", Verdict::Contradicted),
            ("r04", Verdict::NotTriggered),
        ];
        let verdicts = verdicts.map(|(run, verdict)| (run.to_owned(), verdict)).into();
        let answers = answers(&[
            ("r01", "ann", AsAsked, ""),
            ("r02", "ann", Partly, "A nurse waits."),
            ("r03", "ann", Not, "a nurse waits"),
            ("r04", "ann", AsAsked, ""),
            ("r05", "ann", Not, "spoiled"),
            ("r06", "ann", AsAsked, ""),
            ("r01", "bob", AsAsked, ""),
            ("r02", "bob", AsAsked, ""),
            ("r03", "bob", Not, "They stop."),
            ("r04", "bob", Not, "They stop."),
            ("r05", "bob", Partly, "spoiled"),
            ("r06", "bob", Not, "spoiled"),
        ]);
        Figures::of(&answers, &verdicts, &["r05", "r06"].into())
    }

    #[test]
    fn confusions_are_those_counted_by_hand() {
        let figures = figures();
        let (ann, _) = &figures.judges["ann"];
        assert_eq!(*ann, Confusion { realised: [1, 1, 0], others: [1, 0, 1] });
        assert_eq!(figures.judges["bob"].0, Confusion { realised: [2, 0, 0], others: [0, 0, 2] });
        // r02 is `partly` for one of two, r04 `not` for one of two.
        assert_eq!(figures.any, Confusion { realised: [1, 1, 0], others: [0, 0, 2] });
        assert_eq!(figures.all, Confusion { realised: [2, 0, 0], others: [1, 0, 1] });
        assert_eq!(
            (ann.false_realised(), ann.realised_but_not()),
            (Count { hits: 1, of: 2 }, Count { hits: 0, of: 2 })
        );
        assert_eq!(ann.false_refusals(), Count { hits: 1, of: 2 });
    }

    #[test]
    fn agreement_is_that_counted_by_hand() {
        let figures = figures();
        // The same in 2 of 4. Chance: as_asked 2/4 * 2/4, partly 1/4 * 0, not 1/4 * 2/4: 3/8. Kappa: (1/2 - 3/8) / (5/8) = 0.2.
        let [pair] = figures.pairs.as_slice() else { panic!("{:?}", figures.pairs) };
        assert_eq!(pair.same, Count { hits: 2, of: 4 });
        assert!((pair.kappa.unwrap() - 0.2).abs() < 1e-12, "{pair:?}");
        // Eight answers: 4, 1, 3. D_o = 2 + 2 of 8; D_e = (4 * 4 + 1 * 7 + 3 * 5) / 7 = 38 / 7 of 8. Alpha: 1 - 4 * 7 / 38.
        assert!((figures.alpha.unwrap() - (1.0 - 28.0 / 38.0)).abs() < 1e-12, "{:?}", figures.alpha);
    }

    #[test]
    fn controls_stand_apart_and_sentences_are_counted_without_them() {
        let figures = figures();
        assert_eq!(
            (figures.judges["ann"].1, figures.judges["bob"].1),
            (Count { hits: 1, of: 2 }, Count { hits: 0, of: 2 })
        );
        let runs = |runs: &[&str]| runs.iter().map(|run| (*run).to_owned()).collect::<Vec<_>>();
        let wanted =
            [("A nurse waits.".to_owned(), runs(&["r02", "r03"])), ("They stop.".to_owned(), runs(&["r03", "r04"]))];
        assert_eq!(figures.sentences, wanted);
    }

    #[test]
    fn five_of_twenty_controls_are_too_many_and_four_are_not() {
        let passed = |count: usize, of: usize| replace(Count { hits: count, of });
        assert_eq!(
            [passed(4, 20), passed(5, 20), passed(2, 10), passed(3, 10), passed(0, 0)],
            [false, true, false, true, false]
        );
    }

    #[test]
    fn the_interval_is_that_of_wilson() {
        let told = share::told(Count { hits: 8, of: 10 });
        assert!((told["low"].as_f64().unwrap() - 0.490_162_47).abs() < 1e-6, "{told}");
        assert!((told["high"].as_f64().unwrap() - 0.943_317_8).abs() < 1e-6, "{told}");
        assert!(share::told(Count { hits: 0, of: 0 })["share"].is_null());
    }
}
