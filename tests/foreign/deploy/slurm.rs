//! The files for Slurm in a Slurm of two machines on this one, started for the test alone.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_tests::program::start_typed;
use socrates_tests::{program, root, skip};

use super::{deployed, said, script, tools};
use crate::{PROGRAM, WAREHOUSE, socrates};

/// Files of a bundle or library that tell how it was made: when, by whom, in which order.
const PROVENANCE: [&str; 3] = ["library.json", "provenance.json", "report.html"];

/// What a script beside this file saw in a cluster, or none where there can be no cluster here.
#[track_caller]
fn saw(folder: &Path, name: &str, under: &str, words: &[&str]) -> Option<Value> {
    for needed in ["munged", "slurmctld", "slurmd", "sbatch", "python3"] {
        // Daemons lie where only the administrator looks.
        let found =
            skip::program(needed).or_else(|| Some(Path::new("/usr/sbin").join(needed)).filter(|at| at.is_file()));
        skip::installed(found.ok_or_else(|| format!("there is no `{needed}`")))?;
    }
    let rights = std::fs::metadata("/proc/self").map(|own| std::os::unix::fs::MetadataExt::uid(&own));
    let rights = if rights.ok() == Some(0) { Ok(()) } else { Err("only the administrator can start Slurm".to_owned()) };
    skip::elsewhere(rights)?;
    let cluster = folder.join("cluster");
    std::fs::create_dir(&cluster).unwrap();
    let (cluster, work) = (cluster.display().to_string(), folder.join("work").display().to_string());
    let (runner, played) = (script("slurm.sh"), script(name));
    let mut args = vec![cluster.as_str(), played.as_str(), work.as_str()];
    args.extend(words);
    let child = start_typed(&runner, &args, folder, "slurm", "", &[("SOCRATES", under)]).unwrap();
    let finished = program::finish(child, folder, "slurm").unwrap();
    assert_eq!(finished.code, 0, "{}\n{}", finished.out, finished.err);
    Some(finished.json())
}

/// Asserts what has to have become of the array, whatever the program.
fn assert_taken_up_again(seen: &Value) {
    assert_eq!(seen["misspelt"], "refused", "{seen}");
    assert_eq!((&seen["told_again"], &seen["lost_again"]), (&json!(1), &json!(1)), "begun anew once each: {seen}");
    assert_eq!((&seen["early"], &seen["merge"]), (&json!("FAILED"), &json!("COMPLETED")), "{seen}");
    assert_eq!((&seen["canceled"], &seen["canceled_again"]), (&json!(true), &json!(0)), "{seen}");
}

#[test]
fn scripts_for_slurm_and_those_beside_this_test_pass_a_linter_of_shells() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let lint = |file: &str| said(tools.join("shellcheck"), &["--shell=bash", file], folder.path());
    let ours =
        ["shards.sh", "held.sh", "cluster.sh", "slurm.sh", "stand_in.sh"].map(|name| PathBuf::from(script(name)));
    let others = ["shards.sbatch", "merge.sbatch", "cluster.sbatch"].map(|name| deployed("slurm").join(name));
    for file in ours.into_iter().chain(others).chain([root().join("deploy/release.sh")]) {
        let file = file.display().to_string();
        assert_eq!(lint(&file), (0, String::new()), "{file}");
        assert_eq!(said("bash", &["-n", &file], folder.path()), (0, String::new()), "{file}");
    }
    let wrong = super::misspelt(&deployed("slurm/shards.sbatch"), "$scratch/", "$scrach/", folder.path());
    let (code, told) = lint(&wrong);
    assert!(code != 0 && told.contains("scrach"), "{told}");
}

#[test]
fn shards_in_slurm_outlive_the_end_of_their_time_a_dead_machine_and_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let Some(seen) = saw(folder.path(), "shards.sh", &script("stand_in.sh"), &["requests", "--variants", "80"]) else {
        return;
    };
    assert_taken_up_again(&seen);
    let library = folder.path().join("work/library");
    let made: BTreeSet<String> =
        std::fs::read_dir(library).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(made, (0..80).map(|one| format!("scenario-{one}")).collect::<BTreeSet<_>>());
    // The one that was told had all the time to end what it had begun: longer than Slurm waits before it kills.
    let log = folder.path().join(format!("work/socrates-{}_{}.log", seen["job"], seen["told"]));
    let log = std::fs::read_to_string(log).unwrap();
    assert_eq!(log.matches("told to stop").count(), 1, "{log}");
}

#[test]
fn a_cluster_in_slurm_outlives_a_machine_and_goes_on_in_another_job() {
    let folder = tempfile::tempdir().unwrap();
    let Some(seen) = saw(folder.path(), "cluster.sh", &script("stand_in.sh"), &[]) else { return };
    assert_eq!((&seen["alive"], &seen["ended"]), (&json!("RUNNING"), &json!("COMPLETED")), "{seen}");
    assert_eq!(seen["again"], "COMPLETED", "{seen}");
    assert_eq!(
        (&seen["workers_left"], &seen["workers_left_again"]),
        (&json!(1), &json!(1)),
        "told, not killed: {seen}"
    );
    assert_eq!(seen["endpoint"], false, "nobody is led to a port that is shut: {seen}");
    let told = "orchestrator on first,orchestrator left";
    assert_eq!(seen["store"], format!("{told},{told}"), "the second job has the store of the first");
}

/// The files below a folder, but those that tell how it was made.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let (mut found, mut open) = (BTreeMap::new(), vec![folder.to_path_buf()]);
    while let Some(place) = open.pop() {
        for path in std::fs::read_dir(&place).unwrap().map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                open.push(path);
            } else if !PROVENANCE.contains(&name.as_str()) {
                found.insert(path.strip_prefix(folder).unwrap().display().to_string(), std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

#[test]
fn a_library_of_shards_in_slurm_is_that_of_a_single_run() {
    let folder = tempfile::tempdir().unwrap();
    let help = |words: &[&str]| socrates(folder.path(), "help", words);
    let shards = help(&["run", "--help"]).out.contains("--shard") && help(&["library", "merge", "--help"]).code == 0;
    let there = if shards { Ok(()) } else { Err("the program has no `run --shard` or no `library merge`".to_owned()) };
    if skip::elsewhere(there).is_none() {
        return;
    }
    let request = folder.path().join("request.toml").display().to_string();
    std::fs::write(&request, WAREHOUSE).unwrap();
    let words = [request.as_str(), "--variants", "96", "--repeats", "--seed", "3", "--author", "offline"];
    let Some(seen) = saw(folder.path(), "shards.sh", PROGRAM, &words) else { return };
    assert_taken_up_again(&seen);
    let mut whole = vec!["run", "--require", "any", "--out", "single"];
    whole.extend(words);
    let single = socrates(folder.path(), "single", &whole);
    assert_eq!(single.code, 0, "{}", single.err);
    let (single, merged) = (files(&folder.path().join("single")), files(&folder.path().join("work/library")));
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&merged), names(&single));
    let other: Vec<&String> =
        single.iter().filter(|(name, bytes)| merged.get(*name) != Some(*bytes)).map(|(name, _)| name).collect();
    assert!(other.is_empty(), "these differ: {other:?}");
    assert!(single.keys().filter(|name| name.ends_with(".mcap")).count() >= 96, "{:?}", names(&single));
}
