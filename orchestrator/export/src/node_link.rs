//! Scene graphs as SocRATES's annotator and networkx write them: node-link JSON with positions in pixels.

use std::collections::BTreeSet;

use serde_json::{Map, Value};
use socrates_model::{GraphEdge, GraphNode, Grid, Location, NodeId};

use crate::graph::{Graph, MOST, PLAIN_EDGE, PLAIN_NODE, Unusable, micro, node_id};
use crate::not_carried::Losses;

/// The text of a scene graph, with what it does not hold. Positions are pixels of the location's own image, from the top left.
#[must_use]
pub fn write(location: &Location) -> (String, Losses) {
    let mut losses = Losses::default();
    let quoted = |text: &str| Value::from(text).to_string();
    let node = |node: &GraphNode| {
        let (px, py) = location.grid.pixel_from_world(&node.at);
        let (px, py) = (micro(px), micro(py));
        format!(
            "    {{\"type\": {}, \"pos\": [{px:?}, {py:?}], \"id\": {}}}",
            quoted(&node.kind),
            quoted(node.id.as_str())
        )
    };
    let link = |edge: &GraphEdge| {
        let (from, to) = (quoted(edge.from.as_str()), quoted(edge.to.as_str()));
        format!("    {{\"type\": {}, \"source\": {from}, \"target\": {to}}}", quoted(&edge.kind))
    };
    let nodes: Vec<String> = location.graph.nodes().iter().map(node).collect();
    let links: Vec<String> = location.graph.edges().iter().map(link).collect();
    for edge in location.graph.edges().iter().filter(|edge| !edge.via.is_empty()) {
        losses.note(
            "bends of ways",
            format!("{} – {}", edge.from, edge.to),
            "a way is a straight line; the reader leads it round walls again",
        );
    }
    for door in &location.doors {
        losses.note("doors", format!("location.toml door `{}`", door.id), "a scene graph has none");
    }
    for area in &location.names {
        losses.note("names", format!("location.toml name `{}`", area.name), "nodes have an id and a type alone");
    }
    if !location.description.is_empty() {
        losses.note("description", "location.toml: description", "a scene graph has none");
    }
    losses.note("map", "map.yaml and its image", "positions are pixels of the same image");
    let text = format!(
        "{{\n  \"directed\": false,\n  \"multigraph\": false,\n  \"graph\": {{}},\n  \"nodes\": [\n{}\n  ],\n  \"links\": [\n{}\n  ]\n}}\n",
        nodes.join(",\n"),
        links.join(",\n")
    );
    (text, losses)
}

/// Reads a scene graph over the map on which its pixels lie; keys that a scene graph of ours does not have are noted.
///
/// # Errors
/// The first node or edge that cannot be used, with its place in the file.
pub fn read(text: &str, grid: &Grid) -> Result<(Graph, Losses), Unusable> {
    let value: Value = serde_json::from_str(text).map_err(|why| {
        Unusable::new(format!("line {}", why.line()), format!("is no JSON: {why}"), "give a node-link file of networkx")
    })?;
    let list = |keys: &[&str]| {
        let found = keys.iter().find_map(|key| value.get(*key)).and_then(Value::as_array);
        let named = keys.join("` or `");
        let found = found
            .ok_or_else(|| Unusable::new(&*named, "the array is missing", "node-link data has `nodes` and `links`"));
        found.and_then(|items| {
            if items.len() <= MOST {
                return Ok(items);
            }
            Err(Unusable::new(
                &*named,
                format!("has {} elements; allowed: {MOST}", items.len()),
                "cut the graph into parts",
            ))
        })
    };
    let (mut graph, mut losses) = (Graph::default(), Losses::default());
    let mut ids: Vec<(String, NodeId)> = Vec::new();
    let mut taken: BTreeSet<NodeId> = BTreeSet::new();
    for (place, node) in list(&["nodes"])?.iter().enumerate() {
        let at = format!("nodes[{place}]");
        let node = object(&at, node, &["id", "type", "pos"], &mut losses)?;
        let name = name(&at, node, "id")?;
        if ids.iter().any(|(other, _)| *other == name) {
            return Err(Unusable::new(format!("{at}.id"), format!("the id `{name}` is taken"), "ids are unique"));
        }
        let id = node_id(&name, "node", &taken)?;
        taken.insert(id.clone());
        ids.push((name, id.clone()));
        let numbers: Vec<f64> =
            node.get("pos").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_f64).collect();
        let [px, py] = numbers.as_slice() else {
            let found = node.get("pos").unwrap_or(&Value::Null);
            return Err(Unusable::new(
                format!("{at}.pos"),
                format!("is `{found}`"),
                "a position is [x, y] in pixels from the top left",
            ));
        };
        graph.nodes.push(GraphNode { id, kind: kind(node, PLAIN_NODE), at: grid.world_from_pixel(*px, *py) });
    }
    let mut joined = BTreeSet::new();
    for (place, edge) in list(&["links", "edges"])?.iter().enumerate() {
        let at = format!("links[{place}]");
        let edge = object(&at, edge, &["type", "source", "target", "key"], &mut losses)?;
        let end = |key: &str| {
            let name = name(&at, edge, key)?;
            let known = ids.iter().find(|(other, _)| *other == name).map(|(_, id)| id.clone());
            known.ok_or_else(|| {
                Unusable::new(format!("{at}.{key}"), format!("`{name}` is no node"), "name a node of the file")
            })
        };
        let way = GraphEdge { from: end("source")?, to: end("target")?, kind: kind(edge, PLAIN_EDGE), via: Vec::new() };
        if way.from == way.to {
            losses.note("edges from a node to itself", at, "a way joins two nodes");
        } else if !graph.join(way, &mut joined) {
            losses.note("parallel edges", at, "two nodes are joined by one way");
        }
    }
    if value.get("directed").and_then(Value::as_bool) == Some(true) {
        losses.note("directions", "directed", "ways of a scene graph lead both ways");
    }
    let graph = graph.largest_part(&mut losses);
    Ok((graph, losses))
}

fn object<'v>(
    at: &str,
    value: &'v Value,
    keys: &[&str],
    losses: &mut Losses,
) -> Result<&'v Map<String, Value>, Unusable> {
    let found =
        value.as_object().ok_or_else(|| Unusable::new(at, "is no object", format!("it has {}", keys.join(", "))))?;
    for key in found.keys().filter(|key| !keys.contains(&key.as_str())) {
        losses.note(
            "further keys",
            format!("{at}.{key}"),
            "nodes have id, type and pos, edges type, source and target",
        );
    }
    Ok(found)
}

fn name(at: &str, object: &Map<String, Value>, key: &str) -> Result<String, Unusable> {
    match object.get(key) {
        Some(Value::String(text)) if !text.is_empty() => Ok(text.clone()),
        Some(Value::Number(number)) => Ok(number.to_string()),
        other => {
            let found = other.unwrap_or(&Value::Null);
            Err(Unusable::new(format!("{at}.{key}"), format!("is `{found}`"), "write a text or a number"))
        }
    }
}

fn kind(object: &Map<String, Value>, or: &str) -> String {
    let said = object.get("type").and_then(Value::as_str).filter(|kind| !kind.trim().is_empty());
    said.unwrap_or(or).to_owned()
}
