//! Bundles in formats of others through the program: one, a library, packed ones, and everything that can be wrong.

use std::collections::BTreeMap;
use std::path::Path;

use crate::{WAREHOUSE, make, socrates};

/// Files under a folder with their bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(dir) = open.pop() {
        for entry in std::fs::read_dir(&dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                found.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

#[test]
fn a_bundle_goes_out_in_every_format_with_the_same_bytes_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (made, _) = make(at, "hall", WAREHOUSE, &[]);
    assert!(matches!(made.code, 0 | 3), "{}", made.err);
    let wrong = socrates(at, "wrong", &["export", "bundle-hall", "--to", "hunav"]);
    assert!(wrong.code == 2 && wrong.err.contains("several") && wrong.err.contains("hunav-1.1"), "{}", wrong.err);
    let wrong = socrates(at, "none", &["export", "bundle-hall", "--to", "dxf"]);
    assert!(wrong.code == 2 && wrong.err.contains("`dxf` is no format"), "{}", wrong.err);
    let listed = socrates(at, "listed", &["--format", "json", "export", "--formats"]).json();
    let formats: Vec<&str> = listed.as_array().unwrap().iter().map(|format| format["name"].as_str().unwrap()).collect();
    assert!(formats.len() >= 6, "{formats:?}");
    // Formats of the page that are not listed want a feature, and say so.
    let page = std::fs::read_to_string(socrates_tests::root().join("docs/export.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `")).map(|row| row.split('`').nth(1).unwrap());
    let unlisted: Vec<&str> = rows.filter(|name| !formats.contains(name)).collect();
    for format in &unlisted {
        let told = socrates(at, format, &["export", "bundle-hall", "--to", format, "--out", "unlisted"]);
        assert!(told.code == 2 && told.err.contains("--features"), "{format}: {}", told.err);
        assert!(!at.join("unlisted").exists(), "{format} leaves files behind");
    }
    assert!(unlisted.len() <= 1, "{unlisted:?}");
    for format in &formats {
        let outs = ["one", "two"].map(|name| format!("{name} ö/{format}"));
        for out in &outs {
            let told = socrates(at, format, &["export", "bundle-hall", "--to", format, "--out", out]);
            assert_eq!(told.code, 0, "{format}: {}", told.err);
            assert!(told.out.contains("left       clauses") && told.out.contains("not_carried.json"), "{}", told.out);
        }
        let [one, two] = outs.map(|out| files(&at.join(out)));
        assert!(one.len() > 1 && one.contains_key("not_carried.json"), "{format}: {:?}", one.keys());
        assert!(one == two, "{format} differs from itself");
    }
    // A bundle whose recording is gone is still a scenario, but has no tracks.
    std::fs::remove_dir_all(at.join("bundle-hall/details/recordings")).unwrap();
    let told = socrates(at, "gone", &["export", "bundle-hall", "--to", "pedpy", "--out", "gone"]);
    assert!(told.code == 2 && told.err.contains("keeps no recording"), "{}", told.err);
    let told = socrates(at, "still", &["export", "bundle-hall", "--to", "sdf", "--out", "still"]);
    assert!(told.code == 0 && told.out.contains("left       the run"), "{} {}", told.out, told.err);
    let told = socrates(at, "run", &["export", "bundle-hall", "--to", "sdf", "--run", "orca-7"]);
    assert!(told.code == 2 && told.err.contains("no run `orca-7`") && told.err.contains("reference-1"), "{}", told.err);
    let told = socrates(at, "nowhere", &["export", "nowhere", "--to", "sdf"]);
    assert!(told.code == 2 && told.err.contains("`nowhere`"), "{}", told.err);
}

/// A bundle without one of its files, or with one of an older version, is refused by its name and leaves nothing behind.
#[test]
fn half_bundles_and_older_ones_are_refused_with_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (made, _) = make(at, "halle ö", WAREHOUSE, &[]);
    assert!(matches!(made.code, 0 | 3), "{}", made.err);
    let details = at.join("bundle-halle ö/details");
    let export = |name: &str| {
        let told = socrates(at, name, &["export", "bundle-halle ö", "--to", "usda", "--out", "out"]);
        (told.code, told.err)
    };
    for file in ["manifest.json", "location.json", "proposal.json", "paths.json", "behaviors.json"] {
        let path = details.join(file);
        let good = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let (code, said) = export(&format!("without-{file}"));
        assert!(code == 2 && said.contains(file), "without {file}: {code} {said}");
        std::fs::write(&path, &good[..good.len() / 2]).unwrap();
        let (code, said) = export(&format!("half-{file}"));
        assert!(code == 2 && said.contains(file), "half of {file}: {code} {said}");
        let mut old: serde_json::Value = serde_json::from_str(&good).unwrap();
        if old.get("format").is_some() {
            old["format"] = 0.into();
            std::fs::write(&path, old.to_string()).unwrap();
            let (code, said) = export(&format!("old-{file}"));
            assert!(code == 2 && said.contains(file) && said.contains("format"), "older {file}: {code} {said}");
        }
        std::fs::write(&path, good).unwrap();
        assert!(!at.join("out").exists(), "{file}");
    }
    let (code, said) = export("whole");
    assert_eq!(code, 0, "{said}");
}

#[test]
fn a_library_of_packed_bundles_has_a_folder_for_each_and_names_those_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let args = [
        "run",
        "hall.toml",
        "--variants",
        "2",
        "--repeats",
        "--require",
        "any",
        "--keep",
        "packed",
        "--out",
        "library",
    ];
    let made = socrates(at, "made", &args);
    assert_eq!(made.code, 0, "{}", made.err);
    let told = socrates(at, "told", &["--format", "json", "export", "library", "--to", "trajnet", "--out", "out"]);
    assert_eq!(told.code, 0, "{}", told.err);
    let bundles = told.json()["bundles"].as_array().unwrap().clone();
    assert_eq!(bundles.len(), 2);
    for bundle in &bundles {
        let out = at.join(bundle["out"].as_str().unwrap());
        assert!(files(&out).keys().any(|name| name.ends_with(".ndjson")), "{bundle}");
        assert!(!out.display().to_string().contains(".tar"), "{bundle}");
    }
    std::fs::write(at.join("library/zz.tar.zst"), b"no archive").unwrap();
    let told = socrates(at, "damaged", &["export", "library", "--to", "trajnet", "--out", "again"]);
    assert!(told.code == 2 && told.err.contains("1 of 3 bundles") && told.err.contains("zz.tar.zst"), "{}", told.err);
    assert_eq!(files(&at.join("again")).len(), 4, "the good ones are written");
}
