//! Exported scenarios in the hands of readers that others wrote. The column *parsed* of `docs/export.md` is what these tests hold.

mod simulated;
mod stages;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use socrates_tests::{root, skip};

use super::built::reader;
use super::python::python;
use crate::{WAREHOUSE, make, socrates};

/// Readers of tracks.
const READERS: [&str; 4] = ["jupedsim==1.4.2", "pedpy==1.5.1", "trajnetplusplustools==0.3.0", "shapely==2.2.0"];
/// What they find, beside the table of the run.
const TRACKS: &str = include_str!("exports/tracks.py");
/// Formats of tracks that are read by [`TRACKS`], with the largest distance from the run, m: half a digit and that of the table.
const TRACK_FORMATS: [(&str, f64); 4] =
    [("trajnet", 0.0072), ("eth-ucy", 0.000_1), ("pedpy", 0.000_1), ("jupedsim-2", 0.000_1)];
/// Readers of bags, and what they find, beside the table of the run.
const BAG_READERS: [&str; 3] = ["rosbags==0.11.9", "mcap-ros2-support==0.6.0", "numpy"];
const BAGS: &str = include_str!("exports/bags.py");
/// Formats of bags that are read by [`BAGS`].
const BAG_FORMATS: [&str; 1] = ["rosbag2-5"];
/// Formats of worlds that are read by [`SDF_MAIN`].
const WORLD_FORMATS: [&str; 1] = ["sdf-1.6"];

/// Requests in three locations: with people who wait, who come later, and who walk.
fn requests() -> Vec<(&'static str, String)> {
    let shipped = |path: &str| std::fs::read_to_string(root().join("maps").join(path)).unwrap();
    vec![
        ("hall", WAREHOUSE.to_owned()),
        ("doorway", shipped("office/scenarios/doorway.toml")),
        ("elevator", shipped("hospital/scenarios/elevator.toml")),
    ]
}

/// Exports a bundle into a folder named after the format.
fn export(at: &Path, bundle: &str, format: &str) -> Value {
    let out = format!("out/{format}");
    let made = socrates(
        at,
        &format!("export-{format}"),
        &["--format", "json", "export", bundle, "--to", format, "--out", &out],
    );
    assert_eq!(made.code, 0, "{format}: {}", made.err);
    let list: Value = serde_json::from_slice(&std::fs::read(at.join(&out).join("not_carried.json")).unwrap()).unwrap();
    assert_eq!(list["format"], format, "{list}");
    made.json()
}

#[test]
fn the_formats_that_the_page_calls_parsed_are_those_that_are_read_here() {
    let page = std::fs::read_to_string(root().join("docs/export.md")).unwrap();
    let of = |word: &str| -> BTreeSet<String> {
        let rows = page.lines().filter(|line| line.starts_with("| `") && line.contains(&format!(" | {word} | ")));
        rows.map(|row| row.split('`').nth(1).unwrap().to_owned()).collect()
    };
    let tracks = TRACK_FORMATS.map(|(format, _)| format);
    let read = tracks.into_iter().chain(WORLD_FORMATS).chain(BAG_FORMATS).chain(stages::FORMATS).map(str::to_owned);
    assert_eq!(of("parsed"), read.collect::<BTreeSet<String>>());
    assert_eq!(of("run"), simulated::FORMATS.map(str::to_owned).into_iter().collect::<BTreeSet<String>>());
}

