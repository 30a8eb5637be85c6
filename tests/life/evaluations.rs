//! Authors are measured: the same scenarios for every arm, the same figures every time.

use std::path::Path;

use crate::socrates;
use serde_json::Value;

const SPEC: &str = r#"
title = "Half of all paths have a gap"
locations = ["office"]

[[guided]]
name = "frontal"
social_context = "A normal day"
task = "Bring a parcel to the other end"
rough_scenario = "A person walks towards the robot in the corridor."
repeats = 6

[[arms]]
name = "once"
author = "offline"
asks_again = 0
repairs = 0
faults = "gaps"

[[arms]]
name = "again"
author = "offline"
faults = "gaps"

[rates.gaps]
gdisc = 0.5
"#;

/// Evaluates in this folder: the arms of the result object, and the table without its times.
fn evaluate(folder: &Path, out: &str) -> (Vec<Value>, Vec<String>) {
    std::fs::write(folder.join("spec.toml"), SPEC).unwrap();
    let finished = socrates(folder, out, &["--format", "json", "evaluate", "author", "spec.toml", "--out", out]);
    assert_eq!(finished.code, 0, "{}\n{}", finished.err, finished.out);
    let json: Value = finished.json();
    let table = std::fs::read_to_string(folder.join(out).join("results.csv")).unwrap();
    let time = table.lines().next().unwrap().split(',').position(|name| name == "author_ms").unwrap();
    let timeless = |line: &str| {
        let cells = line.split(',').enumerate().filter(|(column, _)| *column != time);
        cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
    };
    (json["arms"].as_array().unwrap().clone(), table.lines().map(timeless).collect())
}

#[test]
fn asking_again_mends_what_asking_once_leaves_and_figures_come_again() {
    let folder = tempfile::tempdir().unwrap();
    let (arms, table) = evaluate(folder.path(), "one");
    let count = |arm: usize, what: &str| arms[arm][what].as_u64().unwrap();
    assert_eq!(table.len(), 13, "a heading and six lines for each arm");
    assert!((1..6).contains(&count(0, "first_pass")), "some of six have a gap: {arms:?}");
    assert_eq!(count(0, "first_pass"), count(1, "first_pass"), "paired");
    assert_eq!(count(0, "realised"), count(0, "first_pass"), "asked once, the first answer counts");
    assert!(count(1, "after_asking") > count(0, "after_asking"), "{arms:?}");
    let report = std::fs::read_to_string(folder.path().join("one/report.md")).unwrap();
    assert!(report.contains("Injected faults, not a model's") && report.contains("| paths | G-DISC |"), "{report}");
    assert!(!folder.path().join("one/.socrates").exists());
    assert_eq!(evaluate(folder.path(), "two").1, table);
}

#[test]
fn an_evaluation_that_cannot_be_done_says_why() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("spec.toml"), SPEC.replace("\"gaps\"", "\"holes\"")).unwrap();
    let finished = socrates(folder.path(), "wrong", &["evaluate", "author", "spec.toml"]);
    assert_eq!(finished.code, 2);
    assert!(finished.err.contains("there is no [rates.holes]; there is gaps"), "{}", finished.err);
    std::fs::write(folder.path().join("spec.toml"), SPEC.replace("gdisc", "gdisk")).unwrap();
    let finished = socrates(folder.path(), "wrong", &["evaluate", "author", "spec.toml"]);
    assert_eq!(finished.code, 2);
    assert!(finished.err.contains("gdisk") && finished.err.contains("allowed"), "{}", finished.err);
}
