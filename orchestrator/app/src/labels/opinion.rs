//! `labels opinion`: a vision model looks at stills of each run and says which facts of its request they show. Off unless a model is named;
//! no verdict knows of it.
//!
//! ```text
//! run ─► stills with letters ─┐
//! request ─► facts ───────────┼─► the judge, several times, in other orders ─► majority ─► second_opinion.csv
//! other runs ─► planted ones ─┘         └─► every answer ─► answers.csv, asked.json (`cost`)
//! ```

mod facts;
mod families;
mod plant;
mod poll;
#[cfg(test)]
pub(super) mod stub;
mod table;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_author::AskError;
use socrates_author::pictured::Onlooker;
use socrates_draw::{Signs, letter};
use socrates_model::{AuthorSpec, Reading, Recording, Request};
use socrates_prompts::opinion::Opinion;

use self::facts::Asked;
use self::plant::Stated;
use self::poll::{Held, Judge, Repeat};
use super::blind::{Candidate, candidates, names};
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::ledger::Ledger;
use crate::output::Printer;
use crate::progress::Progress;
use crate::words::plural;
use crate::{authors, bundle, cost, files};

pub(super) use self::table::{FILE, Row, read};

/// Stills of a run that a judge may get.
const STILLS: RangeInclusive<usize> = 8..=12;
/// Times that a judge may be asked about a run.
const REPEATS: RangeInclusive<usize> = 1..=25;
/// Where the sheets of pictures lie in the folder.
const SHEETS: &str = "sheets";
/// What stands over every sheet; the name of a run would make its pictures another question.
const HEADING: &str = "Pictures of one run";
/// More people than this have no letter in the question.
const LETTERS: usize = 60;
/// Facts, runs and authors are named up to so many.
const NAMED: usize = 12;

/// What `labels opinion` is given.
#[derive(Debug, Clone)]
pub struct OpinionOptions {
    /// Bundles, or folders of bundles.
    pub bundles: Vec<PathBuf>,
    /// The judge, `anthropic:MODEL` and the like; `author.second_opinion` of the configuration where none is named.
    pub model: Option<String>,
    /// Folder of the tables and sheets.
    pub out: PathBuf,
    /// Only the first run of each bundle.
    pub first: bool,
    /// Stills of each run, 8 to 12.
    pub stills: usize,
    /// Times that each run is asked about, 1 to 25.
    pub repeats: usize,
    /// Seed of orders and of what is planted.
    pub seed: u64,
}

/// Does the verb.
pub async fn opinion(talk: &Printer, config: &Config, options: &OpinionOptions) -> Result<(), Diagnostic> {
    let setting = options.model.clone().unwrap_or_else(|| config.text("author.second_opinion"));
    if setting.is_empty() {
        return Err(Diagnostic::input(
            "nobody is named who could give a second opinion",
            "it is off unless a model is named: --model anthropic:MODEL, or `author.second_opinion` in the configuration",
        ));
    }
    within("--stills", options.stills, &STILLS)?;
    within("--repeats", options.repeats, &REPEATS)?;
    let judge = Onlooker::new(&setting, &authors::keys(config)?).map_err(|why| unasked(&why))?;
    let library = Library::of(&options.bundles, options.first)?;
    library.refuse_kin(judge.name())?;
    if let Ok(spec) = setting.parse::<AuthorSpec>() {
        authors::check(config, [&spec]).await?;
    }
    let mut ledger = Ledger::of(judge.name());
    let made = ask(talk, &judge, &mut ledger, &library, options).await;
    // What was asked until an error is paid for all the same.
    ledger.write(&options.out)?;
    let made = made?;
    made.write(&options.out)?;
    made.say(talk, judge.name(), options);
    Ok(())
}

fn within(flag: &str, value: usize, allowed: &RangeInclusive<usize>) -> Result<(), Diagnostic> {
    if allowed.contains(&value) {
        return Ok(());
    }
    Err(Diagnostic::input(
        format!("`{flag}` is `{value}`"),
        format!("allowed: {} to {}", allowed.start(), allowed.end()),
    ))
}

/// The runs that are asked about, and what their requests state.
struct Library {
    runs: Vec<Candidate>,
    stated: Vec<Stated>,
    /// By bundle: the models that wrote it.
    authors: BTreeMap<PathBuf, Vec<String>>,
}

