//! Several requests at once, how they stand while they are made and afterwards, and what the terminal and a log file show of it.

use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::path::Path;

use socrates_tests::program::{finish, poll, signal, start};

use crate::{PROGRAM, WAREHOUSE, socrates};

fn write(path: &Path, text: &str) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn bad_requests_of_a_folder_are_named_and_the_others_are_made() {
    let folder = tempfile::tempdir().unwrap();
    let requests = folder.path().join("all of them");
    write(&requests.join("good.toml"), WAREHOUSE);
    write(&requests.join("moon.toml"), &WAREHOUSE.replace("\"warehouse\"", "\"moon\""));
    write(&requests.join("typo.toml"), &format!("{WAREHOUSE}\ncolor = \"red\"\n"));
    let args = ["--format", "json", "run", "all of them", "--out", "library", "--require", "any"];
    let finished = socrates(folder.path(), "mixed", &args);
    assert_eq!(finished.code, 2, "{}\n{}", finished.err, finished.out);
    for word in ["moon.toml", "there is no location `moon`", "typo.toml", "color", "2 of 3 requests cannot be run"] {
        assert!(finished.err.contains(word), "`{word}` is missing in\n{}", finished.err);
    }
    let told = finished.json();
    let refused: Vec<&str> =
        told["refused"].as_array().unwrap().iter().map(|bad| bad["request"].as_str().unwrap()).collect();
    assert_eq!(refused, ["all of them/moon.toml", "all of them/typo.toml"]);
    assert_eq!(told["scenarios"].as_array().unwrap().len(), 1, "{told}");
    assert!(folder.path().join("library/good-1/report.html").is_file());
    // Where none can be run, nothing is begun.
    std::fs::remove_file(requests.join("good.toml")).unwrap();
    let finished = socrates(folder.path(), "none", &["run", "all of them", "--out", "never"]);
    assert_eq!(finished.code, 2);
    assert!(finished.err.contains("moon.toml") && finished.err.contains("typo.toml"), "{}", finished.err);
    assert!(!folder.path().join("never").exists());
}

#[test]
fn requests_of_one_name_in_two_folders_are_two_scenarios() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("a/x.toml"), WAREHOUSE);
    write(&folder.path().join("b/x.toml"), &WAREHOUSE.replace("busy", "quiet"));
    let args = ["--format", "json", "run", "a/x.toml", "b/x.toml", "--out", "library", "--require", "any"];
    let finished = socrates(folder.path(), "two", &args);
    assert_eq!(finished.code, 0, "{}", finished.err);
    for name in ["x-1", "x-2-1"] {
        let manifest = json(&folder.path().join("library").join(name).join("details/manifest.json"));
        assert_eq!(manifest["scenario"], name);
    }
}

#[test]
fn a_folder_and_its_scenario_have_one_name_and_labels_take_any_names() {
    let folder = tempfile::tempdir().unwrap();
    let request = |text: &str| write(&folder.path().join("x.toml"), text);
    request(WAREHOUSE);
    assert_eq!(socrates(folder.path(), "one", &["run", "x.toml", "--require", "any"]).code, 0);
    request(&WAREHOUSE.replace("busy", "quiet"));
    assert_eq!(socrates(folder.path(), "two", &["run", "x.toml", "--require", "any"]).code, 0);
    let runs = folder.path().join("runs");
    assert_eq!(json(&runs.join("x-1-2/details/manifest.json"))["scenario"], "x-1-2");
    assert_eq!(json(&runs.join("x-1-2/details/reports/reference-1.json"))["run"], "x-1-2.reference-1");
    let labels = socrates(folder.path(), "labels", &["--format", "json", "labels", "page", "runs"]);
    assert_eq!(labels.json()["runs"], serde_json::json!(["x-1.reference-1", "x-1-2.reference-1"]), "{}", labels.err);
    // The same name in two libraries: the page tells the runs apart, and the comparison knows them by the same names.
    std::fs::create_dir_all(folder.path().join("other")).unwrap();
    std::fs::rename(runs.join("x-1-2"), folder.path().join("other/x-1-2")).unwrap();
    request(&WAREHOUSE.replace("busy", "loud"));
    assert_eq!(socrates(folder.path(), "three", &["run", "x.toml", "--require", "any"]).code, 0);
    let labels = socrates(folder.path(), "both", &["--format", "json", "labels", "page", "runs", "other"]);
    let named = ["x-1.reference-1", "runs/x-1-2:x-1-2.reference-1", "other/x-1-2:x-1-2.reference-1"];
    assert_eq!(labels.json()["runs"], serde_json::json!(named), "{}", labels.err);
    let rows: String = named.iter().map(|run| format!("{run},ada,yes,yes,yes\n")).collect();
    write(&folder.path().join("labels.csv"), &format!("run,rater,simulable,appropriate,as_asked\n{rows}"));
    let args = ["--format", "json", "dev", "agreement", "labels.csv", "runs", "other"];
    let compared = socrates(folder.path(), "agreement", &args);
    assert_eq!(compared.code, 0, "{}", compared.err);
    assert_eq!(compared.json()["rows"][0]["runs"], 3, "{}", compared.out);
}

