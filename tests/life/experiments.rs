//! Experiments: what the verb writes, and how it ends.

use socrates_tests::program::{naming, poll};

use crate::socrates;

const SPEC: &str = r#"
title = "A small experiment"
scenarios = 30
tries = [3]
policies = ["none", "ladder"]

[[workload]]
name = "hard"
first_cut = 0.5

[[fault]]
kinds = ["worker_kill", "orchestrator_kill"]
rates = [0.1]
"#;

#[test]
fn an_experiment_leaves_its_tables_its_page_and_what_does_it_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("small.toml"), SPEC).unwrap();
    let made = |spec: &str, out: &str| {
        let finished = socrates(folder.path(), out, &["--format", "json", "experiment", spec, "--out", out]);
        assert_eq!(finished.code, 0, "{}\n{}", finished.err, finished.out);
        finished.json()
    };
    let object = made("small.toml", "one");
    let cells = object["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 2);
    let count = |cell: usize, what: &str| cells[cell][what].as_u64().unwrap();
    assert_eq!((count(0, "lost"), count(1, "doubled"), count(1, "complaints")), (0, 0, 0));
    assert!(count(1, "realised") > count(0, "realised"), "asking again mends some of thirty: {object}");
    made("one/spec.lock.toml", "two");
    for name in ["cells.csv", "scenarios.csv", "attempts.csv", "report.html", "spec.lock.toml", "plots/success.svg"] {
        let read = |out: &str| std::fs::read_to_string(folder.path().join(out).join(name)).unwrap();
        // The page tells the command that does it again, which names its own folder.
        assert_eq!(read("one").replace("one/", "two/"), read("two"), "{name}");
    }
}

#[test]
fn an_experiment_that_cannot_be_done_says_why() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("odd.toml"), SPEC.replace("worker_kill", "worker_kiln")).unwrap();
    let finished = socrates(folder.path(), "odd", &["experiment", "odd.toml"]);
    assert_eq!(finished.code, 2);
    for words in [
        "`odd.toml` cannot be read",
        "worker_kiln",
        "worker_kill",
        "hint: name a file",
        "reliability, worker-loss, outages",
    ] {
        assert!(finished.err.contains(words), "{words}: {}", finished.err);
    }
    assert!(!folder.path().join("experiment").exists());
}

/// Workers that die on real processes: small, with leases that are noticed soon.
const PROCESSES: &str = r#"
title = "Processes that die"
level = "processes"
scenarios = 10
tries = [4]
policies = ["none", "hasty"]
workers = { proposal = 1, paths = 1, behaviors = 1, simulation = 1, scoring = 1 }
durations = { proposal = { fixed = 60 }, paths = { fixed = 60 }, behaviors = { fixed = 60 }, simulation = { fixed = 60 }, scoring = { fixed = 10 } }

[times_ms]
cut = 2500

[policy.hasty]
like = "jitter"
lease_ms = 1500
beat_ms = 300
grace_ms = 200

[[fault]]
name = "deaths"
kinds = ["worker_kill", "worker_freeze", "orchestrator_kill", "llm_error"]
rates = [0.06]
"#;

#[test]
fn an_experiment_on_processes_sees_its_faults_strike_loses_nothing_and_leaves_nobody_running() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("deaths.toml"), PROCESSES).unwrap();
    let args = ["--format", "json", "experiment", "deaths.toml", "--out", "out"];
    let finished = socrates(folder.path(), "deaths", &args);
    assert_eq!(finished.code, 0, "{}\n{}", finished.err, finished.out);
    let object = finished.json();
    let cells = object["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 2);
    for kind in ["worker_kill", "worker_freeze", "orchestrator_kill", "llm_error"] {
        let of = |what: &str| -> u64 {
            let faults = cells.iter().flat_map(|cell| cell["faults"].as_array().unwrap());
            faults.filter(|fault| fault["kind"] == kind).map(|fault| fault[what].as_u64().unwrap()).sum()
        };
        assert!(of("struck") > 0 && of("struck") <= of("scheduled"), "{kind}: {object:#}");
    }
    let count = |cell: usize, what: &str| cells[cell][what].as_u64().unwrap();
    assert!(count(1, "realised") > count(0, "realised"), "tries mend: {object:#}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    // Each scenario has one end, under each policy.
    let rows = read("scenarios.csv");
    let ended: std::collections::BTreeSet<&str> = rows
        .lines()
        .skip(1)
        .map(|row| row.splitn(3, ',').nth(2).map_or(row, |rest| &row[..row.len() - rest.len()]))
        .collect();
    assert_eq!((rows.lines().count(), ended.len()), (21, 20), "{rows}");
    assert!(rows.lines().skip(1).all(|row| !row.split(',').nth(2).unwrap().is_empty()), "{rows}");
    // What the simulator says of the same faults stands beside it: the same end for each scenario that no lease decides over.
    let beside = read("predictions.csv");
    let same: u64 = beside.lines().skip(1).map(|row| row.split(',').nth(7).unwrap().parse::<u64>().unwrap()).sum();
    assert!(same >= 16, "{beside}");
    assert!(read("report.html").contains("Level: real processes, wall time") && read("report.html").contains("cores"));
    assert!(!folder.path().join("out/processes").exists(), "stores of what went well are not kept");
    let gone = poll(|| naming(folder.path()).is_empty().then_some(()));
    assert!(gone.is_some(), "left running: {:#?}", naming(folder.path()));
}
