//! `run` and `demo`: the main job.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;
use socrates_model::{Run, Verdict};
use socrates_store::Reader;

use crate::bundle::{self, Bundle};
use crate::conclude::Finished;
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::history::PastJob;
use crate::keep::Keep;
use crate::many::Library;
use crate::output::Printer;
use crate::place::{self, Place};
use crate::prepare::{Prepared, prepare, prepare_text, request_files, scenario_id};
use crate::reading::print_reading;
use crate::refused::Refused;
use crate::replay::values;
use crate::run_options::RunOptions;
use crate::session::Making;
use crate::view::viewing::Viewing;
use crate::wanted::Wanted;
use crate::{dry_run, layout, many, next, shard, stages, work};

/// The shipped request of `demo`.
const DEMO: (&str, &str) = ("hospital", "elevator");

/// Runs the shipped request.
pub async fn demo(talk: &Printer, config: &Config, options: &RunOptions) -> Result<Code, Diagnostic> {
    let requests = socrates_maps::shipped::requests(DEMO.0);
    let (name, text) = requests.into_iter().find(|(stem, _)| *stem == DEMO.1).ok_or_else(|| {
        Diagnostic::input("the shipped request is missing", "this build is damaged").with_code(Code::Ours)
    })?;
    let prepared = prepare_text(name, text, "demo", Path::new("."), Some(options), config)?;
    single_or_batch(talk, config, options, vec![prepared]).await
}

/// Prints how a request is read, and runs nothing; with `write`, puts what was read as a form under the text; with `passes`, prints first what
/// each pass of the reader makes of the rough scenario, whoever reads it.
pub fn read(talk: &Printer, config: &Config, request: &Path, write: bool, passes: bool) -> Result<(), Diagnostic> {
    let prepared = prepare(request, None, config)?;
    let rough = prepared.request.rough_scenario.as_deref().unwrap_or_default();
    let passes = passes.then(|| socrates_offline::passes(rough));
    for line in passes.iter().flat_map(|passes| passes.lines()) {
        talk.line(line);
    }
    print_reading(talk, &prepared);
    let form = write.then(|| write_form(talk, request, &prepared)).transpose()?;
    let mut result = json!({ "reading": prepared.reading, "form": form });
    if let (Some(passes), Some(members)) = (passes, result.as_object_mut()) {
        members.insert("passes".to_owned(), json!(passes));
    }
    talk.result(&result);
    Ok(())
}

/// Puts the form of the text at the end of the request file.
fn write_form(talk: &Printer, file: &Path, prepared: &Prepared) -> Result<String, Diagnostic> {
    let shown = file.display().to_string();
    if !prepared.request.form.is_empty() {
        let what = format!("the request `{shown}` states its people already");
        return Err(Diagnostic::input(what, "correct its [[human]] tables, or take them out to write them anew"));
    }
    if prepared.reading.humans.is_empty() {
        let what = format!("the request `{shown}` names nobody of whom a form could be written");
        return Err(Diagnostic::input(what, "say in rough_scenario who is there; docs/form.md shows the tables"));
    }
    let form = socrates_offline::form_of(&prepared.request, &prepared.reading, &prepared.location);
    let text = crate::files::text(file, u64::MAX, "a request")?;
    let whole = format!("{}\n{form}", text.trim_end());
    // What is written must be a request, or it is not written.
    socrates_model::Request::of_toml(&whole, None).map_err(|problems| {
        let mut diagnostic =
            Diagnostic::input("the form of this text is no request", "state it by hand, see docs/form.md");
        diagnostic.causes = problems.iter().map(|bad| bad.told(&shown)).collect();
        diagnostic.with_code(Code::Ours)
    })?;
    crate::files::write(file, whole.as_bytes())?;
    talk.line(&format!("wrote      {shown} · the form under its text; what it states wins over the text"));
    Ok(form)
}

