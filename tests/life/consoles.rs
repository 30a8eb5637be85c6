//! A person at the page of the author console, played by a program that asks for what the page asks.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_tests::console::Console;
use socrates_tests::program::{Finished, finish, poll, start};

use crate::foreign::models::{WAREHOUSE_ACCOUNT, accounted};
use crate::{PROGRAM, WAREHOUSE, make, socrates};

fn exchanges(tape: &Path) -> Vec<Value> {
    let inside = |folder: &Path| -> Vec<PathBuf> {
        let mut found: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        found.sort();
        found
    };
    let read = |file: PathBuf| serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    inside(tape).iter().flat_map(|folder| inside(folder)).map(read).collect()
}

/// Good answers by the names of their forms.
fn answers(folder: &Path) -> BTreeMap<String, String> {
    let author = format!("record:{}=offline", folder.join("tape").display());
    let (finished, json) = make(folder, "recorded", WAREHOUSE, &["--author", &author]);
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    let text = |exchange: &Value, pointer: &str| exchange.pointer(pointer).unwrap().as_str().unwrap().to_owned();
    let all = exchanges(&folder.join("tape"));
    let of = |exchange: &Value| (text(exchange, "/request/form"), text(exchange, "/answer/text"));
    let mut found: BTreeMap<String, String> = all.iter().map(of).collect();
    let proposal = accounted(&found["proposal"], &WAREHOUSE_ACCOUNT);
    found.insert("proposal".to_owned(), proposal);
    found
}

/// Runs the line that the console printed while somebody says this to every question.
fn run(folder: &Path, console: &Console, line: &str, says: impl FnMut(u64, &str)) -> Finished {
    std::fs::write(folder.join("my.toml"), WAREHOUSE).unwrap();
    let line = console.told[line].as_str().unwrap();
    let words: Vec<&str> = line.strip_prefix("socrates ").unwrap().split(' ').collect();
    let paths = ["--set", "author.paths_by=model", "--out", "answered"];
    answered(folder, console, &[words.as_slice(), paths.as_slice()].concat(), says)
}

/// Runs a command to its end while somebody says this to every question.
fn answered(folder: &Path, console: &Console, words: &[&str], mut says: impl FnMut(u64, &str)) -> Finished {
    let args = [&["--format", "json"], words].concat();
    let mut child = start(PROGRAM, &args, folder, "answered").unwrap();
    let ended = poll(|| {
        for (number, form) in console.waiting().unwrap() {
            says(number, &form);
        }
        child.try_wait().unwrap()
    });
    assert!(ended.is_some(), "the run does not end");
    finish(child, folder, "answered").unwrap()
}

/// Sends an answer whatever its form: what the offline author writes has more members than models are asked for.
fn insist(console: &Console, number: u64, text: &str) -> (u16, Value) {
    console.page(&format!("POST /questions/{number}/answer"), &json!({"text": text, "anyway": true})).unwrap()
}

