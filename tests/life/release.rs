//! A release runs where there is nothing else: no compiler, no Rust, no network, no settings.

use std::collections::BTreeSet;
use std::process::Command;

use socrates_tests::program::run;
use socrates_tests::{root, tempfile};

use crate::PROGRAM;

#[test]
fn a_release_unpacked_into_an_empty_folder_shows_its_first_page() {
    let folder = tempfile::tempdir().unwrap();
    let script = root().join("deploy/release.sh").display().to_string();
    let out = folder.path().join("archives").display().to_string();
    let packed = run("bash", &[&script, "--binary", PROGRAM, "--out", &out], folder.path(), "pack").unwrap();
    assert_eq!(packed.code, 0, "{}\n{}", packed.out, packed.err);
    let archives = folder.path().join("archives");
    let names: Vec<String> = std::fs::read_dir(&archives)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    let archive = names.iter().find(|name| name.ends_with(".tar.gz")).unwrap();
    let sum = Command::new("sha256sum").args(["-c", &format!("{archive}.sha256")]).current_dir(&archives).status();
    assert!(sum.unwrap().success());

    let empty = folder.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let unpacked = Command::new("tar").arg("xzf").arg(archives.join(archive)).current_dir(&empty).status();
    assert!(unpacked.unwrap().success());
    let name = archive.trim_end_matches(".tar.gz");
    let home = empty.join(name);
    for paper in ["README.md", "LICENSE", "socrates.toml.default", "THIRD-PARTY.txt", "requests/hospital-elevator.toml"]
    {
        assert!(home.join(paper).is_file(), "{paper} is missing");
    }
    // A sample of every format that the program writes, each with its list of losses.
    let listed = run(PROGRAM, &["--format", "json", "export", "--formats"], folder.path(), "formats").unwrap().json();
    let formats = listed.as_array().unwrap().iter().map(|format| format["name"].as_str().unwrap().to_owned());
    let samples = std::fs::read_dir(home.join("samples")).unwrap();
    let samples: BTreeSet<String> =
        samples.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(samples, formats.collect::<BTreeSet<String>>());
    for sample in &samples {
        let count = std::fs::read_dir(home.join("samples").join(sample)).unwrap().count();
        assert!(count > 1 && home.join("samples").join(sample).join("not_carried.json").is_file(), "{sample}");
    }
    let linked = std::fs::read_to_string(home.join("THIRD-PARTY.txt")).unwrap();
    assert!(linked.lines().any(|line| line.starts_with("zenoh ") && line.contains("Apache-2.0")), "{linked}");
    assert!(!linked.contains(&root().display().to_string()));
    // An environment without anything: neither cargo nor cc, nor a home.
    let shown = run("env", &["-i", "PATH=/nonexistent", "./socrates", "demo"], &home, "demo").unwrap();
    assert_eq!(shown.code, 0, "{}\n{}", shown.out, shown.err);
    let page = shown.out.lines().chain(shown.err.lines()).find_map(|line| line.strip_prefix("look ")).unwrap();
    assert!(home.join(page.trim()).is_file(), "{page}");
    let made =
        run("env", &["-i", "PATH=/nonexistent", "./socrates", "run", "requests/hospital-elevator.toml"], &home, "run");
    assert_eq!(made.unwrap().code, 0);
}
