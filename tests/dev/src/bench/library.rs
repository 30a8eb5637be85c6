//! `socrates-dev bench --library N`: what a library costs, whole: processor time of all processes, by block of scenarios, and memory.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::json;
use socrates_app::config::Config;
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::machine::{self, Used};
use socrates_app::output::Printer;
use socrates_app::{place, work};
use socrates_store::Reader;

use crate::program;

/// Scenarios of a block.
const BLOCK: usize = 100;
/// Between two looks at the processes.
const PAUSE: Duration = Duration::from_millis(100);

/// Processor time when a number of scenarios was done.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    done: usize,
    cpu_s: f64,
}

/// What a library cost.
#[derive(Debug, Default)]
struct Cost {
    wall_s: f64,
    cpu_s: f64,
    /// Processes that make scenarios, as those are made.
    making: Vec<Sample>,
    /// The process that writes bundles and carries messages, as bundles appear: they appear later than they are made.
    writing: Vec<Sample>,
    peaks_mb: BTreeMap<String, f64>,
}

/// Makes at least so many scenarios of all shipped requests, with their bundles, and prints what that took.
pub(super) async fn bench(talk: &Printer, config: &Config, scenarios: u32, folder: &Path) -> Result<(), Diagnostic> {
    let requests = socrates_maps::shipped::names().iter().flat_map(|name| socrates_maps::shipped::requests(name));
    let source = folder.join("requests");
    let mut count = 0_u32;
    for (stem, text) in requests {
        socrates_app::files::write(&source.join(format!("{stem}.toml")), text.as_bytes())?;
        count += 1;
    }
    let variants = scenarios.div_ceil(count.max(1)).max(2);
    let flags = config.passed_on().join(" ");
    let settings = if flags.is_empty() { String::new() } else { format!(" · {flags}") };
    talk.line(&format!(
        "library    {count} shipped requests, {variants} seeds each: {} scenarios with their bundles{settings}",
        count * variants
    ));
    let cost = made(config, variants, &source, &folder.join("library")).await?;
    let total = f64::from(count * variants);
    talk.line(&format!("wall       {:.1} s · {:.1} scenarios a second", cost.wall_s, total / cost.wall_s));
    talk.line(&format!(
        "CPU        {:.1} s of all processes · {:.0} ms a scenario · {:.2} cores busy",
        cost.cpu_s,
        cost.cpu_s * 1e3 / total,
        cost.cpu_s / cost.wall_s
    ));
    let parts = [("making", blocks(&cost.making)), ("writing", blocks(&cost.writing))];
    for (name, blocks) in parts.iter().filter(|(_, blocks)| !blocks.is_empty()) {
        let told: Vec<String> = blocks.iter().map(|ms| format!("{ms:.0}")).collect();
        let (least, mean, most) = span(blocks);
        talk.line(&format!("{name:<10} {} ms a scenario, by blocks of {BLOCK}", told.join(" ")));
        let off = |value: f64| (value / mean - 1.0) * 1e2;
        talk.line(&format!("           mean {mean:.1} · {:+.1} % to {:+.1} %", off(least), off(most)));
    }
    let peaks: Vec<String> = cost.peaks_mb.iter().map(|(name, mb)| format!("{name} {mb:.0}")).collect();
    talk.line(&format!("memory     {} MB at most", peaks.join(" · ")));
    talk.result(&json!({
        "scenarios": count * variants, "wall_s": cost.wall_s, "cpu_s": cost.cpu_s, "cpu_ms_per_scenario": cost.cpu_s * 1e3 / total,
        "cores_busy": cost.cpu_s / cost.wall_s, "block": BLOCK, "blocks_ms": BTreeMap::from(parts), "peaks_mb": cost.peaks_mb,
    }));
    Ok(())
}

/// Makes the library in processes of its own and looks at them from time to time.
async fn made(config: &Config, variants: u32, source: &Path, out: &Path) -> Result<Cost, Diagnostic> {
    let program = program::of(config)?;
    let mut command = Command::new(program);
    command
        .args(["run", "--require", "any", "--repeats", "--variants", &variants.to_string(), "--out"])
        .arg(out)
        .arg(source);
    command.args(config.passed_on());
    let before = machine::ended_children_s();
    let started = Instant::now();
    let log = std::fs::File::create(source.with_extension("log")).map_err(|why| super::ours(why.to_string()))?;
    let child = command.stdout(Stdio::null()).stderr(log).spawn().map_err(|why| super::ours(why.to_string()))?;
    let mut cost = Cost::default();
    let status = watched(child, out, &mut cost).await?;
    (cost.wall_s, cost.cpu_s) = (started.elapsed().as_secs_f64(), machine::ended_children_s() - before);
    if status.success() {
        return Ok(cost);
    }
    let log = std::fs::read_to_string(source.with_extension("log")).unwrap_or_default();
    Err(Diagnostic::input(format!("the library could not be made: {log}"), "").with_code(Code::Ours))
}

