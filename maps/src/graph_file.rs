//! `scene_graph.json`: networkx node-link data with pixel positions.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};
use socrates_model::{Fault, FaultCode, GraphEdge, GraphNode, Grid, NodeId, Point, SceneGraph, Where};

use crate::json_lines::object_lines;
use crate::read::GRAPH;

/// Keys of the file as networkx writes them; edges are called `links` or, by newer versions, `edges`.
const TOP_KEYS: [&str; 6] = ["directed", "multigraph", "graph", "nodes", "links", "edges"];
/// A position farther off than this is not kept, pixels.
const FAR_PX: f64 = 1e6;
const NODE_KEYS: [&str; 3] = ["id", "type", "pos"];
/// `key` is written by networkx for multigraphs.
const EDGE_KEYS: [&str; 4] = ["type", "source", "target", "key"];

/// Reads the file; `None` when it is no node-link data. Every problem goes to `faults`.
///
/// Without a grid the positions are only checked for their form.
pub(crate) fn read(bytes: &[u8], grid: Option<&Grid>, faults: &mut Vec<Fault>) -> Option<SceneGraph> {
    let text = String::from_utf8_lossy(bytes);
    let value: Value = match serde_json::from_str(&text) {
        Ok(value) => value,
        Err(why) => {
            let at = Where::file(GRAPH).line(why.line());
            faults.push(Fault::new(FaultCode::MRead, at, format!("is no JSON: {why}")));
            return None;
        }
    };
    let Some(top) = value.as_object() else {
        faults.push(Fault::new(
            FaultCode::MRead,
            Where::file(GRAPH),
            "is no object; node-link data has `nodes` and `links`",
        ));
        return None;
    };
    let mut reading = Reading { text: &text, faults };
    reading.unknown_keys(&Where::file(GRAPH), top, &TOP_KEYS);
    let edges_key = if top.contains_key("links") { "links" } else { "edges" };
    if top.contains_key("links") && top.contains_key("edges") {
        reading.fault(FaultCode::MKey, Where::file(GRAPH), "has both `links` and `edges`; keep one");
    }
    let nodes = reading.nodes(reading.elements(top, "nodes"), grid);
    let edges = reading.elements(top, edges_key);
    let edges = reading.edges(edges_key, edges, &nodes);
    if nodes.len() < 2 || edges.is_empty() {
        let message = format!(
            "has {} nodes and {} edges; at least two and an edge between them are needed",
            nodes.len(),
            edges.len()
        );
        reading.fault(FaultCode::MId, Where::file(GRAPH), message);
    }
    Some(SceneGraph::new(nodes, edges))
}

/// An element with the place to name in a fault.
type Element<'v> = (Where, Option<&'v Map<String, Value>>);

struct Reading<'a> {
    text: &'a str,
    faults: &'a mut Vec<Fault>,
}

