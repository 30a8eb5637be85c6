//! Libraries before they are made and by what they hold: plans, coverage, and what is fixed once they are begun.

use std::path::Path;

use crate::{WAREHOUSE, socrates};

/// Eight scenarios of one request, whatever they become.
const BATCH: [&str; 7] = ["hall.toml", "--variants", "8", "--repeats", "--require", "any", "--out"];

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|why| panic!("{}: {why}", folder.display()));
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn args<'a>(verb: &[&'a str], out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [verb, &BATCH, &[out], more].concat()
}

#[test]
fn a_dry_run_counts_what_a_run_makes_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let more = ["--planner", "reference,orca", "--seeds", "1,2", "--dry-run"];
    let dry = socrates(at, "dry", &args(&["--format", "json", "run"], "library", &more));
    assert_eq!(dry.code, 0, "{}", dry.err);
    let told = dry.json();
    assert_eq!(told["jobs"]["proposal"], 8, "{told}");
    assert_eq!((&told["jobs"]["simulation"], &told["jobs"]["scoring"]), (&32.into(), &32.into()), "{told}");
    assert!(told["cpu_h"].as_f64().is_some_and(|hours| hours > 0.0), "{told}");
    assert!(!at.join("library").exists() && !at.join("runs").exists(), "{:?}", names(at));
    // The author would be a model: its calls and tokens are counted, and nobody is asked.
    let model = ["--author", "openai:gpt-4o", "--dry-run"];
    let dry = socrates(at, "model", &args(&["--format", "json", "library", "build"], "library", &model));
    assert_eq!(dry.code, 0, "{}", dry.err);
    let told = dry.json();
    let asked = &told["authors"]["openai:gpt-4o"];
    assert_eq!(asked["calls"], 16, "two questions of eight scenarios: {told}");
    assert!(
        asked["tokens_in"].as_u64() > asked["tokens_out"].as_u64() && asked["tokens_out"].as_u64() > Some(800),
        "{told}"
    );
    assert!(!at.join("library").exists());
    // What is counted is what a run makes, and then there is nothing left to be made.
    let made = socrates(at, "made", &args(&["library", "build"], "library", &["--keep", "index"]));
    assert_eq!(made.code, 0, "{}", made.err);
    let list: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(at.join("library/library.json")).unwrap()).unwrap();
    assert_eq!(list["scenarios"].as_array().unwrap().len(), 8);
    let again = socrates(at, "again", &args(&["--format", "json", "run"], "library", &["--dry-run"]));
    let told = again.json();
    assert_eq!((&told["there"], &told["keep"]), (&8.into(), &"index".into()), "{told}");
    assert!(told["jobs"].as_object().is_some_and(serde_json::Map::is_empty), "{told}");
}

#[test]
fn what_a_library_keeps_is_fixed_when_it_is_begun() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let run = |name: &str, more: &[&str]| socrates(at, name, &args(&["run"], "library", more));
    assert_eq!(run("made", &["--keep", "index"]).code, 0);
    let before = names(&at.join("library"));
    for dry in [&[][..], &["--dry-run"]] {
        let other = run("other", &[&["--keep", "packed"], dry].concat());
        assert_eq!(other.code, 2, "{}", other.out);
        assert!(other.err.contains("was begun with `--keep index`") && other.err.contains("--out"), "{}", other.err);
    }
    assert_eq!(names(&at.join("library")), before);
    for same in [&[][..], &["--keep", "index"]] {
        let known = run("same", same);
        assert!(known.code == 0 && known.out.contains("nothing to do"), "{}{}", known.out, known.err);
    }
    // A list of an earlier version does not say it: its bundles do.
    let list = at.join("library/library.json");
    let text = std::fs::read_to_string(&list).unwrap();
    std::fs::write(&list, text.replacen("\"keep\": \"index\",", "", 1)).unwrap();
    let realised = text.matches("\"verdict\": \"realised\"").count();
    let other = run("earlier", &["--keep", "packed"]);
    assert_eq!(other.code, if realised < 8 { 2 } else { 0 }, "{}", other.err);
    // Another seed names another library, and that is said.
    let seed = run("seed", &["--seed", "2", "--keep", "packed"]);
    assert_eq!(seed.code, 0, "{}", seed.err);
    assert!(seed.out.contains("goes into `library-2`") && seed.out.contains("fixed      `library`"), "{}", seed.out);
}

#[test]
fn a_library_says_what_it_covers_and_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    assert_eq!(socrates(at, "made", &args(&["run"], "library", &["--keep", "index"])).code, 0);
    let told = socrates(at, "told", &["library", "coverage", "library", "--out", "cells.csv"]);
    assert_eq!(told.code, 0, "{}", told.err);
    for part in [
        "of 45 canonical scenarios",
        "of 11 encounter angles",
        "gaps",
        "no run of these planners",
        "wrote      cells.csv",
    ] {
        assert!(told.out.contains(part), "{part}: {}", told.out);
    }
    let object = socrates(at, "object", &["--format", "json", "library", "coverage", "library"]).json();
    let axes = object["axes"].as_array().unwrap();
    let encounter = axes.iter().find(|axis| axis["axis"] == "encounter").unwrap();
    assert!(encounter["held"].as_u64().is_some_and(|held| (1..11).contains(&held)), "{encounter}");
    let cells = std::fs::read_to_string(at.join("cells.csv")).unwrap();
    assert!(cells.starts_with("axis,cell,by,scenarios,realised\n"), "{cells}");
    // The same stands on the page.
    let page = std::fs::read_to_string(at.join("library/report.html")).unwrap();
    assert!(page.contains("of 45 canonical scenarios") && page.contains("no run of these planners"));
    // A table of an earlier version has fewer columns: what it says is told, and how to have the rest.
    let table = std::fs::read_to_string(at.join("library/index.csv")).unwrap();
    let earlier: String =
        table.lines().map(|line| line.split(',').take(5).collect::<Vec<_>>().join(",") + "\n").collect();
    std::fs::create_dir(at.join("earlier")).unwrap();
    std::fs::write(at.join("earlier/index.csv"), earlier).unwrap();
    let told = socrates(at, "earlier", &["library", "coverage", "earlier"]);
    assert!(told.code == 0 && told.err.contains("earlier version"), "{}{}", told.out, told.err);
    assert!(told.out.contains("1 of 3 locations"), "{}", told.out);
    let odd = socrates(at, "odd", &["library", "coverage", "library", "--out", "cells.xlsx"]);
    assert!(odd.code == 2 && odd.err.contains("coverage.csv"), "{}", odd.err);
    // Rows go to a file by the ending of its name.
    let query = |out: &str| {
        socrates(at, out, &["library", "query", "library", "--columns", "scenario,seed,verdict", "--out", out])
    };
    assert_eq!(query("runs.csv").code, 0);
    assert!(std::fs::read_to_string(at.join("runs.csv")).unwrap().starts_with("scenario,seed,verdict\n"));
    assert_eq!(query("runs.xlsx").code, 2);
}
