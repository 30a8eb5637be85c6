//! The editor asked by bytes, as its page does, over folders on the disk.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use serde_json::{Value, json};
use socrates_gateway::guard::Rules;
use socrates_gateway::server;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};

use super::board::{Board, Checker};
use super::door::{Shared, routes};
use super::journal::{JOURNAL, Journal};
use super::site::{Site, WORK};

const TOKEN: &str = "0123456789abcdef0123456789abcdef";

/// A folder with these files of the shipped office.
fn office(folder: &Path, files: &[&str]) -> PathBuf {
    let at = folder.join("mine");
    std::fs::create_dir_all(&at).unwrap();
    let shipped = socrates_maps::shipped::files("office").unwrap();
    files.iter().for_each(|name| std::fs::write(at.join(name), &shipped[*name]).unwrap());
    at
}

const WHOLE: [&str; 4] = ["map.yaml", "map.png", "scene_graph.json", "location.toml"];

/// An editor of a location; where it listens.
async fn open(given: &str, out: Option<&Path>, read_only: bool) -> SocketAddr {
    let (board, map) = Board::lay(Site::of(given, out).unwrap(), read_only).unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let at = listener.local_addr().unwrap();
    let rules = Arc::new(Rules { token: Some(TOKEN.to_owned()), ..Rules::default() });
    let shared = Arc::new(Shared { board: Mutex::new(board), checker: Checker::new(&map), map });
    drop(tokio::spawn(async move { server::serve(listener, routes(shared, Arc::clone(&rules)), rules, None).await }));
    at
}

async fn asked(at: SocketAddr, line: &str, head: &str, body: &str) -> (u16, String, Vec<u8>) {
    let mut stream = TcpStream::connect(at).await.unwrap();
    let length = body.len();
    let text =
        format!("{line} HTTP/1.1\r\nhost: {at}\r\nconnection: close\r\ncontent-length: {length}\r\n{head}\r\n{body}");
    stream.write_all(text.as_bytes()).await.unwrap();
    let mut answer = Vec::new();
    drop(stream.read_to_end(&mut answer).await);
    let split = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap_or(answer.len());
    let head = String::from_utf8_lossy(&answer[..split]).into_owned();
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    (status, head, answer.get(split + 4..).unwrap_or_default().to_vec())
}

/// What the page asks.
async fn page(at: SocketAddr, line: &str, body: Value) -> (u16, Value) {
    let head = format!("authorization: Bearer {TOKEN}\r\norigin: http://{at}\r\n");
    let body = if body.is_null() { String::new() } else { body.to_string() };
    let (status, _, body) = asked(at, line, &head, &body).await;
    (status, serde_json::from_slice(&body).unwrap_or_else(|why| panic!("{line}: {why}")))
}

async fn rev(at: SocketAddr) -> Value {
    page(at, "GET /state", Value::Null).await.1["rev"].clone()
}

async fn draws(at: SocketAddr, edit: Value) -> (u16, Value) {
    let body = json!({"rev": rev(at).await, "edit": edit});
    page(at, "POST /edit", body).await
}

