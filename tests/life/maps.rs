//! Locations that are named, built and brought from elsewhere, in requests.

use std::path::Path;

use serde_json::Value;

use crate::{make, socrates};

/// Where the robot of a bundle goes.
fn goal(folder: &Path, name: &str) -> String {
    let file = folder.join(format!("bundle-{name}/details/paths.json"));
    let paths: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    paths["robot"].as_array().unwrap().last().unwrap().as_str().unwrap().to_owned()
}

fn request(location: &str, goal: &str) -> String {
    format!(
        "location = \"{location}\"\nsocial_context = \"A quiet hospital floor\"\ntask = \"Deliver medicine to the {goal}\"\nrough_scenario = \"A nurse walks towards the robot in the corridor.\"\n"
    )
}

#[test]
fn a_name_that_people_gave_an_area_is_a_place_of_a_request() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let named = socrates(at, "named", &["map", "name", "hospital", "p2", "printer room", "--out", "mine"]);
    assert_eq!(named.code, 0, "{}", named.err);
    let (finished, _) = make(at, "named", &request("mine", "printer room"), &[]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert_eq!(goal(at, "named"), "p2");
    // Without the name the map has no such place, and the run says so.
    let (finished, _) = make(at, "plain", &request("hospital", "printer room"), &[]);
    assert_eq!(finished.code, 3, "{}", finished.err);
}

#[test]
fn a_building_of_words_is_a_location_whose_rooms_have_names() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let words = "a hospital with two wards, a nurse station, a lobby with two elevators";
    let built = socrates(at, "built", &["map", "build", words, "--out", "st-mary"]);
    assert_eq!(built.code, 0, "{}", built.err);
    let location = std::fs::read_to_string(at.join("st-mary/location.toml")).unwrap();
    let second = location.split("name = \"ward 2\"\nnodes = [\"").nth(1).unwrap().split('"').next().unwrap().to_owned();
    let stem = second.trim_end_matches(char::is_alphabetic).to_owned();
    let (finished, _) = make(at, "ward", &request("st-mary", "ward 2"), &["--require", "any"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(goal(at, "ward").starts_with(&stem), "{} is not in the room of {second}", goal(at, "ward"));
}

#[test]
fn what_cannot_be_built_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let words = "a home with a meeting room of 900 m²";
    let refused = socrates(folder.path(), "refused", &["map", "build", words, "--out", "palace"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(refused.err.contains("asked 720 to 1125 m²") && refused.err.contains("hint:"), "{}", refused.err);
    assert!(!folder.path().join("palace").exists());
}
