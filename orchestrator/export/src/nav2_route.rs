//! Route graphs of Nav2: GeoJSON as its route server loads it.
//!
//! Facts of the format are those of `nav2_route/src/plugins/graph_file_loaders/geojson_graph_file_loader.cpp`: features that are
//! points are nodes, lines are directed edges, both share one space of unsigned ids, `null` is refused in metadata, and numbers
//! of metadata keep their JSON kind, so that a scorer that asks for a real refuses `60`.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use serde_json::{Map, Value};
use socrates_model::{AreaName, Door, DoorKind, DoorOpens, GraphEdge, GraphNode, Location, NodeId, Point};

use crate::graph::{Graph, MOST, PLAIN_EDGE, PLAIN_NODE, Unusable, crossed, door_rule, micro, node_id};
use crate::not_carried::Losses;

/// Keys of metadata that Nav2 reads as reals.
const REALS: [&str; 4] = ["speed_limit", "abs_speed_limit", "penalty", "abs_time_taken"];

#[derive(Serialize)]
struct Collection<'a> {
    r#type: &'static str,
    name: &'a str,
    crs: Value,
    features: Vec<Feature>,
}

#[derive(Serialize)]
struct Feature {
    r#type: &'static str,
    properties: Properties,
    geometry: Geometry,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Properties {
    Node {
        id: usize,
        frame: &'static str,
        metadata: NodeNotes,
    },
    Edge {
        id: usize,
        startid: usize,
        endid: usize,
        cost: f64,
        overridable: bool,
        metadata: EdgeNotes,
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        operations: BTreeMap<String, Operation>,
    },
}

#[derive(Serialize)]
struct NodeNotes {
    class: String,
    name: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    places: Vec<String>,
}

#[derive(Serialize)]
struct EdgeNotes {
    class: String,
}

#[derive(Serialize)]
struct Operation {
    r#type: &'static str,
    trigger: &'static str,
    metadata: DoorNotes,
}

#[derive(Serialize)]
struct DoorNotes {
    service_name: String,
    door: String,
    kind: &'static str,
    line: [f64; 4],
}

#[derive(Serialize)]
#[serde(tag = "type", content = "coordinates")]
enum Geometry {
    Point([f64; 2]),
    MultiLineString([Vec<[f64; 2]>; 1]),
}

fn pair(at: &Point) -> [f64; 2] {
    [micro(at.x), micro(at.y)]
}

/// The text of a route graph, with what it does not hold.
///
/// Each way becomes two directed edges of the length of the way as their cost. Types are `metadata.class`, ids `metadata.name`,
/// names of areas `metadata.places`; a door is an operation `OpenDoor` on the edges that cross its line.
#[must_use]
pub fn write(location: &Location) -> (String, Losses) {
    let mut losses = Losses::default();
    let graph = &location.graph;
    let places = |id: &NodeId| -> Vec<String> {
        location.names.iter().filter(|area| area.nodes.contains(id)).map(|area| area.name.clone()).collect()
    };
    let mut features: Vec<Feature> = graph
        .nodes()
        .iter()
        .enumerate()
        .map(|(id, node)| {
            let metadata = NodeNotes { class: node.kind.clone(), name: node.id.to_string(), places: places(&node.id) };
            let geometry = Geometry::Point(pair(&node.at));
            Feature { r#type: "Feature", properties: Properties::Node { id, frame: "map", metadata }, geometry }
        })
        .collect();
    let mut passed: BTreeSet<&str> = BTreeSet::new();
    for edge in graph.edges() {
        let doors = crossed(location, edge);
        passed.extend(doors.iter().map(|door| door.id.as_str()));
        let points = graph.edge_points(&edge.from, &edge.to).unwrap_or_default();
        let length: f64 = points.windows(2).map(|pair| if let [a, b] = pair { (b - a).norm() } else { 0.0 }).sum();
        let Some((from, to)) = graph.position(&edge.from).zip(graph.position(&edge.to)) else { continue };
        let line: Vec<[f64; 2]> = points.iter().map(pair).collect();
        let back = line.iter().rev().copied().collect();
        for (startid, endid, line) in [(from, to, line), (to, from, back)] {
            let operations = doors.iter().map(|door| (format!("open_{}", door.id), operation(door))).collect();
            let properties = Properties::Edge {
                id: features.len(),
                startid,
                endid,
                cost: micro(length),
                overridable: true,
                metadata: EdgeNotes { class: edge.kind.clone() },
                operations,
            };
            features.push(Feature { r#type: "Feature", properties, geometry: Geometry::MultiLineString([line]) });
        }
    }
    for door in &location.doors {
        if passed.contains(door.id.as_str()) {
            door_rule(door, &mut losses);
        } else {
            losses.note("doors", format!("location.toml door `{}`", door.id), "no way of the graph crosses it");
        }
    }
    left_behind(location, &mut losses);
    let crs = serde_json::json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::3857" } });
    let file = Collection { r#type: "FeatureCollection", name: &location.name, crs, features };
    let mut text = serde_json::to_string_pretty(&file).unwrap_or_else(|why| why.to_string());
    text.push('\n');
    (text, losses)
}

fn left_behind(location: &Location, losses: &mut Losses) {
    if !location.description.is_empty() {
        losses.note("description", "location.toml: description", "a route graph has none");
    }
    losses.note("map", "map.yaml and its image", "a route graph has no walls; Nav2 takes the same map.yaml");
}

fn operation(door: &Door) -> Operation {
    let kind = match door.kind {
        DoorKind::Room => "room",
        DoorKind::Elevator => "elevator",
    };
    let ([x0, y0], [x1, y1]) = (pair(&door.from), pair(&door.to));
    let metadata =
        DoorNotes { service_name: format!("open_{}", door.id), door: door.id.clone(), kind, line: [x0, y0, x1, y1] };
    Operation { r#type: "OpenDoor", trigger: "ON_ENTER", metadata }
}

/// Reads a route graph as strictly as Nav2's loader does, with what a scene graph does not hold.
///
/// # Errors
/// The first thing that the loader or a scorer of Nav2 would refuse, with its feature: no JSON, no features, an id that is missing,
/// negative or taken, an edge to a node that is not there, `null` in metadata, an integer where a scorer reads a real.
pub fn read(text: &str) -> Result<(Graph, Losses), Unusable> {
    let value: Value = serde_json::from_str(text).map_err(|why| {
        Unusable::new(format!("line {}", why.line()), format!("is no JSON: {why}"), "give a GeoJSON file of nav2_route")
    })?;
    let features = value.get("features").and_then(Value::as_array).ok_or_else(|| {
        Unusable::new("features", "the array is missing", "a route graph is a FeatureCollection with `features`")
    })?;
    if features.len() > MOST {
        let problem = format!("has {} features; allowed: {MOST}", features.len());
        return Err(Unusable::new("features", problem, "cut the graph into parts"));
    }
    let mut reading = Reading::default();
    for (place, feature) in features.iter().enumerate() {
        reading.node(place, feature)?;
    }
    for (place, feature) in features.iter().enumerate() {
        reading.edge(place, feature)?;
    }
    if reading.graph.nodes.is_empty() || reading.graph.edges.is_empty() {
        let found = format!("has {} nodes and {} edges", reading.graph.nodes.len(), reading.graph.edges.len());
        return Err(Unusable::new("features", found, "Nav2 needs at least one of each"));
    }
    for (from, to) in
        reading.directed.iter().filter(|(from, to)| !reading.directed.contains(&(to.clone(), from.clone())))
    {
        reading.losses.note("one-way edges", format!("{from} → {to}"), "ways of a scene graph lead both ways");
    }
    let (graph, mut losses) = (reading.graph, reading.losses);
    let graph = graph.largest_part(&mut losses);
    Ok((graph, losses))
}

/// Number and key of a feature in messages.
fn at(place: usize, key: &str) -> String {
    format!("features[{place}].{key}")
}

#[derive(Default)]
struct Reading {
    graph: Graph,
    losses: Losses,
    ids: BTreeMap<u64, Option<NodeId>>,
    taken: BTreeSet<NodeId>,
    joined: BTreeSet<(NodeId, NodeId)>,
    directed: BTreeSet<(NodeId, NodeId)>,
    doors: BTreeSet<String>,
}

impl Reading {
    fn node(&mut self, place: usize, feature: &Value) -> Result<(), Unusable> {
        if kind_of(place, feature)? != "Point" {
            return Ok(());
        }
        let properties = properties(place, feature)?;
        let number = self.number(place, properties)?;
        let geometry = feature.get("geometry").and_then(|geometry| geometry.get("coordinates"));
        let point = point_of(place, geometry)?;
        let notes = self.metadata(place, properties)?;
        let said = |key: &str| notes.and_then(|notes| notes.get(key)).and_then(Value::as_str);
        let id = node_id(said("name").unwrap_or_default(), &number.to_string(), &self.taken)?;
        self.taken.insert(id.clone());
        self.ids.insert(number, Some(id.clone()));
        for name in notes.and_then(|notes| notes.get("places")).and_then(Value::as_array).into_iter().flatten() {
            let Some(name) = name.as_str() else { continue };
            match self.graph.names.iter_mut().find(|area| area.name == name) {
                Some(area) => area.nodes.push(id.clone()),
                None => self.graph.names.push(AreaName { name: name.to_owned(), nodes: vec![id.clone()] }),
            }
        }
        for key in
            notes.into_iter().flat_map(Map::keys).filter(|key| !["class", "name", "places"].contains(&key.as_str()))
        {
            self.losses.note(
                "metadata of nodes",
                format!("{}: {key}", at(place, "properties.metadata")),
                "a node has a type alone",
            );
        }
        if properties.get("operations").is_some_and(|operations| !operations.is_null()) {
            self.losses.note("operations", at(place, "properties.operations"), "nodes of a scene graph have none");
        }
        if let Some(frame) = properties.get("frame").and_then(Value::as_str).filter(|frame| *frame != "map") {
            self.losses.note(
                "frames",
                format!("{}: {frame}", at(place, "properties.frame")),
                "positions were taken to be in the map frame",
            );
        }
        let kind = said("class").filter(|class| !class.trim().is_empty()).unwrap_or(PLAIN_NODE).to_owned();
        self.graph.nodes.push(GraphNode { id, kind, at: point });
        Ok(())
    }

    fn edge(&mut self, place: usize, feature: &Value) -> Result<(), Unusable> {
        let kind = kind_of(place, feature)?;
        if kind == "Point" {
            return Ok(());
        }
        if kind != "MultiLineString" && kind != "LineString" {
            self.losses.note(
                "geometry",
                format!("{}: {kind}", at(place, "geometry.type")),
                "Nav2 reads points and lines alone",
            );
            return Ok(());
        }
        let properties = properties(place, feature)?;
        self.edge_number(place, properties)?;
        let (from, to) = (self.end(place, properties, "startid")?, self.end(place, properties, "endid")?);
        let notes = self.metadata(place, properties)?;
        let class = notes.and_then(|notes| notes.get("class")).and_then(Value::as_str);
        for key in notes.into_iter().flat_map(Map::keys).filter(|key| *key != "class") {
            self.losses.note(
                "metadata of edges",
                format!("{}: {key}", at(place, "properties.metadata")),
                "a way has a type alone",
            );
        }
        self.operations(place, properties);
        let via = via_of(feature);
        let way = GraphEdge { from: from.clone(), to: to.clone(), kind: class.unwrap_or(PLAIN_EDGE).to_owned(), via };
        let length = self.length(&way);
        if let Some(cost) = properties.get("cost").and_then(Value::as_f64)
            && length.is_none_or(|length| (cost - length).abs() > 0.01)
        {
            self.losses.note("costs", at(place, "properties.cost"), "a way costs its length");
        }
        if from == to {
            self.losses.note("edges from a node to itself", at(place, "properties"), "a way joins two nodes");
            return Ok(());
        }
        self.directed.insert((from, to));
        self.graph.join(way, &mut self.joined);
        Ok(())
    }

    fn length(&self, way: &GraphEdge) -> Option<f64> {
        let end = |id: &NodeId| self.graph.nodes.iter().find(|node| node.id == *id).map(|node| node.at);
        let points: Vec<Point> =
            std::iter::once(end(&way.from)?).chain(way.via.iter().copied()).chain([end(&way.to)?]).collect();
        Some(points.windows(2).map(|pair| if let [a, b] = pair { (b - a).norm() } else { 0.0 }).sum())
    }

    /// The unsigned id of a feature, which no node and no edge has yet.
    fn number(&self, place: usize, properties: &Map<String, Value>) -> Result<u64, Unusable> {
        let found = properties.get("id").unwrap_or(&Value::Null);
        let number = found.as_u64().ok_or_else(|| {
            Unusable::new(at(place, "properties.id"), format!("is `{found}`"), "ids are whole numbers from 0 on")
        })?;
        if self.ids.contains_key(&number) {
            let problem = format!("the id {number} is taken");
            return Err(Unusable::new(at(place, "properties.id"), problem, "nodes and edges share one space of ids"));
        }
        Ok(number)
    }

    /// Takes the id of an edge; one that another edge has is noted, since graphs that Nav2 ships have such.
    fn edge_number(&mut self, place: usize, properties: &Map<String, Value>) -> Result<(), Unusable> {
        let told = properties.get("id").and_then(Value::as_u64);
        if told.is_some_and(|told| self.ids.get(&told) == Some(&None)) {
            self.losses.note("ids of edges", at(place, "properties.id"), "another edge has the same; ways have no ids");
            return Ok(());
        }
        let number = self.number(place, properties)?;
        self.ids.insert(number, None);
        Ok(())
    }

    fn end(&self, place: usize, properties: &Map<String, Value>, key: &str) -> Result<NodeId, Unusable> {
        let found = properties.get(key).unwrap_or(&Value::Null);
        let known = found.as_u64().and_then(|number| self.ids.get(&number)).cloned().flatten();
        known.ok_or_else(|| {
            Unusable::new(
                at(place, &format!("properties.{key}")),
                format!("is `{found}`, which is no node"),
                "name a node of the file",
            )
        })
    }

    /// The metadata of a feature, refused where Nav2 would throw.
    fn metadata<'v>(
        &self,
        place: usize,
        properties: &'v Map<String, Value>,
    ) -> Result<Option<&'v Map<String, Value>>, Unusable> {
        let Some(notes) = properties.get("metadata") else { return Ok(None) };
        let here = at(place, "properties.metadata");
        let notes =
            notes.as_object().ok_or_else(|| Unusable::new(&*here, format!("is `{notes}`"), "metadata is an object"))?;
        sound(&here, notes)?;
        Ok(Some(notes))
    }

    /// Doors among the operations of an edge; others are noted.
    fn operations(&mut self, place: usize, properties: &Map<String, Value>) {
        for (name, operation) in properties.get("operations").and_then(Value::as_object).into_iter().flatten() {
            match door_of(operation) {
                Some(door) if self.doors.insert(door.id.clone()) => self.graph.doors.push(door),
                Some(_) => {}
                None => self.losses.note(
                    "operations",
                    format!("{}: {name}", at(place, "properties.operations")),
                    "a way has none; an `OpenDoor` with a `line` becomes a door",
                ),
            }
        }
    }
}

fn kind_of(place: usize, feature: &Value) -> Result<&str, Unusable> {
    let found = feature.get("geometry").and_then(|geometry| geometry.get("type"));
    found.and_then(Value::as_str).ok_or_else(|| {
        Unusable::new(
            at(place, "geometry.type"),
            "is missing",
            "a feature is a `Point`, a `LineString` or a `MultiLineString`",
        )
    })
}

fn properties(place: usize, feature: &Value) -> Result<&Map<String, Value>, Unusable> {
    let found = feature.get("properties").and_then(Value::as_object);
    found.ok_or_else(|| {
        Unusable::new(at(place, "properties"), "is missing", "a feature has an `id` in its `properties`")
    })
}

/// A coordinate pair; whole numbers are taken here, as Nav2 takes them.
fn point_of(place: usize, value: Option<&Value>) -> Result<Point, Unusable> {
    let numbers: Vec<f64> = value.and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_f64).collect();
    match numbers.as_slice() {
        [x, y, ..] if x.abs() < 1e7 && y.abs() < 1e7 => Ok(Point::new(*x, *y)),
        _ => {
            let found = value.unwrap_or(&Value::Null);
            Err(Unusable::new(
                at(place, "geometry.coordinates"),
                format!("is `{found}`"),
                "a place is [x, y] in the map frame, m, below 10 000 km",
            ))
        }
    }
}

/// The points between both ends of a line.
fn via_of(feature: &Value) -> Vec<Point> {
    let coordinates = feature.get("geometry").and_then(|geometry| geometry.get("coordinates"));
    let outer = coordinates.and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    let nested =
        outer.first().and_then(Value::as_array).is_some_and(|first| first.first().is_some_and(Value::is_array));
    let points: Vec<&Value> =
        if nested { outer.iter().filter_map(Value::as_array).flatten().collect() } else { outer.iter().collect() };
    let inner = points.get(1..points.len().saturating_sub(1)).unwrap_or_default();
    inner.iter().filter_map(|value| point_of(0, Some(value)).ok()).collect()
}

/// Refuses `null`, arrays of other than primitives, and integers where a scorer reads a real.
fn sound(at: &str, notes: &Map<String, Value>) -> Result<(), Unusable> {
    for (key, value) in notes {
        let here = format!("{at}.{key}");
        match value {
            Value::Null => return Err(Unusable::new(here, "is `null`", "Nav2 refuses it; leave the key out")),
            Value::Number(number) if REALS.contains(&key.as_str()) && !number.is_f64() => {
                let problem = format!("is the integer `{number}`");
                return Err(Unusable::new(here, problem, format!("Nav2 reads a real; write `{number}.0`")));
            }
            Value::Array(items) if items.iter().any(|item| item.is_array() || item.is_object() || item.is_null()) => {
                return Err(Unusable::new(
                    here,
                    "is an array of other than texts, numbers and truths",
                    "Nav2 refuses it",
                ));
            }
            Value::Object(inner) => sound(&here, inner)?,
            Value::Bool(_) | Value::Number(_) | Value::String(_) | Value::Array(_) => {}
        }
    }
    Ok(())
}

/// The door that an operation opens, where it says where.
fn door_of(operation: &Value) -> Option<Door> {
    let notes = operation.get("metadata")?;
    let line: Vec<f64> = notes.get("line")?.as_array()?.iter().filter_map(Value::as_f64).collect();
    let [x0, y0, x1, y1] = line.as_slice() else { return None };
    let kind =
        if notes.get("kind").and_then(Value::as_str) == Some("elevator") { DoorKind::Elevator } else { DoorKind::Room };
    Some(Door {
        id: notes.get("door")?.as_str()?.to_owned(),
        kind,
        from: Point::new(*x0, *y0),
        to: Point::new(*x1, *y1),
        opens: DoorOpens::Always,
        hold_s: 12.0,
        inside: Vec::new(),
    })
}
