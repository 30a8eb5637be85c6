//! The page of the author console in a browser that others wrote, driven as a person would.

use std::path::PathBuf;

use serde_json::{Value, json};
use socrates_tests::console::{Console, ask};
use socrates_tests::program::{poll, run};
use socrates_tests::{browser, root};

use super::live::snake;
use crate::PROGRAM;

/// Windows of a desk and of a phone, px.
const SIZES: [&str; 2] = ["1280x800", "390x844"];
/// A picture of one pixel.
const PIXEL: &str = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

fn question() -> Value {
    let human = json!({"type": "object", "properties": {"start": {"enum": ["r1", "r2"]}, "pace_mps": {"type": "number", "maximum": 1.8}},
        "required": ["start", "pace_mps"], "additionalProperties": false});
    let schema = json!({"type": "object", "properties": {"title": {"type": "string"}, "human_1": {"$ref": "#/$defs/human"}},
        "required": ["title", "human_1"], "additionalProperties": false, "$defs": {"human": human}});
    let words = "# Your task\nWrite `human_1`.\n\n# Rules\n1. First this.\n2. Then <b>that</b>.\n\n| word | meaning |\n|---|---|\n| r1 | a room |\n\n\
                 Data: {\"humans\": [{\"id\": \"human_1\", \"role\": \"nurse\", \"relation\": \"crossing\"}], \"place\": \"hall\"}";
    let picture = json!({"type": "image_url", "image_url": {"url": format!("data:image/png;base64,{PIXEL}")}});
    json!({"model": "anna", "messages": [{"role": "system", "content": "Be brief."},
            {"role": "user", "content": [{"type": "text", "text": words}, picture]}],
        "response_format": {"type": "json_schema", "json_schema": {"name": "paths", "schema": schema}}})
}

#[test]
fn a_person_reads_mends_sends_and_refuses_at_the_page() {
    let Some(python) = snake() else { return };
    let Some(chromium) = browser::chromium() else { return };
    for size in SIZES {
        let folder = tempfile::tempdir().unwrap();
        let console = Console::start(PROGRAM, folder.path()).unwrap();
        let programs: Vec<std::thread::JoinHandle<(u16, Value)>> = (0..2)
            .map(|_| {
                let (address, body) = (console.address.clone(), question().to_string());
                std::thread::spawn(move || ask(&address, "POST /v1/chat/completions", "", &body).unwrap())
            })
            .collect();
        assert!(poll(|| (console.waiting().unwrap().len() == 2).then_some(())).is_some());
        let script: PathBuf = root().join("tests/foreign/consoles/page.py");
        let page = console.told["page"].as_str().unwrap().to_owned();
        let (script, folder_of_pictures) = (script.display().to_string(), folder.path().display().to_string());
        let args = [script.as_str(), &chromium.display().to_string(), &folder_of_pictures, size, &page];
        let finished = run(&python.display().to_string(), &args, folder.path(), &format!("page-{size}")).unwrap();
        let found = finished.json();
        assert_eq!(finished.code, 0, "{}\n{}", finished.out, finished.err);
        for clean in ["console", "policy", "strangers"] {
            assert_eq!(found[clean], json!([]), "{size}: {found}");
        }
        assert_eq!((&found["waiting"], &found["picture"]), (&json!(2), &json!(true)), "{size}: {found}");
        assert_eq!(
            (&found["markup"], &found["code"]),
            (&json!(0), &json!("human_1")),
            "texts are set as text: {found}"
        );
        assert_eq!(found["order"], json!(["title", "human_1"]), "members stand as they are to be written");
        let faults = found["faults"].as_array().unwrap();
        assert!(faults.iter().any(|fault| fault.as_str().unwrap().contains("at most 1.8")), "{found}");
        assert!(found["kept"].as_str().unwrap().contains("\"pace_mps\": 9"), "a draft outlives a reload: {found}");
        assert_eq!((&found["good"], &found["answered"]), (&json!(true), &json!(true)), "{found}");
        for moment in ["first", "faulty", "form", "last"] {
            let seen = &found[moment];
            assert!(seen["wide"].as_f64() <= seen["inner"].as_f64(), "{size}: cut at {moment}: {seen}");
            assert_eq!((&seen["cut"], &seen["odd"]), (&json!([]), &json!([])), "{size}, {moment}: {seen}");
        }
        let mut said: Vec<Value> = programs.into_iter().map(|program| program.join().unwrap().1).collect();
        said.sort_by_key(|answer| answer["id"].to_string());
        let message = |index: usize| &said[index]["choices"][0]["message"];
        let sent: Value = serde_json::from_str(message(0)["content"].as_str().unwrap()).unwrap();
        assert_eq!(sent, json!({"title": "Ann", "human_1": {"start": "r1", "pace_mps": 1}}));
        assert_eq!(message(1)["refusal"], "two things exclude each other");
        console.leave().unwrap();
    }
}
