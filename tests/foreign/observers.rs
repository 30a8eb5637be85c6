//! The page for observers in a browser that others wrote: films that play once, answers that open at the end, and the table.

use serde_json::json;
use socrates_tests::program::run;
use socrates_tests::{browser, root};

use super::live::snake;
use crate::life::observers::{WORDS, page};
use crate::socrates;

/// Windows of a desk and of a phone, px.
const SIZES: [&str; 2] = ["1280x720", "390x844"];

#[test]
fn an_observer_answers_at_a_desk_and_on_a_phone_and_the_table_is_read() {
    let Some(python) = snake() else { return };
    let Some(chromium) = browser::chromium() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let asked = page(at, &["--slider", "--belief", "--pairs", "--repeat", "1"]);
    let script = root().join("tests/foreign/observers/page.py").display().to_string();
    let address = format!("file://{}", at.join("observing/observe.html").display());
    for size in SIZES {
        let args = [script.as_str(), &chromium.display().to_string(), &at.display().to_string(), size, &address];
        let finished = run(&python.display().to_string(), &args, at, &format!("page-{size}")).unwrap();
        assert_eq!(finished.code, 0, "{}\n{}", finished.out, finished.err);
        let found = finished.json();
        for clean in ["console", "policy", "strangers"] {
            assert_eq!(found[clean], json!([]), "{size}: {found}");
        }
        assert_eq!(found["kinds"], json!(["belief", "pair", "rate"]), "{found}");
        for (what, wanted) in [("unnamed", true), ("gated", true), ("early", false)] {
            assert_eq!(found[what], wanted, "{what}: {found}");
        }
        let tasks: u64 =
            ["rate", "again", "belief", "pair"].iter().map(|kind| asked["tasks"][kind].as_u64().unwrap()).sum();
        assert_eq!(found["progress"], format!("{tasks} of {tasks} answered"));
        for moment in ["rate", "rate-answered", "belief", "belief-answered", "pair", "pair-answered", "end"] {
            let seen = &found[moment];
            assert!(seen["wide"].as_f64() <= seen["inner"].as_f64(), "{size}: cut at {moment}: {seen}");
            assert_eq!((&seen["cut"], &seen["odd"]), (&json!([]), &json!([])), "{size}, {moment}: {seen}");
        }
        let table = format!("observer-{size}.csv");
        let read = socrates(
            at,
            "read",
            &["--format", "json", "labels", "observed", &table, "--key", "observing/observe-key.csv"],
        );
        assert_eq!(read.code, 0, "{}", read.err);
        assert_eq!((&read.json()["raters"], &read.json()["films"]), (&json!(1), &json!(2)), "{}", read.out);
    }
    let html = std::fs::read_to_string(at.join("observing/observe.html")).unwrap();
    assert!(WORDS.iter().all(|word| !html.split_once("</style>").unwrap().1.contains(word)));
}
