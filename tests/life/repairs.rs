//! What goes wrong goes back with its reason, and not for ever.

use std::path::Path;

use serde_json::Value;

use crate::{WAREHOUSE, make};

/// Attempts of a stage in a bundle's provenance, all revisions, in order.
fn attempts(bundle: &Path, stage: &str) -> Vec<Value> {
    jobs(bundle, stage).iter().flat_map(|job| job["attempts"].as_array().unwrap().clone()).collect()
}

fn jobs(bundle: &Path, stage: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(bundle.join("details/provenance.json")).unwrap();
    let provenance: Value = serde_json::from_str(&text).unwrap();
    provenance["jobs"].as_array().unwrap().iter().filter(|job| job["job"]["stage"] == stage).cloned().collect()
}

/// The first answer of a stage is spoiled; the second is asked for with the reason and stands.
fn comes_back(kind: &str, stage: &str, code: &str) {
    let folder = tempfile::tempdir().unwrap();
    let inject = format!("{kind}=1,first_only=true");
    let (finished, json) = make(folder.path(), kind, WAREHOUSE, &["--inject", &inject]);
    assert_eq!(json["verdict"], "realised", "{kind}: {}\n{}", finished.err, finished.out);
    assert!(finished.out.contains(code), "the stage line names {code}:\n{}", finished.out);
    let attempts = attempts(&folder.path().join(format!("bundle-{kind}")), stage);
    let fault = attempts[0]["faults"].as_array().unwrap().iter().find(|fault| fault["code"] == code).unwrap();
    let reason = fault["message"].as_str().unwrap();
    assert_eq!(attempts[0]["end"], "failed");
    assert_eq!(attempts[1]["end"], "succeeded");
    // The author was told why: the very words stand in what it was asked the second time.
    let asked = attempts[1]["exchanges"].to_string() + &jobs_exchanges(folder.path(), kind, stage);
    let words = Value::String(reason.to_owned()).to_string();
    assert!(asked.contains(words.trim_matches('"')), "`{reason}` is not in the second question: {asked}");
}

fn jobs_exchanges(folder: &Path, kind: &str, stage: &str) -> String {
    jobs(&folder.join(format!("bundle-{kind}")), stage).iter().map(|job| job["exchanges"].to_string()).collect()
}

#[test]
fn a_discontinuous_path_goes_back_with_its_reason() {
    comes_back("gdisc", "paths", "G-DISC");
}

#[test]
fn a_broken_tree_goes_back_with_its_reason() {
    comes_back("bxml", "behaviors", "B-XML");
}

#[test]
fn an_author_who_never_learns_is_not_asked_for_ever() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, json) = make(folder.path(), "never", WAREHOUSE, &["--inject", "gdisc=1"]);
    assert_eq!(finished.code, 3, "{}\n{}", finished.err, finished.out);
    assert!(json["verdict"].is_null(), "{json}");
    assert!(finished.err.contains("G-DISC") && finished.err.contains("hint:"), "{}", finished.err);
    let stages = json["stages"].as_array().unwrap();
    let paths = stages.iter().find(|stage| stage["stage"].as_str().unwrap().starts_with("paths")).unwrap();
    let asked = paths["attempts"].as_u64().unwrap();
    assert!((2..=12).contains(&asked), "asked {asked} times");
    assert!(!folder.path().join("bundle-never/report.html").exists());
}

#[test]
fn an_encounter_that_did_not_happen_goes_back_with_its_reason_within_its_budget() {
    let folder = tempfile::tempdir().unwrap();
    // Nobody can be met in four seconds.
    let request = format!("{WAREHOUSE}\n[run]\nduration = \"4s\"\n");
    let (finished, json) = make(folder.path(), "short", &request, &[]);
    assert_eq!(finished.code, 3, "{}\n{}", finished.err, finished.out);
    assert_ne!(json["verdict"], "realised");
    let bundle = folder.path().join("bundle-short");
    let again: Vec<Value> = ["proposal", "paths", "behaviors", "simulation"]
        .iter()
        .flat_map(|stage| jobs(&bundle, stage))
        .filter(|job| job["job"]["revision"].as_u64().unwrap() > 0)
        .collect();
    assert!(!again.is_empty(), "no stage was asked again");
    assert!(again.iter().all(|job| job["job"]["revision"].as_u64().unwrap() <= 8), "the budget ends");
    let reasons: Vec<&Value> = again.iter().flat_map(|job| job["sent_back"].as_array().unwrap()).collect();
    assert!(reasons.iter().any(|fault| fault["code"] == "D-NOMEET"), "{reasons:?}");
}

#[test]
fn a_kind_of_fault_that_does_not_exist_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, _) = make(folder.path(), "kind", WAREHOUSE, &["--inject", "gremlins=1"]);
    assert_eq!(finished.code, 2);
    assert!(finished.err.contains("gremlins") && finished.err.contains("gdisc"), "{}", finished.err);
}