impl Library {
    fn of(bundles: &[PathBuf], first: bool) -> Result<Self, Diagnostic> {
        let runs = candidates(bundles, first, false)?;
        if runs.is_empty() {
            return Err(Diagnostic::input("the bundles hold no run with a robot", "`socrates run` makes one"));
        }
        let (mut stated, mut authors) = (Vec::new(), BTreeMap::new());
        for Candidate { dir, .. } in &runs {
            if authors.contains_key(dir) {
                continue;
            }
            let bundle = bundle::read_some(dir, |_, _| false)?;
            let people = people_of(&bundle.reading);
            let facts = facts::facts(&bundle.request, &bundle.reading, &[]);
            stated.extend(facts.into_iter().map(|fact| Stated { people, fact }));
            authors.insert(dir.clone(), cost::models(dir)?);
        }
        Ok(Self { runs, stated, authors })
    }

    /// Refuses a judge of the family of any author.
    fn refuse_kin(&self, judge: &str) -> Result<(), Diagnostic> {
        let kin: Vec<String> = self
            .authors
            .iter()
            .filter_map(|(dir, authors)| {
                let (author, family) = families::kin(judge, authors)?;
                Some(format!("`{}` was written by `{author}`, of the family {family}", dir.display()))
            })
            .collect();
        if kin.is_empty() {
            return Ok(());
        }
        let mut diagnostic = Diagnostic::input(
            format!("`{judge}` is of the family of an author, so its opinion is no second one"),
            "name a model of another family, or leave those bundles out",
        );
        diagnostic.causes = kin.into_iter().take(NAMED).collect();
        Err(diagnostic)
    }
}

fn people_of(reading: &Reading) -> u32 {
    u32::try_from(reading.humans.len()).unwrap_or(u32::MAX)
}

/// Everything that came of a judge.
#[derive(Debug, Default)]
struct Made {
    rows: Vec<Row>,
    answers: String,
    sheets: Vec<(String, Vec<u8>)>,
    /// Runs that do not count, and why.
    not_judged: Vec<(String, String)>,
    runs: usize,
    questions: usize,
}

/// Asks about every run, until there is no answer.
async fn ask(
    talk: &Printer,
    judge: &dyn Judge,
    ledger: &mut Ledger,
    library: &Library,
    options: &OpinionOptions,
) -> Result<Made, Diagnostic> {
    let mut made = Made::default();
    let mut progress = Progress::new(*talk, "asking", library.runs.len());
    for (index, (candidate, run)) in library.runs.iter().zip(names(library.runs.len())).enumerate() {
        progress.at(index, &run);
        let asked = About::of(candidate, &library.stated, options)?;
        made.runs += 1;
        made.sheets.push((run.clone(), asked.png.clone()));
        if let Some(why) = asked.unfit() {
            made.not_judged.push((run.clone(), why.to_owned()));
            made.rows.extend(asked.rows(&run, &[], false));
            continue;
        }
        let mut repeats = Vec::new();
        for number in 0..options.repeats {
            let seed = poll::seed_of(options.seed, &asked.recording, number);
            let (repeat, end) = poll::repeat(judge, &asked.question, &asked.png, seed).await;
            made.questions += 1;
            ledger.book(&format!("{} {} of {}", asked.run, number + 1, options.repeats), &repeat.answers);
            repeats.push(repeat);
            end.map_err(|why| unasked(&why))?;
        }
        made.take(&run, &asked, &repeats);
    }
    Ok(made)
}

fn unasked(why: &AskError) -> Diagnostic {
    let hint =
        "what was answered is kept where the model is `replay:FOLDER=MODEL`: the same command goes on from there";
    authors::unasked("there is no second opinion".to_owned(), why, hint)
}

/// What is asked about one run.
struct About {
    bundle: String,
    run: String,
    recording: String,
    facts: Vec<Asked>,
    planted: Vec<String>,
    question: Opinion,
    png: Vec<u8>,
}

impl About {
    fn of(candidate: &Candidate, stated: &[Stated], options: &OpinionOptions) -> Result<Self, Diagnostic> {
        let Candidate { dir, run, .. } = candidate;
        let bundle = bundle::read_some(dir, |_, entry| entry.run() == *run)?;
        let Some((recording, report)) = bundle.runs.first() else { return Err(crate::batch::none(dir)) };
        let facts = facts::facts(&bundle.request, &bundle.reading, &report.clauses);
        let hash = recording.hash().to_string();
        let seed = poll::seed_of(options.seed, &hash, usize::MAX);
        let planted = plant::planted(stated, &facts, people_of(&bundle.reading), &bundle.reading, recording, seed);
        let svg = socrates_draw::contact_sheet(HEADING, &bundle.location, recording, options.stills, Signs::Letters);
        let png = socrates_draw::png_from_svg(&svg, 1.0).map_err(|why| {
            Diagnostic::input(format!("the stills of `{}` cannot be drawn: {why}", dir.display()), "")
                .with_code(Code::Ours)
        })?;
        let question = question(&bundle.request, recording, &facts, &planted, options.stills);
        let bundle = dir.canonicalize().unwrap_or_else(|_why| dir.clone()).display().to_string();
        Ok(Self { bundle, run: report.run.to_string(), recording: hash, facts, planted, question, png })
    }

