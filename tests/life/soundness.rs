//! `socrates fsck`: a cluster is sound while it works and after a kill -9, and what is damaged by hand is named.

use std::path::{Path, PathBuf};

use serde_json::Value;
use socrates_tests::program::{Finished, finish, naming, poll, signal, start};

use crate::{PROGRAM, WAREHOUSE, socrates};

/// Scenarios of the batch.
const COUNT: &str = "4";

fn fsck(at: &Path, folders: &[&str]) -> (Finished, Value) {
    let args: Vec<&str> = ["--format", "json", "fsck"].iter().chain(folders).copied().collect();
    let finished = socrates(at, "fsck", &args);
    let json = finished.json();
    (finished, json)
}

/// Everything that is wrong, which must be something.
fn wrong(at: &Path, folders: &[&str]) -> String {
    let (finished, json) = fsck(at, folders);
    assert_eq!((finished.code, &json["sound"]), (2, &Value::Bool(false)), "{}\n{}", finished.out, finished.err);
    let wrong: Vec<&str> = json["wrong"].as_array().unwrap().iter().map(|wrong| wrong.as_str().unwrap()).collect();
    assert!(!wrong.is_empty());
    wrong.join("\n")
}

fn sound(at: &Path, folders: &[&str]) -> Value {
    let (finished, json) = fsck(at, folders);
    assert_eq!((finished.code, &json["sound"]), (0, &Value::Bool(true)), "{}\n{}", finished.out, finished.err);
    json
}

/// The largest artifact: a recording.
fn largest(blobs: &Path) -> PathBuf {
    let files =
        |dir: &Path| -> Vec<PathBuf> { std::fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().path()).collect() };
    let all = files(blobs).into_iter().filter(|shelf| shelf.is_dir()).flat_map(|shelf| files(&shelf));
    all.max_by_key(|file| std::fs::metadata(file).unwrap().len()).unwrap()
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap()) {
        let (path, to) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() { copy(&path, &to) } else { assert!(std::fs::copy(path, to).is_ok()) }
    }
}

/// A cluster's folder `jobs` and the library `library` that was collected from it; its processes were killed.
fn cluster(at: &Path) {
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let endpoint = format!("unixsock-stream/{}", at.join("bus").display());
    let up = start(PROGRAM, &["cluster", "up", "--dir", "jobs", "--listen", &endpoint], at, "up").unwrap();
    assert!(poll(|| at.join("bus").exists().then_some(())).is_some());
    let work = ["cluster", "work", "--connect", &endpoint, "--slots", "1", "--dir", "spool"];
    let work = start(PROGRAM, &work, at, "work").unwrap();
    let submit = [
        "cluster",
        "submit",
        "hall.toml",
        "--variants",
        COUNT,
        "--repeats",
        "--require",
        "any",
        "--connect",
        &endpoint,
    ];
    let submitted = socrates(at, "submit", &submit);
    assert_eq!(submitted.code, 0, "{}", submitted.err);
    // While it works: every look is sound, and the first is at a batch that is not done.
    let mut open = 0;
    let done = poll(|| {
        let counts = sound(at, &["jobs"])["stores"][0]["counts"].clone();
        open += u64::from(counts["ended"] != counts["scenarios"]);
        (counts["scenarios"] == 4 && counts["ended"] == 4).then_some(())
    });
    assert!(done.is_some() && open > 0, "{open} looks at an open batch");
    let collected = socrates(at, "collect", &["cluster", "collect", "--connect", &endpoint, "--out", "library"]);
    assert_eq!(collected.code, 0, "{}", collected.err);
    for (child, name) in [(work, "work"), (up, "up")] {
        assert!(signal(child.id(), "KILL").unwrap());
        assert_eq!(finish(child, at, name).unwrap().code, -1);
    }
    assert!(poll(|| naming(at).is_empty().then_some(())).is_some(), "left running: {:#?}", naming(at));
}

#[test]
fn a_cluster_is_sound_while_it_works_and_once_killed_and_what_is_damaged_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    cluster(at);
    let told = sound(at, &["jobs", "library"]);
    assert_eq!((&told["bundles"], told["stores"].as_array().unwrap().len()), (&4.into(), 1));
    let counts = &told["stores"][0]["counts"];
    assert!(counts["results"].as_u64().unwrap() >= 20 && counts["reigns"] == 1, "{counts}");
    // Every rule was asked of something, but that a message came as a text.
    let rules = told["checked"].as_array().unwrap();
    assert!(rules.iter().filter(|rule| rule["looked_at"] != 0).count() >= 20, "{rules:#?}");
    let text = socrates(at, "text", &["fsck", "jobs"]);
    assert!(text.code == 0 && text.out.contains("sound      nothing is wrong"), "{}{}", text.out, text.err);

    let recording = largest(&at.join("jobs/blobs"));
    let bytes = std::fs::read(&recording).unwrap();
    let name = recording.file_name().unwrap().to_string_lossy().into_owned();
    std::fs::write(&recording, &bytes[..bytes.len() - 1]).unwrap();
    let told = wrong(at, &["jobs"]);
    assert!(told.contains(&name) && told.contains(&format!("which has {}", bytes.len() - 1)), "{told}");
    std::fs::remove_file(&recording).unwrap();
    assert!(wrong(at, &["jobs"]).contains(&name));
    std::fs::write(&recording, &bytes).unwrap();

    let (one, other) = (at.join("library/hall-1-00001"), at.join("library/twin"));
    copy(&one, &other);
    let told = wrong(at, &["library"]);
    assert!(told.contains("scenario `hall-1-00001` has 2 bundles") && told.contains("library/twin"), "{told}");
    std::fs::remove_dir_all(&other).unwrap();

    let story = std::fs::read(one.join("story.txt")).unwrap();
    std::fs::write(one.join("story.txt"), "another").unwrap();
    let told = wrong(at, &["library"]);
    assert!(told.contains("hall-1-00001` is not as it was written: story.txt"), "{told}");
    std::fs::write(one.join("story.txt"), story).unwrap();

    std::fs::rename(&one, at.join("away")).unwrap();
    let told = wrong(at, &["jobs", "library"]);
    assert!(told.contains("scenario `hall-1-00001` was judged, and its bundle is not there"), "{told}");
    assert!(told.contains("`hall-1-00001` is listed as"), "{told}");
    std::fs::rename(at.join("away"), &one).unwrap();
    sound(at, &["jobs", "library"]);

    std::fs::create_dir(at.join("stranger")).unwrap();
    std::fs::write(at.join("stranger/jobs.sqlite"), vec![b'x'; 5000]).unwrap();
    for (what, words) in
        [("stranger", "cannot be read"), ("spool", "neither a job store nor a bundle"), ("none", "is not there")]
    {
        let (finished, _) = fsck(at, &[what]);
        assert_eq!(finished.code, 2, "{what}: {}", finished.err);
        assert!(finished.err.contains(words) && finished.err.contains("hint:"), "{what}: {}", finished.err);
    }
}