/// Waits for the end of a making and notes on the way what it uses.
async fn watched(mut child: Child, out: &Path, cost: &mut Cost) -> Result<std::process::ExitStatus, Diagnostic> {
    let id = child.id();
    loop {
        if let Some(status) = child.try_wait().map_err(|why| super::ours(why.to_string()))? {
            return Ok(status);
        }
        let family = machine::family(id);
        let made = Reader::open(&work::store(&out.join(place::WORK))).and_then(|reader| reader.standings(0, u64::MAX));
        let made = made.map_or(0, |all| all.iter().filter(|one| one.result.is_some()).count());
        let bundles = std::fs::read_dir(out).map_or(0, |entries| {
            let names = entries.filter_map(Result::ok).map(|entry| entry.file_name());
            names.filter(|name| !name.as_encoded_bytes().starts_with(b".")).count()
        });
        let cpu_s =
            |of: bool| family.iter().filter(|(other, _)| (**other == id) == of).map(|(_, used)| used.cpu_s).sum();
        // The store goes with the work folder, when everything is made.
        let made = made.max(cost.making.last().map_or(0, |last| last.done));
        cost.making.push(Sample { done: made, cpu_s: cpu_s(false) });
        cost.writing.push(Sample { done: bundles, cpu_s: cpu_s(true) });
        // One that has just been started has no name yet.
        for Used { name, peak_mb, .. } in family.into_values().filter(|used| !used.name.is_empty()) {
            let name = if name.starts_with("run") { "run".to_owned() } else { name };
            let peak = cost.peaks_mb.entry(name).or_default();
            *peak = peak.max(peak_mb);
        }
        tokio::time::sleep(PAUSE).await;
    }
}

/// Processor time per scenario of each whole block, ms: the time between the moments at which its first and its last scenario
/// was done, between two samples in proportion.
fn blocks(samples: &[Sample]) -> Vec<f64> {
    #[expect(clippy::cast_precision_loss, reason = "counts of scenarios")]
    let at = |done: usize| -> Option<f64> {
        let after = samples.iter().position(|sample| sample.done >= done)?;
        let later = samples.get(after)?;
        let earlier = after.checked_sub(1).and_then(|before| samples.get(before)).unwrap_or(later);
        let gained = later.done.saturating_sub(earlier.done).max(1) as f64;
        let share = done.saturating_sub(earlier.done) as f64 / gained;
        Some(earlier.cpu_s + (later.cpu_s - earlier.cpu_s) * share.min(1.0))
    };
    let most = samples.iter().map(|sample| sample.done).max().unwrap_or(0);
    #[expect(clippy::cast_precision_loss, reason = "a hundred")]
    let per = 1e3 / BLOCK as f64;
    (0..most / BLOCK).filter_map(|block| Some((at((block + 1) * BLOCK)? - at(block * BLOCK)?) * per)).collect()
}

/// Least, mean and largest of some values.
fn span(values: &[f64]) -> (f64, f64, f64) {
    #[expect(clippy::cast_precision_loss, reason = "a few blocks")]
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    (least, mean, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_costs_what_was_used_between_its_first_and_its_last_scenario() {
        let samples: Vec<Sample> = [(0, 0.0), (0, 2.0), (50, 7.0), (150, 17.0), (200, 27.0)]
            .map(|(done, cpu_s)| Sample { done, cpu_s })
            .into();
        // The start belongs to the first block: 12 s for 100, then 10 s and the rest.
        assert_eq!(blocks(&samples), [120.0, 150.0]);
        assert!(blocks(&[]).is_empty());
        let (least, mean, most) = span(&[1.0, 2.0, 6.0]);
        assert!((least - 1.0).abs() + (mean - 3.0).abs() + (most - 6.0).abs() < 1e-12);
    }
}