    /// Why nothing can be asked about this run.
    const fn unfit(&self) -> Option<&'static str> {
        if self.facts.is_empty() {
            Some("its request states nothing that pictures could show")
        } else if self.planted.is_empty() {
            Some(
                "no other run of the library with as many people states anything that this run is known not to hold, so nothing can be planted",
            )
        } else {
            None
        }
    }

    /// Names of the facts in the order in which they were numbered: `f1`, …, then `p1`, ….
    fn names(&self) -> Vec<String> {
        let own = (1..=self.facts.len()).map(|number| format!("f{number}"));
        own.chain((1..=self.planted.len()).map(|number| format!("p{number}"))).collect()
    }

    /// The lines of the table.
    fn rows(&self, name: &str, repeats: &[Repeat], judged: bool) -> Vec<Row> {
        let own = self.facts.iter().map(|fact| (fact.words.as_str(), fact.quote.as_str(), fact.program, false));
        let all = own.chain(self.planted.iter().map(|words| (words.as_str(), "", None, true)));
        all.zip(self.names())
            .enumerate()
            .map(|(index, ((words, quote, program, planted), fact))| {
                let majority = poll::majority(repeats, index);
                Row {
                    name: name.to_owned(),
                    bundle: self.bundle.clone(),
                    run: self.run.clone(),
                    recording: self.recording.clone(),
                    fact,
                    words: words.to_owned(),
                    quote: quote.to_owned(),
                    planted,
                    program,
                    held: majority.held,
                    agree: majority.agree,
                    repeats: repeats.len(),
                    pictures: majority.pictures,
                    judged,
                }
            })
            .collect()
    }
}

/// The question about a run: the setting, never what is to happen there, as the statements say that and a planted one would stand out.
fn question(request: &Request, recording: &Recording, facts: &[Asked], planted: &[String], stills: usize) -> Opinion {
    let setting = [("Social context", &request.social_context), ("Task of the robot", &request.task)];
    let setting = setting.into_iter().filter(|(_, words)| !words.trim().is_empty());
    let agents = recording.header.agents.iter().map(|info| info.agent).filter(|agent| agent.number() != 0);
    Opinion {
        setting: setting.map(|(what, words)| (what.to_owned(), words.trim().to_owned())).collect(),
        people: agents.take(LETTERS).map(|agent| (letter(agent), agent.to_string())).collect(),
        statements: facts.iter().map(|fact| fact.words.clone()).chain(planted.iter().cloned()).collect(),
        last_picture: u32::try_from(stills).unwrap_or(u32::MAX),
    }
}

impl Made {
    /// Takes what was said of a run. A judge who finds what was planted has not looked, and one who says nothing has not judged: the run
    /// does not count.
    fn take(&mut self, name: &str, asked: &About, repeats: &[Repeat]) {
        let mut rows = asked.rows(name, repeats, true);
        let fooled = rows.iter().find(|row| row.planted && row.held.shown() == Some(true));
        let why = match fooled {
            Some(row) => Some(format!("`shown` is said of a planted fact: \"{}\"", row.words)),
            None if rows.iter().all(|row| row.held == Held::NoAnswer) => Some("no answer could be read".to_owned()),
            None => None,
        };
        if let Some(why) = why {
            self.not_judged.push((name.to_owned(), why));
            rows.iter_mut().for_each(|row| row.judged = false);
        }
        self.rows.extend(rows);
        self.answers.push_str(&table::answers(name, &asked.names(), repeats));
    }

    fn write(&self, out: &Path) -> Result<(), Diagnostic> {
        for (name, png) in &self.sheets {
            files::write(&out.join(SHEETS).join(format!("{name}.png")), png)?;
        }
        files::write(&out.join(FILE), table::write(&self.rows).as_bytes())?;
        files::write(&out.join(table::ANSWERS), (table::answers_head() + &self.answers).as_bytes())
    }

