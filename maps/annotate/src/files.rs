//! An annotation as the files of a location folder.

use std::collections::BTreeMap;

use serde_json::json;
use socrates_maps::{EXTRA, GRAPH, written};
use socrates_model::{Grid, Point};

use crate::annotate::Annotation;

/// The files of an annotation by name: `scene_graph.json`, `location.toml`, and `annotation.json` with the confidences and remarks.
///
/// Beside the map's own YAML file and image they make a location folder. The same annotation gives the same bytes.
#[must_use]
pub fn files(annotation: &Annotation, grid: &Grid) -> BTreeMap<String, Vec<u8>> {
    BTreeMap::from([
        (GRAPH.to_owned(), graph_json(annotation, grid).into_bytes()),
        (EXTRA.to_owned(), location_toml(annotation).into_bytes()),
        ("annotation.json".to_owned(), annotation_json(annotation).into_bytes()),
    ])
}

fn graph_json(annotation: &Annotation, grid: &Grid) -> String {
    let (nodes, edges) = (annotation.graph.nodes(), annotation.graph.edges());
    let nodes = nodes.iter().map(|node| (node.id.as_str(), node.kind.as_str(), grid.pixel_from_world(&node.at)));
    let links = edges.iter().map(|edge| (edge.kind.as_str(), edge.from.as_str(), edge.to.as_str()));
    written::graph_json(nodes, links, 2)
}

fn location_toml(annotation: &Annotation) -> String {
    let at = |point: &Point| format!("[{:.3}, {:.3}]", point.x, point.y);
    written::location_toml(&annotation.description, &annotation.doors, at)
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
