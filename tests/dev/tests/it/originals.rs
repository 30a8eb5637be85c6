//! Crowds and trees from outside, through the tools.

use std::path::{Path, PathBuf};

use socrates_tests::root;
use socrates_tests::skip::shared;

use crate::tool;

/// Files of a folder with this ending, by their stem.
fn cases(folder: &Path, ending: &str) -> Vec<(String, PathBuf)> {
    let mut found: Vec<(String, PathBuf)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter_map(|path| Some((path.file_name()?.to_string_lossy().strip_suffix(ending)?.to_owned(), path.clone())))
        .collect();
    found.sort();
    found
}

fn same(name: &str, ours: &Path, theirs: &Path) {
    let (ours, theirs) = (std::fs::read_to_string(ours).unwrap(), std::fs::read_to_string(theirs).unwrap());
    let differs = ours.lines().zip(theirs.lines()).position(|(a, b)| a != b);
    assert_eq!(differs, None, "{name}: line {differs:?}");
    assert_eq!(ours.lines().count(), theirs.lines().count(), "{name}");
}

/// Ticks every tree of the folders `v3` and `v4` by its script, and holds trace and events against what is recorded.
fn ticked_alike(data: &Path, at_least: usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    for version in ["v3", "v4"] {
        let from = data.join(version);
        let all = cases(&from, ".script.json");
        assert!(all.len() >= at_least, "{} cases in {}", all.len(), from.display());
        for (name, script) in all {
            let tree = from.join(format!("{name}.xml")).display().to_string();
            let script = script.display().to_string();
            let (out, events) = (path("trace.csv"), path("events.csv"));
            let finished =
                tool(folder.path(), "trace", &["bt-trace", &tree, &script, "--out", &out, "--events", &events]);
            assert_eq!(finished.code, 0, "{name}: {}", finished.err);
            same(&name, Path::new(&out), &from.join(format!("{name}.trace.csv")));
            same(&name, Path::new(&events), &from.join(format!("{name}.events.csv")));
        }
    }
}

#[test]
fn every_tree_of_our_own_record_is_ticked_alike() {
    ticked_alike(&root().join("workers/behavior_tree/tests/data"), 12);
}

#[test]
fn every_reference_tree_is_ticked_alike() {
    if let Some(data) = shared("bt_reference") {
        ticked_alike(&data, 41);
    }
}

/// Largest difference from numbers that another program worked out, in m, m/s and rad: the last bits of its sines and exponentials may
/// differ, and the run lets them grow.
const GROWN: f64 = 1e-6;

#[test]
fn every_crowd_of_our_own_record_walks_alike() {
    let folder = tempfile::tempdir().unwrap();
    let from = root().join("workers/simulation/crowd/tests/data");
    let out = folder.path().join("trajectory.csv").display().to_string();
    let scenes = cases(&from, ".json");
    assert!(scenes.len() >= 4, "{scenes:?}");
    let numbers = |line: &str| -> Vec<f64> { line.split(',').map(|cell| cell.parse().unwrap()).collect() };
    for (name, scene) in scenes {
        let scene = scene.display().to_string();
        let finished = tool(folder.path(), "scene", &["sfm-trace", &scene, "--out", &out]);
        assert_eq!(finished.code, 0, "{name}: {}", finished.err);
        let read = |file: &Path| std::fs::read_to_string(file).unwrap();
        let (ours, theirs) = (read(Path::new(&out)), read(&from.join(format!("{name}.traj.csv"))));
        assert_eq!(ours.lines().count(), theirs.lines().count(), "{name}");
        assert_eq!(ours.lines().next(), theirs.lines().next(), "{name}");
        for (line, (ours, theirs)) in ours.lines().zip(theirs.lines()).enumerate().skip(1) {
            let (ours, theirs) = (numbers(ours), numbers(theirs));
            let near = ours.iter().zip(&theirs).all(|(ours, theirs)| (ours - theirs).abs() <= GROWN);
            assert!(near && ours.len() == theirs.len(), "{name} line {line}: {ours:?} {theirs:?}");
        }
    }
}

#[test]
fn every_reference_crowd_walks_alike() {
    let Some(data) = shared("sfm_reference") else { return };
    let folder = tempfile::tempdir().unwrap();
    let (from, out) = (data, folder.path().join("trajectory.csv").display().to_string());
    let scenes = cases(&from, ".json");
    assert!(scenes.len() >= 8);
    for (name, scene) in scenes {
        let scene = scene.display().to_string();
        let finished = tool(folder.path(), "scene", &["sfm-trace", &scene, "--out", &out]);
        assert_eq!(finished.code, 0, "{name}: {}", finished.err);
        same(&name, Path::new(&out), &from.join(format!("{name}.traj.csv")));
    }
}