#[test]
fn a_person_answers_a_run_and_what_they_said_is_a_cassette() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let answers = answers(folder);
    std::fs::remove_dir_all(folder.join("tape")).unwrap();
    let console = Console::start(PROGRAM, folder).unwrap();
    let mut seen: Vec<(String, bool)> = Vec::new();
    let finished = run(folder, &console, "record", |number, form| {
        let (_, one) = console.page(&format!("GET /questions/{number}"), &Value::Null).unwrap();
        let pictures = one["turns"].as_array().unwrap().iter().any(|turn| turn["pictures"][0].is_string());
        assert!(one["schema"].is_string() && one["turns"][0]["role"] == "system", "{one}");
        let (status, told) = insist(&console, number, &answers[form]);
        assert_eq!(status, 200, "{form}: {told}");
        seen.push((form.to_owned(), pictures));
    });
    let json = finished.json();
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    let mut forms: Vec<&str> = seen.iter().map(|(form, _)| form.as_str()).collect();
    forms.sort_unstable();
    assert_eq!(forms, ["paths", "proposal"], "behaviors are compiled");
    assert!(seen.iter().any(|(form, pictures)| form == "paths" && *pictures), "the map comes with its picture");
    let provenance = std::fs::read_to_string(folder.join("answered/details/provenance.json")).unwrap();
    assert!(provenance.contains("\"console:person\""), "who answered is said");
    console.leave().unwrap();
    // Without the console, from what was kept.
    let tape = exchanges(&folder.join("tape"));
    assert_eq!(tape.len(), 2);
    assert!(tape.iter().all(|exchange| exchange["answer"]["model"] == "console:person"), "{tape:?}");
    let (finished, again) =
        make(folder, "again", WAREHOUSE, &["--author", "cassette:tape", "--set", "author.paths_by=model"]);
    assert_eq!(again["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    let artifact = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert_eq!(artifact("answered/details/paths.json"), artifact("bundle-again/details/paths.json"));
}

#[test]
fn a_refusal_ends_the_run_and_a_faulty_answer_is_asked_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let answers = answers(folder);
    let console = Console::start(PROGRAM, folder).unwrap();
    let mut asked: BTreeMap<String, usize> = BTreeMap::new();
    let finished = run(folder, &console, "run", |number, form| {
        let times = asked.entry(form.to_owned()).or_default();
        *times += 1;
        match (form, *times) {
            ("proposal", 1) => {
                let (status, told) = console.answer(number, "{\"analysis\": 3}").unwrap();
                let first = &told["faults"][0]["message"];
                assert_eq!(status, 422, "{told}");
                assert!(first.as_str().unwrap().contains("is missing"), "{told}");
                assert_eq!(insist(&console, number, "{\"analysis\": 3}").0, 200);
            }
            ("proposal", _) => assert_eq!(insist(&console, number, &answers[form]).0, 200),
            _ => {
                let why = json!({"text": "the map has no such place"});
                // A sibling may have ended the run meanwhile.
                drop(console.page(&format!("POST /questions/{number}/refusal"), &why).unwrap());
            }
        }
    });
    assert_ne!(finished.code, 0);
    let told = format!("{}{}", finished.out, finished.err);
    assert!(told.contains("E-REFUSAL") && told.contains("the map has no such place"), "{told}");
    assert_eq!(asked["proposal"], 2, "{asked:?}");
    assert!(asked.values().all(|times| *times <= 2), "a refusal is not asked again: {asked:?}");
}

#[test]
fn a_building_is_made_from_words_and_asked_for_again_where_it_cannot_be_built() {
    let folder = tempfile::tempdir().unwrap();
    let console = Console::start(PROGRAM, folder.path()).unwrap();
    let line = console.told["run"].as_str().unwrap();
    let author: Vec<&str> = line.strip_prefix("socrates run my.toml ").unwrap().split(' ').collect();
    let room = |kind: &str, count: u32| json!({"type": kind, "count": count, "name": null, "area_m2": null, "beside": null, "open": null, "door_m": null});
    let brief = |elevators: u32| {
        json!({
            "kind": "hospital", "form": null, "corridor_m": null, "door_m": null, "elevators": elevators, "only": false,
            "rooms": [room("ward", 2), room("chapel", 1)], "left_out": ["a roof garden"],
        })
    };
    let sentence = "Ein Krankenhaus mit zwei Stationen, einer Kapelle, zwei Aufzügen und einem Dachgarten";
    let words = [&["map", "build", sentence, "--out", "built"], author.as_slice()].concat();
    let mut refused = String::new();
    let finished = answered(folder.path(), &console, &words, |number, form| {
        assert_eq!(form, "building");
        let (_, one) = console.page(&format!("GET /questions/{number}"), &Value::Null).unwrap();
        let turns = one["turns"].as_array().unwrap();
        assert!(turns[1]["text"].as_str().unwrap().contains(sentence), "{one}");
        let again = turns.len() > 2;
        if again {
            refused = turns[3]["text"].as_str().unwrap().to_owned();
        }
        let (status, told) = console.answer(number, &brief(if again { 2 } else { 9 }).to_string()).unwrap();
        assert_eq!(status, 200, "{told}");
    });
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(refused.contains("elevators: asked 9; allowed: at most 4"), "{refused}");
    assert!(finished.err.contains("left out   a roof garden") || finished.out.contains("left out   a roof garden"));
    let location = socrates_maps::load(&folder.path().join("built")).unwrap();
    assert!(location.named("chapel").is_some() && location.named("ward 2").is_some(), "{:?}", location.names);
    assert_eq!(location.doors.iter().filter(|door| door.id.starts_with("elevator")).count(), 2);
}

#[test]
fn a_port_that_is_taken_is_told_with_what_helps() {
    let folder = tempfile::tempdir().unwrap();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let finished = socrates(folder.path(), "taken", &["author", "console", "--port", &port]);
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert!(finished.err.contains(&port) && finished.err.contains("hint:"), "{}", finished.err);
}
