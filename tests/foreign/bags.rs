//! Bags of ROS 2 that software of others writes, scored: rosbags and the MCAP project's writer, by the script beside the reader.
//!
//! The robot goes 6 m within 12 s and stands; Ann comes the other way 1 m beside it, Bob stands 1.5 m from its way.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use socrates_tests::program::Finished;
use socrates_tests::{root, skip};

use super::python::python;
use crate::socrates;

const PACKAGES: [&str; 2] = ["rosbags==0.11.9", "mcap==1.6.0"];

/// A Python that writes bags; where there is none, the running test is left out.
#[track_caller]
fn writing() -> Option<PathBuf> {
    static PLACE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let import = "import rosbags.rosbag2, mcap.writer, lz4.frame";
    skip::installed(PLACE.get_or_init(|| python("bags", &PACKAGES, import)).clone())
}

/// Writes a bag into a folder of this name.
fn write(python: &Path, folder: &Path, name: &str, kind: &str, options: &[&str]) {
    let script = root().join("bus/stream/tests/data/bag.py");
    let out = Command::new(python).arg(script).args([name, kind]).args(options).current_dir(folder).output().unwrap();
    assert!(out.status.success(), "{name}: {}", String::from_utf8_lossy(&out.stderr));
}

/// Scores a bag into the folder `scored`.
fn scored(folder: &Path, bag: &str, more: &[&str]) -> Value {
    let finished = score(folder, bag, &[&["--out", "scored"], more].concat());
    assert_eq!(finished.code, 0, "{bag}: {}", finished.err);
    finished.json()
}

fn score(folder: &Path, bag: &str, more: &[&str]) -> Finished {
    socrates(folder, "score", &[&["--format", "json", "score", bag], more].concat())
}

