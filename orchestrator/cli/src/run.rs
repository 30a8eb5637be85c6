//! `run` and `demo`: the main job.

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_model::Verdict;
use socrates_model::wire::ScenarioStatus;

use crate::again::values;
use crate::args::{Cli, RunOptions};
use crate::bundle::{self, Bundle};
use crate::config::Config;
use crate::exit::{Code, Complaint};
use crate::library;
use crate::prepare::{Prepared, plural, prepare, prepare_text, request_files, scenario_id};
use crate::session::{Made, Wanted, make};
use crate::talk::Talk;

/// The shipped request of `demo`.
const DEMO: (&str, &str) = ("hospital", "elevator");

/// Runs the shipped request.
pub(crate) async fn demo(talk: &Talk, cli: &Cli, config: &Config, options: &RunOptions) -> Result<Code, Complaint> {
    let requests = socrates_maps::shipped::requests(DEMO.0);
    let (name, text) = requests.into_iter().find(|(stem, _)| *stem == DEMO.1).ok_or_else(|| {
        Complaint::input("the shipped request is missing", "this build is damaged").with_code(Code::Ours)
    })?;
    let prepared = prepare_text(name, text, "demo", Path::new("."), Some(options), config)?;
    single_or_batch(talk, cli, config, options, vec![prepared]).await
}

/// Runs request files.
pub(crate) async fn run(
    talk: &Talk,
    cli: &Cli,
    config: &Config,
    requests: &[PathBuf],
    options: &RunOptions,
) -> Result<Code, Complaint> {
    let files = request_files(requests)?;
    let prepared = files.iter().map(|file| prepare(file, Some(options), config)).collect::<Result<Vec<_>, _>>()?;
    single_or_batch(talk, cli, config, options, prepared).await
}

async fn single_or_batch(
    talk: &Talk,
    cli: &Cli,
    config: &Config,
    options: &RunOptions,
    prepared: Vec<Prepared>,
) -> Result<Code, Complaint> {
    pace(&options.pace)?;
    let count: u64 = prepared.iter().map(|one| u64::from(one.request.run.variants)).sum();
    if options.ask && count != 1 {
        return Err(Complaint::input(
            format!("`--ask` looks at one scenario; {count} are asked for"),
            "name one request, with `--variants 1`",
        ));
    }
    let mut prepared = prepared;
    match prepared.pop() {
        Some(one) if count == 1 => single(talk, cli, config, options, one).await,
        last => {
            prepared.extend(last);
            batch(talk, cli, config, options, prepared, count).await
        }
    }
}

/// Checks a pace.
fn pace(text: &str) -> Result<(), Complaint> {
    if text == "max" || text.parse::<f64>().is_ok_and(|pace| pace.is_finite() && pace > 0.0) {
        return Ok(());
    }
    Err(Complaint::input(format!("`--pace {text}` is no pace"), "`max`, or simulated seconds per second such as 1"))
}

async fn single(
    talk: &Talk,
    cli: &Cli,
    config: &Config,
    options: &RunOptions,
    prepared: Prepared,
) -> Result<Code, Complaint> {
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
    let dir = match place(&base, wish) {
        Place::Finished(dir) => {
            talk.line(&format!("known      {} was made from this request; nothing to do", dir.display()));
            let bundle = bundle::read(&dir)?;
            return Ok(finish(talk, options, &bundle, None));
        }
        Place::New(dir) => dir,
    };
    let work = dir.join(".socrates");
    claim(&dir, &work, wish)?;
    let id = scenario_id(&prepared.name, options.seed, 0, 1)?;
    let wanted = vec![Wanted { id, seed: options.seed, prepared: &prepared }];
    let mut made = make(talk, &cli.flags, config, options, &work, &wanted, wanted.len()).await?;
    let status = made.statuses.pop().ok_or_else(|| {
        Complaint::input("the scenario has no result", "run the same command again").with_code(Code::Ours)
    })?;
    let outcome = conclude(&dir, &prepared, options.seed, &status, &made);
    talk.line(&stage_line(&status));
    let result = match outcome {
        Ok(bundle) => {
            // The work folder is only needed to resume; the bundle holds everything now.
            drop(std::fs::remove_dir_all(&work));
            finish(talk, options, &bundle, Some(&status))
        }
        Err(mut complaint) => {
            complaint.result = Some(Box::new(
                json!({ "bundle": dir.display().to_string(), "verdict": null, "stages": stages(&status), "metrics": {}, "reading": prepared.reading }),
            ));
            return Err(complaint);
        }
    };
    Ok(result)
}

