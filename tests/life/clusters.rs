//! The same batch made in one go, in shards that never speak with each other, and by a cluster that somebody else collects.

use std::collections::BTreeMap;
use std::path::Path;

use socrates_tests::program::{finish, naming, poll, signal, start};

use crate::{PROGRAM, WAREHOUSE, socrates};

/// Arguments of the batch: six scenarios of one request, whatever they become.
const BATCH: [&str; 6] = ["hall.toml", "--variants", "6", "--repeats", "--require", "any"];

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

/// Manifests of all bundles of a library: the digest of every file but those that hold working times.
fn manifests(library: &Path) -> BTreeMap<String, String> {
    let entries = std::fs::read_dir(library)
        .unwrap()
        .filter_map(Result::ok)
        .filter(|entry| entry.path().join("details").is_dir());
    let one = |entry: std::fs::DirEntry| {
        (entry.file_name().into_string().unwrap(), read(&entry.path().join("details/manifest.json")))
    };
    entries.map(one).collect()
}

/// Both hold the same scenarios, and list, tables and page of both are the same bytes.
fn same(one: &Path, other: &Path) {
    assert_eq!(manifests(one), manifests(other));
    for file in ["library.json", "index.csv", "planners.csv", "report.html"] {
        assert_eq!(read(&one.join(file)), read(&other.join(file)), "{file}");
    }
}

/// The batch in one go.
fn whole(folder: &Path) -> std::path::PathBuf {
    std::fs::write(folder.join("hall.toml"), WAREHOUSE).unwrap();
    let args: Vec<&str> = ["run"].into_iter().chain(BATCH).chain(["--out", "whole/library"]).collect();
    let whole = socrates(folder, "whole", &args);
    assert_eq!(whole.code, 0, "{}", whole.err);
    folder.join("whole/library")
}

#[test]
fn shards_make_what_one_run_makes_and_a_damaged_or_missing_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let whole = whole(at);
    let made = |shard: &str, out: &str| {
        let args: Vec<&str> = ["run"].into_iter().chain(BATCH).chain(["--shard", shard, "--out", out]).collect();
        let made = socrates(at, "shard", &args);
        assert_eq!(made.code, 0, "{}", made.err);
    };
    made("0/4", "shards/0");
    made("3/4", "shards/3");
    made("1/4", "shards/1");
    let merge = |out: &str| socrates(at, "merge", &["library", "merge", "shards", "--out", out]);
    let lacks = merge("early/library");
    assert!(lacks.code == 2 && lacks.err.contains("1 of 4") && lacks.err.contains("2/4"), "{}", lacks.err);
    assert!(!at.join("early/library").exists(), "nothing is begun that cannot be ended");
    made("2/4", "shards/2");
    let merged = merge("merged/library");
    assert_eq!(merged.code, 0, "{}", merged.err);
    same(&whole, &at.join("merged/library"));
    assert!(!at.join("merged/library/.socrates").exists());
    let again = merge("merged/library");
    assert!(again.code == 0 && again.out.contains("nothing to do"), "{}{}", again.out, again.err);
    // A byte of one bundle changed on the way.
    let name = manifests(&at.join("shards/1")).into_keys().next().unwrap();
    let story = at.join("shards/1").join(&name).join("story.txt");
    std::fs::write(&story, read(&story) + "x").unwrap();
    let damaged = merge("damaged/library");
    assert!(damaged.code == 2 && damaged.err.contains(&name) && damaged.err.contains("story.txt"), "{}", damaged.err);
}

#[test]
fn a_cluster_is_submitted_to_and_collected_from_with_what_a_run_would_make() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let whole = whole(at);
    let endpoint = format!("unixsock-stream/{}", at.join("bus").display());
    let up = start(PROGRAM, &["cluster", "up", "--dir", "jobs", "--listen", &endpoint], at, "up").unwrap();
    assert!(poll(|| at.join("bus").exists().then_some(())).is_some());
    let nothing = socrates(at, "nothing", &["cluster", "collect", "--connect", &endpoint, "--out", "c"]);
    assert!(nothing.code == 2 && nothing.err.contains("nothing was submitted"), "{}", nothing.err);
    let work = ["cluster", "work", "--connect", &endpoint, "--slots", "2", "--dir", "spool"];
    let work = start(PROGRAM, &work, at, "work").unwrap();
    let args: Vec<&str> = ["cluster", "submit"].into_iter().chain(BATCH).chain(["--connect", &endpoint]).collect();
    let submitted = socrates(at, "submit", &args);
    assert_eq!(submitted.code, 0, "{}", submitted.err);
    assert!(submitted.out.contains("6 scenarios from 1 request"), "{}", submitted.out);
    // While it works, and again until all is there.
    let collected = poll(|| {
        let args = ["--format", "json", "cluster", "collect", "--connect", &endpoint, "--out", "collected/library"];
        let collected = socrates(at, "collect", &args);
        assert_eq!(collected.code, 0, "{}", collected.err);
        (collected.json()["scenarios"].as_array().map(Vec::len) == Some(6)).then_some(collected)
    });
    assert!(collected.is_some(), "not all was made");
    same(&whole, &at.join("collected/library"));
    let other = socrates(at, "other", &["cluster", "collect", "--connect", &endpoint, "--batch", "mine", "--out", "c"]);
    assert!(other.code == 2 && other.err.contains("`mine`") && other.err.contains("(6)"), "{}", other.err);
    for (child, name) in [(work, "work"), (up, "up")] {
        assert!(signal(child.id(), "TERM").unwrap());
        let ended = finish(child, at, name).unwrap();
        assert_eq!(ended.code, 0, "{name}: {}{}", ended.out, ended.err);
    }
    assert!(poll(|| naming(at).is_empty().then_some(())).is_some(), "left running: {:#?}", naming(at));
}

#[test]
fn a_submission_names_no_folder_of_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let tape = at.join("tape");
    let authors = ["record:TAPE=offline", "replay:TAPE=offline", "cassette:TAPE"];
    for (number, author) in authors.into_iter().enumerate() {
        let author = author.replace("TAPE", &tape.display().to_string());
        // It is refused before anybody is asked: there is no cluster here.
        let submit = |name: &str, more: &[&str]| {
            let args: Vec<&str> = ["cluster", "submit", "hall.toml", "--connect", "unixsock-stream/none"].to_vec();
            socrates(at, name, &[args.as_slice(), more].concat())
        };
        std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
        let by_option = submit(&format!("option-{number}"), &["--author", &author]);
        std::fs::write(at.join("hall.toml"), format!("{WAREHOUSE}\n[run]\nauthor = {author:?}\n")).unwrap();
        let by_request = submit(&format!("request-{number}"), &[]);
        for refused in [by_option, by_request] {
            assert!(refused.code == 2 && refused.err.contains(&author), "{}", refused.err);
            assert!(refused.err.contains("open no folder") && refused.err.contains("hall"), "{}", refused.err);
        }
    }
    assert!(!tape.exists());
}