#[test]
fn readers_of_tracks_find_the_positions_of_the_run() {
    let python =
        skip::installed(python("export-readers", &READERS, "import jupedsim, pedpy, shapely, trajnetplusplustools"));
    let Some(python) = python else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (made, _) = make(at, "hall", WAREHOUSE, &[]);
    assert!(matches!(made.code, 0 | 3), "{}", made.err);
    for (format, _) in TRACK_FORMATS {
        export(at, "bundle-hall", format);
    }
    let mut reads = Command::new(python);
    reads.args(["-c", TRACKS, "out", "bundle-hall/agents.csv"]).current_dir(at).stdin(Stdio::null());
    let out = reads.output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let found: Value = serde_json::from_slice(&out.stdout).unwrap();
    for (format, most_m) in TRACK_FORMATS {
        let (positions, off) = (found[format]["positions"].as_u64().unwrap(), found[format]["off"].as_f64().unwrap());
        assert!(positions > 100 && off <= most_m, "{format}: {found}");
    }
    assert_eq!(found["pedpy"]["inside"], true, "{found}");
    assert!(
        found["trajnet"]["scenes"].as_u64().unwrap() > 0 && found["jupedsim-2"]["area"].as_f64().unwrap() > 10.0,
        "{found}"
    );
}

#[test]
fn two_readers_of_bags_find_the_positions_of_the_run_and_so_does_ours() {
    let python = skip::installed(python("bag-readers", &BAG_READERS, "import rosbags, mcap_ros2"));
    let Some(python) = python else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (made, _) = make(at, "hall", WAREHOUSE, &[]);
    assert!(matches!(made.code, 0 | 3), "{}", made.err);
    for format in BAG_FORMATS {
        export(at, "bundle-hall", format);
        let bag = format!("out/{format}/bag");
        let mut reads = Command::new(&python);
        reads.args(["-c", BAGS, &bag, "bundle-hall/agents.csv"]).current_dir(at).stdin(Stdio::null());
        let out = reads.output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let found: Value = serde_json::from_slice(&out.stdout).unwrap();
        let (positions, off) = (found["positions"].as_u64().unwrap(), found["off"].as_f64().unwrap());
        assert!(positions > 100 && off <= 0.000_1, "{found}");
        assert_eq!(found["messages"], found["others"], "{found}");
        assert_eq!(found["topics"].as_array().unwrap().len(), 11, "{found}");
        assert!(found["scans"].as_u64().unwrap() > 50 && found["nearest"].as_f64().unwrap() > 0.0, "{found}");
        let scored = socrates(at, "scored", &["score", &bag, "--out", "scored"]);
        assert_eq!(scored.code, 0, "{}", scored.err);
    }
}

/// A program around a reader of SDF that others wrote: what it finds in each file, a line each.
const SDF_MAIN: &str = r#"
fn main() {
    for file in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&file).expect("a file");
        let root: sdformat::SdfRoot = match sdformat::yaserde::de::from_str(&text) {
            Ok(root) => root,
            Err(why) => return println!("refused {why}"),
        };
        for world in &root.world {
            let walls = world.model.iter().filter(|model| model.name.starts_with("wall"));
            let walls: usize = walls.flat_map(|model| &model.link).map(|link| link.collision.len()).sum();
            let doors = world.model.iter().filter(|model| model.name.contains("door")).count();
            let trajectories = world.actor.iter().flat_map(|actor| &actor.script.trajectory);
            let poses: usize = trajectories.map(|one| one.waypoint.len()).sum();
            println!("world {} {} {} {} {}", walls, doors, world.light.len(), world.actor.len(), poses);
        }
    }
}
"#;

/// Bundles in locations with and without doors, and the world of each.
fn worlds(at: &Path) -> Vec<(PathBuf, Value)> {
    let requests =
        ["warehouse", "hospital", "office"].map(|location| (location, WAREHOUSE.replace("warehouse", location)));
    let mut made = Vec::new();
    for (location, request) in requests {
        let request = if location == "warehouse" {
            request
        } else {
            format!(
                "location = \"{location}\"\nsocial_context = \"A morning\"\ntask = \"Deliver a parcel\"\nrough_scenario = \"One person walks towards the robot.\"\n"
            )
        };
        let (run, _) = make(at, location, &request, &[]);
        assert!(matches!(run.code, 0 | 3), "{location}: {}", run.err);
        for format in WORLD_FORMATS {
            let bundle = format!("bundle-{location}");
            let out = format!("worlds/{location}-{format}");
            let told = socrates(
                at,
                &out.replace('/', "-"),
                &["--format", "json", "export", &bundle, "--to", format, "--out", &out],
            );
            assert_eq!(told.code, 0, "{location}: {}", told.err);
            let files = told.json()["files"].as_array().unwrap().clone();
            let world = files.iter().filter_map(Value::as_str).find(|name| name.ends_with(".world")).unwrap();
            let text = std::fs::read_to_string(at.join(&bundle).join("details/location.json")).unwrap();
            made.push((at.join(&out).join(world), serde_json::from_str(&text).unwrap()));
        }
    }
    made
}

