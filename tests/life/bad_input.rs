//! Wrong input is answered with what, where, which value and a hint, before anything runs.

use std::path::Path;

use crate::{WAREHOUSE, socrates};

/// What becomes of a file of a location: other bytes, or nothing.
type Change<'a> = dyn Fn(&str, Vec<u8>) -> Option<Vec<u8>> + 'a;

fn refused(folder: &Path, name: &str, request: &str, words: &[&str]) {
    let file = folder.join(format!("{name}.toml"));
    std::fs::write(&file, request).unwrap();
    let finished = socrates(folder, name, &["run", &file.display().to_string(), "--out", "never"]);
    assert_eq!(finished.code, 2, "{name}: {}\n{}", finished.err, finished.out);
    for word in words.iter().chain(&["hint:"]) {
        assert!(finished.err.contains(word), "{name}: `{word}` is missing in\n{}", finished.err);
    }
    assert!(!finished.err.contains("panicked"), "{}", finished.err);
    assert!(!folder.join("never/report.html").exists());
}

#[test]
fn wrong_requests_are_refused_with_the_value_and_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let with = |rough: &str| {
        format!(
            "location = \"office\"\nsocial_context = \"An office\"\ntask = \"Deliver mail\"\nrough_scenario = {rough:?}\n"
        )
    };
    let long = "people ".repeat(150_000);
    for (name, request, words) in [
        ("none", with("None"), vec!["rough_scenario", "None", "leave the key out"]),
        ("control", with("two people").replace("two ", "two\\u0007 "), vec!["rough_scenario", "U+0007"]),
        ("crowd", with("There are 10000 humans in the corridor."), vec!["10000"]),
        ("nobody", with("There are 0 humans in the corridor."), vec!["0"]),
        (
            "german",
            with("Zwei Menschen stehen im Flur und warten auf den Roboter, dann gehen sie weg."),
            vec!["P-LANG"],
        ),
        ("long", with(&long), vec!["bytes"]),
        ("key", format!("{WAREHOUSE}\ncolor = \"red\"\n"), vec!["color"]),
        ("place", WAREHOUSE.replace("\"warehouse\"", "\"atlantis\""), vec!["atlantis", "warehouse"]),
        (
            "planner",
            format!("{WAREHOUSE}\n[robot]\nplanners = [\"telepathy\"]\n"),
            vec!["J-PLANNER", "telepathy", "reactive"],
        ),
        ("seeds", format!("{WAREHOUSE}\n[run]\nseeds = \"9..1\"\n"), vec!["run.seeds", "9..1"]),
        ("task", WAREHOUSE.replace("Carry a box from the loading dock to the packing area", " "), vec!["task"]),
    ] {
        refused(folder.path(), name, &request, &words);
    }
}

#[test]
fn everything_wrong_with_a_request_is_told_at_once_with_line_and_column_before_an_author_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let line = WAREHOUSE.lines().count();
    // The author would have to be asked over the network, where nobody listens: an ask would end with another code.
    let request = format!(
        "{}\n[robot]\nmodel = \"hal\"\nplanners = [\"telepathy\"]\ngestures = [{{ when = \"whenever\", say = \"WAIT\" }}]\n\
         [run]\nseeds = \"9..1\"\nduration = \"long\"\nauthor = \"ollama:none\"\n",
        WAREHOUSE.trim_end()
    );
    let line = |below: usize| line + below;
    let (model, planner, when) = (
        format!("much.toml:{}:9 ", line(2)),
        format!("much.toml:{}:13 ", line(3)),
        format!("much.toml:{}:22 ", line(4)),
    );
    let (seeds, duration) = (format!("much.toml:{}:9 ", line(6)), format!("much.toml:{}:12 ", line(7)));
    let words = [
        "has 5 problems",
        &model,
        "`hal` is not a robot model; allowed: linorobot2, turtlebot3_burger",
        &planner,
        "J-PLANNER",
        "telepathy",
        "reactive",
        &when,
        "`whenever` is not a moment; allowed: `start`, `blocked 3 s`",
        &seeds,
        &duration,
    ];
    refused(folder.path(), "much", &request, &words);
}

#[test]
fn wrong_locations_are_refused_with_file_and_value() {
    let folder = tempfile::tempdir().unwrap();
    let files = socrates_maps::shipped::files("office").unwrap();
    let broken = |name: &str, change: &Change<'_>| {
        let dir = folder.path().join(name);
        std::fs::create_dir_all(&dir).unwrap();
        for (file, bytes) in &files {
            if let Some(bytes) = change(file, bytes.clone()) {
                std::fs::write(dir.join(file), bytes).unwrap();
            }
        }
        WAREHOUSE.replace("\"warehouse\"", &format!("{name:?}"))
    };
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let no_image = broken("no-image", &|file, bytes| (!file.ends_with(".png")).then_some(bytes));
    refused(folder.path(), "no-image-request", &no_image, &["M-IMAGE"]);
    let cut = broken("cut", &|file, bytes| {
        Some(if file.ends_with(".png") { bytes[..bytes.len() / 3].to_vec() } else { bytes })
    });
    refused(folder.path(), "cut-request", &cut, &["M-IMAGE"]);
    let key = broken("key", &|file, bytes| {
        Some(if file == "map.yaml" { format!("{}color: red\n", text(bytes)).into_bytes() } else { bytes })
    });
    refused(folder.path(), "key-request", &key, &["M-KEY", "color"]);
    let dangling = broken("dangling", &|file, bytes| {
        Some(if file == "scene_graph.json" {
            let mut graph: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            let list = if graph.get("links").is_some() { "links" } else { "edges" };
            graph[list][0]["target"] = serde_json::json!("nowhere");
            graph.to_string().into_bytes()
        } else {
            bytes
        })
    });
    refused(folder.path(), "dangling-request", &dangling, &["M-ID", "nowhere"]);
}

#[test]
fn a_folder_that_cannot_be_written_and_a_taken_port_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("good.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let file = file.display().to_string();
    // A file where a folder should be cannot be written into, even by root.
    std::fs::write(folder.path().join("taken"), "x").unwrap();
    let finished = socrates(folder.path(), "folder", &["run", &file, "--out", "taken/inside"]);
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert!(finished.err.contains("taken/inside") && finished.err.contains("hint:"), "{}", finished.err);
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let set = format!("supervisor.port={port}");
    let finished = socrates(folder.path(), "port", &["run", &file, "--out", "fine", "--set", &set]);
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert!(finished.err.contains(&port.to_string()) && finished.err.contains("hint:"), "{}", finished.err);
}

#[test]
fn usage_errors_end_with_two_and_every_code_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(socrates(folder.path(), "verb", &["dance"]).code, 2);
    assert_eq!(socrates(folder.path(), "absent", &["run", "absent.toml"]).code, 2);
    let explained = socrates(folder.path(), "explain", &["explain", "g-disc"]);
    assert_eq!(explained.code, 0);
    assert!(explained.out.starts_with("# G-DISC"));
    assert_eq!(socrates(folder.path(), "unknown", &["explain", "G-NOPE"]).code, 2);
}
