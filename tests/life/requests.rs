//! Every shipped request, and the published tool's sample, is realised.

use socrates_tests::skip::shared;

use crate::{WAREHOUSE, make, socrates};

fn realised(location: &str) {
    let folder = tempfile::tempdir().unwrap();
    let requests = socrates_maps::shipped::requests(location);
    assert!(requests.len() >= 3, "{location} ships {} requests", requests.len());
    let mut missed = Vec::new();
    for (stem, text) in requests {
        let (finished, json) = make(folder.path(), stem, text, &[]);
        if json["verdict"] != "realised" {
            missed.push(format!(
                "{stem}: code {} {}\n{}\n{}",
                finished.code, json["verdict"], finished.err, finished.out
            ));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn every_request_of_the_warehouse_is_realised() {
    realised("warehouse");
}

#[test]
fn every_request_of_the_hospital_is_realised() {
    realised("hospital");
}

#[test]
fn every_request_of_the_office_is_realised() {
    realised("office");
}

#[test]
fn seeds_that_a_request_writes_are_kept_and_those_it_does_not_write_are_that_of_the_flag() {
    let folder = tempfile::tempdir().unwrap();
    let written = format!("{WAREHOUSE}\n[run]\nseeds = \"1\"\n");
    for (name, request, more, seed) in [
        ("unwritten", WAREHOUSE, &["--require", "any", "--seed", "7"][..], 7),
        ("written", &written, &["--require", "any", "--seed", "7"], 1),
        ("flag", &written, &["--require", "any", "--seed", "7", "--seeds", "3"], 3),
    ] {
        let (finished, json) = make(folder.path(), name, request, more);
        assert_eq!(finished.code, 0, "{name}: {}", finished.err);
        let seeds: Vec<&serde_json::Value> = json["runs"].as_array().unwrap().iter().map(|run| &run["seed"]).collect();
        assert_eq!(seeds, [&serde_json::json!(seed)], "{name}");
    }
}

#[test]
fn a_location_in_the_style_of_others_is_realised_guided_and_unguided() {
    let folder = tempfile::tempdir().unwrap();
    let location = socrates_tests::root().join(socrates_tests::ANNEX).display().to_string();
    let base = format!(
        "location = {location:?}\nsocial_context = \"A storage hall with racks\"\ntask = \"Bring a box from one corner to another\"\n"
    );
    let guided =
        format!("{base}rough_scenario = \"A worker comes towards the robot in the corridor and gives way.\"\n");
    for (name, text) in [("guided", &guided), ("unguided", &base)] {
        let (finished, json) = make(folder.path(), name, text, &[]);
        assert_eq!(json["verdict"], "realised", "{name}: {}\n{}", finished.err, finished.out);
    }
}

#[test]
fn a_narrow_passage_that_a_location_does_not_have_is_refused_with_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let location = socrates_tests::root().join(socrates_tests::ANNEX).display().to_string();
    let request = format!(
        "location = {location:?}\nsocial_context = \"A storage hall with racks\"\ntask = \"Bring a box from one corner to another\"\n\
         rough_scenario = \"A worker comes towards the robot in the aisle and gives way.\"\n"
    );
    let (finished, json) = make(folder.path(), "narrow", &request, &[]);
    assert!(json["verdict"].is_null(), "{}", finished.out);
    assert_eq!(
        json["causes"][0],
        "E-CANNOT answer: a narrow passage of 1.3 to 1.7 m is needed; `a2`, which comes nearest on this map, has 4.0 m",
        "{}",
        finished.err
    );
}

#[test]
fn a_foreign_location_is_realised_with_its_own_request_and_without_any() {
    let Some(data) = shared("socrates_hunav/socrates") else { return };
    let folder = tempfile::tempdir().unwrap();
    let config = std::fs::read_to_string(data.join("config/inputs.yaml")).unwrap();
    let value = |key: &str| {
        let line = config.lines().find(|line| line.starts_with(&format!("{key}:"))).unwrap();
        line.split_once(':').unwrap().1.trim().to_owned()
    };
    let location = data.join("locations/small_warehouse").display().to_string();
    let base = format!("location = {location:?}\nsocial_context = {}\ntask = {}\n", value("context"), value("task"));
    let guided = format!("{base}rough_scenario = {}\n", value("rough_scenario"));
    for (name, text) in [("guided", &guided), ("unguided", &base)] {
        let (finished, json) = make(folder.path(), name, text, &[]);
        assert_eq!(json["verdict"], "realised", "{name}: {}\n{}", finished.err, finished.out);
    }
}

#[test]
fn the_demo_needs_nothing_and_is_realised() {
    let folder = tempfile::tempdir().unwrap();
    let finished = socrates(folder.path(), "demo", &["demo"]);
    assert_eq!(finished.code, 0, "{}\n{}", finished.err, finished.out);
    for word in
        ["location", "reading", "author  offline", "proposal ✔", "simulation ✔", "realised", "robot", "look", "next"]
    {
        assert!(finished.out.contains(word), "`{word}` is missing in\n{}", finished.out);
    }
    assert!(folder.path().join("runs/elevator-1/report.html").is_file());
}
