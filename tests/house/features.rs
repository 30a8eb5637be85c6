//! What a room needs to be built: the bus between processes, shared memory, recordings and the store belong to the program.

use std::process::Command;

use socrates_tests::root;

use crate::members;

/// Libraries that a room which computes does not need, with all whose names begin so.
const HEAVY: [&str; 5] = ["zenoh", "iceoryx2", "mcap", "rusqlite", "libsqlite3-sys"];
/// Rooms in which somebody adds a metric, a node of a tree, a planner, a tool for maps, or a reader of requests.
const ALONE: [&str; 16] = [
    "socrates-bt",
    "socrates-checks",
    "socrates-crowd",
    "socrates-draw",
    "socrates-engine",
    "socrates-experiment",
    "socrates-export",
    "socrates-hunav",
    "socrates-kit",
    "socrates-maps",
    "socrates-model",
    "socrates-offline",
    "socrates-planners",
    "socrates-scoring",
    "socrates-simulation",
    "socrates-stats",
];

/// Names of everything that cargo would build for a package and its tests.
fn tree(package: &str, more: &[&str]) -> Vec<String> {
    let told = Command::new(env!("CARGO"))
        .args(["tree", "--offline", "--locked", "--edges", "normal,build,dev", "--prefix", "none", "--format", "{p}"])
        .args(["-p", package])
        .args(more)
        .current_dir(root())
        .output()
        .unwrap();
    assert!(told.status.success(), "{package}: {}", String::from_utf8_lossy(&told.stderr));
    let text = String::from_utf8_lossy(&told.stdout);
    let mut names: Vec<String> =
        text.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    assert!(names.contains(&package.to_owned()), "{package}: {text}");
    names
}

fn heavy(names: &[String]) -> Vec<&'static str> {
    HEAVY.into_iter().filter(|heavy| names.iter().any(|name| name.starts_with(heavy))).collect()
}

#[test]
fn a_room_that_computes_is_built_and_tested_without_bus_recordings_and_store() {
    for room in ALONE {
        for more in [&[] as &[&str], &["--no-default-features"]] {
            assert_eq!(heavy(&tree(room, more)), [""; 0], "{room} {more:?} builds more than it needs");
        }
    }
    // The names are those of the libraries that the program has.
    assert_eq!(heavy(&tree("socrates", &[])), HEAVY);
}

#[test]
fn the_program_is_built_without_bus_and_shared_memory_where_nobody_asks_for_them() {
    assert_eq!(heavy(&tree("socrates", &["--no-default-features"])), ["mcap", "rusqlite", "libsqlite3-sys"]);
    assert_eq!(heavy(&tree("socrates", &["--no-default-features", "--features", "zenoh"])).first(), Some(&"zenoh"));
}

#[test]
fn only_the_program_switches_features_on() {
    for (member, manifest) in members() {
        let default = manifest.get("features").and_then(|features| features.get("default"));
        assert!(default.is_none() || member == "orchestrator/cli", "{member} has features that are on by themselves");
    }
}

#[test]
fn crates_that_are_built_for_speed_are_crates_of_the_workspace_or_its_dependencies() {
    let read = |file: &str| -> toml::Table { std::fs::read_to_string(root().join(file)).unwrap().parse().unwrap() };
    let (manifest, lock) = (read("Cargo.toml"), read("Cargo.lock"));
    let built: Vec<&str> = lock["package"].as_array().unwrap().iter().filter_map(|one| one["name"].as_str()).collect();
    for profile in ["release", "ci"] {
        for name in manifest["profile"][profile]["package"].as_table().unwrap().keys().filter(|name| *name != "*") {
            assert!(built.contains(&name.as_str()), "[profile.{profile}.package.{name}]: no such crate in Cargo.lock");
        }
    }
}
