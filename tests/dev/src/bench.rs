//! `socrates-dev bench`: the main job as a user meets it, what the bus adds to each of its stages, what a library costs, and how many jobs a
//! cluster passes on.

mod jobs;
mod library;

pub use jobs::{JobsOptions, idle};

use std::path::Path;
use std::time::Instant;

use serde_json::json;
use socrates_app::config::Config;
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::machine;
use socrates_app::output::Printer;
use socrates_app::prepare::{prepare_text, scenario_id};
use socrates_app::run_options::RunOptions;
use socrates_app::session::Making;
use socrates_app::wanted::Wanted;

use crate::program;

/// The request that is made again and again: one that is realised, so that the whole way is measured.
const REQUEST: &str = include_str!("../../../maps/warehouse/scenarios/group.toml");
/// Scenarios that are made one after the other by the same processes.
const SERIES: u64 = 14;
/// The first of them warm the processes up and are not counted.
const WARM_UP: usize = 2;

/// What is measured.
#[derive(Debug, Clone, Copy)]
pub enum What {
    /// One scenario, as the median of this many runs.
    Scenario(u32),
    /// A library of at least this number of scenarios.
    Library(u32),
    /// Jobs that do nothing.
    Jobs(JobsOptions),
}

/// Prints the figures; nothing is judged.
///
/// # Errors
/// What is measured fails, or a program that is started is not there: `socrates`, or this one, whose file is `own`.
pub async fn bench(talk: &Printer, config: &Config, own: Option<&Path>, what: What) -> Result<(), Diagnostic> {
    let folder = config.program().temp.join(format!("socrates-bench-{}", std::process::id()));
    machine::told(&program::build(config)).iter().for_each(|line| talk.line(line));
    let measured = match what {
        What::Library(scenarios) => library::bench(talk, config, scenarios, &folder).await,
        What::Scenario(runs) => measure(talk, config, runs, &folder).await,
        What::Jobs(options) => jobs::bench(talk, config, own, &options, &folder).await,
    };
    drop(std::fs::remove_dir_all(&folder));
    measured
}

async fn measure(talk: &Printer, config: &Config, runs: u32, folder: &Path) -> Result<(), Diagnostic> {
    std::fs::create_dir_all(folder).map_err(|why| ours(why.to_string()))?;
    talk.line("request    warehouse/group.toml (4 humans, author offline), from process start to exit");
    let (times, result) = whole(config, runs, folder)?;
    let (median, least, most) = spread(&times);
    talk.line(&format!(
        "warm run   {median:.0} ms wall, all processes (least {least:.0}, most {most:.0}, {} runs); target 1000 ms",
        times.len()
    ));
    talk.line(&format!("budget     {:.2} of the target", median / 1000.0));
    for stage in result.get("stages").and_then(|stages| stages.as_array()).into_iter().flatten() {
        let name = stage.get("stage").and_then(|name| name.as_str()).unwrap_or_default();
        talk.line(&format!("  {name:<28} {:>5} ms", stage.get("ms").and_then(|ms| ms.as_u64()).unwrap_or_default()));
    }
    let overheads = hand_overs(talk, config, folder).await?;
    let (overhead, fastest, slowest) = spread(&overheads);
    talk.line(&format!(
        "hand-over  {overhead:.0} ms median over the bus, from ready to reported without the work (least {fastest:.0}, most {slowest:.0}, {} jobs); target 5 ms",
        overheads.len()
    ));
    talk.result(&json!({
        "median_ms": median, "least_ms": least, "most_ms": most, "runs": times.len(),
        "hand_over_ms": overhead, "hand_overs": overheads.len(),
    }));
    Ok(())
}

/// The main job on the shipped warehouse, from process start to exit: times in ms, sorted, and the last result.
fn whole(config: &Config, runs: u32, folder: &Path) -> Result<(Vec<f64>, serde_json::Value), Diagnostic> {
    let program = program::of(config)?;
    let request = folder.join("bench.toml");
    std::fs::write(&request, REQUEST).map_err(|why| ours(why.to_string()))?;
    let mut times = Vec::new();
    let mut last = String::new();
    for number in 0..runs.max(1) + 1 {
        let started = Instant::now();
        let out = std::process::Command::new(program)
            .args(["run", "--require", "realised", "--format", "json", "--out"])
            .arg(folder.join(number.to_string()))
            .arg(&request)
            .output()
            .map_err(|why| ours(why.to_string()))?;
        let ms = started.elapsed().as_secs_f64() * 1000.0;
        if !out.status.success() {
            return Err(ours(format!("the bench run failed: {}", String::from_utf8_lossy(&out.stderr))));
        }
        last = String::from_utf8_lossy(&out.stdout).lines().last().unwrap_or_default().to_owned();
        // The first run warms the disk cache and is not counted.
        if number > 0 {
            times.push(ms);
        }
    }
    times.sort_by(f64::total_cmp);
    Ok((times, serde_json::from_str(&last).unwrap_or_default()))
}

/// What each job took beyond its work, ms, sorted: both ways over the bus and the decisions between, with processes that
/// are awake and nothing in line before it.
async fn hand_overs(talk: &Printer, config: &Config, folder: &Path) -> Result<Vec<f64>, Diagnostic> {
    let options = RunOptions { author: Some(socrates_model::AuthorSpec::Offline), ..RunOptions::plain(1) };
    let prepared = prepare_text("bench", REQUEST, "bench", Path::new("."), Some(&options), config)?;
    let wanted = (1..=SERIES)
        .map(|seed| Ok(Wanted { id: scenario_id("bench", seed, 0, 1)?, index: 0, seed, prepared: &prepared }))
        .collect::<Result<Vec<_>, Diagnostic>>()?;
    let work = folder.join("series");
    std::fs::create_dir_all(&work).map_err(|why| ours(why.to_string()))?;
    // Each only when the one before it is done: nothing waits for anything else.
    let made = Making { talk, config, options: &options, work: &work, wanted: &wanted }.in_turn().await?;
    let mut found: Vec<f64> = wanted
        .iter()
        .skip(WARM_UP)
        .flat_map(|want| made.history.of(&want.id))
        .flat_map(|job| &job.attempts)
        .map(|attempt| attempt.span_ms.saturating_sub(attempt.wall_ms))
        .map(|ms| f64::from(u32::try_from(ms).unwrap_or(u32::MAX)))
        .collect();
    found.sort_by(f64::total_cmp);
    Ok(found)
}

/// Median, least and most of sorted values.
fn spread(sorted: &[f64]) -> (f64, f64, f64) {
    let at = |place: usize| sorted.get(place).copied().unwrap_or(f64::NAN);
    (at(sorted.len() / 2), at(0), at(sorted.len().saturating_sub(1)))
}

fn ours(why: String) -> Diagnostic {
    Diagnostic::input(why, "").with_code(Code::Ours)
}