/// Writes the bundle, or says why there is none.
fn conclude(
    dir: &Path,
    prepared: &Prepared,
    seed: u64,
    status: &ScenarioStatus,
    made: &Made,
) -> Result<Bundle, Complaint> {
    let scored =
        status.jobs.iter().any(|job| job.key.stage == socrates_model::job::Stage::Scoring && job.state == "succeeded");
    if scored {
        return bundle::write(dir, prepared, seed, status, made.history.of(&status.id), &|digest| made.fetch(digest));
    }
    let faults: Vec<socrates_model::Fault> =
        status.jobs.iter().filter(|job| job.state != "succeeded").flat_map(|job| job.faults.clone()).collect();
    let author = faults.iter().any(|fault| fault.code.code().starts_with("T-"));
    let mut complaint = Complaint::faults(
        format!("the scenario ended as `{}` before it could be simulated", status.result),
        &faults,
        if author {
            "`socrates config author` shows which author is asked; `--author offline` needs none"
        } else {
            "`socrates explain CODE` says what each fault means; another --seed asks for another answer"
        },
    );
    complaint.code = if author { Code::Author } else { Code::NotRealised };
    Err(complaint)
}

/// Prints verdict, robot, where to look, what to try next, and the result object.
fn finish(talk: &Talk, options: &RunOptions, bundle: &Bundle, status: Option<&ScenarioStatus>) -> Code {
    let Some((_, report)) = bundle.runs.first() else { return Code::Ours };
    talk.line(&format!("{:<10} {}", report.verdict.name(), report.verdict_text));
    for (_, report) in &bundle.runs {
        let seed = if bundle.runs.len() > 1 { format!(" seed {}", report.seed) } else { String::new() };
        if report.planner == "none" {
            talk.line(&format!("twin       without the robot{seed}: {:.1} s", report.simulated_s));
            continue;
        }
        let verdict = if bundle.runs.len() > 1 { format!(" · {}", report.verdict) } else { String::new() };
        talk.line(&format!("robot      {}{seed}: {}{verdict}", report.planner, report.robot_text));
    }
    // The first line is that of the first run; of several, this one says how often it happened.
    let played = || bundle.runs.iter().filter(|(_, report)| report.planner != "none");
    if played().count() > 1 {
        let count = |wanted: Verdict| played().filter(|(_, report)| report.verdict == wanted).count();
        let (realised, late) = (count(Verdict::Realised), count(Verdict::RealisedLate));
        let of_them = if late > 0 { format!(", {late} of them late") } else { String::new() };
        talk.line(&format!("runs       realised in {} of {}{of_them}", realised + late, played().count()));
    }
    if bundle.proposal.author.starts_with("offline") {
        talk.line("author     offline: written by rules, not by a language model");
    }
    let dir = bundle.dir.display().to_string();
    talk.line(&format!("look       {dir}/report.html"));
    let next = if report.verdict == Verdict::Realised {
        format!("socrates run {dir}/request.toml --planner reactive --seeds 1..5")
    } else {
        format!(
            "socrates explain {}; or another --seed",
            report
                .repair
                .as_ref()
                .and_then(|repair| repair.faults.first())
                .map_or("D-SETUP", |fault| fault.code.code())
        )
    };
    talk.line(&format!("next       {next}"));
    talk.result(&json!({
        "bundle": dir, "verdict": report.verdict, "stages": status.map(stages), "metrics": values(report), "reading": bundle.reading,
        "author": bundle.proposal.author,
        "runs": bundle.manifest.runs.iter().map(|run| json!({ "planner": run.planner, "seed": run.seed, "verdict": run.verdict, "recording_hash": run.recording_hash })).collect::<Vec<_>>(),
    }));
    if options.require == "any" || report.verdict == Verdict::Realised { Code::Ok } else { Code::NotRealised }
}

async fn batch(
    talk: &Talk,
    cli: &Cli,
    config: &Config,
    options: &RunOptions,
    prepared: Vec<Prepared>,
    count: u64,
) -> Result<Code, Complaint> {
    let base = options.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("library-{}", options.seed)));
    let wishes: Vec<String> =
        prepared.iter().map(|one| format!("{} {}", bundle::wish(one, options.seed), one.name)).collect();
    let wish = socrates_model::Digest::of(wishes.join("\n").as_bytes());
    let root = match place(&base, wish) {
        Place::Finished(root) => {
            talk.line(&format!("known      {} was made from these requests; nothing to do", root.display()));
            return library::finish(talk, options, &root);
        }
        Place::New(root) => root,
    };
    let work = root.join(".socrates");
    claim(&root, &work, wish)?;
    for one in &prepared {
        talk.line(&format!("request    {:<26}author  {}", one.name, one.author_note));
        print_reading(talk, one);
    }
    let mut wanted = Vec::new();
    for one in &prepared {
        for index in 0..one.request.run.variants {
            let seed = options.seed + u64::from(index);
            wanted.push(Wanted {
                id: scenario_id(&one.name, options.seed, index, one.request.run.variants)?,
                seed,
                prepared: one,
            });
        }
    }
    let made = make(talk, &cli.flags, config, options, &work, &wanted, wanted.len()).await?;
    let mut rows = Vec::new();
    let mut repeats = library::Repeats::default();
    for status in &made.statuses {
        let Some(want) = wanted.iter().find(|want| want.id == status.id) else { continue };
        let dir = root.join(want.id.as_str());
        let known = bundle::manifest(&dir).filter(|manifest| manifest.wish == bundle::wish(want.prepared, want.seed));
        let made = match known {
            Some(manifest) => bundle::read_some(&dir, |_, _| false).map(|bundle| (manifest.verdict, bundle.proposal)),
            None => conclude(&dir, want.prepared, want.seed, status, &made)
                .map(|bundle| (bundle.manifest.verdict, bundle.proposal)),
        };
        let (verdict, repeats) = match made {
            Ok((verdict, proposal)) => (verdict.to_string(), repeats.of(&want.id, &proposal)),
            Err(why) => {
                talk.warn(&format!("{}: {why}", want.id));
                ("failed".to_owned(), None)
            }
        };
        rows.push(library::Row { scenario: want.id.clone(), bundle: dir.display().to_string(), verdict, repeats });
    }
    let readings = prepared.iter().map(|one| one.reading.clone()).collect();
    library::write(&root, &library::Library { wish, count, readings, scenarios: rows })?;
    if let Err(why) = crate::batch::write(&root)?.figures {
        talk.warn(&why.what);
    }
    // The work folder is only needed to resume.
    drop(std::fs::remove_dir_all(&work));
    library::finish(talk, options, &root)
}

