//! `study`: files around the study of `socrates-study`.
//!
//! ```text
//! bundles ─► new ─► study.toml ─► build ─► kit ─► serve ─► answers ─► read ─► tables ─► analyze ─► report
//! ```

mod build;
mod correlate;
mod new;
mod scenes;
mod serve;

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_study::analyze::{Declared, analyze as analyzed, results_csv};
use socrates_study::design::Design;
use socrates_study::instrument::Instrument;
use socrates_study::plan::{Ask, STUDIES, orders, pay, power, raters, smallest_found};
use socrates_study::rating::{Origin, Ratings};
use socrates_study::read::{
    Codebook, Format, Pseudonyms, format_of, jspsych, limesurvey, own, participants_csv, prolific, qualtrics,
    ratings_csv, ratings_of_csv,
};
use socrates_study::simulate::{Truth, simulate as simulated};
use socrates_study::{Problem, SCRIPT_PYTHON, SCRIPT_R, page, words};

pub use self::build::{BuildOptions, Clips, build};
pub use self::correlate::{CorrelateOptions, correlate};
pub use self::new::{NewOptions, new};
pub use self::serve::{ServeOptions, serve};
use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;

/// Largest file of answers, bytes.
const MAX_ANSWERS: u64 = 256 * 1024 * 1024;
/// Largest study file, bytes.
const MAX_STUDY: u64 = 4 * 1024 * 1024;
/// Numbers of people whose power is told.
const SIZES: [usize; 5] = [24, 42, 60, 84, 120];

/// Options of `study plan`.
#[derive(Debug, Clone, Copy)]
pub struct PlanOptions {
    /// Planners.
    pub planners: usize,
    /// People per scenario.
    pub people: usize,
    /// Smallest effect that matters, log odds.
    pub effect: f64,
    /// Scenarios.
    pub scenarios: usize,
    /// Items about each film.
    pub items: usize,
    /// Length of a film, s.
    pub length: f64,
    /// Pay for an hour.
    pub hourly: f64,
    /// Seed.
    pub seed: u64,
}

/// Options of `study simulate`.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// Study file.
    pub design: PathBuf,
    /// Folder.
    pub out: PathBuf,
    /// People per scenario.
    pub people: Option<usize>,
    /// Effects by planner, log odds.
    pub effects: Vec<f64>,
    /// People who click without looking.
    pub careless: usize,
    /// Share of answers that are skipped.
    pub skipped: f64,
    /// Seed.
    pub seed: u64,
}

/// Options of `study read`.
#[derive(Debug, Clone)]
pub struct ReadOptions {
    /// Files of answers.
    pub files: Vec<PathBuf>,
    /// Study file.
    pub design: PathBuf,
    /// Folder for the tables.
    pub out: PathBuf,
    /// Prolific's export.
    pub prolific: Option<PathBuf>,
    /// Codebook of Qualtrics' columns.
    pub codebook: Option<PathBuf>,
    /// Key of the names.
    pub key: PathBuf,
}

/// Options of `study analyze`.
#[derive(Debug, Clone)]
pub struct AnalyzeOptions {
    /// Folder of tables, or a table of ratings.
    pub answers: PathBuf,
    /// Study file.
    pub design: PathBuf,
    /// Folder for the report.
    pub out: PathBuf,
    /// The preregistration.
    pub preregistration: Option<PathBuf>,
}

fn bad(why: &Problem) -> Diagnostic {
    Diagnostic::input(why.told(), why.hint.clone())
}

fn name(path: &Path) -> String {
    path.display().to_string()
}

fn design(path: &Path) -> Result<Design, Diagnostic> {
    let text = files::text(path, MAX_STUDY, "a study file; docs/study.md shows one")?;
    Design::parse(&text, &name(path)).map_err(|why| bad(&why))
}

/// Does `study instruments`.
pub fn instruments(talk: &Printer, only: Option<&str>) -> Result<(), Diagnostic> {
    let all = match only {
        Some(id) => vec![Instrument::named(id, "study instruments").map_err(|why| bad(&why))?],
        None => Instrument::shipped().map_err(|why| bad(&why))?,
    };
    for one in &all {
        let items: usize = one.scales.iter().map(|scale| scale.items.len()).sum();
        let valid = if one.validated { "" } else { " · not validated" };
        talk.line(&format!(
            "{:<11} {} · {items} items, {} to {} points{valid}",
            one.id, one.title, one.points.0, one.points.1
        ));
        if only.is_none() {
            continue;
        }
        talk.line(&format!("{}\n{}\n{}", one.source, one.notice, one.stem));
        for scale in &one.scales {
            talk.line(&format!(
                "{}{}",
                scale.id,
                if scale.is_single() { " (single item: fewer than three)" } else { "" }
            ));
            for item in &scale.items {
                talk.line(&format!(
                    "  {:<5} {}{}",
                    item.code,
                    item.text,
                    if item.reversed { " (reversed)" } else { "" }
                ));
            }
        }
    }
    talk.result(&json!({ "instruments": all.iter().map(|one| &one.id).collect::<Vec<_>>() }));
    Ok(())
}