/// Runs request files.
pub async fn run(
    talk: &Printer,
    config: &Config,
    requests: &[PathBuf],
    options: &RunOptions,
) -> Result<Code, Diagnostic> {
    let (prepared, refused) = prepared_all(config, requests, options)?;
    if options.dry_run {
        checked(options, &prepared)?;
        return dry_run::tell(talk, config, options, prepared, &refused).await;
    }
    if refused.is_empty() {
        return single_or_batch(talk, config, options, prepared).await;
    }
    made(talk, config, options, prepared, &refused).await.map(|library| library.code)
}

/// The same, into a library also where there is one scenario.
pub async fn build(
    talk: &Printer,
    config: &Config,
    requests: &[PathBuf],
    options: &RunOptions,
) -> Result<Code, Diagnostic> {
    if options.dry_run {
        return run(talk, config, requests, options).await;
    }
    library(talk, config, requests, options).await.map(|library| library.code)
}

/// Runs request files into a folder of scenarios, also where there is one.
pub(crate) async fn library(
    talk: &Printer,
    config: &Config,
    requests: &[PathBuf],
    options: &RunOptions,
) -> Result<Library, Diagnostic> {
    let (prepared, refused) = prepared_all(config, requests, options)?;
    // That one scenario is kept or not is a question in a library.
    checked(&RunOptions { keep: None, ..options.clone() }, &prepared)?;
    if options.view {
        return Err(Diagnostic::input(
            "`--view` shows a scenario that is made alone",
            "`socrates view FOLDER` in another terminal shows the folder of a library",
        ));
    }
    if options.ask {
        return Err(Diagnostic::input(
            "`--ask` looks at a scenario while it is made alone",
            "`socrates run REQUEST --ask`",
        ));
    }
    made(talk, config, options, prepared, &refused).await
}

/// Requests as they are run, and those that cannot be.
pub(crate) fn prepared_all(
    config: &Config,
    requests: &[PathBuf],
    options: &RunOptions,
) -> Result<(Vec<Prepared>, Vec<Refused>), Diagnostic> {
    let files = request_files(requests)?;
    let (mut prepared, mut refused) = (Vec::new(), Vec::new());
    for file in &files {
        match prepare(file, Some(options), config) {
            Ok(one) => prepared.push(one),
            Err(why) if files.len() == 1 => return Err(why),
            Err(why) => refused.push(Refused { file: file.clone(), why }),
        }
    }
    Ok((prepared, refused))
}

/// Makes the scenarios of the requests that can be run, and says which cannot.
async fn made(
    talk: &Printer,
    config: &Config,
    options: &RunOptions,
    prepared: Vec<Prepared>,
    refused: &[Refused],
) -> Result<Library, Diagnostic> {
    if refused.is_empty() {
        return many::batch(talk, config, options, prepared, refused).await;
    }
    let what = Refused::told(talk, refused, prepared.len())?;
    let library = many::batch(talk, config, options, prepared, refused).await?;
    talk.warn(&format!("error: {what}\n\nhint: the others were run; correct these and run them alone"));
    Ok(Library { code: Code::Input, ..library })
}

/// Refuses options that do not fit the scenarios, and counts these.
fn checked(options: &RunOptions, prepared: &[Prepared]) -> Result<u64, Diagnostic> {
    pace(&options.pace)?;
    if options.shard.is_some() {
        if options.ask {
            return Err(shard::refused("--ask", "a shard is made where nobody looks"));
        }
        if options.view {
            return Err(shard::refused("--view", "a shard is made where nobody looks"));
        }
    }
    let count: u64 = prepared.iter().map(|one| u64::from(one.request.run.variants)).sum();
    if options.keep.is_some() && count == 1 && options.shard.is_none() {
        return Err(Diagnostic::input(
            "`--keep` says what a library of several scenarios keeps; one is asked for, and it is kept",
            "leave it out, or ask for more with `--variants`",
        ));
    }
    if options.ask && count != 1 {
        return Err(Diagnostic::input(
            format!("`--ask` looks at one scenario; {count} are asked for"),
            "name one request, with `--variants 1`",
        ));
    }
    if options.view && count != 1 {
        return Err(Diagnostic::input(
            format!("`--view` shows one scenario while it is made; {count} are asked for"),
            "without it, `socrates view FOLDER` in another terminal shows the folder of a library",
        ));
    }
    Ok(count)
}

