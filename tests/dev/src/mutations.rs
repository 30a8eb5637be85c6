//! `socrates-dev mutations`: does the judge refuse what is wrong and let pass what is right? Measured on real runs.

mod further;
pub(crate) mod lacks;
mod others;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_app::config::Config;
use socrates_app::exit::Diagnostic;
use socrates_app::in_process::{self, Made};
use socrates_app::output::Printer;
use socrates_app::prepare::{Prepared, prepare, prepare_text, request_files};
use socrates_author::Written;
use socrates_author::offline::Offline;
use socrates_model::job::Stage;
use socrates_model::{Behaviors, Fault, Paths, Proposal, Recording, Report, Run, ScenarioId, Verdict};
use socrates_scoring::Evidence;

use crate::mutants::{harmless, spoiled, time_margin};
use lacks::Table;
use others::{FAR, MOVED, other_scenarios, parts_from_afar, same_meeting};

/// Rounds of authoring: what the orchestrator would also ask again.
const ROUNDS: u64 = 4;
/// A request with its artifacts, its run with the reference robot, and what the judge says of it.
pub(crate) struct Scenario {
    pub(crate) prepared: Prepared,
    pub(crate) made: Made,
    pub(crate) run: Recording,
    pub(crate) report: Report,
    pub(crate) seed: u64,
}

/// How one kind of change fared.
#[derive(Default)]
struct Row {
    tried: usize,
    right: usize,
}

/// Everything that was tried.
#[derive(Default)]
pub(crate) struct Tally {
    spoiled: BTreeMap<String, Row>,
    harmless: BTreeMap<String, Row>,
    /// By how much each human could have been sooner and later, s.
    margins: Vec<(String, f64, f64)>,
    /// Changed artifacts that gave the same meeting all the same: nothing is wrong with those runs.
    equal: usize,
    wrong: Vec<String>,
    lines: Vec<String>,
}

impl Tally {
    /// How often a kind of change was tried and how often it was refused.
    #[cfg(test)]
    pub(crate) fn spoiled_of(&self, kind: &str) -> (usize, usize) {
        self.spoiled.get(kind).map_or((0, 0), |row| (row.tried, row.right))
    }

    /// What went wrong, a line each.
    #[cfg(test)]
    pub(crate) fn wrong(&self) -> &[String] {
        &self.wrong
    }

    fn enter(&mut self, wanted: bool, kind: &str, about: &str, base: &str, verdict: &str, why: &str) {
        let kept = verdict == Verdict::Realised.name();
        let row = if wanted { &mut self.harmless } else { &mut self.spoiled }.entry(kind.to_owned()).or_default();
        row.tried += 1;
        row.right += usize::from(kept == wanted);
        let line = format!("{base}: {kind} ({about}): {verdict} · {why}");
        if kept != wanted {
            self.wrong.push(line.clone());
        }
        self.lines.push(line);
    }
}

/// Does `socrates-dev mutations`.
pub async fn mutations(
    talk: &Printer,
    config: &Config,
    requests: &[PathBuf],
    seeds: std::ops::Range<u64>,
    all: bool,
) -> Result<(), Diagnostic> {
    let scenarios = if requests.is_empty() { shipped(config)? } else { named(config, requests)? };
    let mut tally = Tally::default();
    let mut unrealised = Vec::new();
    let mut bases = 0;
    for prepared in &scenarios {
        for seed in seeds.clone() {
            talk.passing(&format!("{} seed {seed}", prepared.name));
            let name = format!("{}-{seed}", prepared.name);
            match realised(prepared.clone(), seed).await {
                Ok(scenario) if scenario.report.verdict == Verdict::Realised => {
                    bases += 1;
                    try_all(&scenario, &name, &mut tally);
                }
                Ok(Scenario { report, .. }) => {
                    unrealised.push(format!("{name}: {} · {}", report.verdict, report.verdict_text));
                }
                Err(why) => unrealised.push(format!("{name}: {why}")),
            }
        }
    }
    let mut lacking = Table::default();
    let own = if requests.is_empty() { lacks::asked(config)? } else { lacks::of_requests(&scenarios) };
    for seed in seeds {
        for base in lacks::bases(&own, seed).await {
            talk.passing(&base.name);
            lacking.enter(&base);
        }
    }
    talk.clear();
    print(talk, &tally, &lacking, bases, &unrealised, all);
    Ok(())
}

pub(crate) fn shipped(config: &Config) -> Result<Vec<Prepared>, Diagnostic> {
    let mut found = Vec::new();
    for location in socrates_maps::shipped::names() {
        for (name, text) in socrates_maps::shipped::requests(location) {
            let name = format!("{location}-{}", name.trim_end_matches(".toml"));
            found.push(prepare_text(&name, text, &name, Path::new("."), None, config)?);
        }
    }
    Ok(found)
}