#[tokio::test]
async fn what_is_drawn_is_checked_undone_saved_and_the_same_file_again() {
    let folder = tempfile::tempdir().unwrap();
    let mine = office(folder.path(), &WHOLE);
    let at = open(&mine.display().to_string(), None, false).await;
    let before = std::fs::read(mine.join("scene_graph.json")).unwrap();
    let (_, found) = page(at, "GET /findings", Value::Null).await;
    assert_eq!(found["findings"], json!([]));
    let (status, state) = draws(at, json!({"move_nodes": {"nodes": [["h0", [1, 1]]]}})).await;
    assert_eq!(
        (status, &state["dirty"], &state["undo"], &state["said"]),
        (200, &json!(true), &json!(1), &json!("moved node h0"))
    );
    let (_, found) = page(at, "GET /findings", Value::Null).await;
    assert_eq!(
        (&found["findings"][0]["subject"], &found["findings"][0]["at"]),
        (&json!({"node": "h0"}), &json!([1.0, 1.0]))
    );
    // An edit of a sketch that is another one by now is not done, and the page is told how it stands.
    let (status, stale) = page(at, "POST /edit", json!({"rev": 0, "edit": {"describe": {"text": "x"}}})).await;
    assert_eq!((status, &stale["error"]["code"], &stale["state"]["undo"]), (409, &json!("stale"), &json!(1)));
    let (status, wrong) = draws(at, json!({"rename_node": {"id": "h0", "to": "h1"}})).await;
    assert!(status == 422 && wrong["error"]["message"].as_str().unwrap().contains("called `h1` already"), "{wrong}");
    let (status, wrong) = draws(at, json!({"rename_node": {"id": "h0", "to": "h 1"}})).await;
    assert!(status == 400, "{wrong}");
    let (_, state) = page(at, "POST /undo", json!({"rev": rev(at).await})).await;
    assert_eq!(
        (&state["dirty"], &state["redo"], &state["said"]),
        (&json!(false), &json!(1), &json!("took back: moved node h0"))
    );
    assert_eq!(page(at, "POST /undo", json!({"rev": rev(at).await})).await.0, 422);
    let (_, saved) = page(at, "POST /save", json!({"rev": rev(at).await})).await;
    assert!(saved["said"].as_str().unwrap().contains("scene_graph.json, location.toml in "), "{saved}");
    assert_eq!(std::fs::read(mine.join("scene_graph.json")).unwrap(), before);
    let (_, state) = page(at, "POST /redo", json!({"rev": rev(at).await})).await;
    assert_eq!(state["sketch"]["nodes"][0]["at"], json!([1.0, 1.0]));
}

#[tokio::test]
async fn a_file_that_another_program_changed_is_not_overwritten_unless_that_is_wished() {
    let folder = tempfile::tempdir().unwrap();
    let mine = office(folder.path(), &WHOLE);
    let at = open(&mine.display().to_string(), None, false).await;
    draws(at, json!({"describe": {"text": "Mine."}})).await;
    let theirs = std::fs::read_to_string(mine.join("location.toml")).unwrap().replace("One floor", "Their floor");
    std::fs::write(mine.join("location.toml"), &theirs).unwrap();
    let (status, told) = page(at, "POST /save", json!({"rev": rev(at).await})).await;
    assert_eq!(
        (status, &told["error"]["code"], &told["error"]["files"]),
        (409, &json!("changed"), &json!(["location.toml"]))
    );
    assert_eq!(std::fs::read_to_string(mine.join("location.toml")).unwrap(), theirs);
    // Theirs is taken as an edit: undoing it brings mine back.
    let (_, state) = page(at, "POST /theirs", json!({"rev": rev(at).await})).await;
    assert!(state["sketch"]["description"].as_str().unwrap().starts_with("Their floor"), "{state}");
    assert_eq!(state["dirty"], json!(false));
    page(at, "POST /undo", json!({"rev": rev(at).await})).await;
    std::fs::write(mine.join("location.toml"), theirs.replace("Their floor", "Another floor")).unwrap();
    let (status, saved) = page(at, "POST /save", json!({"rev": rev(at).await, "overwrite": true})).await;
    assert_eq!(status, 200, "{saved}");
    let written = std::fs::read_to_string(mine.join("location.toml")).unwrap();
    assert!(written.starts_with("description = \"Mine.\""), "{written}");
    let kept = saved["said"].as_str().unwrap().split("kept as ").nth(1).unwrap();
    assert!(std::fs::read_to_string(kept).unwrap().contains("Another floor"));
    // Another map is nothing to choose about.
    std::fs::write(mine.join("map.yaml"), "image: map.png\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\n").unwrap();
    let (status, told) = page(at, "POST /save", json!({"rev": rev(at).await, "overwrite": true})).await;
    assert!(status == 422 && told["error"]["message"].as_str().unwrap().contains("another map"), "{told}");
}