/// Prints how a request is read.
pub(crate) fn print_reading(talk: &Talk, prepared: &Prepared) {
    talk.line(&format!("reading    {}", socrates_offline::summary(&prepared.reading)));
    talk.line(&format!("planners   {}", prepared.request.robot.planners.join(", ")));
    for problem in &prepared.reading.problems {
        talk.line(&format!("problem    {problem}"));
    }
    if !prepared.reading.ignored.is_empty() {
        let words: Vec<String> = prepared.reading.ignored.iter().map(|word| format!("\"{word}\"")).collect();
        talk.line(&format!("ignored    {}", words.join(" ")));
    }
    for note in &prepared.reading.notes {
        talk.line(&format!("note       {note}"));
    }
}

enum Place {
    New(PathBuf),
    Finished(PathBuf),
}

/// The folder for this wish: the same again, or the next free suffix.
fn place(base: &Path, wish: socrates_model::Digest) -> Place {
    for number in 1.. {
        let dir = if number == 1 { base.to_path_buf() } else { PathBuf::from(format!("{}-{number}", base.display())) };
        let made = bundle::manifest(&dir)
            .map(|manifest| manifest.wish)
            .or_else(|| library::read(&dir).map(|library| library.wish));
        if let Some(made) = made {
            if made == wish {
                return Place::Finished(dir);
            }
            continue;
        }
        let started = std::fs::read_to_string(dir.join(".socrates/wish")).ok();
        if started.is_none_or(|text| text.trim() == wish.to_string()) {
            return Place::New(dir);
        }
    }
    Place::New(base.to_path_buf())
}

/// Makes the work folder and marks it with the wish, so that the same command resumes it.
fn claim(dir: &Path, work: &Path, wish: socrates_model::Digest) -> Result<(), Complaint> {
    let cannot = |why: std::io::Error| {
        Complaint::input(format!("cannot write into `{}`: {why}", dir.display()), "--out chooses another folder")
    };
    std::fs::create_dir_all(work).map_err(cannot)?;
    std::fs::write(work.join("wish"), wish.to_string()).map_err(cannot)
}

/// Stages of a status for the result object.
fn stages(status: &ScenarioStatus) -> Vec<serde_json::Value> {
    bundle::stage_rows(status)
        .into_iter()
        .map(|row| json!({ "stage": row.stage, "state": row.state, "attempts": row.attempts, "ms": row.wall_ms, "remark": row.remark }))
        .collect()
}

/// `proposal ✔ 3 ms   paths ✔ 11 ms (1 retry: G-MEET)   …`
pub(crate) fn stage_line(status: &ScenarioStatus) -> String {
    let mut parts = Vec::new();
    for stage in socrates_model::job::Stage::WORKERS {
        let jobs: Vec<_> =
            status.jobs.iter().filter(|job| job.key.stage == stage && job.state != "superseded").collect();
        let Some(last) = jobs.iter().max_by_key(|job| job.key.revision) else { continue };
        let mark = match last.state.as_str() {
            "succeeded" => "✔",
            "failed" | "dead" | "canceled" => "✘",
            _ => "…",
        };
        let ms: u64 = jobs.iter().map(|job| job.wall_ms).sum();
        let what = if stage == socrates_model::job::Stage::Simulation && !last.remark.is_empty() {
            format!("{} in {ms} ms", last.remark)
        } else {
            format!("{ms} ms")
        };
        let retries: u32 = jobs.iter().map(|job| job.attempts.saturating_sub(1)).sum::<u32>() + last.key.revision;
        let mut codes: Vec<&str> = status
            .jobs
            .iter()
            .filter(|job| job.key.stage == stage)
            .flat_map(|job| job.faults.iter().map(|fault| fault.code.code()))
            .collect();
        codes.dedup();
        let again = if retries > 0 {
            format!(" ({}{}{})", plural_retry(retries), if codes.is_empty() { "" } else { ": " }, codes.join(", "))
        } else {
            String::new()
        };
        parts.push(format!("{stage} {mark} {what}{again}"));
    }
    parts.join("   ")
}

fn plural_retry(count: u32) -> String {
    if count == 1 { "1 retry".to_owned() } else { plural(count as usize, "retrie") }
}