fn named(config: &Config, requests: &[PathBuf]) -> Result<Vec<Prepared>, Diagnostic> {
    request_files(requests)?.iter().map(|file| prepare(file, None, config)).collect()
}

/// The scenario of a request with its reference run, asked again where the verdict says so.
pub(crate) async fn realised(prepared: Prepared, seed: u64) -> Result<Scenario, String> {
    let mut feedback: BTreeMap<Stage, Vec<Fault>> = BTreeMap::new();
    let mut last = Err("was never asked for".to_owned());
    for round in 0..ROUNDS {
        let made = author(&prepared, seed * 1000 + round, &mut feedback).await;
        let made = match made {
            Ok(made) => made,
            Err(why) => {
                last = Err(why);
                continue;
            }
        };
        let run = simulate(&prepared, &made, seed)?;
        let report = judge(&prepared, &made, &run);
        if let Some(repair) = &report.repair {
            feedback.entry(repair.stage).or_default().clone_from(&repair.faults);
        }
        let done = report.verdict == Verdict::Realised;
        last = Ok((made, run, report));
        if done {
            break;
        }
    }
    last.map(|(made, run, report)| Scenario { prepared, made, run, report, seed })
}

/// Asks the offline author for everything, as the authoring stages do.
async fn author(prepared: &Prepared, seed: u64, feedback: &mut BTreeMap<Stage, Vec<Fault>>) -> Result<Made, String> {
    let mut proposal: Option<Proposal> = None;
    let mut paths: Option<Paths> = None;
    let mut behaviors: Option<Behaviors> = None;
    for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
        let question = socrates_prompts::Question {
            stage,
            proposal: proposal.clone(),
            feedback: feedback.get(&stage).cloned().unwrap_or_default(),
            ..socrates_prompts::Question::first(
                prepared.request.clone(),
                prepared.reading.clone(),
                prepared.location.clone(),
                seed,
            )
        };
        match socrates_author::attempt(&Offline, &question).await {
            Ok(answer) => match answer.written {
                Written::Proposal(found) => proposal = Some(found),
                Written::Paths(found) => paths = Some(found),
                Written::Behaviors(found) => behaviors = Some(found),
            },
            Err(refused) => {
                let why = format!("{stage} refused: {}", texts(&refused.faults));
                feedback.insert(stage, refused.faults);
                return Err(why);
            }
        }
    }
    match (proposal, paths, behaviors) {
        (Some(proposal), Some(paths), Some(behaviors)) => Ok(Made { proposal, paths, behaviors }),
        _ => Err("a stage has no answer".to_owned()),
    }
}

fn texts(faults: &[Fault]) -> String {
    faults.iter().map(|fault| format!("{} {}", fault.code, fault.message)).collect::<Vec<_>>().join("; ")
}

fn simulate(prepared: &Prepared, made: &Made, seed: u64) -> Result<Recording, String> {
    let scenario = ScenarioId::new("mutations").map_err(|why| why.to_string())?;
    let run = Run::reference(seed);
    in_process::simulate(&prepared.request, &prepared.location, made.clone(), run.id(&scenario), &run)
        .map_err(|faults| texts(&faults))
}

fn judge(prepared: &Prepared, made: &Made, recording: &Recording) -> Report {
    socrates_scoring::score(&evidence(prepared, made, recording))
}

pub(crate) fn evidence<'a>(prepared: &'a Prepared, made: &'a Made, recording: &'a Recording) -> Evidence<'a> {
    in_process::evidence(&prepared.request, &prepared.reading, &prepared.location, made, recording)
}

/// Every harmless and every spoiling change of a realised scenario.
pub(crate) fn try_all(scenario: &Scenario, name: &str, tally: &mut Tally) {
    let Scenario { prepared, made, run, seed, .. } = scenario;
    for human in &made.proposal.humans {
        let (sooner, later) = time_margin(&evidence(prepared, made, run), human.id);
        tally.margins.push((format!("{name} {}", human.id), sooner, later));
    }
    for mutant in harmless(run) {
        let report = judge(prepared, made, &mutant.recording);
        tally.enter(true, mutant.kind, &mutant.about, name, report.verdict.name(), &report.verdict_text);
    }
    for mutant in spoiled(&evidence(prepared, made, run)) {
        let report = judge(prepared, made, &mutant.recording);
        tally.enter(false, mutant.kind, &mutant.about, name, report.verdict.name(), &report.verdict_text);
    }
    for (kind, about, other) in other_scenarios(prepared, made) {
        let told = about.to_string();
        // Played from other artifacts, judged by those that were asked for.
        match simulate(prepared, &other, *seed) {
            Ok(recording) if kind == MOVED && same_meeting(run, &recording, &about) => tally.equal += 1,
            Ok(recording) if kind == FAR && !parts_from_afar(run, &recording, &about) => tally.equal += 1,
            Ok(recording) => {
                let report = judge(prepared, made, &recording);
                tally.enter(false, kind, &told, name, report.verdict.name(), &report.verdict_text);
            }
            Err(why) => tally.enter(false, kind, &told, name, "refused before the run", &why),
        }
    }
}