#[tokio::test]
async fn only_the_page_with_its_token_is_let_in_and_it_loads_nothing_from_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let at = open(&office(folder.path(), &WHOLE).display().to_string(), None, true).await;
    let (status, head, body) = asked(at, "GET /", "", "").await;
    let page_text = String::from_utf8(body).unwrap();
    let nonce = head.split("script-src 'nonce-").nth(1).unwrap().split('\'').next().unwrap();
    assert!(status == 200 && page_text.contains(&format!("<script nonce=\"{nonce}\">")), "{head}");
    assert!(!page_text.contains("{nonce}") && !page_text.contains("{scripts}") && !page_text.contains("src=\"http"));
    for (line, head) in [
        ("GET /state", String::new()),
        ("GET /tile/0/0/0", "authorization: Bearer wrong\r\n".to_owned()),
        ("GET /state", format!("authorization: Bearer {TOKEN}\r\norigin: http://strange.example\r\n")),
    ] {
        assert!([401, 403].contains(&asked(at, line, &head, "").await.0), "{line} {head}");
    }
    let (status, told) = draws(at, json!({"describe": {"text": "x"}})).await;
    assert_eq!((status, &told["error"]["code"]), (403, &json!("read_only")));
    let tokened = format!("authorization: Bearer {TOKEN}\r\n");
    let (status, head, tile) = asked(at, "GET /tile/0/0/0", &tokened, "").await;
    assert!(status == 200 && head.contains("image/png") && tile.starts_with(b"\x89PNG"));
    assert_eq!(asked(at, "GET /tile/9/0/0", &tokened, "").await.0, 404);
    assert_eq!(asked(at, "GET /tile/a/0/0", &tokened, "").await.0, 404);
}

#[tokio::test]
async fn openings_elevators_ways_and_the_proposal_are_worked_out_here() {
    let folder = tempfile::tempdir().unwrap();
    let mine = office(folder.path(), &WHOLE);
    let at = open(&mine.display().to_string(), None, false).await;
    let (_, door) = page(at, "POST /opening", json!({"near": [262, 140]})).await;
    assert_eq!(
        (&door["inside"], &door["from"], &door["to"]),
        (&json!(["m1a", "m1b", "m1c"]), &json!([256.0, 141.0]), &json!([266.0, 141.0]))
    );
    assert_eq!(page(at, "POST /opening", json!({"near": [1, 1]})).await.0, 422);
    let (_, found) = page(at, "POST /way", json!({"from": "h0", "to": "m1a"})).await;
    assert_eq!((&found["walk"]["arrives"], &found["way"]["nodes"][0]), (&json!(true), &json!("h0")));
    assert_eq!(page(at, "POST /way", json!({"from": "h0", "to": "zz"})).await.0, 422);
    let raw = folder.path().join("raw");
    std::fs::create_dir_all(&raw).unwrap();
    for file in ["map.yaml", "map.png"] {
        std::fs::copy(mine.join(file), raw.join(file)).unwrap();
    }
    let at = open(&raw.display().to_string(), None, false).await;
    let (_, state) = page(at, "GET /state", Value::Null).await;
    assert_eq!(state["sketch"]["nodes"], json!([]), "a map without a scene graph begins empty");
    let (_, proposal) = page(at, "POST /propose", json!({})).await;
    let (_, state) = page(at, "POST /accept", json!({"rev": 0, "nodes": null})).await;
    assert_eq!((&state["sketch"], &state["undo"]), (&proposal["sketch"], &json!(1)));
    page(at, "POST /save", json!({"rev": 1})).await;
    assert!(socrates_maps::load(&raw).unwrap().graph.nodes().len() > 20);
}

#[test]
fn a_map_file_a_shipped_name_and_a_folder_with_another_map_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let mine = office(folder.path(), &WHOLE);
    let file = mine.join("map.yaml").display().to_string();
    assert_eq!(Site::of(&file, None).unwrap().folder, mine, "the map file of a location stands for it");
    let raw = office(&folder.path().join("raw"), &WHOLE[..2]);
    let named = raw.join("map.yaml").display().to_string();
    assert_eq!(Site::of(&named, None).unwrap().folder, Path::new("mine-edited"));
    assert_eq!(Site::of("office", None).unwrap().folder, Path::new("office-edited"));
    let out = folder.path().join("copy");
    let site = Site::of("hospital", Some(&out)).unwrap();
    let (mut board, map) = Board::lay(site, false).unwrap();
    board.save(0, false, &map).unwrap();
    let shipped = socrates_maps::shipped::files("hospital").unwrap();
    for name in WHOLE {
        assert_eq!(std::fs::read(out.join(name)).unwrap(), shipped[name], "{name}");
    }
    assert!(!out.join("plan.toml").exists());
    let other = Site::of(&named, Some(&out)).unwrap_err();
    assert!(other.what.contains("is another map"), "{}", other.what);
    let none = Site::of("nowhere/at/all", None).unwrap_err();
    assert!(none.what.contains("no location `nowhere/at/all`") && none.hint.contains("office"), "{none}");
}

