//! Files that were changed by hand or damaged: each is named, with line and key, and nothing panics or hangs.

use std::path::Path;

use socrates_tests::tempfile;

use crate::{WAREHOUSE, make, socrates};

/// Changes a text of a bundle, runs the verb, and puts the text back.
fn changed(folder: &Path, file: &str, change: impl Fn(&str) -> String, verb: &str) -> (i32, String) {
    let path = folder.join("bundle-doors").join(file);
    let good = std::fs::read_to_string(&path).unwrap();
    let bad = change(&good);
    assert_ne!(bad, good, "{file} was not changed");
    std::fs::write(&path, bad).unwrap();
    let finished = socrates(folder, "changed", &[verb, "bundle-doors"]);
    std::fs::write(&path, good).unwrap();
    (finished.code, finished.err)
}

#[test]
fn a_bundle_that_was_changed_by_hand_is_refused_with_file_line_and_key() {
    let folder = tempfile::tempdir().unwrap();
    let (made, _) = make(folder.path(), "doors", WAREHOUSE, &["--require", "any"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let plain = socrates(folder.path(), "plain", &["score", "bundle-doors"]);
    assert_eq!(plain.code, 0, "{}", plain.err);
    let key = |from: &'static str, to: &'static str| move |text: &str| text.replacen(from, to, 1);
    for (file, from, to, words) in [
        ("details/paths.json", "\"robot\": [", "\"robot\": [7,", vec!["details/paths.json", "robot[0]", "line "]),
        ("details/paths.json", "\"encounters\"", "\"meetings\"", vec!["details/paths.json", "meetings", "line "]),
        (
            "details/proposal.json",
            "\"humans\": [",
            "\"humans\": [[",
            vec!["details/proposal.json", "humans[0]", "line "],
        ),
        ("details/manifest.json", "\"seed\": 1", "\"seed\": -1", vec!["details/manifest.json", "seed", "line "]),
        (
            "details/manifest.json",
            "\"planner\": \"reference\"",
            "\"planner\": \"../up\"",
            vec!["manifest.json", "runs"],
        ),
        (
            "details/location.json",
            "\"resolution_m\": 0.",
            "\"resolution_m\": -0.",
            vec!["details/location.json", "resolution_m"],
        ),
        ("details/behaviors.json", "{", "", vec!["details/behaviors.json", "line "]),
        (
            "details/reports/reference-1.json",
            "\"verdict\": \"",
            "\"verdict\": \"un",
            vec!["reports/reference-1.json", "verdict", "line "],
        ),
        ("request.toml", "task = ", "tusk = ", vec!["request.toml", "tusk"]),
    ] {
        for verb in ["score", "simulate", "report"] {
            let (code, err) = changed(folder.path(), file, key(from, to), verb);
            assert_eq!(code, 2, "{verb} {file}: {err}");
            for word in words.iter().chain(&["hint:", "bundle-doors/"]) {
                assert!(err.contains(word), "{verb} {file}: `{word}` is missing in\n{err}");
            }
        }
    }
}

#[test]
fn what_differs_because_a_file_was_changed_is_not_called_our_fault() {
    let folder = tempfile::tempdir().unwrap();
    let (made, _) = make(folder.path(), "doors", WAREHOUSE, &["--require", "any"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let report = "details/reports/reference-1.json";
    let (code, err) =
        changed(folder.path(), report, |text| text.replacen("\"robot_text\": \"", "\"robot_text\": \"x", 1), "score");
    assert_eq!(code, 2, "{err}");
    assert!(err.contains(report) && err.contains("changed"), "{err}");
}
