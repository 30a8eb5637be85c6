//! `map edit` as a process: killed at any moment it loses nothing, and one alone edits a folder.

use serde_json::{Value, json};
use socrates_tests::editor::Editor;

use crate::{PROGRAM, socrates};

#[test]
fn an_editor_that_is_killed_has_every_edit_again_and_saves_the_shipped_file() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = socrates_tests::root().join("maps/office");
    let mine = folder.path().join("mine");
    std::fs::create_dir_all(&mine).unwrap();
    for name in ["map.yaml", "map.png"] {
        std::fs::copy(shipped.join(name), mine.join(name)).unwrap();
    }
    let graph: Value = serde_json::from_slice(&std::fs::read(shipped.join("scene_graph.json")).unwrap()).unwrap();
    let node = |node: &Value| json!({"add_node": {"id": node["id"], "kind": node["type"], "at": node["pos"]}});
    let edge = |edge: &Value| json!({"add_edge": {"from": edge["source"], "to": edge["target"], "kind": edge["type"]}});
    let nodes = graph["nodes"].as_array().unwrap().iter().map(node);
    let edits: Vec<Value> = nodes.chain(graph["links"].as_array().unwrap().iter().map(edge)).collect();
    let mut rev = 0;
    for (round, part) in edits.chunks(30).enumerate() {
        let editor = Editor::start(PROGRAM, folder.path(), &format!("edit-{round}"), &["mine"]).unwrap();
        let (_, state) = editor.ask("GET /state", &Value::Null).unwrap();
        assert_eq!(state["undo"], json!(round * 30), "what was answered is there after a kill");
        for edit in part {
            let (status, state) = editor.ask("POST /edit", &json!({"rev": rev, "edit": edit})).unwrap();
            assert_eq!(status, 200, "{state}");
            rev += 1;
        }
        // A second one is refused with who holds the folder; one that only looks is not.
        if round == 0 {
            let second = socrates(folder.path(), "second", &["map", "edit", "mine"]);
            let holder =
                format!("is being edited by process {}, with a page at http://{}/", editor.id(), editor.address);
            assert!(second.code == 2 && second.err.contains(&holder), "{}", second.err);
            assert!(second.err.contains("--read-only"), "{}", second.err);
            let looks = Editor::start(PROGRAM, folder.path(), "looks", &["mine", "--read-only"]).unwrap();
            let (status, told) = looks.ask("POST /edit", &json!({"rev": 0, "edit": edits[0]})).unwrap();
            assert_eq!((status, &told["error"]["code"]), (403, &json!("read_only")));
            looks.end("INT").unwrap();
        }
        editor.end("KILL").unwrap();
    }
    let editor = Editor::start(PROGRAM, folder.path(), "last", &["mine"]).unwrap();
    let (status, saved) = editor.ask("POST /save", &json!({"rev": rev})).unwrap();
    assert_eq!((status, &saved["dirty"]), (200, &json!(false)), "{saved}");
    assert_eq!(
        std::fs::read_to_string(mine.join("scene_graph.json")).unwrap(),
        std::fs::read_to_string(shipped.join("scene_graph.json")).unwrap()
    );
    editor.end("INT").unwrap();
    let checked = socrates(folder.path(), "check", &["map", "check", "mine"]);
    assert_eq!(checked.code, 0, "{}", checked.err);
}
