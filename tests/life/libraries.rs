//! A library grows bundle by bundle while it is made, and a killed one leaves whole bundles only.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use socrates_model::Digest;
use socrates_tests::program::{poll, start};

use crate::{PROGRAM, WAREHOUSE, socrates};

/// Scenarios of the library.
const COUNT: usize = 24;

/// Folders of scenarios that are there by now, each with the digests that its manifest has of its files.
fn bundles(root: &Path) -> BTreeMap<String, BTreeMap<String, String>> {
    let entries = std::fs::read_dir(root).into_iter().flatten().filter_map(Result::ok);
    entries
        .filter(|entry| entry.path().is_dir() && !entry.file_name().to_string_lossy().starts_with('.'))
        .map(|entry| {
            let text = std::fs::read_to_string(entry.path().join("details/manifest.json"))
                .unwrap_or_else(|why| panic!("{} is there, but not whole: {why}", entry.path().display()));
            let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
            let files = serde_json::from_value(manifest["files"].clone()).unwrap();
            (entry.file_name().into_string().unwrap(), files)
        })
        .collect()
}

/// Every file of every bundle is what the manifest says.
fn whole(root: &Path, bundles: &BTreeMap<String, BTreeMap<String, String>>) {
    for (name, files) in bundles {
        assert!(files.len() > 10, "{name}: {files:?}");
        for (file, digest) in files {
            let bytes = std::fs::read(root.join(name).join(file)).unwrap();
            assert_eq!(Digest::of(&bytes).to_string(), *digest, "{name}/{file}");
        }
        for page in ["report.html", "details/provenance.json"] {
            assert!(root.join(name).join(page).is_file(), "{name}/{page}");
        }
    }
}

fn manifest_times(root: &Path) -> BTreeMap<String, std::time::SystemTime> {
    let time = |name: &String| root.join(name).join("details/manifest.json").metadata().unwrap().modified().unwrap();
    bundles(root).keys().map(|name| (name.clone(), time(name))).collect()
}

#[test]
fn a_killed_library_holds_whole_bundles_and_the_same_command_makes_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("hall.toml"), WAREHOUSE).unwrap();
    let count = COUNT.to_string();
    let args = [
        "--format",
        "json",
        "run",
        "hall.toml",
        "--variants",
        &count,
        "--repeats",
        "--out",
        "library",
        "--require",
        "any",
    ];
    let root: PathBuf = folder.path().join("library");
    let mut grown = BTreeSet::new();
    // Killed when there is one bundle more than before: others are being made and written at that moment.
    for (round, name) in ["first", "second", "third"].into_iter().enumerate() {
        let mut child = start(PROGRAM, &args, folder.path(), name).unwrap();
        let wanted = grown.len() + 1;
        let seen = poll(|| (bundles(&root).len() >= wanted).then_some(()));
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(seen.is_some(), "round {round}: no bundle came while the library was made");
        let now = bundles(&root);
        whole(&root, &now);
        assert!(now.len() < COUNT, "the library was finished before it could be killed");
        assert!(now.keys().collect::<BTreeSet<_>>().is_superset(&grown.iter().collect()), "a bundle was lost");
        grown = now.into_keys().collect();
    }
    let before = manifest_times(&root);
    let finished = socrates(folder.path(), "rest", &args);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let (all, told) = (bundles(&root), finished.json());
    whole(&root, &all);
    let listed: Vec<&str> =
        told["scenarios"].as_array().unwrap().iter().map(|row| row["scenario"].as_str().unwrap()).collect();
    assert_eq!(listed.len(), COUNT);
    assert_eq!(listed, all.keys().map(String::as_str).collect::<Vec<_>>(), "each once, in order");
    let after = manifest_times(&root);
    assert!(before.iter().all(|(name, time)| after[name] == *time), "a bundle that was there was written again");
    assert!(!root.join(".socrates").exists());
    // The page that was put together on the way is the one that is put together from the folder.
    let (page, table) = (root.join("report.html"), root.join("index.csv"));
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    let made = (read(&page), read(&table));
    assert_eq!(socrates(folder.path(), "page", &["report", "library"]).code, 0);
    let args = ["--format", "json", "library", "diversity", "library", "--out", "pairs.csv"];
    let told = socrates(folder.path(), "diversity", &args);
    assert_eq!(told.code, 0, "{}", told.err);
    let (told, pairs) = (told.json(), std::fs::read_to_string(folder.path().join("pairs.csv")).unwrap());
    let count: u64 = told["locations"].as_array().unwrap().iter().map(|place| place["pairs"].as_u64().unwrap()).sum();
    assert!(count > 0 && pairs.lines().count() as u64 == count + 1, "{told}");
    let least = &told["locations"][0]["distances"]["track_m"]["pairs"][0];
    assert!(least.as_f64().is_some_and(|least| least >= 0.0), "{told}");
    let odd = socrates(folder.path(), "odd", &["library", "diversity", "library", "--most", "1"]);
    assert!(odd.code == 2 && odd.err.contains("`--most 1` leaves no pair"), "{}", odd.err);
    assert_eq!((read(&page), read(&table)), made);
}
