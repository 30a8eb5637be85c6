//! Second opinions: what a model behind a server sees in runs, what of it counts, and what it is worth beside labels by people.

use std::collections::BTreeSet;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;

use serde_json::{Value, json};

use crate::{WAREHOUSE, make, socrates};

/// What happens in the run of a social context, and in no run of the other one.
const HAPPENS: [(&str, &str); 2] =
    [("A busy warehouse", "follows the robot."), ("A quiet warehouse", "runs away when they see the robot.")];

/// A judge behind a server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Eye {
    /// Finds what happens.
    Sees,
    /// Finds everything.
    SaysYes,
    /// Answers in words.
    Chats,
    /// Takes no pictures.
    Blind,
}

fn question(socket: &mut TcpStream) -> Option<(String, String)> {
    let (mut head, mut byte) = (Vec::new(), [0]);
    while !head.ends_with(b"\r\n\r\n") && socket.read_exact(&mut byte).is_ok() {
        head.extend(byte);
    }
    let head = String::from_utf8_lossy(&head).to_lowercase();
    let length = head.lines().find_map(|line| line.strip_prefix("content-length: ")?.trim().parse().ok());
    let mut body = vec![0; length.unwrap_or(0)];
    socket.read_exact(&mut body).ok()?;
    Some((head, String::from_utf8(body).ok()?))
}

/// What is asked of the model in words.
fn asked(body: &str) -> String {
    let body: Value = serde_json::from_str(body).unwrap();
    let parts = body["messages"][1]["content"].as_array().unwrap();
    parts.iter().filter_map(|part| part["text"].as_str()).collect()
}

fn answer(eye: Eye, body: &str) -> (u16, String) {
    if eye == Eye::Blind {
        return (400, json!({"error": {"message": "image input is not supported by this model"}}).to_string());
    }
    let text = asked(body);
    let (_, happens) = HAPPENS.iter().find(|(setting, _)| text.contains(setting)).unwrap();
    let statements = text.lines().filter_map(|line| {
        let (number, words) = line.split_once(". \"")?;
        Some((number.parse::<u32>().ok()?, words.trim_end_matches('"').to_owned()))
    });
    let answers: Vec<Value> = statements
        .map(|(number, words)| {
            let shown = eye == Eye::SaysYes
                || ["One person walks", "Carry a box"].iter().any(|begins| words.starts_with(begins))
                || words.ends_with(happens);
            json!({"statement": number, "answer": if shown { "shown" } else { "not_shown" }, "pictures": [1, 2]})
        })
        .collect();
    let said = if eye == Eye::Chats { "Hard to say!".to_owned() } else { json!({"answers": answers}).to_string() };
    let message = json!({"role": "assistant", "content": said});
    let usage = json!({"prompt_tokens": 1000, "completion_tokens": 50});
    let choices = json!([{"index": 0, "message": message, "finish_reason": "stop"}]);
    (200, json!({"model": "eye", "choices": choices, "usage": usage}).to_string())
}

/// A server on loopback; it ends with the test's process.
fn server(eye: Eye) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    std::thread::spawn(move || {
        for mut socket in listener.incoming().filter_map(Result::ok) {
            let Some((head, body)) = question(&mut socket) else { continue };
            let (status, body) = if head.starts_with("post") { answer(eye, &body) } else { (404, String::new()) };
            let kind = "content-type: application/json\r\nconnection: close\r\n";
            let head = format!("HTTP/1.1 {status} X\r\n{kind}content-length: {}\r\n\r\n", body.len());
            drop(socket.write_all(head.as_bytes()));
            drop(socket.write_all(body.as_bytes()));
        }
    });
    format!("author.vllm.url=http://127.0.0.1:{port}/v1")
}

fn library(folder: &Path) {
    let quiet = WAREHOUSE.replace("busy", "quiet").replace("follows the robot", "runs away when they see the robot");
    for (name, request) in [("busy", WAREHOUSE), ("quiet", &quiet)] {
        let (made, _) = make(folder, name, request, &["--require", "any", "--seed", "3"]);
        assert_eq!(made.code, 0, "{}", made.err);
    }
}

fn opinion(folder: &Path, more: &[&str]) -> socrates_tests::program::Finished {
    let args =
        [&["--format", "json", "labels", "opinion", "bundle-busy", "bundle-quiet", "--stills", "8"], more].concat();
    socrates(folder, "opinion", &args)
}

fn text(folder: &Path, path: &str) -> String {
    std::fs::read_to_string(folder.join(path)).unwrap()
}