/// Does `study plan`.
pub fn plan(talk: &Printer, options: PlanOptions) -> Result<(), Diagnostic> {
    let PlanOptions { planners, people, effect, scenarios, items, length, hourly, seed } = options;
    if !(2..=8).contains(&planners) || !(1..=10_000).contains(&people) || scenarios == 0 || items == 0 {
        return Err(Diagnostic::input(
            format!("{planners} planners, {people} people, {scenarios} scenarios, {items} items"),
            "2 to 8 planners, 1 to 10000 people, at least one scenario and item",
        ));
    }
    let sound = [effect, length, hourly].iter().all(|value| value.is_finite() && (0.0..=10_000.0).contains(value));
    if !sound || effect > 10.0 {
        return Err(Diagnostic::input(
            format!("effect {effect}, length {length} s, {hourly} an hour"),
            "an effect of 0 to 10 log odds; the others are not negative",
        ));
    }
    let ask = |people| Ask { people, planners, effect, alpha: 0.05, studies: STUDIES, seed };
    let shows = |people: usize| {
        let found = power(ask(people));
        let least = smallest_found(ask(people)).map_or_else(|| "more than 3".to_owned(), |least| format!("{least:.1}"));
        (found, least)
    };
    let (count, below, above) = orders(planners, people);
    let (of, least) = shows(people);
    let said = format!(
        "{people} people find an effect of {effect} log odds on one five-point item in {:.0} of 100 studies by Friedman's test and in {:.0} by the pair that has it (Holm); what they find in 80 of 100 by the pair is {least} log odds or more",
        of.friedman * 100.0,
        of.pair * 100.0
    );
    if people != below {
        let mut why = Diagnostic::input(
            format!("{people} people are no multiple of the {count} orders of {planners} planners"),
            if below == 0 { format!("--people {above}") } else { format!("--people {below} or --people {above}") },
        );
        why.causes = vec![said];
        return Err(why);
    }
    talk.line(&format!(
        "orders     {planners} planners have {count} balanced orders (Williams); each is seen by {} people",
        people / count
    ));
    talk.line(&format!("power      {said}"));
    talk.line("people     Friedman  pair (Holm)   smallest effect found in 80 of 100");
    let mut rows = Vec::new();
    for size in SIZES.iter().map(|size| orders(planners, *size).2) {
        let (of, least) = shows(size);
        talk.line(&format!("{size:<10} {:<9.2} {:<13.2} {least}", of.friedman, of.pair));
        rows.push(json!({ "people": size, "power": of, "smallest": least }));
    }
    let (minutes, all) = pay(planners, length, items, people * scenarios, hourly);
    talk.line(&format!(
        "time       about {minutes:.0} min for each person ({planners} films of {length} s, {items} items each)"
    ));
    talk.line(&format!(
        "pay        {all:.2} for {} people at {hourly} an hour, before the platform's fee",
        people * scenarios
    ));
    for reliability in [0.8, 0.9] {
        let (low, high) = (raters(0.36, reliability), raters(0.22, reliability));
        talk.line(&format!(
            "raters     {:.0} to {:.0} of a film for a reliability of {reliability} of their mean (one rater: 0.36 to 0.22)",
            low.ceil(),
            high.ceil()
        ));
    }
    if of.pair < 0.8 {
        talk.warn(&format!("{people} people are too few for an effect of {effect}: take more people, more items, or a larger smallest effect"));
    }
    talk.result(&json!({ "people": people, "orders": count, "power": of, "smallest": least, "table": rows, "minutes": minutes, "pay": all }));
    Ok(())
}

/// Does `study preregister`.
pub fn preregister(talk: &Printer, study: &Path, out: &Path) -> Result<(), Diagnostic> {
    let design = design(study)?;
    files::write(out, words::preregistration(&design).as_bytes())?;
    talk.line(&format!("wrote      {}", out.display()));
    talk.line(&format!("digest     {}", design.digest));
    talk.result(&json!({ "preregistration": out, "digest": design.digest }));
    Ok(())
}

