//! An annotation as the files of a location folder.

use std::collections::BTreeMap;

use serde_json::json;
use socrates_model::{DoorKind, DoorOpens, Grid};

use crate::annotate::Annotation;

/// The files of an annotation by name: `scene_graph.json`, `location.toml`, and `annotation.json` with the confidences and remarks.
///
/// Beside the map's own YAML file and image they make a location folder. The same annotation gives the same bytes.
#[must_use]
pub fn files(annotation: &Annotation, grid: &Grid) -> BTreeMap<String, Vec<u8>> {
    BTreeMap::from([
        ("scene_graph.json".to_owned(), graph_json(annotation, grid).into_bytes()),
        ("location.toml".to_owned(), location_toml(annotation).into_bytes()),
        ("annotation.json".to_owned(), annotation_json(annotation).into_bytes()),
    ])
}

fn graph_json(annotation: &Annotation, grid: &Grid) -> String {
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let nodes: Vec<String> = annotation
        .graph
        .nodes()
        .iter()
        .map(|node| {
            let (px, py) = grid.pixel_from_world(&node.at);
            let (id, kind) = (quoted(node.id.as_str()), quoted(&node.kind));
            format!("    {{\"id\": {id}, \"type\": {kind}, \"pos\": [{px:.2}, {py:.2}]}}")
        })
        .collect();
    let links: Vec<String> = annotation
        .graph
        .edges()
        .iter()
        .map(|edge| {
            let (kind, from, to) = (quoted(&edge.kind), quoted(edge.from.as_str()), quoted(edge.to.as_str()));
            format!("    {{\"type\": {kind}, \"source\": {from}, \"target\": {to}}}")
        })
        .collect();
    format!(
        "{{\n  \"directed\": false,\n  \"multigraph\": false,\n  \"graph\": {{}},\n  \"nodes\": [\n{}\n  ],\n  \"links\": [\n{}\n  ]\n}}\n",
        nodes.join(",\n"),
        links.join(",\n")
    )
}

fn location_toml(annotation: &Annotation) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let mut out = format!("description = {}\n", quoted(&annotation.description));
    for door in &annotation.doors {
        let kind = match door.kind {
            DoorKind::Room => "room",
            DoorKind::Elevator => "elevator",
        };
        // Doors that were found stand open, those of elevators open for the robot; nothing else is made here.
        let opens = match &door.opens {
            DoorOpens::RobotNear(m) => format!("{{ robot_near = {m:?} }}"),
            DoorOpens::Always
            | DoorOpens::Never
            | DoorOpens::AtTimes(_)
            | DoorOpens::Near(_)
            | DoorOpens::OnEvent(_) => "\"always\"".to_owned(),
        };
        let inside: Vec<String> = door.inside.iter().map(|id| quoted(id.as_str())).collect();
        let at = |point: &socrates_model::Point| format!("[{:.3}, {:.3}]", point.x, point.y);
        out.push_str(&format!(
            "\n[[doors]]\nid = {}\nkind = \"{kind}\"\nfrom = {}\nto = {}\nopens = {opens}\nhold_s = {:?}\ninside = [{}]\n",
            quoted(&door.id),
            at(&door.from),
            at(&door.to),
            door.hold_s,
            inside.join(", ")
        ));
    }
    out
}

fn annotation_json(annotation: &Annotation) -> String {
    let sure: serde_json::Map<String, serde_json::Value> = annotation
        .graph
        .nodes()
        .iter()
        .zip(&annotation.confidence)
        .map(|(node, sure)| (node.id.to_string(), json!(sure)))
        .collect();
    let told = json!({
        "about": "made by `socrates map annotate`; how sure each node's type is (0 to 1), and what was left out, doubted or is asked (m, map frame)",
        "counts": annotation.counts,
        "confidence": sure,
        "remarks": annotation.remarks,
    });
    let mut text = serde_json::to_string_pretty(&told).unwrap_or_default();
    text.push('\n');
    text
}
