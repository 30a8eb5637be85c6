//! Processes while a run is made, and a subscriber in another process.

use std::collections::BTreeMap;
use std::path::Path;

use socrates_tests::program::{children, finish, naming, poll, signal, start};
use socrates_tests::skip::elsewhere;

use crate::{PROGRAM, WAREHOUSE};

#[test]
fn every_worker_is_a_process_and_a_watcher_misses_no_tick_unsaid() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("live.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let (file, out) = (file.display().to_string(), folder.path().join("live").display().to_string());
    // Slow enough to be looked at, fast enough for a test.
    let run = start(PROGRAM, &["run", &file, "--out", &out, "--pace", "8", "--require", "any"], folder.path(), "run")
        .unwrap();
    let workers = poll(|| {
        // A child that has not become its program yet has the line of its parent.
        let begun = |line: &String| line.contains(" worker ") || line.contains(" orchestrator ");
        let lines: Vec<String> = children(run.id()).into_iter().map(|(_, line)| line).filter(begun).collect();
        (lines.len() >= 6).then_some(lines)
    })
    .unwrap();
    for stage in ["proposal", "paths", "behaviors", "simulation", "scoring"] {
        let count = workers.iter().filter(|line| line.contains(&format!("worker {stage} "))).count();
        assert_eq!(count, 1, "{stage} in {workers:#?}");
    }
    assert_eq!(workers.iter().filter(|line| line.contains("orchestrator")).count(), 1);
    let watched = start(PROGRAM, &["--format", "json", "watch", &out], folder.path(), "watch").unwrap();
    let watched = finish(watched, folder.path(), "watch").unwrap();
    assert_eq!(watched.code, 0, "{}", watched.err);
    let lines: Vec<serde_json::Value> = watched
        .out
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|why| panic!("{why}: {line}")))
        .collect();
    let kinds = |kind: &str| lines.iter().filter(|line| line["type"] == kind).count() as u64;
    let json = watched.json();
    assert_eq!((kinds("run"), kinds("end"), &json["type"]), (1, 1, &"end".into()));
    assert!(kinds("event") > 0 && kinds("tick") == json["received"].as_u64().unwrap(), "{json}");
    assert!(lines.iter().any(|line| line["agents"][0]["x"].is_number()));
    let (ticks, received, missing) =
        (json["ticks"].as_u64().unwrap(), json["received"].as_u64().unwrap(), json["missing_ticks"].as_u64().unwrap());
    assert!(ticks > 1000, "{json}");
    assert_eq!(received + missing, ticks, "{json}");
    let run = finish(run, folder.path(), "run").unwrap();
    assert_eq!(run.code, 0, "{}", run.err);
    let left = poll(|| naming(folder.path()).is_empty().then_some(()));
    assert!(left.is_some(), "left running: {:#?}", naming(folder.path()));
}

/// Rows of `tick,agent,x,y,yaw` by tick and agent.
fn ticks(csv: &str) -> BTreeMap<(u64, String), (f64, f64)> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        ((cells[0].parse().unwrap(), cells[1].to_owned()), (cells[2].parse().unwrap(), cells[3].parse().unwrap()))
    };
    csv.lines().skip(1).map(row).collect()
}

#[test]
fn the_examples_of_the_wire_read_the_ticks_of_a_run_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let examples = Path::new(PROGRAM).parent().unwrap().join("examples");
    let example = |name: &str| examples.join(name).display().to_string();
    let built = if Path::new(&example("subscriber")).is_file() && Path::new(&example("shared_memory")).is_file() {
        Ok(())
    } else {
        Err("the examples of bus/stream are built with the whole workspace only".to_owned())
    };
    if elsewhere(built).is_none() {
        return;
    }
    let file = folder.path().join("wire.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let (file, out) = (file.display().to_string(), folder.path().join("wire").display().to_string());
    let args = ["run", &file, "--out", &out, "--pace", "8", "--require", "any"];
    let run = start(PROGRAM, &args, folder.path(), "run").unwrap();
    let place = || std::fs::read_to_string(folder.path().join("wire/.socrates/endpoint")).ok();
    let place = poll(|| place().filter(|text| text.lines().count() >= 3)).unwrap();
    let lines: Vec<&str> = place.lines().collect();
    let over_bus = [lines[0], lines[1], "wire.reference-1"];
    let over_bus = start(&example("subscriber"), &over_bus, folder.path(), "bus").unwrap();
    let over_shm = start(&example("shared_memory"), &[lines[2], "wire.reference-1"], folder.path(), "shm").unwrap();
    let run = finish(run, folder.path(), "run").unwrap();
    assert_eq!(run.code, 0, "{}", run.err);
    let (bus, shm) = (finish(over_bus, folder.path(), "bus").unwrap(), finish(over_shm, folder.path(), "shm").unwrap());
    assert_eq!((bus.code, shm.code), (0, 0), "{}{}", bus.err, shm.err);
    let (heard, shared) = (ticks(&bus.out), ticks(&shm.out));
    // Every agent of every tick, and each as the bundle has it.
    let last = heard.keys().map(|(tick, _)| *tick).max().unwrap();
    let agents = heard.range((0, String::new())..(1, String::new())).count() as u64;
    assert_eq!(heard.len() as u64, (last + 1) * agents, "{agents} agents, {last} the last tick");
    let table = std::fs::read_to_string(folder.path().join("wire/agents.csv")).unwrap();
    let mut compared = 0;
    for row in table.lines().filter(|line| line.starts_with("reference,1,")) {
        let cells: Vec<&str> = row.split(',').collect();
        let tick = (cells[2].parse::<f64>().unwrap() * 100.0).round() as u64;
        let (x, y) = heard[&(tick, cells[3].to_owned())];
        let near = |one: f64, other: &str| (one - other.parse::<f64>().unwrap()).abs() < 1e-3;
        assert!(near(x, cells[4]) && near(y, cells[5]), "tick {tick}: {row} is not {x}, {y}");
        compared += 1;
    }
    assert!(compared > 100, "{compared}");
    // What shared memory told is the same; it may have missed ticks.
    assert!(shared.len() as u64 > agents * 100, "{}: {}", shared.len(), shm.err);
    assert!(shared.iter().all(|(key, place)| heard.get(key) == Some(place)));
}

#[test]
fn an_interrupted_run_leaves_nothing_running_and_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("stop.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let (file, out) = (file.display().to_string(), folder.path().join("stop").display().to_string());
    let args = ["run", file.as_str(), "--out", out.as_str(), "--require", "any", "--pace", "4"];
    let run = start(PROGRAM, &args, folder.path(), "first").unwrap();
    let simulating = poll(|| {
        std::fs::read_dir(folder.path().join("stop/.socrates/blobs"))
            .ok()
            .map(|list| list.count())
            .filter(|count| *count >= 5)
    });
    assert!(simulating.is_some());
    assert!(signal(run.id(), "INT").unwrap());
    let stopped = finish(run, folder.path(), "first").unwrap();
    assert_eq!(stopped.code, 4, "{}", stopped.err);
    assert!(stopped.err.contains("resumes"), "{}", stopped.err);
    assert!(poll(|| naming(folder.path()).is_empty().then_some(())).is_some());
    let again =
        start(PROGRAM, &["run", &file, "--out", &out, "--require", "any", "--pace", "4"], folder.path(), "second")
            .unwrap();
    let again = finish(again, folder.path(), "second").unwrap();
    assert_eq!(again.code, 0, "{}", again.err);
    assert!(folder.path().join("stop/report.html").is_file());
    assert!(!folder.path().join("stop-2").exists(), "a resumed run got a new folder");
}