#[test]
fn a_killed_batch_says_where_it_stopped_and_a_finished_one_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("x.toml"), WAREHOUSE);
    let args = ["run", "x.toml", "--variants", "6", "--repeats", "--pace", "30", "--require", "any", "--out", "lib"];
    let status = |name: &str, more: &[&str]| {
        let args: Vec<&str> = ["--format", "json", "status", "lib"].iter().chain(more).copied().collect();
        let finished = socrates(folder.path(), name, &args);
        assert_eq!(finished.code, 0, "{}", finished.err);
        (finished.json(), finished.err)
    };
    let run = start(PROGRAM, &args, folder.path(), "first").unwrap();
    let going = poll(|| {
        let asked = folder.path().join("lib/.socrates/jobs.sqlite").exists().then(|| status("going", &[]).0)?;
        (asked["phase"] == "going_on" && asked["done"].as_u64()? > 0).then_some(asked)
    })
    .unwrap();
    assert_eq!(going["total"], 6, "{going}");
    assert!(going["rate_per_s"].as_f64().unwrap() > 0.0 && going["left_s"].is_number(), "{going}");
    assert!(signal(run.id(), "KILL").unwrap());
    finish(run, folder.path(), "first").unwrap();
    let (stopped, lines) = status("stopped", &[]);
    assert_eq!((&stopped["phase"], &stopped["total"]), (&"stopped".into(), &6.into()), "{stopped}");
    assert!(stopped["done"].as_u64().unwrap() >= going["done"].as_u64().unwrap(), "{stopped}");
    assert!(lines.contains(" of 6; the same command resumes") && lines.lines().count() == 8, "{lines}");
    assert!(socrates(folder.path(), "second", &args).code == 0);
    let (whole, lines) = status("whole", &["--all"]);
    assert_eq!((&whole["phase"], &whole["done"], &whole["failed"]), (&"finished".into(), &6.into(), &0.into()));
    assert_eq!(whole["scenarios"].as_array().unwrap().len(), 6);
    assert_eq!(lines.lines().count(), 14, "{lines}");
    // One of its bundles, and the folder above.
    for what in ["lib/x-1-00001", "."] {
        let told = socrates(folder.path(), "below", &["--format", "json", "status", what]).json();
        assert_eq!(told["phase"], "finished", "{what}: {told}");
    }
}

#[test]
fn what_failed_says_why_and_makes_room_for_the_next_wish() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("x.toml"), WAREHOUSE);
    let failed = socrates(folder.path(), "failed", &["run", "x.toml", "--inject", "gdisc=1"]);
    assert_eq!(failed.code, 3, "{}", failed.err);
    let args = ["--format", "json", "status", "runs/x-1", "--failed"];
    let told = socrates(folder.path(), "status", &args).json();
    assert_eq!((&told["phase"], &told["failed"]), (&"finished".into(), &1.into()), "{told}");
    assert!(told["scenarios"][0]["told"].as_str().unwrap().contains("G-DISC"), "{told}");
    assert_eq!(socrates(folder.path(), "next", &["run", "x.toml", "--require", "any"]).code, 0);
    assert!(folder.path().join("runs/x-1/report.html").is_file() && !folder.path().join("runs/x-1-2").exists());
}

/// A server that has two models and answers no other question.
fn two_models() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}/v1", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        for mut socket in listener.incoming().filter_map(Result::ok).take(2) {
            let mut seen = [0_u8; 2048];
            let read = socket.read(&mut seen).unwrap_or(0);
            assert!(String::from_utf8_lossy(&seen[..read]).starts_with("GET /v1/models "));
            let body = r#"{"data":[{"id":"small"},{"id":"large"}]}"#;
            let head = "HTTP/1.1 200 OK\r\ncontent-type: application/json\r\nconnection: close\r\n";
            drop(write!(socket, "{head}content-length: {}\r\n\r\n{body}", body.len()));
        }
    });
    url
}