/// Does `study simulate`.
pub fn simulate(talk: &Printer, options: &SimulateOptions) -> Result<(), Diagnostic> {
    let design = design(&options.design)?;
    let people = options.people.unwrap_or(design.participants);
    let effects = if options.effects.is_empty() { vec![0.0; design.planners.len()] } else { options.effects.clone() };
    let sound =
        effects.iter().all(|one| one.is_finite() && one.abs() <= 10.0) && (0.0..=1.0).contains(&options.skipped);
    if effects.len() != design.planners.len() || !sound || people == 0 || people > 10_000 || options.careless > people {
        return Err(Diagnostic::input(
            format!("effects {effects:?}, {people} people, {} careless, {} skipped", options.careless, options.skipped),
            format!("an effect for each of {}; 1 to 10000 people; a share of 0 to 1", design.planners.join(", ")),
        ));
    }
    let (careless, skipped, seed) = (options.careless, options.skipped, options.seed);
    let truth = Truth { people, effects, order: 0.0, between: 1.63, within: 0.5, careless, skipped, seed };
    let found = simulated(&design, &truth);
    let texts = [
        ("answers.jsonl", found.own()),
        ("qualtrics.csv", found.qualtrics(&design, true)),
        ("jspsych.csv", found.jspsych(&design)),
        ("limesurvey.csv", found.limesurvey(&design)),
        ("prolific.csv", found.prolific()),
    ];
    for (file, text) in &texts {
        files::write(&options.out.join(file), text.as_bytes())?;
        talk.line(&format!("wrote      {}", options.out.join(file).display()));
    }
    talk.result(&json!({ "out": options.out, "careless": found.careless() }));
    Ok(())
}

/// The key of the names: read, or made by the system's chance and kept.
fn key(talk: &Printer, path: &Path) -> Result<Pseudonyms, Diagnostic> {
    use std::io::Read as _;
    let hint = "--key names another file; it holds 64 hexadecimal digits";
    if path.exists() {
        let text = files::text(path, 4096, hint)?;
        let text = text.trim();
        let pair = |at: usize| text.get(2 * at..2 * at + 2).and_then(|two| u8::from_str_radix(two, 16).ok());
        let bytes: Option<Vec<u8>> = (0..32).map(pair).collect();
        let bytes = bytes.filter(|_| text.len() == 64).and_then(|bytes| <[u8; 32]>::try_from(bytes).ok());
        let wrong = || Diagnostic::input(format!("`{}` holds no key", path.display()), hint);
        return Ok(Pseudonyms { key: bytes.ok_or_else(wrong)? });
    }
    let mut key = [0; 32];
    std::fs::File::open("/dev/urandom")
        .and_then(|mut chance| chance.read_exact(&mut key))
        .map_err(|why| Diagnostic::input(format!("no key can be made: {why}"), hint))?;
    let text: String = key.iter().map(|byte| format!("{byte:02x}")).collect();
    files::write(path, format!("{text}\n").as_bytes())?;
    talk.line(&format!(
        "key        {} was made: keep it to read further answers, and never hand it on",
        path.display()
    ));
    Ok(Pseudonyms { key })
}

/// Does `study read`.
pub fn read(talk: &Printer, options: &ReadOptions) -> Result<(), Diagnostic> {
    let design = design(&options.design)?;
    let book = match &options.codebook {
        None => Codebook::default(),
        Some(path) => {
            let text = files::text(path, MAX_STUDY, "a table `column,role,film,item`")?;
            Codebook::read(&text, &name(path)).map_err(|why| bad(&why))?
        }
    };
    let texts = options.files.iter().map(|path| Ok((name(path), files::text(path, MAX_ANSWERS, "a file of answers")?)));
    let texts = texts.collect::<Result<Vec<_>, Diagnostic>>()?;
    let names = key(talk, &options.key)?;
    let mut parts = Vec::new();
    for (file, text) in &texts {
        let part = match format_of(text, file).map_err(|why| bad(&why))? {
            Format::Own => own(text, file, &design, names),
            Format::JsPsych => jspsych(text, file, &design, names),
            Format::LimeSurvey => limesurvey(text, file, &design, names),
            Format::Qualtrics => qualtrics(text, file, &design, names, &book),
        };
        parts.push((file.clone(), part.map_err(|why| bad(&why))?));
    }
    let mut all = Ratings::join(parts).map_err(|why| bad(&why))?;
    if let Some(path) = &options.prolific {
        let text = files::text(path, MAX_ANSWERS, "Prolific's export of submissions")?;
        let left = all.add_submissions(prolific(&text, &name(path), names).map_err(|why| bad(&why))?);
        if left > 0 {
            talk.line(&format!("prolific   {left} submissions have no answers"));
        }
    }
    files::write(&options.out.join("ratings.csv"), ratings_csv(&all, &design, &|_| Vec::new()).as_bytes())?;
    files::write(&options.out.join("participants.csv"), participants_csv(&all).as_bytes())?;
    let given = all.rows.iter().filter(|row| row.rating.points().is_some()).count();
    let (people, missing) = (all.participants.len(), all.rows.len() - given);
    let shown = words::people(people, all.origin);
    talk.line(&format!("read       {shown}, {given} ratings, {missing} missing"));
    warn_of(talk, all.origin);
    talk.line(&format!("tables     {}", options.out.display()));
    talk.result(
        &json!({ "out": options.out, "people": people, "ratings": given, "missing": missing, "simulated": all.origin }),
    );
    Ok(())
}

