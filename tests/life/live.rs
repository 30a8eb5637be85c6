//! Processes while a run is made, and a subscriber in another process.

use socrates_tests::program::{children, finish, naming, poll, signal, start};

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
        let lines: Vec<String> = children(run.id()).into_iter().map(|(_, line)| line).collect();
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