/// How far somebody of `tracks.csv` is from where they should be, m: at most.
fn farthest(folder: &Path, id: &str, wanted: impl Fn(f64) -> (f64, f64)) -> f64 {
    let text = std::fs::read_to_string(folder.join("scored/tracks.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0][..4], ["t", "id", "x", "y"]);
    let own: Vec<&Vec<&str>> = rows.iter().filter(|row| row[1] == id).collect();
    assert_eq!(own.len(), 141, "{id}");
    let number = |cell: &str| cell.parse::<f64>().unwrap();
    let off = own.iter().map(|row| {
        let (x, y) = wanted(number(row[0]));
        (number(row[2]) - x).hypot(number(row[3]) - y)
    });
    off.fold(0.0, f64::max)
}

#[track_caller]
fn near(found: &Value, id: &str, wanted: f64, within: f64) {
    let value = found["metrics"][id].as_f64().unwrap_or(f64::NAN);
    assert!((value - wanted).abs() <= within, "{id} is {value}, not {wanted}: {}", found["told"]);
}

/// Everybody is where they were, and the figures are those of the motion; `radii` are those of the robot and of Ann.
fn is_the_walk(folder: &Path, found: &Value, radii: (f64, f64)) {
    for (id, off) in [
        ("robot", farthest(folder, "robot", |t| (2.0, 1.0 + (0.5 * t).min(6.0)))),
        ("ann", farthest(folder, "ann", |t| (3.0, 9.0 - 0.8 * t))),
        ("bob", farthest(folder, "bob", |_| (0.5, 4.0))),
    ] {
        assert!(off < 1e-3, "{id} is {off} m off: {}", found["told"]);
    }
    // It has arrived 0.5 m before the goal.
    near(found, "path_length", 5.5, 0.01);
    near(found, "human_distance_min", 1.0 - radii.0 - radii.1, 0.005);
    near(found, "success", 1.0, 0.0);
    near(found, "time_to_goal", 11.0, 0.02);
}

#[test]
fn a_walk_has_its_figures_in_every_form_of_mcap() {
    let Some(python) = writing() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut first: Option<Value> = None;
    for (name, options) in [("plain", &[][..]), ("zstd", &["zstd"]), ("lz4", &["lz4"]), ("big", &["big"])] {
        write(&python, folder.path(), name, "people", options);
        let found = scored(folder.path(), name, &[]);
        is_the_walk(folder.path(), &found, (0.25, 0.28));
        let told = found["told"].to_string();
        for what in ["robot: `/odom`", "people: `/people`", "the last of 2 of `/goal_pose`", "not read: `/chatter`"] {
            assert!(told.contains(what), "{name}: {what}: {told}");
        }
        let same = first.get_or_insert_with(|| found.clone());
        assert_eq!(same["recording_hash"], found["recording_hash"], "{name}");
        assert_eq!(same["metrics"], found["metrics"], "{name}");
        // The file alone is the bag as well, and so is the table that came of it.
        let file = scored(folder.path(), &format!("{name}/{name}.mcap"), &[]);
        assert_eq!(same["metrics"], file["metrics"], "{name}");
    }
    std::fs::copy(folder.path().join("scored/tracks.csv"), folder.path().join("again.csv")).unwrap();
    let table = score(folder.path(), "again.csv", &[]).json();
    assert_eq!(first.map(|found| found["metrics"].clone()), Some(table["metrics"].clone()));
    // Another goal is the user's word: it has arrived beside Bob, before Ann comes by.
    let asked = scored(folder.path(), "plain", &["--goal", "2,3", "--groups", "ann+bob", "--radius", "0.3"]);
    near(&asked, "human_distance_min", 4.5_f64.sqrt() - 0.3 - 0.28, 0.005);
    near(&asked, "time_to_goal", 3.0, 0.02);
}

#[test]
fn hunavsim_is_scored_in_both_layouts_of_its_agents() {
    let Some(python) = writing() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut both = Vec::new();
    for kind in ["hunav1", "hunav2"] {
        write(&python, folder.path(), kind, kind, &[]);
        let found = scored(folder.path(), kind, &[]);
        // The robot's messages have the recorder's time alone, which runs twice as fast.
        is_the_walk(folder.path(), &found, (0.3, 0.35));
        let told = found["told"].to_string();
        assert!(told.contains("--robot chooses another of `/odom`") && told.contains("another of `/people`"), "{told}");
        assert!(!told.contains("radius of people"), "{told}");
        both.push(found);
        let odometry = scored(folder.path(), kind, &["--robot", "/odom", "--goal", "2,7"]);
        is_the_walk(folder.path(), &odometry, (0.25, 0.35));
    }
    assert_eq!(both[0]["metrics"], both[1]["metrics"]);
}

#[test]
fn a_robot_that_only_transforms_tell_of_is_scored_among_poses() {
    let Some(python) = writing() else { return };
    let folder = tempfile::tempdir().unwrap();
    write(&python, folder.path(), "poses", "poses", &["zstd"]);
    let found = scored(folder.path(), "poses", &["--goal", "2,7"]);
    let told = found["told"].to_string();
    assert!(told.contains("robot: the frame `base_footprint` of /tf, placed in `map`"), "{told}");
    assert!(told.contains("people: `/tracker/people`") && told.contains("`/mocap/human_7/pose`"), "{told}");
    assert!(farthest(folder.path(), "robot", |t| (2.0, 1.0 + (0.5 * t).min(6.0))) < 1e-3);
    assert!(farthest(folder.path(), "1", |t| (3.0, 9.0 - 0.8 * t)) < 1e-3);
    near(&found, "human_distance_min", 1.0 - 0.25 - 0.28, 0.005);
    let one = scored(folder.path(), "poses", &["--people", "/mocap/human_8/pose", "--goal", "2,7"]);
    assert!(farthest(folder.path(), "human_8", |_| (0.5, 4.0)) < 1e-3);
    near(&one, "human_distance_min", 1.5 - 0.25 - 0.28, 0.005);
}

#[test]
fn other_storages_are_refused_with_the_command_that_makes_them_mcap() {
    let Some(python) = writing() else { return };
    let folder = tempfile::tempdir().unwrap();
    write(&python, folder.path(), "lite", "people", &["sqlite3"]);
    write(&python, folder.path(), "packed", "people", &["message"]);
    for bag in ["lite", "lite/lite.db3", "packed", "packed/packed.mcap"] {
        let refused = score(folder.path(), bag, &[]);
        assert_eq!(refused.code, 2, "{bag}: {}", refused.out);
        let hint = refused.json()["hint"].as_str().unwrap().to_owned();
        assert!(
            hint.contains("rosbags-convert --src BAG --dst BAG_mcap") || bag == "packed/packed.mcap",
            "{bag}: {hint}"
        );
        assert!(hint.contains("--compression-mode message") || bag != "packed/packed.mcap", "{bag}: {hint}");
    }
    let convert = python.with_file_name("rosbags-convert");
    for bag in ["lite", "packed"] {
        let to = format!("{bag}_mcap");
        let args = ["--src", bag, "--dst", &to, "--dst-storage", "mcap"];
        let out = Command::new(&convert).args(args).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap();
        assert!(out.status.success(), "{bag}: {}", String::from_utf8_lossy(&out.stderr));
        let found = scored(folder.path(), &to, &[]);
        is_the_walk(folder.path(), &found, (0.25, 0.28));
    }
}
