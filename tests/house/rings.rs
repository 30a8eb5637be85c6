//! Tests in two rings: one program of tests a crate, one way to leave a test out, one way to run them all.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use socrates_tests::root;

use crate::{files, members, shown};

/// The one file that leaves tests out.
const SKIP: &str = "tests/src/skip.rs";

/// Programs of integration tests that cargo builds for a crate: those that its folder holds, and those that its manifest names.
fn test_programs(folder: &Path, manifest: &toml::Table) -> BTreeSet<PathBuf> {
    let tests = folder.join("tests");
    let mut found: BTreeSet<PathBuf> = BTreeSet::new();
    for entry in std::fs::read_dir(&tests).into_iter().flatten().map(|entry| entry.unwrap().path()) {
        let main = entry.join("main.rs");
        if entry.extension().is_some_and(|ending| ending == "rs") {
            found.insert(entry);
        } else if main.is_file() {
            found.insert(main);
        }
    }
    for test in manifest.get("test").and_then(toml::Value::as_array).into_iter().flatten() {
        let name = test["name"].as_str().unwrap();
        let path = test.get("path").and_then(toml::Value::as_str).map(|path| folder.join(path));
        found.insert(path.unwrap_or_else(|| tests.join(format!("{name}.rs"))));
    }
    found
}

#[test]
fn a_crate_has_at_most_one_program_of_integration_tests() {
    let mut many = Vec::new();
    for (member, manifest) in members() {
        let programs = test_programs(&root().join(&member), &manifest);
        if programs.len() > 1 {
            let names: Vec<String> = programs.iter().map(|path| shown(path)).collect();
            many.push(format!("  {member}: {}", names.join(", ")));
        }
        assert!(programs.iter().all(|path| path.is_file()), "{member} names a program that is not there: {programs:?}");
    }
    assert!(many.is_empty(), "put them into modules of `tests/it/main.rs`:\n{}", many.join("\n"));
}

#[test]
fn tests_are_left_out_in_one_place_alone() {
    let marks = ["ln!(\"skipped", "shared/data"];
    let mut found = Vec::new();
    for path in files(".rs").iter().filter(|path| !path.ends_with(SKIP) && !path.ends_with("house/rings.rs")) {
        for (number, line) in std::fs::read_to_string(path).unwrap().lines().enumerate() {
            if marks.iter().any(|mark| line.contains(mark)) {
                found.push(format!("  {}:{}: {}", shown(path), number + 1, line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "ask `socrates_tests::skip` for what a test needs:\n{}", found.join("\n"));
}

#[test]
fn ci_runs_both_rings_and_nothing_else() {
    let run = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let commands: Vec<&str> = run.lines().filter(|line| line.starts_with("./") || line.contains("cargo")).collect();
    assert_eq!(commands, ["./gate", "./gate --foreign"]);
}

#[test]
fn every_document_says_itself_what_it_rests_on() {
    // A page that is not here explains nothing to whoever reads the code.
    let absent = ["`spec/", "(spec/"];
    let mut found = Vec::new();
    let documents = [".rs", ".md", ".toml"].into_iter().flat_map(files);
    for path in documents.filter(|path| !path.ends_with("house/rings.rs")) {
        for (number, line) in std::fs::read_to_string(&path).unwrap().lines().enumerate() {
            if absent.iter().any(|mark| line.contains(mark)) {
                found.push(format!("  {}:{}: {}", shown(&path), number + 1, line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "these cite pages outside the repository:\n{}", found.join("\n"));
}
