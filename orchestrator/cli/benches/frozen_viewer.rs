//! What a viewer costs a run: processor time of the simulation's worker with one that reads every tick, and with one that is stopped
//! (SIGSTOP) and reads nothing, in interleaved pairs at `--pace max`. Both recordings must be the same.
//!
//! ```text
//! cargo bench -p socrates --bench frozen_viewer            # 20 pairs; BENCH_PAIRS=5 for fewer
//! ```
//!
//! Linux alone: processor time is read from `/proc`, in steps of 10 ms.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "a bench ends where it cannot measure, and prints what it measured"
)]

use std::path::Path;

use socrates_tests::program::{children, finish, poll, signal, start};

const PROGRAM: &str = env!("CARGO_BIN_EXE_socrates");

/// Long and crowded, so that steps of 10 ms do not matter.
const REQUEST: &str = r#"
location = "warehouse"
social_context = "A warehouse in the middle of a shift"
task = "Carry a box"
rough_scenario = "Eight people walk through the hall."

[run]
duration = "120s"
"#;

/// Runs, one after another in the same worker.
const SEEDS: &str = "1..12";

/// Processor time of a process and all its threads so far, ms.
fn cpu_ms(pid: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |place: usize| fields.get(place)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) * 10.0)
}

/// Digests of everything that was recorded.
fn recorded(bundle: &Path) -> String {
    let text = std::fs::read_to_string(bundle.join("details/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    let runs = manifest["runs"].as_array().cloned().unwrap_or_default();
    assert!(!runs.is_empty(), "{manifest}");
    runs.iter().map(|run| run["recording_hash"].to_string()).collect()
}

/// One run with a viewer: processor time of its simulation, ms, ticks that the viewer had, and what was recorded.
fn watched(folder: &Path, name: &str, frozen: bool) -> (f64, u64, String) {
    let out = folder.join(name);
    let (file, shown) = (folder.join("request.toml").display().to_string(), out.display().to_string());
    let args = ["run", &file, "--out", &shown, "--pace", "max", "--require", "any", "--seeds", SEEDS];
    let run = start(PROGRAM, &args, folder, name).unwrap();
    let place =
        poll(|| std::fs::read_to_string(out.join(".socrates/endpoint")).ok().filter(|text| text.lines().count() >= 2));
    assert!(place.is_some(), "the run did not start");
    let viewer = start(PROGRAM, &["--format", "json", "watch", &shown], folder, "viewer").unwrap();
    let pid = poll(|| {
        children(run.id()).into_iter().find(|(_, line)| line.contains("worker simulation ")).map(|(pid, _)| pid)
    });
    let (pid, told) = (pid.unwrap(), folder.join("viewer.out"));
    if frozen {
        // Not before it has begun to read.
        let begun = poll(|| std::fs::metadata(&told).ok().filter(|file| file.len() > 0).map(drop));
        assert!(begun.is_some() && signal(viewer.id(), "STOP").unwrap(), "the viewer could not be stopped");
    }
    let mut used = 0.0;
    let ended = poll(|| {
        let now = cpu_ms(pid);
        used = now.unwrap_or(used);
        now.is_none().then_some(())
    });
    assert!(ended.is_some(), "the simulation did not end");
    let run = finish(run, folder, name).unwrap();
    assert_eq!(run.code, 0, "{}", run.err);
    if frozen {
        assert!(signal(viewer.id(), "CONT").unwrap());
    }
    let viewer = finish(viewer, folder, "viewer").unwrap();
    let ticks = viewer.out.lines().filter(|line| line.contains("\"type\":\"tick\"")).count();
    let digest = recorded(&out);
    std::fs::remove_dir_all(&out).unwrap();
    (used, ticks as u64, digest)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { f64::midpoint(values[middle - 1], values[middle]) }
}

fn main() {
    // What `cargo bench` hands to every bench is of no meaning here.
    let pairs = std::env::var("BENCH_PAIRS").ok().and_then(|pairs| pairs.parse().ok()).unwrap_or(20_u32);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("request.toml"), REQUEST).unwrap();
    let (mut differences, mut reading_ms, mut heard) = (Vec::new(), Vec::new(), (0, 0));
    for pair in 0..pairs {
        // Whichever is first has the colder machine: they take turns.
        let one = |frozen: bool| watched(folder.path(), if frozen { "frozen" } else { "reading" }, frozen);
        let (reading, frozen) = if pair % 2 == 0 {
            let reading = one(false);
            (reading, one(true))
        } else {
            let frozen = one(true);
            (one(false), frozen)
        };
        assert_eq!(reading.2, frozen.2, "the recordings differ");
        heard = (heard.0 + reading.1, heard.1 + frozen.1);
        reading_ms.push(reading.0);
        differences.push((reading.0 - frozen.0) / frozen.0 * 100.0);
        println!(
            "pair {:>2}: {:>6.0} ms with a reading viewer, {:>6.0} ms with a stopped one",
            pair + 1,
            reading.0,
            frozen.0
        );
    }
    println!(
        "median difference {:+.1} % of {:.0} ms; {} ticks read, {} by those that were stopped; all {pairs} pairs recorded the same",
        median(differences),
        median(reading_ms),
        heard.0,
        heard.1
    );
}