/// Warns of simulated answers.
fn warn_of(talk: &Printer, origin: Origin) {
    if origin.is_simulated() {
        talk.warn(Origin::MARK);
    }
}

/// The ratings of a folder of tables, or of a table.
fn rated(answers: &Path, design: &Design) -> Result<Ratings, Diagnostic> {
    let is_folder = answers.is_dir();
    let ratings = if is_folder { answers.join("ratings.csv") } else { answers.to_path_buf() };
    let text = files::text(
        &ratings,
        MAX_ANSWERS,
        "`study read` writes `ratings.csv`; a table of ratings can also be named itself",
    )?;
    let people = answers.join("participants.csv");
    let people = if is_folder && people.exists() {
        Some((files::text(&people, MAX_ANSWERS, "the people of `study read`")?, name(&people)))
    } else {
        None
    };
    let people = people.as_ref().map(|(text, file)| (text.as_str(), file.as_str()));
    ratings_of_csv(&text, people, &name(&ratings), design).map_err(|why| bad(&why))
}

/// Does `study analyze`.
pub fn analyze(talk: &Printer, options: &AnalyzeOptions) -> Result<(), Diagnostic> {
    let design = design(&options.design)?;
    let out = &options.out;
    let declared = match &options.preregistration {
        None => Declared::Never,
        Some(path) => {
            let text = files::text(path, MAX_STUDY, "the text that `study preregister` wrote")?;
            let digest = words::registered_digest(&text).ok_or_else(|| {
                let what = format!("`{}` holds no digest of a study file", path.display());
                Diagnostic::input(what, "`study preregister STUDY` writes the text; keep its line with the digest")
            })?;
            if digest == design.digest { Declared::Before } else { Declared::Changed }
        }
    };
    // Before an answer is opened.
    files::write(&out.join("preregistration.md"), words::preregistration(&design).as_bytes())?;
    let ratings = rated(&options.answers, &design)?;
    let results = analyzed(&ratings, &design, declared);
    let broken = |person: &str| results.excluded.get(person).cloned().unwrap_or_default();
    let whole = serde_json::to_string_pretty(&results).map_err(|why| {
        Diagnostic::input(format!("results cannot be written: {why}"), "").with_code(crate::exit::Code::Ours)
    })?;
    let texts = [
        ("ratings.csv", ratings_csv(&ratings, &design, &broken)),
        ("participants.csv", participants_csv(&ratings)),
        ("results.csv", results_csv(&results)),
        ("results.json", whole),
        ("planners.txt", design.planners.iter().map(|planner| format!("{planner}\n")).collect()),
        ("methods.txt", words::methods(&results, &design)),
        ("report.html", page::page(&results, &design)),
        ("analysis.R", SCRIPT_R.to_owned()),
        ("analysis.py", SCRIPT_PYTHON.to_owned()),
    ];
    for (file, text) in &texts {
        files::write(&out.join(file), text.as_bytes())?;
    }
    let shown = words::people(results.people, results.origin);
    talk.line(&format!("answers    {shown}, {} left out by declared rules", results.excluded.len()));
    warn_of(talk, results.origin);
    talk.line(&format!("declared   {}", words::standing(declared)));
    for one in &results.findings {
        let kind = if one.declared { "declared" } else { "exploratory" };
        talk.line(&format!(
            "finding    {} above {} on {} in {}: {:.2} points, p {:.4} after Holm ({kind})",
            one.higher, one.lower, one.dimension, one.scenario, one.points, one.p
        ));
    }
    if results.findings.is_empty() {
        talk.line("finding    no pair of planners differs after Holm's adjustment");
    }
    talk.line(&format!("look       {}", out.join("report.html").display()));
    talk.result(
        &json!({ "out": out, "people": results.people, "excluded": results.excluded, "declared": results.declared,
        "findings": results.findings, "digest": results.digest, "simulated": results.origin }),
    );
    Ok(())
}