#[test]
fn the_crate_for_sdf_reads_walls_doors_and_actors_and_refuses_a_damaged_world() {
    static READER: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let Some(reader) =
        skip::installed(READER.get_or_init(|| reader("sdf-reader", ("sdformat", "0.1.0"), SDF_MAIN)).clone())
    else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let read = |file: &Path| {
        let out = Command::new(&reader).arg(file).stdin(Stdio::null()).output().unwrap();
        format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr))
    };
    for (world, location) in worlds(folder.path()) {
        let (found, text) = (read(&world), std::fs::read_to_string(&world).unwrap());
        let counts: Vec<usize> = found.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let [walls, doors, lights, actors, poses] = counts[..] else { panic!("{}: {found}", world.display()) };
        let doors_wanted = location["doors"].as_array().unwrap();
        let elevators = doors_wanted.iter().filter(|door| door["kind"] == "elevator").count();
        assert_eq!((doors, lights), (doors_wanted.len(), 1 + elevators), "{found}");
        assert_eq!(walls, text.matches("<collision name=\"wall_").count(), "{found}");
        assert_eq!((actors, poses), (text.matches("<actor ").count(), text.matches("<waypoint>").count()), "{found}");
        assert!(walls > 20 && actors > 0 && poses >= 2 * actors, "{found}");
        let damaged = folder.path().join("damaged.world");
        std::fs::write(&damaged, text.replace("<gravity>0 0 -9.8</gravity>", "")).unwrap();
        assert!(read(&damaged).starts_with("refused"), "{}", read(&damaged));
    }
}

/// What Gazebo's own library says of a world.
const CMD_CHECK: &str = r#"
import ctypes, os, sys
os.environ["SDF_PATH"] = "/usr/share/sdformat12"
print(ctypes.CDLL("libsdformat12.so.12").cmdCheck(sys.argv[1].encode()))
"#;

/// Debian's library is part of the system, so no ring installs it.
#[test]
fn the_library_of_gazebo_calls_the_worlds_valid() {
    let check = |file: &str| {
        Command::new("python3")
            .args(["-c", CMD_CHECK, file])
            .stdin(Stdio::null())
            .output()
            .map_err(|why| why.to_string())
    };
    let there = Command::new("python3")
        .args(["-c", "import ctypes; ctypes.CDLL('libsdformat12.so.12')"])
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success());
    let there = if there { Ok(()) } else { Err("`libsdformat12-12` of Debian is not installed".to_owned()) };
    let Some(()) = skip::elsewhere(there) else { return };
    let folder = tempfile::tempdir().unwrap();
    for (world, _) in worlds(folder.path()) {
        let out = check(&world.display().to_string()).unwrap();
        let text = String::from_utf8_lossy(&out.stdout).into_owned();
        assert_eq!(text.trim().lines().last(), Some("0"), "{}: {text}", world.display());
        let damaged = folder.path().join("damaged.world");
        let good = std::fs::read_to_string(&world).unwrap();
        std::fs::write(&damaged, good.replacen("_visual\"", "\"", 1)).unwrap();
        let out = check(&damaged.display().to_string()).unwrap();
        let text = String::from_utf8_lossy(&out.stdout).into_owned();
        assert_eq!(text.trim().lines().last(), Some("-1"), "names of a link twice: {text}");
    }
}
