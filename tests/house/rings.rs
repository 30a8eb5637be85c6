//! Tests in three rings: one program of tests a crate, one way to leave a test out, one way to run them all.

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
fn tests_build_what_is_shipped_with_overflow_checks_and_claims() {
    let manifest: toml::Table = std::fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    let ci = &manifest["profile"]["ci"];
    assert_eq!(ci["inherits"].as_str(), Some("release"));
    assert_eq!((ci["overflow-checks"].as_bool(), ci["debug-assertions"].as_bool()), (Some(true), Some(true)));
    for (package, own) in ci["package"].as_table().unwrap() {
        let checked = ["overflow-checks", "debug-assertions"].iter().all(|check| own.get(check).is_none());
        assert!(package == "*" || checked, "only the crates of others are left unchecked: {package}: {own}");
    }
}

#[test]
fn functions_of_more_than_a_hundred_lines_are_told() {
    let clippy: toml::Table = std::fs::read_to_string(root().join("clippy.toml")).unwrap().parse().unwrap();
    assert_eq!(clippy["too-many-lines-threshold"].as_integer(), Some(100));
    let manifest: toml::Table = std::fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    assert_eq!(manifest["workspace"]["lints"]["clippy"]["too_many_lines"].as_str(), Some("warn"));
    for (member, manifest) in members() {
        assert_eq!(manifest["lints"]["workspace"].as_bool(), Some(true), "{member} has lints of its own");
    }
}

/// The arguments that a line of a script gives to cargo.
fn asked_of_cargo(line: &str) -> Option<&str> {
    let line = line.trim();
    let (before, asked) = line.split_once("cargo ")?;
    let called = before.is_empty() || before.starts_with("step ") || before.starts_with("if ");
    (called && !line.starts_with('#')).then_some(asked)
}

#[test]
fn the_gate_builds_everything_in_the_profile_of_tests() {
    let gate = std::fs::read_to_string(root().join("gate")).unwrap();
    let settings = gate.lines().find(|line| line.starts_with("build=(")).unwrap();
    assert!(settings.contains("--profile ci ") && settings.contains("--workspace"), "{settings}");
    let asked: Vec<&str> = gate.lines().filter_map(asked_of_cargo).collect();
    assert!(asked.len() >= 6, "{asked:?}");
    for words in asked {
        let builds_nothing =
            ["fmt --all --check", "nextest --version", "deny check"].iter().any(|own| words.starts_with(own));
        let profile = words.contains("\"${build[@]}\"")
            || words.contains("--profile ci ")
            || words.contains("/--profile/--cargo-profile}");
        assert!(builds_nothing || profile, "`cargo {words}` builds in another profile");
    }
}

/// How a ring ends when `cargo test` says this, without nextest, with nothing to install and nothing to build.
fn ring_ends_with(ring: &str, said: &str) -> (Option<i32>, String) {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let all = [
        "apt-get", "cargo", "cc", "chromium", "curl", "ffprobe", "node", "npm", "promtool", "python3", "Rscript",
        "script", "setpriv",
    ];
    let ours = ["munged", "sbatch", "slurmctld", "slurmd", "strace", "systemd-analyze"];
    for name in all.into_iter().chain(ours) {
        let program = folder.path().join(name);
        let cargo = format!("[ $1 = nextest ] && exit 1; echo '{said}'");
        let does = if name == "cargo" { cargo.as_str() } else { "" };
        std::fs::write(&program, format!("#!/bin/sh\n{does}\nexit 0\n")).unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap());
    let ended = std::process::Command::new(root().join("gate"))
        .args(["--foreign", "--sweep"].iter().filter(|option| **option == ring))
        .env("PATH", path)
        .env("CARGO_TARGET_DIR", folder.path().join("target"))
        .output()
        .unwrap();
    (ended.status.code(), String::from_utf8_lossy(&[ended.stdout, ended.stderr].concat()).into_owned())
}

#[test]
fn a_ring_in_which_no_test_runs_fails() {
    for ring in ["", "--foreign", "--sweep"] {
        let (code, said) = ring_ends_with(ring, "running 0 tests");
        assert_eq!(code, Some(1), "{ring}: {said}");
        assert!(said.contains("no test of the ring ran"), "{ring}: {said}");
        let (code, said) = ring_ends_with(ring, "test looks::a_page ... ok");
        assert_eq!(code, Some(0), "{ring}: {said}");
    }
}

#[test]
fn only_sweeps_are_ignored_and_they_say_what_they_cost() {
    let mut wrong = Vec::new();
    for path in files(".rs").iter().filter(|path| !path.ends_with("house/rings.rs")) {
        for (number, line) in std::fs::read_to_string(path).unwrap().lines().enumerate() {
            if line.trim_start().starts_with("#[ignore") && !line.contains("#[ignore = \"sweep: ") {
                wrong.push(format!("  {}:{}: {}", shown(path), number + 1, line.trim()));
            }
        }
    }
    assert!(wrong.is_empty(), "write `#[ignore = \"sweep: …\"]` with what it runs over:\n{}", wrong.join("\n"));
}

#[test]
fn every_document_says_itself_what_it_rests_on() {
    // A page that is not here explains nothing to whoever reads the code.
    let absent = ["`spec/", "(spec/", "`DESIGN", "DESIGN.md", "`STYLE", "STYLE.md", "§"];
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