fn share(right: usize, tried: usize) -> String {
    let interval = socrates_stats::wilson(right, tried, socrates_stats::Z_95).ok();
    #[expect(clippy::cast_precision_loss, reason = "counts of a table")]
    let percent = if tried == 0 { 0.0 } else { 100.0 * right as f64 / tried as f64 };
    interval.map_or_else(
        || "none tried".to_owned(),
        |interval| format!("{percent:.1} % ({:.1} to {:.1})", interval.low * 100.0, interval.high * 100.0),
    )
}

fn print(talk: &Printer, tally: &Tally, lacking: &Table, bases: usize, unrealised: &[String], all: bool) {
    let sum = |rows: &BTreeMap<String, Row>| {
        rows.values().fold((0, 0), |(right, tried), row| (right + row.right, tried + row.tried))
    };
    let table = |title: &str, word: &str, rows: &BTreeMap<String, Row>| {
        talk.line(&format!("{title:<38} tried  {word}"));
        for (kind, row) in rows {
            talk.line(&format!("  {kind:<36} {:>5}  {}", row.tried, share(row.right, row.tried)));
        }
        let (right, tried) = sum(rows);
        talk.line(&format!("  {:<36} {tried:>5}  {}", "all", share(right, tried)));
    };
    talk.line(&format!("{bases} realised runs, {} not", unrealised.len()));
    for line in unrealised {
        talk.line(&format!("  not realised  {line}"));
    }
    table("spoiled", "refused", &tally.spoiled);
    talk.line(&format!(
        "  ({} more with an encounter moved in the paths gave the same meeting and are not counted)",
        tally.equal
    ));
    table("harmless", "let pass", &tally.harmless);
    let middle = |of: &dyn Fn(&(String, f64, f64)) -> f64| {
        let mut all: Vec<f64> = tally.margins.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    talk.line(&format!(
        "time margin: half of {} people could be {:.2} s sooner, {:.2} s later and more (0.25 to 6 s tried)",
        tally.margins.len(),
        middle(&|margin| margin.1),
        middle(&|margin| margin.2)
    ));
    for (who, sooner, later) in tally.margins.iter().filter(|_| all) {
        talk.line(&format!("  {who:<36} {sooner:.2} s sooner, {later:.2} s later"));
    }
    for line in if all { &tally.lines } else { &tally.wrong } {
        talk.line(&format!("  {}{line}", if all { "" } else { "WRONG  " }));
    }
    lacking.print(talk);
    let (caught, spoiled) = sum(&tally.spoiled);
    let (kept, harmless) = sum(&tally.harmless);
    talk.result(&json!({
        "runs": bases,
        "unrealised": unrealised,
        "spoiled": { "tried": spoiled, "refused": caught },
        "harmless": { "tried": harmless, "let_pass": kept },
        "time_margins": tally.margins,
        "wrong": tally.wrong,
        "without": lacking.json(),
        "without_wrong": lacking.wrong,
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn of_real_runs_spoiled_ones_are_refused_and_harmless_changes_pass() {
        let config = Config::load(None, std::iter::empty(), &[]).unwrap();
        let mut tally = Tally::default();
        let mut bases = 0;
        for prepared in shipped(&config)
            .unwrap()
            .iter()
            .filter(|prepared| ["frontal", "group", "crossing"].iter().any(|kind| prepared.name.contains(kind)))
        {
            let scenario = realised(prepared.clone(), 1).await.unwrap();
            let report = &scenario.report;
            assert_eq!(report.verdict, Verdict::Realised, "{}: {}", prepared.name, report.verdict_text);
            bases += 1;
            try_all(&scenario, &prepared.name, &mut tally);
        }
        assert!(bases >= 2);
        let sum = |rows: &BTreeMap<String, Row>| {
            rows.values().fold((0, 0), |(right, tried), row| (right + row.right, tried + row.tried))
        };
        let ((caught, spoiled), (kept, harmless)) = (sum(&tally.spoiled), sum(&tally.harmless));
        assert!(spoiled >= 10 && caught * 100 >= spoiled * 95, "{caught} of {spoiled}: {:#?}", tally.wrong);
        assert!(harmless >= 6 && kept * 100 >= harmless * 95, "{kept} of {harmless}: {:#?}", tally.wrong);
    }
}
