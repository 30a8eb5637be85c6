//! Human studies: from simulated answers in every format to the same report.

use std::path::Path;

use crate::socrates;

/// A study of three planners in two scenarios, with checks and reversed items.
pub(crate) const STUDY: &str = r#"
title = "Elevator and aisle"
planners = ["mppi", "ha", "can"]
participants = 30
instruments = ["psi", "vega2020"]
checks = { check1 = 4, check2 = 5 }
resamples = 300
margin = 0.5
film = [
  { id = "k7f", scenario = "elevator", planner = "mppi", length_s = 20 },
  { id = "q2b", scenario = "elevator", planner = "ha", length_s = 20 },
  { id = "z9x", scenario = "elevator", planner = "can", length_s = 20 },
  { id = "m3c", scenario = "aisle", planner = "mppi", length_s = 24 },
  { id = "t5d", scenario = "aisle", planner = "ha", length_s = 24 },
  { id = "w8e", scenario = "aisle", planner = "can", length_s = 24 },
]
[[hypothesis]]
text = "Robots that keep clear of groups are rated as better adapted."
dimension = "psi.AB"
"#;

/// Does it, and gives the result object.
pub(crate) fn does(folder: &Path, name: &str, args: &[&str]) -> serde_json::Value {
    let done = socrates(folder, name, &[&["--format", "json", "study"], args].concat());
    assert_eq!(done.code, 0, "{name}: {} {}", done.out, done.err);
    done.json()
}

fn refused(folder: &Path, name: &str, args: &[&str]) -> String {
    let done = socrates(folder, name, &[&["study"], args].concat());
    assert_eq!(done.code, 2, "{name}: {} {}", done.out, done.err);
    done.err
}

#[test]
fn simulated_answers_of_sixty_people_give_the_same_report_through_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("study.toml"), STUDY).unwrap();
    does(at, "preregister", &["preregister", "study.toml"]);
    let planted = does(at, "simulate", &["simulate", "--effects", "0,0,1.6", "--careless", "6", "--skipped", "0.02"]);
    assert_eq!(planted["careless"].as_array().unwrap().len(), 6);
    let mut reports = Vec::new();
    for file in ["answers.jsonl", "qualtrics.csv", "jspsych.csv"] {
        let from = format!("simulated/{file}");
        let args = ["read", from.as_str(), "--prolific", "simulated/prolific.csv", "--out", file];
        let read = does(at, "read", &args);
        assert_eq!(read["people"], 60, "{file}: {read}");
        let out = format!("{file}-results");
        let args = ["analyze", file, "--out", out.as_str(), "--preregistration", "preregistration.md"];
        let found = does(at, "analyze", &args);
        assert_eq!(found["declared"], "before");
        assert_eq!(found["excluded"].as_object().unwrap().len(), 6, "{file}: {found}");
        let findings = found["findings"].as_array().unwrap();
        // In both scenarios `can` is above both others on all three scales, and nothing else differs.
        assert_eq!(findings.len(), 12, "{file}: {findings:#?}");
        assert!(findings.iter().all(|one| one["higher"] == "can"), "{findings:#?}");
        assert!(findings.iter().all(|one| one["declared"] == (one["dimension"] == "psi.AB")), "{findings:#?}");
        let text = |name: &str| std::fs::read_to_string(at.join(&out).join(name)).unwrap();
        let page = text("report.html");
        assert!(
            !page.contains("http://") && !page.contains("https://") && !page.contains("sim0"),
            "nothing from outside, no id"
        );
        assert!(
            text("ratings.csv").contains("failed-checks") && text("methods.txt").contains("6 were excluded by rules")
        );
        reports.push((file, text("results.json"), page));
    }
    let (_, first, page) = &reports[0];
    for (file, results, other) in &reports {
        assert!(results == first && other == page, "{file} gives another report");
    }
    // A study that was changed after its registration is exploratory as a whole.
    std::fs::write(at.join("study.toml"), STUDY.replace("margin = 0.5", "margin = 0.4")).unwrap();
    let args = ["analyze", "answers.jsonl", "--out", "changed", "--preregistration", "preregistration.md"];
    let changed = does(at, "changed", &args);
    assert_eq!(changed["declared"], "changed");
    assert!(changed["findings"].as_array().unwrap().iter().all(|one| one["declared"] == false));
}

#[test]
fn bad_input_is_told_with_its_place_its_value_and_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("study.toml"), STUDY).unwrap();
    std::fs::write(at.join("forty.toml"), STUDY.replace("participants = 30", "participants = 40")).unwrap();
    let forty = refused(at, "forty", &["preregister", "forty.toml"]);
    assert!(forty.contains("`participants` is `40`") && forty.contains("take 36 or 42"), "{forty}");
    let few = refused(at, "few", &["plan", "--people", "40"]);
    assert!(
        few.contains("no multiple of the 6 orders") && few.contains("40 people find an effect of 1 log odds"),
        "{few}"
    );
    assert!(few.contains("--people 36 or --people 42"), "{few}");
    std::fs::write(at.join("r.csv"), "participant,film,item,raw\np,k7f,RB1,0\n").unwrap();
    let zero = refused(at, "zero", &["analyze", "r.csv"]);
    assert!(zero.contains("`r.csv` line 2, `raw` is `0`") && zero.contains("hint:"), "{zero}");
    std::fs::write(at.join("r.csv"), "participant,film,item,raw\np,other,RB1,3\n").unwrap();
    assert!(refused(at, "film", &["analyze", "r.csv"]).contains("`film` is `other`: no film of the study"));
    let unknown = refused(at, "format", &["read", "r.csv"]);
    assert!(unknown.contains("no format of answers that is known") && unknown.contains("study analyze"), "{unknown}");
    assert!(refused(at, "instrument", &["instruments", "rosa"]).contains("did you mean `rosas`"));
}

#[test]
fn a_plan_says_what_its_people_can_show() {
    let folder = tempfile::tempdir().unwrap();
    let plan = does(folder.path(), "plan", &["plan", "--people", "42", "--effect", "1.4"]);
    let pair = plan["power"]["pair"].as_f64().unwrap();
    assert!((pair - 0.82).abs() < 0.03, "{plan}");
    assert_eq!(plan["orders"], 6);
}
