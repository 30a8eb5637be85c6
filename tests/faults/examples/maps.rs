//! `M-`: locations that cannot be.

use std::collections::BTreeMap;

use socrates_model::FaultCode;

use super::{Examples, keep};

/// Two rooms with a gap between them.
const PLAN: &str = r#"description = "Two rooms."
size_m = [8.0, 5.0]
resolution_m = 0.1
floors = [[0.5, 0.5, 7.5, 4.5]]
walls = [[4.0, 0.5, 4.0, 4.5]]
openings = [[4.0, 2.0, 4.0, 3.0]]
nodes = [{ id = "a", type = "ROOM", at = [2.0, 2.5] }, { id = "b", type = "ROOM", at = [6.0, 2.5] }]
edges = [{ type = "DOORWAY", along = ["a", "b"] }]
"#;

pub(super) fn examples() -> Examples {
    let mut all = Examples::new();
    let whole = socrates_maps::generate(PLAN).unwrap();
    let plan = |old: &str, new: &str| socrates_maps::generate(&PLAN.replace(old, new)).unwrap_err();
    keep(&mut all, plan("size_m", "sise_m"));
    keep(&mut all, plan("resolution_m = 0.1", "resolution_m = 3.0"));
    keep(&mut all, plan("[6.0, 2.5]", "[4.0, 1.0]"));
    keep(&mut all, plan("[\"a\", \"b\"]", "[\"a\", \"c\"]"));
    let file = |name: &str, edit: &dyn Fn(String) -> Option<String>| {
        let mut files: BTreeMap<String, Vec<u8>> = whole.clone();
        let text = files.remove(name).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        if let Some(text) = text.and_then(edit) {
            files.insert(name.to_owned(), text.into_bytes());
        }
        socrates_maps::parse(&files, "two")
    };
    keep(&mut all, file("scene_graph.json", &|_| None).unwrap_err());
    keep(&mut all, file("map.png", &|_| None).unwrap_err());
    let apart = plan("edges = [{ type = \"DOORWAY\", along = [\"a\", \"b\"] }]", "edges = []");
    keep(&mut all, apart);
    // An edge round a wall is a warning, which a location keeps as text.
    let below = PLAN.replace("[2.0, 2.5]", "[2.0, 1.0]").replace("[6.0, 2.5]", "[6.0, 1.0]");
    let routed = socrates_maps::parse(&socrates_maps::generate(&below).unwrap(), "two").unwrap();
    let warning = routed.warnings.iter().find(|warning| warning.starts_with(FaultCode::MRoute.code()));
    all.insert(FaultCode::MRoute, warning.unwrap().clone());
    let mut location = socrates_maps::parse(&whole, "two").unwrap();
    location.graph = location.graph.edited(|nodes, _| nodes[0].kind.clear());
    keep(&mut all, socrates_maps::check(&location));
    all
}