async fn single_or_batch(
    talk: &Printer,
    config: &Config,
    options: &RunOptions,
    prepared: Vec<Prepared>,
) -> Result<Code, Diagnostic> {
    let count = checked(options, &prepared)?;
    let mut prepared = prepared;
    match prepared.pop() {
        Some(one) if count == 1 && options.shard.is_none() => single(talk, config, options, one).await,
        last => {
            prepared.extend(last);
            many::batch(talk, config, options, prepared, &[]).await.map(|library| library.code)
        }
    }
}

/// Checks a pace.
fn pace(text: &str) -> Result<(), Diagnostic> {
    if text == "max" || text.parse::<f64>().is_ok_and(|pace| pace.is_finite() && pace > 0.0) {
        return Ok(());
    }
    Err(Diagnostic::input(format!("`--pace {text}` is no pace"), "`max`, or simulated seconds per second such as 1"))
}

async fn single(talk: &Printer, config: &Config, options: &RunOptions, prepared: Prepared) -> Result<Code, Diagnostic> {
    let mut viewing = None;
    let made = one(talk, config, options, prepared, &mut viewing).await;
    match (viewing, &made) {
        (Some(viewing), Ok(_)) => viewing.stay(talk).await?,
        (Some(viewing), Err(_)) => viewing.leave().await,
        (None, _) => {}
    }
    made
}

/// Makes one scenario, and shows it meanwhile where that is wanted.
async fn one(
    talk: &Printer,
    config: &Config,
    options: &RunOptions,
    prepared: Prepared,
    viewing: &mut Option<Viewing>,
) -> Result<Code, Diagnostic> {
    let shipped = if socrates_maps::shipped::files(&prepared.request.location).is_some() { " (shipped)" } else { "" };
    talk.line(&format!(
        "location   {:<26}author  {}",
        format!("{}{shipped}", prepared.location.name),
        prepared.author_note
    ));
    print_reading(talk, &prepared);
    let wish = bundle::wish(&prepared, options.seed);
    let base = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs").join(format!("{}-{}", prepared.name, options.seed)));
    let dir = match place::place(&base, wish, prepared.is_driven()) {
        Place::Finished(dir) => {
            talk.line(&format!("known      {} was made from this request; nothing to do", dir.display()));
            let bundle = bundle::read(&dir)?;
            if options.view {
                *viewing = Some(Viewing::begin(talk, config, &dir).await?);
            }
            return Ok(finish(talk, options, &prepared, &bundle, None));
        }
        Place::New(dir) => place::told(talk, &base, dir),
    };
    crate::authors::check(config, prepared.asked()).await?;
    let work = place::claim(&dir, wish)?;
    if options.view {
        *viewing = Some(Viewing::begin(talk, config, &dir).await?);
    }
    let id = place::named_like(&dir, scenario_id(&prepared.name, options.seed, 0, 1)?);
    let prepared = Arc::new(prepared);
    let writing = {
        let (dir, work, id, prepared, seed) =
            (dir.clone(), work.clone(), id.clone(), Arc::clone(&prepared), options.seed);
        move || -> Result<Bundle, Diagnostic> {
            let reader = Reader::open(&work::store(&work)).map_err(work::unread)?;
            Finished { dir: &dir, work: &work, id: &id, prepared: &prepared, seed, alone: true, keep: Keep::Folders }
                .by_store(&reader)
        }
    };
    let want = Wanted { id, index: 0, seed: options.seed, prepared: &prepared };
    let then = async { tokio::task::spawn_blocking(writing).await };
    let making = Making { talk, config, options, work: &work, wanted: &[want] };
    let (mut made, outcome) = making.and(then).await?;
    let status = made.statuses.pop().ok_or_else(|| {
        Diagnostic::input("the scenario has no result", "run the same command again").with_code(Code::Ours)
    })?;
    let outcome = outcome.unwrap_or_else(|broke| {
        Err(Diagnostic::input(format!("the bundle could not be written: {broke}"), "").with_code(Code::Ours))
    });
    let past = made.history.of(&status.id);
    talk.line(&stages::line(past, status.result));
    let result = match outcome {
        Ok(bundle) => {
            // The work folder is only needed to resume; the bundle holds everything now.
            drop(std::fs::remove_dir_all(&work));
            finish(talk, options, &prepared, &bundle, Some(past))
        }
        Err(mut diagnostic) => {
            if diagnostic.code != Code::Ours {
                place::end(&dir, status.result);
            }
            diagnostic.result = Some(Box::new(
                json!({ "bundle": dir.display().to_string(), "verdict": null, "stages": told(past), "metrics": {}, "reading": prepared.reading }),
            ));
            return Err(diagnostic);
        }
    };
    Ok(result)
}

