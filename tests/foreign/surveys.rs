//! A survey in a browser that others wrote, answered as a participant would.

use serde_json::json;
use socrates_tests::program::run;
use socrates_tests::{browser, root};

use super::live::snake;
use crate::WAREHOUSE;
use crate::life::kits::{Served, compared, kit};
use crate::life::studies::does;

/// Windows of a desk and of a phone, px.
const SIZES: [&str; 2] = ["1280x720", "390x844"];

#[test]
fn a_participant_answers_at_a_desk_and_on_a_phone_and_goes_on_after_a_kill() {
    let Some(python) = snake() else { return };
    let Some(chromium) = browser::chromium() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    compared(at, WAREHOUSE);
    kit(at, &["--instruments", "psi,godspeed,slider"]);
    let script = root().join("tests/foreign/surveys/page.py").display().to_string();
    for size in SIZES {
        // One film, then the server is killed and the browser is another one, then the rest.
        for (part, films) in [("first", "1"), ("rest", "2")] {
            let served = Served::start(at, &format!("serve-{size}-{part}"));
            let address = format!("http://{}/?PROLIFIC_PID=P{size}", served.address);
            let pictures = at.display().to_string();
            let args = [script.as_str(), &chromium.display().to_string(), &pictures, size, &address, films];
            let finished = run(&python.display().to_string(), &args, at, &format!("page-{size}-{part}")).unwrap();
            let found = finished.json();
            assert_eq!(finished.code, 0, "{}\n{}", finished.out, finished.err);
            for clean in ["console", "policy", "strangers"] {
                assert_eq!(found[clean], json!([]), "{size} {part}: {found}");
            }
            assert!(found["gated"].as_array().unwrap().iter().all(|gated| *gated == json!(true)), "{found}");
            let steps = if part == "first" { json!(["Film 1 of 3"]) } else { json!(["Film 2 of 3", "Film 3 of 3"]) };
            assert_eq!(found["steps"], steps, "{size}: {found}");
            assert_eq!(found["code"], if part == "first" { "" } else { "CDONE42" }, "the code comes last");
            assert!(found["reminder"].as_str().unwrap().contains("questions are open"), "{found}");
            assert_eq!(found["send"], "Continue");
            for moment in ["consent", "shapes", "film", "open", "answered", "last"] {
                let seen = &found[moment];
                assert!(seen["wide"].as_f64() <= seen["inner"].as_f64(), "{size}: cut at {moment}: {seen}");
                assert_eq!((&seen["cut"], &seen["odd"]), (&json!([]), &json!([])), "{size}, {moment}: {seen}");
            }
        }
    }
    let read = does(at, "read", &["read", "answers/answers.jsonl"]);
    assert_eq!((read["people"].as_u64(), read["missing"].as_u64()), (Some(2), Some(0)), "{read}");
    let people = std::fs::read_to_string(at.join("tables/participants.csv")).unwrap();
    assert!(people.lines().count() == 3 && !people.contains("1280x720"), "{people}");
}
