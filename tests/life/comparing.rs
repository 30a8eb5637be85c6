//! Planners compared: the same scenarios and seeds, tables, page and film.

use std::path::Path;

use serde_json::Value;

use crate::{WAREHOUSE, socrates};

/// A parameter file of the program with 400 trajectories, which a test has time for.
fn small(folder: &Path, name: &str, text: &str) {
    assert!(text.contains("batch_size: 2000"), "{name}");
    std::fs::write(folder.join(format!("{name}.yaml")), text.replace("batch_size: 2000", "batch_size: 400")).unwrap();
}

/// The figures of a metric in the result of `compare`.
fn figures<'r>(result: &'r Value, metric: &str) -> &'r Value {
    let rows = result["figures"].as_array().unwrap();
    rows.iter().find(|row| row["id"] == metric).unwrap_or_else(|| panic!("no `{metric}` in {result}"))
}

#[test]
fn planners_are_compared_over_the_same_runs_and_a_second_time_from_their_bundles() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("requests")).unwrap();
    std::fs::write(folder.path().join("requests/dock.toml"), WAREHOUSE).unwrap();
    let other = WAREHOUSE.replace(
        "One person walks towards the robot. One person follows the robot.",
        "A worker stands in the way of the robot.",
    );
    std::fs::write(folder.path().join("requests/block.toml"), other).unwrap();
    let args = ["--format", "json", "compare", "requests", "--planner", "orca,straight_line", "--seeds", "1..2"];
    let film = ["--out", "out", "--film", "out/film.svg", "--opaque"];
    let made = socrates(folder.path(), "compare", &[&args[..], &film[..]].concat());
    assert_eq!(made.code, 0, "{} {}", made.out, made.err);
    let result = made.json();
    assert_eq!((result["scenarios"].as_u64(), result["common"].as_u64()), (Some(2), Some(4)), "{result}");
    let names: Vec<&str> = result["planners"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert_eq!(names, ["orca", "straight_line"]);
    for outcome in result["outcomes"].as_array().unwrap() {
        let parts = outcome["parts"].as_array().unwrap().iter().map(|part| part["count"].as_u64().unwrap());
        assert_eq!(
            (outcome["runs"].as_u64(), parts.sum::<u64>()),
            (Some(4), 4),
            "every run is counted once: {outcome}"
        );
    }
    let out = folder.path().join("out");
    let rows = |file: &str| std::fs::read_to_string(out.join(file)).unwrap().lines().count();
    // The reference, both planners and the run without a robot, twice in two scenarios.
    assert_eq!(rows("compare.csv"), 1 + 4 * 2 * 2);
    assert!(rows("differences.csv") > 10);
    let paper = std::fs::read_to_string(out.join("compare.tex")).unwrap();
    assert!(paper.contains("\\begin{tabular}{lrrr}") && paper.contains("straight\\_line"), "{paper}");
    let film = std::fs::read_to_string(out.join("film.svg")).unwrap();
    assert!(film.contains("robot A") && film.contains("robot B") && !film.contains("orca"));
    let page = std::fs::read(out.join("compare.html")).unwrap();
    // The same from the bundles, compared with the other planner.
    let args = ["--format", "json", "compare", "out/scenarios", "--against", "straight_line", "--out", "again"];
    let again = socrates(folder.path(), "again", &args);
    assert_eq!(again.code, 0, "{} {}", again.out, again.err);
    let of = |result: &Value, place: usize| figures(result, "success")["means"][place]["mean"].clone();
    assert_eq!((of(&again.json(), 0), of(&again.json(), 1)), (of(&result, 1), of(&result, 0)));
    let args = ["--format", "json", "compare", "out/scenarios", "--out", "out"];
    let same = socrates(folder.path(), "same", &args);
    assert_eq!((same.code, std::fs::read(out.join("compare.html")).unwrap() == page), (0, true), "{}", same.err);
}

#[test]
fn what_cannot_be_compared_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("dock.toml"), WAREHOUSE).unwrap();
    let refused = |name: &str, args: &[&str]| {
        let run = socrates(folder.path(), name, &[&["compare"], args].concat());
        assert_eq!(run.code, 2, "{name}: {} {}", run.out, run.err);
        run.err
    };
    let one = refused("one", &["dock.toml", "--planner", "orca"]);
    assert!(one.contains("orca alone cannot be compared") && one.contains("--planner socrates_mppi,nav2can"), "{one}");
    let args = ["compare", "dock.toml", "--planner", "orca,straight_line", "--out", "one"];
    assert_eq!(socrates(folder.path(), "run", &args).code, 0);
    let gone = refused("gone", &["nowhere"]);
    assert!(gone.contains("nowhere"), "{gone}");
    let mixed = refused("mixed", &["one/scenarios", "dock.toml"]);
    assert!(mixed.contains("`one/scenarios` holds bundles"), "{mixed}");
    let who = refused("who", &["one/scenarios", "--planner", "orca,rpp"]);
    assert!(who.contains("`rpp` has no run here; those that have are orca, reference and straight_line"), "{who}");
}

#[test]
fn the_case_study_of_the_paper_is_reproduced_in_its_main_points() {
    let folder = tempfile::tempdir().unwrap();
    small(folder.path(), "plain", include_str!("../../workers/simulation/planners/presets/socrates_mppi.yaml"));
    small(folder.path(), "aware", include_str!("../../workers/simulation/planners/presets/ha_mppi.yaml"));
    small(folder.path(), "grouped", include_str!("../../workers/simulation/planners/presets/nav2can.yaml"));
    let files = "\n[robot.nav2]\nplain = \"plain.yaml\"\naware = \"aware.yaml\"\ngrouped = \"grouped.yaml\"\n";
    let group = include_str!("../../maps/warehouse/scenarios/group.toml");
    std::fs::write(folder.path().join("group.toml"), format!("{group}{files}")).unwrap();
    let args = ["--format", "json", "compare", "group.toml", "--planner", "plain,aware,grouped", "--seeds", "1..3"];
    let made = socrates(folder.path(), "compare", &[&args[..], &["--out", "out"]].concat());
    assert_eq!(made.code, 0, "{} {}", made.out, made.err);
    let result = made.json();
    let mean = |metric: &str, place: usize| figures(&result, metric)["means"][place]["mean"].as_f64().unwrap();
    assert!(mean("o_space_entries", 0) > 0.0, "MPPI enters the group's space: {result}");
    assert!(mean("o_space_entries", 2) < 1e-9, "nav2can does not, where a way round exists: {result}");
    let more = mean("human_distance_min", 1) - mean("human_distance_min", 0);
    assert!(more >= 0.3, "ha_mppi keeps {more:.2} m more than MPPI: {result}");
}