#[test]
fn a_model_that_looks_is_heard_booked_and_replayed_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    library(at);
    let verdicts = || text(at, "bundle-busy/details/manifest.json");
    let before = verdicts();
    let url = server(Eye::Sees);
    let first = opinion(at, &["--model", "record:tape=vllm:eye", "--set", &url, "--out", "first"]);
    assert_eq!(first.code, 0, "{}", first.err);
    let said = first.json();
    assert_eq!((&said["runs"], &said["judged"], &said["questions"]), (&json!(2), &json!(2), &json!(10)), "{said}");
    assert_eq!((&said["planted"], &said["facts"]["shown"]), (&json!({"count": 0, "of": 2}), &json!(6)), "{said}");
    assert_eq!(verdicts(), before, "no verdict knows of it");
    let table = text(at, "first/second_opinion.csv");
    assert_eq!(table.lines().count(), 1 + 2 * 4, "three sentences and a planted one of each run: {table}");
    assert!(table.contains(",One person follows the robot.,,yes,,not_shown,5,5,"), "{table}");
    assert!(std::fs::read(at.join("first/sheets/r01.png")).unwrap().starts_with(&[0x89, b'P', b'N', b'G']));

    // What was recorded gives the same files without a server.
    let second = opinion(at, &["--model", "cassette:tape", "--out", "second"]);
    assert_eq!(second.code, 0, "{}", second.err);
    for file in ["second_opinion.csv", "answers.csv", "sheets/r01.png", "sheets/r02.png"] {
        let bytes = |out: &str| std::fs::read(at.join(out).join(file)).unwrap();
        assert_eq!(bytes("first"), bytes("second"), "{file}");
    }
    // Every repeat has an order of its own.
    let places = |number: usize| -> BTreeSet<String> {
        let answers = text(at, "first/answers.csv");
        let own = answers.lines().filter(|line| line.split(',').nth(2) == Some(&number.to_string())).map(str::to_owned);
        own.map(|line| line.split(',').enumerate().filter(|(at, _)| *at != 2).map(|(_, cell)| cell).collect()).collect()
    };
    assert!((2..=5).any(|number| places(number) != places(1)));

    std::fs::write(at.join("prices.toml"), "[\"vllm:eye\"]\ninput = 2.0\noutput = 10.0\n").unwrap();
    let cost = socrates(at, "cost", &["--format", "json", "cost", "first", "bundle-busy", "--prices", "prices.toml"]);
    assert_eq!(cost.code, 0, "{}", cost.err);
    let total = cost.json()["total"].as_array().unwrap().clone();
    let eye = total.iter().find(|row| row["author"] == "vllm:eye").unwrap();
    assert_eq!(
        (&eye["calls"], &eye["tokens_in"], &eye["tokens_out"]),
        (&json!(10), &json!(10_000), &json!(500)),
        "{eye}"
    );
    assert!((eye["cost"].as_f64().unwrap() - 0.025).abs() < 1e-9, "{eye}");

    // Without labels there is no share.
    let page =
        socrates(at, "page", &["labels", "page", "bundle-busy", "bundle-quiet", "--films", "--out", "judged/l.html"]);
    assert_eq!(page.code, 0, "{}", page.err);
    std::fs::write(at.join("a.csv"), "run,rater,as_asked,sentence\nr01,ann,as_asked,\nr02,ann,as_asked,\n").unwrap();
    let args = ["labels", "calibrate", "a.csv", "--key", "judged/key.csv", "--opinion", "first/second_opinion.csv"];
    let refused = socrates(at, "calibrate", &args);
    assert_eq!(refused.code, 2, "{}", refused.out);
    assert!(refused.err.contains("too few labels by people: 6 facts shown and 0 not shown"), "{}", refused.err);
    assert!(!refused.out.contains("share"), "{}", refused.out);
}

#[test]
fn judges_who_agree_to_all_or_answer_nothing_do_not_count() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    library(at);
    let said = |eye: Eye| {
        let made = opinion(at, &["--model", "vllm:eye", "--set", &server(eye), "--repeats", "1", "--out", "out"]);
        (made.code, made.err.clone(), made.json())
    };
    let (code, err, yes) = said(Eye::SaysYes);
    assert_eq!((code, &yes["judged"], &yes["planted"]["count"]), (0, &json!(0), &json!(2)), "{err} {yes}");
    assert!(yes["not_judged"][0]["why"].as_str().unwrap().contains("planted fact"), "{yes}");
    assert!(!text(at, "out/second_opinion.csv").contains(",yes,no\n"), "no run counts");
    let (code, err, chat) = said(Eye::Chats);
    assert_eq!((code, &chat["judged"]), (0, &json!(0)), "{err} {chat}");
    assert_eq!(chat["not_judged"][1]["why"], "no answer could be read", "{chat}");
    let table = text(at, "out/second_opinion.csv");
    assert!(table.matches(",no_answer,0,1,").count() == 8 && !table.contains(",not_shown,"), "{table}");
    // Three answers each, and all of them are paid for.
    let cost = socrates(at, "cost", &["--format", "json", "cost", "out"]).json();
    assert_eq!(cost["total"][0]["calls"], json!(6), "{cost}");
    let (code, err, _) = said(Eye::Blind);
    assert_eq!(code, 2);
    assert!(err.contains("the model `vllm:eye` takes no picture"), "{err}");
}

#[test]
fn what_cannot_be_a_second_opinion_is_refused_before_anybody_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    library(at);
    let refused = |more: &[&str], words: &str| {
        let finished = opinion(at, more);
        assert_eq!(finished.code, 2, "{}", finished.err);
        assert!(finished.err.contains(words), "{words}: {}", finished.err);
    };
    refused(&[], "it is off unless a model is named");
    refused(&["--model", "offline"], "`offline` sees no pictures");
    let few = socrates(at, "few", &["labels", "opinion", "bundle-busy", "--model", "vllm:eye", "--stills", "4"]);
    assert!(few.code == 2 && few.err.contains("`--stills` is `4`"), "{}", few.err);
    refused(&["--model", "vllm:eye", "--repeats", "0"], "`--repeats` is `0`");
    // A run that a model of the same family wrote.
    let path = at.join("bundle-quiet/details/provenance.json");
    let written = text(at, "bundle-quiet/details/provenance.json").replace("\"offline/1\"", "\"openai:gpt-4o\"");
    std::fs::write(path, written).unwrap();
    let url = server(Eye::Sees);
    refused(&["--model", "vllm:org/gpt-oss-20b", "--set", &url], "was written by `openai:gpt-4o`, of the family gpt");
    let other = opinion(at, &["--model", "vllm:eye", "--set", &url, "--repeats", "1"]);
    assert_eq!(other.code, 0, "{}", other.err);
}
