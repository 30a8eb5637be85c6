//! A person looks at what was made: with real processes, and standard input instead of a terminal.

use std::path::Path;

use serde_json::Value;
use socrates_tests::program::{Finished, finish, start_typed};

use crate::{PROGRAM, WAREHOUSE};

/// Runs `run --ask` with these lines typed.
pub(crate) fn asked(folder: &Path, name: &str, typed: &str, editor: &str) -> (Finished, Value) {
    let file = folder.join("asked.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let (file, out) = (file.display().to_string(), folder.join("bundle").display().to_string());
    let args = ["--format", "json", "run", &file, "--out", &out, "--ask", "--author", "offline"];
    let variables = [("EDITOR", editor), ("VISUAL", "")];
    let child = start_typed(PROGRAM, &args, folder, name, typed, &variables).unwrap();
    let finished = finish(child, folder, name).unwrap();
    let json = finished.json();
    (finished, json)
}

fn read(folder: &Path, file: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("bundle").join(file)).unwrap()).unwrap()
}

#[test]
fn what_a_person_leaves_is_what_is_simulated_and_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let typed = "human_1 gives way when the robot is within 3 m\naccept\n\
                 make the robot's path longer\nagain behaviors because I want others\naccept\n";
    let (finished, json) = asked(folder.path(), "asked", typed, "true");
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    assert!(finished.err.contains("look 1 of 2") && finished.err.contains("look 2 of 2"), "{}", finished.err);
    let proposal = read(folder.path(), "details/proposal.json");
    assert!(proposal["author"].as_str().unwrap().ends_with("+ person"), "{}", proposal["author"]);
    assert!(proposal["humans"][0]["rules"].to_string().contains("give_way"), "{}", proposal["humans"][0]);
    let reading = read(folder.path(), "details/reading.json");
    assert!(reading["humans"].to_string().contains("give_way"), "the wish is one of the request now: {reading}");
    assert!(
        proposal["expected_events"].to_string().contains("gives_way"),
        "and the run is held against it: {proposal}"
    );
    assert!(read(folder.path(), "details/paths.json")["author"].as_str().unwrap().ends_with("+ person"));
    let provenance = read(folder.path(), "details/provenance.json");
    let looks: Vec<&Value> =
        provenance["jobs"].as_array().unwrap().iter().filter(|job| job["job"]["stage"] == "review").collect();
    assert_eq!(looks.len(), 3, "the proposal, the draft, the draft again: {provenance}");
    let first = looks.iter().find(|look| look["job"]["item"] == "draft" && look["job"]["revision"] == 0).unwrap();
    assert_eq!(first["said"][0], "make the robot's path longer", "{looks:?}");
    assert!(provenance.to_string().contains("because I want others"));
    // What a person changed is preferred to what it was made from.
    let exported = ["library", "export", "bundle", "--chat-jsonl", "data"];
    assert_eq!(crate::socrates(folder.path(), "export", &exported).code, 0);
    let index = std::fs::read_to_string(folder.path().join("data/index.jsonl")).unwrap();
    let pairs: Vec<&str> = index.lines().filter(|line| line.contains("preferences.jsonl")).collect();
    for stage in ["proposal", "paths"] {
        let found = pairs.iter().any(|line| line.contains(&format!("\"{stage}\"")) && line.contains("+ person"));
        assert!(found, "{stage}: {index}");
    }
    // The bundle's request holds what the person left: it needs nobody to look again.
    let again = folder.path().join("bundle/request.toml").display().to_string();
    let out = folder.path().join("again").display().to_string();
    let second = crate::socrates(folder.path(), "again", &["--format", "json", "run", &again, "--out", &out]).json();
    assert_eq!(second["runs"][0]["recording_hash"], json["runs"][0]["recording_hash"], "{second}");
}

#[test]
fn who_leaves_comes_back_to_the_same_look() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, _) = asked(folder.path(), "leaves", "accept\nmake the robot's path longer\nquit\n", "true");
    assert_eq!(finished.code, 4, "{}", finished.err);
    assert!(finished.err.contains("left at look 2; nothing is lost"), "{}", finished.err);
    let (finished, json) = asked(folder.path(), "returns", "accept\n", "true");
    assert_eq!(finished.code, 0, "{}\n{}", finished.err, finished.out);
    assert!(!finished.err.contains("look 1 of 2"), "the first look was decided: {}", finished.err);
    assert_eq!(json["verdict"], "realised");
    assert!(read(folder.path(), "details/paths.json")["author"].as_str().unwrap().ends_with("+ person"));
}

#[test]
fn an_editor_that_fails_and_a_closed_input_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, _) = asked(folder.path(), "editor", "edit\nmow the lawn\n", "no-such-editor --wait");
    assert_eq!(finished.code, 4, "the input ended: {}", finished.err);
    assert!(finished.err.contains("`no-such-editor --wait` cannot be started"), "{}", finished.err);
    assert!(finished.err.contains("what can be said"), "{}", finished.err);
    let many = [WAREHOUSE, "[run]\nvariants = 2\n"].concat();
    let (finished, json) = crate::make(folder.path(), "many", &many, &["--ask"]);
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert!(json["error"].as_str().unwrap().contains("`--ask` looks at one scenario; 2"), "{json}");
}