#[test]
fn an_author_who_cannot_be_asked_is_found_before_a_folder_is_made() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("key.toml"), WAREHOUSE);
    write(&folder.path().join("other.toml"), WAREHOUSE);
    let url = format!("author.vllm.url={}", two_models());
    for (author, code, words) in [
        ("openai:gpt-4o", 5, vec!["needs a key", "T-AUTH"]),
        ("vllm:smal", 5, vec!["has no model `smal`", "small, large"]),
        ("cassette:no-such-tape", 2, vec!["no-such-tape"]),
    ] {
        let more = ["--author", author, "--set", "author.key_variable=", "--set", &url];
        let args: Vec<&str> = ["run", "key.toml"].iter().chain(&more).copied().collect();
        let finished = socrates(folder.path(), "author", &args);
        assert_eq!(finished.code, code, "{author}: {}", finished.err);
        for word in words.iter().chain(&["nothing was made", "hint:"]) {
            assert!(finished.err.contains(word), "{author}: `{word}` is missing in\n{}", finished.err);
        }
        assert!(!folder.path().join("runs").exists(), "{author} left a folder");
    }
    let nobody = socrates(folder.path(), "nobody", &["run", "key.toml", "--author", "gpt"]);
    assert_eq!(nobody.code, 2, "{}", nobody.err);
    assert!(nobody.err.contains("`gpt` is not a name of an author; allowed: auto, offline"), "{}", nobody.err);
    assert!(!folder.path().join("runs").exists(), "an author who is nobody left a folder");
    let more = ["run", "key.toml", "other.toml", "--author", "vllm:smal", "--set", &url];
    assert_eq!(socrates(folder.path(), "batch", &more).code, 5);
    assert!(!folder.path().join("runs").exists());
}

#[test]
fn a_log_file_gets_lines_of_progress_and_no_codes_of_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("x.toml"), WAREHOUSE);
    let args = [
        "run",
        "x.toml",
        "--variants",
        "2",
        "--repeats",
        "--pace",
        "12",
        "--require",
        "any",
        "--set",
        "log.progress_s=1",
    ];
    let args: Vec<&str> = args.iter().chain(&["--set", "log.filter=info"]).copied().collect();
    let finished = socrates(folder.path(), "log", &args);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let lines: Vec<&str> = finished.err.lines().filter(|line| line.starts_with("making     ")).collect();
    assert!(!lines.is_empty() && lines.iter().all(|line| line.contains(" of 2")), "{}", finished.err);
    assert!(finished.err.contains(" INFO "), "the log was read");
    for text in [&finished.err, &finished.out] {
        assert!(!text.contains('\u{1b}') && !text.contains('\r'), "{text:?}");
    }
}

#[test]
fn a_run_that_missed_is_marked_with_its_times_and_what_comes_next_is_a_command() {
    let folder = tempfile::tempdir().unwrap();
    // Nobody can be met in four seconds.
    write(&folder.path().join("mein Büro/short.toml"), &format!("{WAREHOUSE}\n[run]\nduration = \"4s\"\n"));
    let finished = socrates(folder.path(), "short", &["run", "mein Büro/short.toml", "--out", "out put"]);
    assert_eq!(finished.code, 3, "{}\n{}", finished.err, finished.out);
    let line = finished.out.lines().find(|line| line.starts_with("proposal ")).unwrap();
    assert!(line.contains("scoring ✘ "), "{line}");
    assert!(!line.contains(" 0 ms (") && !line.contains("in 0 ms"), "{line}");
    let next = finished.out.lines().find_map(|line| line.strip_prefix("next       ")).unwrap();
    assert!(next.starts_with("socrates run 'mein Büro/short.toml' --"), "{next}");
    let vague = WAREHOUSE.replace("follows the robot.\"", "follows the robot. He juggles three lemons.\"");
    write(&folder.path().join("vague.toml"), &vague);
    let finished = socrates(folder.path(), "vague", &["run", "vague.toml", "--require", "any"]);
    let next = finished.out.lines().find_map(|line| line.strip_prefix("next       ")).unwrap();
    assert!(next.starts_with("socrates run vague.toml --ask "), "{next}\n{}", finished.out);
}