#[test]
fn a_graph_that_no_reader_takes_is_opened_with_what_is_wrong_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let mine = office(folder.path(), &WHOLE);
    let graph = std::fs::read_to_string(mine.join("scene_graph.json")).unwrap();
    let broken = graph
        .replace("[14, 128]", "[1, 1]")
        .replace("[48, 128]", "[4800, 128]")
        .replace("\"target\": \"h2\"", "\"target\": \"gone\"");
    std::fs::write(mine.join("scene_graph.json"), &broken).unwrap();
    let (board, _) = Board::lay(Site::of(&mine.display().to_string(), None).unwrap(), true).unwrap();
    assert!(socrates_maps::load(&mine).is_err());
    assert_eq!(board.sketch().nodes.len(), 40, "nodes in walls and off the map are there to be moved");
    assert!((board.sketch().nodes[1].at.x - 4800.0).abs() < 1e-6);
    assert!(board.notes.iter().any(|note| note.contains("`gone`")), "{:?}", board.notes);
    std::fs::write(mine.join("scene_graph.json"), "{\n  \"nodes\": oh").unwrap();
    let told = Board::lay(Site::of(&mine.display().to_string(), None).unwrap(), true).unwrap_err();
    assert!(told.to_string().contains("scene_graph.json:2"), "{told}");
}

#[test]
fn a_journal_is_gone_on_with_and_a_line_that_was_cut_off_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let mine = office(folder.path(), &WHOLE);
    let given = mine.display().to_string();
    let lay = || Board::lay(Site::of(&given, None).unwrap(), false);
    let (mut board, map) = lay().unwrap();
    for (rev, text) in ["one", "two", "three"].iter().enumerate() {
        board.act(rev as u64, socrates_edit::Edit::Describe { text: (*text).to_owned() }).unwrap();
    }
    board.undo(3).unwrap();
    drop(board);
    let journal = mine.join(WORK).join(JOURNAL);
    let kept = std::fs::read_to_string(&journal).unwrap();
    std::fs::write(&journal, format!("{kept}{{\"step\":{{\"edit\":{{\"descr")).unwrap();
    let (mut board, _) = lay().unwrap();
    assert_eq!(board.sketch().description, "two");
    assert!(board.notes[0].contains("not saved yet"), "{:?}", board.notes);
    assert_eq!(std::fs::read_to_string(&journal).unwrap(), kept, "the half line is gone");
    let rev = board.revision();
    assert_eq!(board.redo(rev).unwrap()["sketch"]["description"], "three");
    board.save(rev + 1, false, &map).unwrap();
    drop(board);
    let (board, _) = lay().unwrap();
    assert!(board.notes[0].contains("3 edits can be undone, and all is saved"), "{:?}", board.notes);
    drop(board);
    // The files changed while nobody edited: what was drawn is there, and saving will ask.
    std::fs::write(mine.join("location.toml"), "description = \"Theirs.\"\n").unwrap();
    let (board, _) = lay().unwrap();
    assert!(board.notes[0].contains("location.toml was changed by another program"), "{:?}", board.notes);
    assert_eq!(board.sketch().description, "three");
    drop(board);
    let whole = std::fs::read_to_string(&journal).unwrap();
    std::fs::write(&journal, whole.replacen("\"step\"", "\"stop\"", 1)).unwrap();
    let told = lay().unwrap_err();
    assert!(told.what.contains("journal.jsonl:2") && told.hint.contains("--fresh"), "{told}");
    std::fs::write(&journal, whole).unwrap();
    std::fs::write(mine.join("map.yaml"), "image: map.png\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\n").unwrap();
    assert!(lay().unwrap_err().what.contains("was drawn on another map"));
    let aside = Journal::put_aside(&mine.join(WORK)).unwrap().unwrap();
    assert!(aside.ends_with("journal-1.jsonl") && lay().is_ok());
}
