//! Faults during a batch, from kill -9 of any process to a full disk: every scenario ends with one result, none twice, nothing is left
//! running, and `socrates fsck` finds nothing wrong.

mod cluster;
mod figures;
mod nemesis;
mod network;
mod schedule;
mod storm;

use std::path::Path;

use socrates_tests::program::{children, finish, naming, poll, signal, start};

use crate::{PROGRAM, socrates};

const REQUEST: &str = r#"
location = "warehouse"
social_context = "A warehouse"
task = "Carry a box"
rough_scenario = "One person walks towards the robot."

[run]
duration = "20s"
"#;

fn results(folder: &Path) -> usize {
    let Ok(list) = std::fs::read_dir(folder) else { return 0 };
    list.filter_map(Result::ok).filter(|entry| entry.path().join("details/manifest.json").is_file()).count()
}

/// Scenarios done so far, as the orchestrator's own store of artifacts shows it: a rough measure is enough.
fn progress(folder: &Path) -> usize {
    fn count(dir: &Path) -> usize {
        let Ok(list) = std::fs::read_dir(dir) else { return 0 };
        list.filter_map(Result::ok).map(|entry| if entry.path().is_dir() { count(&entry.path()) } else { 1 }).sum()
    }
    count(&folder.join(".socrates/blobs"))
}

#[test]
fn a_batch_survives_the_death_of_every_kind_of_process() {
    survives(50);
}

#[test]
#[ignore = "sweep: a batch of 200 scenarios"]
fn two_hundred_scenarios_survive_the_death_of_every_kind_of_process() {
    survives(200);
}

/// Kills one process of every kind during a batch of `scenarios` scenarios, then its supervisor, and runs the batch to its end.
fn survives(scenarios: usize) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("batch.toml");
    std::fs::write(&file, REQUEST).unwrap();
    let (file, library) = (file.display().to_string(), folder.path().join("library"));
    let (out, count) = (library.display().to_string(), scenarios.to_string());
    let args = [
        "--format",
        "json",
        "run",
        &file,
        "--out",
        &out,
        "--variants",
        &count,
        "--repeats",
        "--require",
        "any",
        "--workers",
        "2",
    ];
    let run = start(PROGRAM, &args, folder.path(), "first").unwrap();
    let mut killed = Vec::new();
    let mut seen = 0;
    for victim in [
        "worker proposal ",
        "worker paths ",
        "worker behaviors ",
        "worker simulation ",
        "worker scoring ",
        "orchestrator ",
    ] {
        // Each dies while the batch moves on, not before.
        let moved = poll(|| Some(progress(&library)).filter(|now| *now > seen + 20));
        seen = moved.unwrap_or(seen);
        let pid = poll(|| children(run.id()).into_iter().find(|(_, line)| line.contains(victim)).map(|(pid, _)| pid))
            .unwrap();
        assert!(signal(pid, "KILL").unwrap(), "{victim} could not be killed");
        killed.push((victim, pid));
    }
    // The fault really fired: another process serves in each place.
    for (victim, pid) in &killed {
        let next = poll(|| {
            children(run.id())
                .into_iter()
                .find(|(other, line)| line.contains(victim) && other != pid)
                .map(|(other, _)| other)
        });
        assert!(next.is_some(), "{victim} was not started again");
    }
    // Then the supervisor itself.
    let moved = poll(|| Some(progress(&library)).filter(|now| *now > seen + 20));
    assert!(moved.is_some(), "the batch stands still");
    assert!(signal(run.id(), "KILL").unwrap());
    let first = finish(run, folder.path(), "first").unwrap();
    assert_eq!(first.code, -1, "the supervisor was not killed: {}", first.err);
    let gone = poll(|| naming(folder.path()).is_empty().then_some(()));
    assert!(gone.is_some(), "left running: {:#?}", naming(folder.path()));
    // What it leaves is sound: the store, its artifacts, and the bundles that are written.
    let left = socrates(folder.path(), "left", &["--format", "json", "fsck", &out]);
    assert_eq!(left.code, 0, "{}{}", left.out, left.err);
    assert_eq!(left.json()["stores"][0]["counts"]["scenarios"], scenarios, "{}", left.out);
    let done_before = results(&library);
    assert!(done_before < scenarios, "the batch was over before the supervisor died");
    let second = finish(start(PROGRAM, &args, folder.path(), "second").unwrap(), folder.path(), "second").unwrap();
    let json = second.json();
    let ended = json["scenarios"].as_array().unwrap_or_else(|| panic!("{}\n{}", second.err, second.out));
    assert_eq!(ended.len(), scenarios, "{}", second.err);
    let names: std::collections::BTreeSet<&str> = ended.iter().map(|row| row["scenario"].as_str().unwrap()).collect();
    assert_eq!(names.len(), scenarios, "a scenario came twice");
    assert!(ended.iter().all(|row| row["verdict"] != "failed"), "{json}");
    assert_eq!(results(&library), scenarios);
    let made = socrates(folder.path(), "made", &["fsck", &out]);
    assert_eq!(made.code, 0, "{}{}", made.out, made.err);
    assert!(poll(|| naming(folder.path()).is_empty().then_some(())).is_some());
}
