//! Observers: the page and its key, and what their tables say.

use std::path::Path;

use serde_json::{Value, json};

use crate::{WAREHOUSE, make, socrates};

/// Words that would tell observers which planner or run they look at.
pub(crate) const WORDS: [&str; 4] = ["reference-", "reactive", "90417", "bundle-texts"];

/// The page over two runs of one scenario, and what was said of it.
pub(crate) fn page(folder: &Path, more: &[&str]) -> Value {
    if !folder.join("bundle-texts").exists() {
        let args = ["--require", "any", "--seed", "90417", "--planner", "reference,reactive"];
        let (made, _) = make(folder, "texts", WAREHOUSE, &args);
        assert_eq!(made.code, 0, "{}", made.err);
    }
    let args = [&["--format", "json", "labels", "observe", "bundle-texts"], more].concat();
    let finished = socrates(folder, "observe", &args);
    assert_eq!(finished.code, 0, "{}", finished.err);
    finished.json()
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// The table of somebody who thinks the reactive planner better by `by`, believes in the goal from half of the film on, and prefers what they
/// think better.
fn answers(key: &str, rater: &str, by: f64) -> String {
    let mut out = String::from("task,rater,t,value\n");
    for line in key.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let (task, kind, planner, truth) = (cells[0], cells[1], cells[4], cells[8]);
        let value = if planner == "reactive" { 0.4 + by } else { 0.4 };
        match kind {
            "belief" => {
                for k in 0..=100 {
                    let belief = if k < 50 { 0.5 - 0.004 * f64::from(k) } else { 0.9 };
                    let to_b = if truth == "b" { belief } else { 1.0 - belief };
                    out.push_str(&format!("{task},{rater},{:.1},{to_b:.2}\n", f64::from(k) / 10.0));
                }
            }
            "pair" => {
                let left = (planner == "reactive") == (by > 0.0);
                out.push_str(&format!("{task},{rater},,{}\n", if left { "left" } else { "right" }));
            }
            _ => out.push_str(&format!("{task},{rater},,{value:.2}\n")),
        }
    }
    out
}

#[test]
fn what_observers_say_becomes_ratings_beliefs_and_strengths_of_planners() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let asked = page(at, &["--slider", "--belief", "--pairs", "--repeat", "2"]);
    assert_eq!(asked["tasks"], json!({ "rate": 2, "again": 2, "belief": 2, "pair": 1 }));
    let html = text(&at.join("observing/observe.html"));
    let (_, body) = html.split_once("</style>").unwrap();
    for word in WORDS {
        assert!(!body.contains(word), "`{word}` stands on the page");
    }
    let key = text(&at.join("observing/observe-key.csv"));
    let mut args = vec!["--format", "json", "labels", "observed"];
    let people = [("ann", 0.4), ("bob", 0.5), ("cy", 0.3), ("dee", -0.3)];
    let files: Vec<String> = people.iter().map(|(name, _)| format!("{name}.csv")).collect();
    for ((name, by), file) in people.iter().zip(&files) {
        std::fs::write(at.join(file), answers(&key, name, *by)).unwrap();
        args.push(file);
    }
    args.extend(["--key", "observing/observe-key.csv"]);
    let found = socrates(at, "observed", &args);
    assert_eq!(found.code, 0, "{}", found.err);
    let found = found.json();
    assert_eq!(found["dropped"], json!(["dee"]), "who turns the slider round: {found}");
    assert_eq!(text(&at.join("observed/raters.csv")).lines().count(), 5);
    let films = text(&at.join("observed/films.csv"));
    let mean = |planner: &str| -> f64 {
        let line = films.lines().find(|line| line.contains(&format!(",{planner},"))).unwrap();
        line.split(',').nth(4).unwrap().parse().unwrap()
    };
    assert!((mean("reference") - 0.4).abs() < 1e-9 && (mean("reactive") - 0.8).abs() < 1e-9, "{films}");
    let beliefs = text(&at.join("observed/beliefs.csv"));
    let first: Vec<&str> = beliefs.lines().nth(1).unwrap().split(',').collect();
    // At 0.5 at first, then below: one drop; right from 5 s of 10 on.
    assert_eq!((first[3], first[4], first[6]), ("3", "5.0000", "1.0000"), "{beliefs}");
    // All three prefer one planner: there is no finite strength, and that is said.
    assert!(found["pairs"]["why"].as_str().unwrap().contains("no finite estimate"), "{found}");
}

#[test]
fn what_cannot_be_observed_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    page(at, &["--slider", "--repeat", "0"]);
    let refused = |args: &[&str], words: &str| {
        let finished = socrates(at, "refused", &[&["labels"], args].concat());
        assert_eq!(finished.code, 2, "{}", finished.err);
        assert!(finished.err.contains(words), "{words}: {}", finished.err);
    };
    refused(&["observe", "bundle-texts"], "nothing is asked of observers");
    refused(&["observe", "bundle-texts", "--slider"], "`--repeat 5` is more than the `2` films");
    refused(&["observe", "bundle-texts", "--pairs", "--first"], "no two runs are of one scenario");
    std::fs::write(at.join("a.csv"), "task,rater,t,value\nt001,ann,,7\n").unwrap();
    refused(&["observed", "a.csv", "--key", "observing/observe-key.csv"], "a.csv:2: `value` is `7`");
}