impl Reading<'_> {
    fn fault(&mut self, code: FaultCode, at: impl Into<Where>, message: impl Into<String>) {
        self.faults.push(Fault::new(code, at, message));
    }

    fn unknown_keys(&mut self, at: &Where, object: &Map<String, Value>, allowed: &[&str]) {
        for key in object.keys().filter(|key| !allowed.contains(&key.as_str())) {
            self.fault(FaultCode::MKey, at, format!("unknown key `{key}`; allowed: {}", allowed.join(", ")));
        }
    }

    /// The elements of a top-level array with file and line.
    fn elements<'v>(&self, top: &'v Map<String, Value>, key: &str) -> Option<Vec<Element<'v>>> {
        let lines = object_lines(self.text, key);
        let array = top.get(key)?.as_array()?;
        let at = |index: usize| match lines.get(index).filter(|_| lines.len() == array.len()) {
            Some(line) => Where::file(GRAPH).line(*line),
            None => Where::file(GRAPH).at_key(format_args!("{key}[{index}]")),
        };
        Some(array.iter().enumerate().map(|(index, value)| (at(index), value.as_object())).collect())
    }

    fn nodes(&mut self, elements: Option<Vec<Element<'_>>>, grid: Option<&Grid>) -> Vec<GraphNode> {
        let Some(elements) = elements else {
            self.fault(FaultCode::MKey, Where::file(GRAPH), "the array `nodes` is missing");
            return Vec::new();
        };
        let mut seen: BTreeMap<NodeId, Where> = BTreeMap::new();
        let mut nodes = Vec::new();
        for (at, object) in elements {
            let Some(object) = object else {
                self.fault(FaultCode::MValue, at, "a node is no object; it has `id`, `type` and `pos`");
                continue;
            };
            self.unknown_keys(&at, object, &NODE_KEYS);
            let id = self.id(&at, object, "id");
            let kind = self.kind(&at, object);
            let place = self.position(&at, object, grid);
            let Some(id) = id else { continue };
            if let Some(first) = seen.insert(id.clone(), at.clone()) {
                self.fault(FaultCode::MId, &at, format!("the id `{id}` is taken already by the node at {first}"));
                continue;
            }
            // A node with another flaw is kept, so that its edges are not called dangling too.
            nodes.push(GraphNode { id, kind: kind.unwrap_or_default(), at: place.unwrap_or_else(Point::origin) });
        }
        nodes
    }

    fn edges(&mut self, key: &str, elements: Option<Vec<Element<'_>>>, nodes: &[GraphNode]) -> Vec<GraphEdge> {
        let Some(elements) = elements else {
            self.fault(FaultCode::MKey, Where::file(GRAPH), format!("the array `{key}` is missing"));
            return Vec::new();
        };
        let known: BTreeSet<&NodeId> = nodes.iter().map(|node| &node.id).collect();
        let mut seen: BTreeMap<(NodeId, NodeId), Where> = BTreeMap::new();
        let mut edges = Vec::new();
        for (at, object) in elements {
            let Some(object) = object else {
                self.fault(FaultCode::MValue, at, "an edge is no object; it has `type`, `source` and `target`");
                continue;
            };
            self.unknown_keys(&at, object, &EDGE_KEYS);
            let kind = self.kind(&at, object);
            let ends = (self.id(&at, object, "source"), self.id(&at, object, "target"));
            let (Some(from), Some(to)) = ends else { continue };
            let dangling: Vec<&NodeId> = [&from, &to].into_iter().filter(|end| !known.contains(end)).collect();
            for end in &dangling {
                self.fault(
                    FaultCode::MId,
                    &at,
                    format!("the edge `{from}` – `{to}` ends at `{end}`, which is no node"),
                );
            }
            if from == to {
                self.fault(
                    FaultCode::MId,
                    &at,
                    format!("the edge `{from}` – `{to}` joins a node to itself; remove it"),
                );
                continue;
            }
            let pair = if from < to { (from.clone(), to.clone()) } else { (to.clone(), from.clone()) };
            if let Some(first) = seen.insert(pair, at.clone()) {
                self.fault(FaultCode::MId, &at, format!("the edge `{from}` – `{to}` is there already at {first}"));
                continue;
            }
            if dangling.is_empty() {
                edges.push(GraphEdge { from, to, kind: kind.unwrap_or_default(), via: Vec::new() });
            }
        }
        edges
    }

    fn id(&mut self, at: &Where, object: &Map<String, Value>, key: &str) -> Option<NodeId> {
        let text = match object.get(key) {
            Some(Value::String(text)) => text.clone(),
            // networkx takes numbers as ids too.
            Some(Value::Number(number)) => number.to_string(),
            Some(other @ (Value::Null | Value::Bool(_) | Value::Array(_) | Value::Object(_))) => {
                self.fault(FaultCode::MValue, at, format!("`{key}` is `{other}`; allowed: a text or a number"));
                return None;
            }
            None => {
                self.fault(FaultCode::MKey, at, format!("the key `{key}` is missing"));
                return None;
            }
        };
        NodeId::new(text).map_err(|why| self.fault(FaultCode::MId, at, why.to_string())).ok()
    }

    fn kind(&mut self, at: &Where, object: &Map<String, Value>) -> Option<String> {
        match object.get("type") {
            Some(Value::String(kind)) => Some(kind.clone()),
            Some(other) => {
                self.fault(FaultCode::MValue, at, format!("`type` is `{other}`; allowed: a text such as `CORRIDOR`"));
                None
            }
            None => {
                self.fault(FaultCode::MKey, at, "the key `type` is missing; it says what kind of place it is");
                None
            }
        }
    }

    fn position(&mut self, at: &Where, object: &Map<String, Value>, grid: Option<&Grid>) -> Option<Point> {
        let Some(value) = object.get("pos") else {
            self.fault(FaultCode::MKey, at, "the key `pos` is missing; it is [x, y] in pixels from the top left");
            return None;
        };
        let numbers: Vec<f64> = value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        let [px, py] = numbers.as_slice() else {
            self.fault(
                FaultCode::MValue,
                at,
                format!("`pos` is `{value}`; allowed: [x, y] in pixels from the top left"),
            );
            return None;
        };
        let grid = grid?;
        #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
        let inside = (0.0..grid.width as f64).contains(px) && (0.0..grid.height as f64).contains(py);
        if !inside {
            let message = format!("`pos` is `{value}`; the image is {} by {} pixels", grid.width, grid.height);
            self.fault(FaultCode::MValue, at, message);
        }
        // One outside keeps its place, so that a person who mends the file sees where it went.
        (inside || px.abs().max(py.abs()) < FAR_PX).then(|| grid.world_from_pixel(*px, *py))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::grid;

    fn read_over(text: &str) -> (Option<SceneGraph>, String) {
        let mut faults = Vec::new();
        let grid = grid(&["....", "....", "...."]);
        let graph = read(text.as_bytes(), Some(&grid), &mut faults);
        (graph, faults.iter().map(|fault| format!("{fault}\n")).collect())
    }

    const GOOD: &str = r#"{"directed": false, "multigraph": false, "graph": {},
 "nodes": [{"id": "a", "type": "ROOM", "pos": [1, 1]},
 {"id": 7, "type": "DOORWAY", "pos": [3, 2]}],
 "links": [{"type": "SIMPLE EDGE", "source": "a", "target": 7}]}"#;

    #[test]
    fn both_spellings_of_the_edges_are_read() {
        for text in [GOOD.to_owned(), GOOD.replace("links", "edges")] {
            let (graph, faults) = read_over(&text);
            let graph = graph.unwrap();
            assert_eq!(faults, "");
            assert_eq!((graph.nodes().len(), graph.edges().len()), (2, 1));
            assert!((graph.nodes()[0].at - Point::new(0.5, 1.0)).norm() < 1e-12);
            assert_eq!(graph.edges()[0].to.as_str(), "7");
        }
    }

    #[test]
    fn every_problem_of_the_graph_is_named_with_its_line() {
        let bad = r#"{"nodes": [
 {"id": "a", "type": "ROOM", "pos": [1, 1]},
 {"id": "a", "type": "ROOM", "pos": [2, 1]},
 {"id": "b", "typ": "ROOM", "pos": [90, 1]},
 {"id": "c d", "type": "ROOM", "pos": "x"}],
 "links": [
 {"type": "E", "source": "a", "target": "zz"},
 {"type": "E", "source": "a", "target": "a"},
 {"type": "E", "source": "a", "target": "b"},
 {"type": "E", "source": "b", "target": "a"},
 {"source": "b"}], "extra": 1}"#;
        let (_, faults) = read_over(bad);
        for part in [
            "json:3: the id `a` is taken",
            "json:4: unknown key `typ`",
            "json:4: the key `type`",
            "json:4: `pos`",
            "json:5: `c d` is not a node id",
            "json:5: `pos`",
            "json:7: the edge `a` – `zz` ends",
            "json:8: the edge `a` – `a`",
            "json:10: the edge `b` – `a` is there already",
            "json:11: the key `type`",
            "json:11: the key `target`",
            "json: unknown key `extra`",
        ] {
            assert!(faults.contains(part), "{part} not in\n{faults}");
        }
    }

    #[test]
    fn broken_json_says_the_line() {
        assert!(read_over("{\n\"nodes\": [\n").1.contains("scene_graph.json:"));
        assert!(read_over("[]").1.contains("no object"));
    }
}
