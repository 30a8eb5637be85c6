//! Graphs and buildings in the hands of readers that others wrote: `geojson` and `networkx` from the package index of Python, and
//! the reader of Open-RMF's site editor, a crate that is built in a folder of its own.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use socrates_tests::skip;

use super::built::reader;
use super::python::python;
use crate::socrates;

/// Readers of GeoJSON and of node-link graphs.
const READERS: [&str; 2] = ["geojson==3.3.0", "networkx==3.6"];
/// What they find in both files.
const SCRIPT: &str = r#"
import geojson, json, networkx, sys
route = geojson.load(open(sys.argv[1]))
kinds = [feature["geometry"]["type"] for feature in route["features"]]
first = route["features"][0]
graph = networkx.node_link_graph(json.load(open(sys.argv[2])), edges="links")
print(json.dumps({
    "errors": route.errors() if not route.is_valid else [],
    "points": kinds.count("Point"),
    "lines": kinds.count("MultiLineString"),
    "first": [first["properties"]["metadata"]["name"], first["properties"]["metadata"]["class"], first["geometry"]["coordinates"]],
    "nodes": graph.number_of_nodes(),
    "edges": graph.number_of_edges(),
    "connected": networkx.is_connected(graph),
    "type": graph.nodes[first["properties"]["metadata"]["name"]]["type"],
}))
"#;

#[test]
fn geojson_and_networkx_read_the_graphs_of_a_location() {
    let python = skip::installed(python("graph-readers", &READERS, "import geojson, networkx"));
    let Some(python) = python else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (to, file) in [("nav2-route", "route.geojson"), ("node-link", "graph.json")] {
        let made = socrates(at, to, &["map", "export", "hospital", "--to", to, "--out", file]);
        assert_eq!(made.code, 0, "{}", made.err);
        let list: Value = serde_json::from_slice(&std::fs::read(at.join("not_carried.json")).unwrap()).unwrap();
        assert_eq!(list["format"], to, "{list}");
    }
    let mut reads = Command::new(python);
    reads.args(["-c", SCRIPT, "route.geojson", "graph.json"]).current_dir(at).stdin(Stdio::null());
    let out = reads.output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let found: Value = serde_json::from_slice(&out.stdout).unwrap();
    let count = |key: &str| found[key].as_u64().unwrap();
    assert_eq!(found["errors"], serde_json::json!([]), "{found}");
    assert_eq!((count("points"), count("lines")), (count("nodes"), 2 * count("edges")), "{found}");
    assert!(count("nodes") > 40 && found["connected"] == true, "{found}");
    assert_eq!(found["type"], found["first"][1], "{found}");
}

/// A program around the reader of Open-RMF's site editor: what it finds in each file, a line each.
const MAIN: &str = r#"
use rmf_site_format::legacy::building_map::BuildingMap;

fn main() {
    for file in std::env::args().skip(1) {
        let bytes = std::fs::read(&file).expect("a file");
        let map = match BuildingMap::from_bytes(&bytes) {
            Ok(map) => map,
            Err(why) => return println!("refused {why}"),
        };
        for (name, level) in &map.levels {
            println!("level {name} {} {} {} {}", level.vertices.len(), level.lanes.len(), level.doors.len(), level.walls.len());
        }
        match map.to_site() {
            Ok(site) => println!("site {}", site.levels.len()),
            Err(why) => println!("no site {why:?}"),
        }
    }
}
"#;

#[test]
fn the_reader_of_the_site_editor_makes_a_site_of_a_building_and_refuses_a_damaged_one() {
    static READER: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let Some(reader) =
        skip::installed(READER.get_or_init(|| reader("rmf-reader", ("rmf_site_format", "0.0.2"), MAIN)).clone())
    else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let read = |file: &str| {
        let out = Command::new(&reader).arg(at.join(file)).stdin(Stdio::null()).output().unwrap();
        format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr))
    };
    for name in ["hospital", "office", "warehouse"] {
        let file = format!("{name}.building.yaml");
        let made = socrates(at, name, &["--format", "json", "map", "export", name, "--to", "rmf", "--out", &file]);
        assert_eq!(made.code, 0, "{}", made.err);
        let told = made.json();
        let found = read(&file);
        let level: Vec<u64> = found.lines().next().unwrap().split(' ').filter_map(|word| word.parse().ok()).collect();
        let [vertices, lanes, doors, walls] = level[..] else { panic!("{name}: {found}") };
        assert!(vertices >= told["nodes"].as_u64().unwrap() && walls >= 40, "{name}: {found}");
        assert!(lanes >= told["edges"].as_u64().unwrap(), "{name}: {found}");
        let location = socrates(at, &format!("{name}-doors"), &["--format", "json", "map", "check", name]);
        assert_eq!(location.code, 0, "{}", location.err);
        assert!(name == "warehouse" || doors > 0, "{name}: {found}");
        assert!(found.contains("\nsite 1\n"), "{name}: {found}");
        let text = std::fs::read_to_string(at.join(&file)).unwrap();
        std::fs::write(at.join("damaged.yaml"), text.replace("right_left_ratio", "ratio")).unwrap();
        assert!(doors == 0 || read("damaged.yaml").starts_with("refused"), "{name}: {}", read("damaged.yaml"));
    }
}