    /// How many facts that count are held to be what.
    fn counts(&self) -> BTreeMap<&'static str, usize> {
        let mut counts: BTreeMap<&'static str, usize> = Held::ALL.map(|held| (held.word(), 0)).into();
        for row in self.rows.iter().filter(|row| row.judged && !row.planted) {
            *counts.entry(row.held.word()).or_default() += 1;
        }
        counts
    }

    fn say(&self, talk: &Printer, judge: &str, options: &OpinionOptions) {
        let table = options.out.join(FILE);
        let judged = self.runs - self.not_judged.len().min(self.runs);
        let differing: Vec<&Row> = self.rows.iter().filter(|row| row.differs()).collect();
        let asked: Vec<&Row> = self.rows.iter().filter(|row| row.planted && row.repeats > 0).collect();
        let planted = asked.len();
        let believed = asked.iter().filter(|row| row.held.shown() == Some(true)).count();
        talk.line(&format!("wrote      {} · {}", table.display(), plural(self.runs, "run")));
        talk.line(&format!("asked      {judge}: {}", plural(self.questions, "question")));
        for (run, why) in &self.not_judged {
            talk.line(&format!("not judged {run}: {why}"));
        }
        talk.line(&format!("planted    {believed} of {planted} planted facts are said to be shown"));
        let counts = self.counts();
        let told: Vec<String> = counts.iter().map(|(word, count)| format!("{word} {count}")).collect();
        talk.line(&format!("facts      in {}: {}", plural(judged, "judged run"), told.join(", ")));
        for row in differing.iter().take(NAMED) {
            let program = if row.program == Some(true) { "shown" } else { "not_shown" };
            let says = format!("program {program}, opinion {} ({} of {})", row.held.word(), row.agree, row.repeats);
            talk.line(&format!("differs    {} {}: {says}: \"{}\"", row.name, row.fact, row.words));
        }
        talk.line(
            "hint: no share follows from this before `socrates labels calibrate` has held it against labels by people",
        );
        let not_judged: Vec<_> = self.not_judged.iter().map(|(run, why)| json!({"run": run, "why": why})).collect();
        talk.result(&json!({
            "table": table.display().to_string(), "judge": judge, "runs": self.runs, "judged": judged, "not_judged": not_judged,
            "questions": self.questions, "planted": {"count": believed, "of": planted}, "facts": counts,
            "differs": differing.len(),
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::stub::{Stub, judged};
    use super::*;

    #[tokio::test]
    async fn a_judge_who_says_yes_to_everything_judges_no_run_and_that_is_said() {
        let yes = Stub { sensitivity: 1.0, specificity: 0.0, seed: 3 };
        let made = judged(&yes, 6, 0.9, 3).await;
        assert_eq!(made.not_judged.len(), 6);
        let (run, why) = &made.not_judged[0];
        assert_eq!((run.as_str(), why.contains("\"false planted fact of run 0\"")), ("r0000", true), "{why}");
        assert!(made.rows.iter().all(|row| !row.judged), "nothing of such a run counts, and all of it is in the table");
        assert_eq!((made.rows.len(), made.counts()["shown"]), (30, 0));
    }

    #[tokio::test]
    async fn an_honest_judge_judges_every_run_and_differs_where_the_program_is_wrong() {
        let honest = Stub { sensitivity: 1.0, specificity: 1.0, seed: 3 };
        let made = judged(&honest, 20, 0.7, 3).await;
        assert!(made.not_judged.is_empty(), "{:?}", made.not_judged);
        // The program of these runs finds everything.
        let wrong = made.rows.iter().filter(|row| !row.planted && row.words.starts_with("false")).count();
        assert!(wrong > 10 && made.rows.iter().filter(|row| row.differs()).count() == wrong);
        assert_eq!(made.answers.lines().count(), 20 * 5 * 3);
    }

    #[test]
    fn the_question_holds_the_setting_and_not_the_scenario() {
        let text = "location = \"office\"\nsocial_context = \"An office\"\ntask = \"Deliver mail\"\nrough_scenario = \"They pass.\"\n";
        let request = Request::of_toml(text, None).unwrap();
        let header = json!({"format": 1, "run": "x-1.reference-1", "planner": "reference", "seed": 90417, "profile": "native",
            "step_s": 0.01, "leaves": [], "agents": [
                {"agent": "robot", "radius_m": 0.3, "speed_mps": 0.8, "role": "robot"}, {"agent": "human_1", "radius_m": 0.28, "speed_mps": 1.2, "role": "clerk"}]});
        let recording =
            Recording { header: serde_json::from_value(header).unwrap(), frames: Vec::new(), events: Vec::new() };
        let asked = question(&request, &recording, &[], &["They dance.".to_owned()], 8);
        assert_eq!(asked.people, [("A".to_owned(), "human_1".to_owned())]);
        let told: String = asked.messages().into_iter().map(|message| message.text).collect();
        assert!(told.contains("An office") && told.contains("Deliver mail") && told.contains("They dance."), "{told}");
        for hidden in ["They pass.", "reference", "90417"] {
            assert!(!told.contains(hidden), "{hidden}: {told}");
        }
    }
}