/// Prints verdict, robot, where to look, what to try next, and the result object.
fn finish(
    talk: &Printer,
    options: &RunOptions,
    prepared: &Prepared,
    bundle: &Bundle,
    past: Option<&[PastJob]>,
) -> Code {
    let Some((_, report)) = bundle.runs.first() else { return Code::Ours };
    talk.line(&format!("{:<10} {}", report.verdict.name(), report.verdict_text));
    for (_, report) in &bundle.runs {
        let seed = if bundle.runs.len() > 1 { format!(" seed {}", report.seed) } else { String::new() };
        if report.planner.is_no_robot() {
            talk.line(&format!("twin       without the robot{seed}: {:.1} s", report.simulated_s));
            continue;
        }
        let verdict = if bundle.runs.len() > 1 { format!(" · {}", report.verdict) } else { String::new() };
        talk.line(&format!("robot      {}{seed}: {}{verdict}", report.planner, report.robot_text));
    }
    for failed in &bundle.manifest.failed {
        let Run { planner, seed } = &failed.run;
        talk.line(&format!("robot      {planner} seed {seed}: NO RESULT · {}", failed.told()));
    }
    // The first line is that of the first run; of several, this one says how often it happened.
    let played = || bundle.runs.iter().filter(|(_, report)| !report.planner.is_no_robot());
    let lost = bundle.manifest.failed.len();
    if played().count() + lost > 1 {
        let count = |wanted: Verdict| played().filter(|(_, report)| report.verdict == wanted).count();
        let (realised, late) = (count(Verdict::Realised), count(Verdict::RealisedLate));
        let of_them = if late > 0 { format!(", {late} of them late") } else { String::new() };
        let without = if lost > 0 { format!(", {lost} without a result") } else { String::new() };
        let all = played().count() + lost;
        talk.line(&format!("runs       realised in {} of {all}{of_them}{without}", realised + late));
    }
    if bundle.proposal.author.is_rules() {
        talk.line("author     offline: written by rules, not by a language model");
    }
    let dir = bundle.dir.display().to_string();
    talk.line(&format!("look       {dir}/{}", layout::PAGE.path));
    talk.line(&format!("next       {}", next::after_run(options, bundle, prepared.file.as_deref())));
    talk.result(&json!({
        "bundle": dir, "verdict": report.verdict, "stages": past.map(told), "metrics": values(report), "reading": bundle.reading,
        "author": bundle.proposal.author,
        "failed": bundle.manifest.failed,
        "runs": bundle.manifest.runs.iter().map(|run| json!({ "planner": run.planner, "seed": run.seed, "verdict": run.verdict, "recording_hash": run.recording_hash })).collect::<Vec<_>>(),
    }));
    // A run that was wanted and has no result is never met, whatever the others were.
    let is_met = lost == 0 && options.require.is_met(report.verdict == Verdict::Realised);
    if is_met { Code::Ok } else { Code::NotRealised }
}

/// Stages for the result object.
fn told(past: &[PastJob]) -> Vec<serde_json::Value> {
    bundle::stage_rows(past)
        .into_iter()
        .map(|row| json!({ "stage": row.stage, "state": row.state, "attempts": row.attempts, "ms": row.wall_ms, "remark": row.remark }))
        .collect()
}
