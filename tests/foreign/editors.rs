//! The page of the map editor in a browser that others wrote: the shipped office drawn from empty, as a person would.

use serde_json::{Value, json};
use socrates_tests::editor::Editor;
use socrates_tests::program::run;
use socrates_tests::{browser, root};

use super::live::snake;
use crate::{PROGRAM, socrates};

/// Windows of a small and of a large desk, px.
const SIZES: [&str; 2] = ["1280x720", "1920x1080"];
/// The doors of the shipped office on its image, pixels, and the sentence about it.
fn place() -> Value {
    json!({
        "doors": [
            {"id": "meeting_room_1", "from": [256, 141], "to": [266, 141]},
            {"id": "meeting_room_2", "from": [144, 115], "to": [154, 115]},
        ],
        "description": "One floor of an office building: a long main corridor with side corridors, meeting rooms behind doors, an open-plan \
                        area, a kitchen, a reception and two ways out.",
    })
}

#[test]
fn the_shipped_office_is_drawn_from_empty_to_the_same_files() {
    let Some(python) = snake() else { return };
    let Some(chromium) = browser::chromium() else { return };
    let shipped = root().join("maps/office");
    for size in SIZES {
        let folder = tempfile::tempdir().unwrap();
        let mine = folder.path().join("mine");
        std::fs::create_dir_all(&mine).unwrap();
        for name in ["map.yaml", "map.png"] {
            std::fs::copy(shipped.join(name), mine.join(name)).unwrap();
        }
        let editor = Editor::start(PROGRAM, folder.path(), "edit", &["mine"]).unwrap();
        let texts = [
            root().join("tests/foreign/editors/page.py").display().to_string(),
            chromium.display().to_string(),
            folder.path().display().to_string(),
            size.to_owned(),
            editor.page.clone(),
            shipped.join("scene_graph.json").display().to_string(),
            place().to_string(),
        ];
        let args: Vec<&str> = texts.iter().map(String::as_str).collect();
        let finished = run(&python.display().to_string(), &args, folder.path(), &format!("page-{size}")).unwrap();
        let found = finished.json();
        assert_eq!(finished.code, 0, "{}\n{}", finished.out, finished.err);
        for clean in ["console", "policy", "strangers", "findings"] {
            assert_eq!(found[clean], json!([]), "{size}: {found}");
        }
        assert_eq!((&found["undone"], &found["redone"]), (&json!([0, 0, 0]), &json!(true)), "{found}");
        assert_eq!((&found["told"][0], &found["told"][1]), (&json!("M-WALL"), &json!(1)), "{found}");
        assert_eq!(found["names"], json!(["way in", "way in", "way in h0"]), "{found}");
        assert_eq!(found["walked"][1], json!(true), "{found}");
        for moment in ["empty", "nodes", "drawn", "wall", "called", "way", "proposed", "saved"] {
            let seen = &found[moment];
            assert!(seen["wide"].as_f64() <= seen["inner"].as_f64(), "{size}: cut at {moment}: {seen}");
            assert!(seen["tall"].as_f64() <= seen["high"].as_f64(), "{size}: scrolls at {moment}: {seen}");
            assert_eq!((&seen["cut"], &seen["odd"]), (&json!([]), &json!([])), "{size}, {moment}: {seen}");
        }
        for name in ["scene_graph.json", "location.toml"] {
            let files = [&mine, &shipped].map(|folder| std::fs::read_to_string(folder.join(name)).unwrap());
            assert_eq!(files[0], files[1], "{size}: {name}");
        }
        editor.end("INT").unwrap();
        assert_eq!(socrates(folder.path(), "check", &["map", "check", "mine"]).code, 0);
    }
}
