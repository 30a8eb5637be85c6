//! A building as locations, one to a level.

use std::collections::BTreeSet;

use serde_json::{Map, Value};
use socrates_model::{AreaName, Door, DoorKind, DoorOpens, GraphEdge, GraphNode, NodeId, Point};

use crate::graph::{Graph, MOST, PLAIN_EDGE, PLAIN_NODE, Unusable, node_id, segments_meet};
use crate::not_carried::Losses;

use super::floor::{self, Lift};
use super::{BEND, KIND, NAMES, TYPE};

/// Scale where a level has no measurement, m per pixel: what RMF takes.
const PIXEL_M: f64 = 0.05;

/// A building that was read.
#[derive(Debug, Clone)]
pub struct Building {
    /// Name of the building.
    pub name: String,
    levels: Vec<(String, Map<String, Value>)>,
    lifts: Map<String, Value>,
    pixels: bool,
}

/// A level as a map, and what stands on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Floor {
    /// The map, drawn of floors, walls and lifts.
    pub grid: socrates_model::Grid,
    /// Nodes and ways of its lanes; empty where it has none.
    pub graph: Graph,
}

impl Building {
    /// Reads a `building.yaml`.
    ///
    /// # Errors
    /// No YAML, no levels, or a coordinate system that is not on a plane.
    pub fn read(text: &str) -> Result<Self, Unusable> {
        let value: Value = yaml_serde::from_str(text).map_err(|why| {
            let at = why.location().map_or_else(|| "building".to_owned(), |at| format!("line {}", at.line()));
            Unusable::new(at, format!("is no YAML: {why}"), "give a building.yaml of Open-RMF")
        })?;
        let system = value.get("coordinate_system").and_then(Value::as_str).unwrap_or("reference_image");
        if !["reference_image", "cartesian_meters"].contains(&system) {
            let hint = "read are `reference_image` and `cartesian_meters`; the traffic editor converts others";
            return Err(Unusable::new("coordinate_system", format!("is `{system}`"), hint));
        }
        let levels = value.get("levels").and_then(Value::as_object).filter(|levels| !levels.is_empty());
        let levels =
            levels.ok_or_else(|| Unusable::new("levels", "there is none", "a building has at least one level"))?;
        let level = |(name, level): (&String, &Value)| Some((name.clone(), level.as_object()?.clone()));
        Ok(Self {
            name: value.get("name").and_then(Value::as_str).unwrap_or("building").to_owned(),
            levels: levels.iter().filter_map(level).collect(),
            lifts: value.get("lifts").and_then(Value::as_object).cloned().unwrap_or_default(),
            pixels: system == "reference_image",
        })
    }

    /// Names of the levels, by name.
    #[must_use]
    pub fn levels(&self) -> Vec<&str> {
        self.levels.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// A level as a map with its graph, and what of it is not held.
    ///
    /// # Errors
    /// No such level, a vertex, wall, lane or door that cannot be, or a level without floor or larger than a map may be.
    pub fn level(&self, name: &str) -> Result<(Floor, Losses), Unusable> {
        let found = self.levels.iter().find(|(other, _)| other == name);
        let (_, level) = found.ok_or_else(|| {
            Unusable::new(
                "levels",
                format!("there is no `{name}`"),
                format!("levels of the building: {}", self.levels().join(", ")),
            )
        })?;
        let mut losses = Losses::default();
        let mut reading = Reading { at: format!("levels.{name}"), level, points: Vec::new(), losses: &mut losses };
        reading.points = reading.vertices(self.pixels)?;
        let lifts = self.lifts_of(name, &mut reading);
        let doors = reading.doors(&lifts)?;
        let graph = reading.graph(doors, &lifts)?;
        let (walls, floors) = (reading.walls()?, reading.floors()?);
        for (key, why) in LEFT {
            for (place, _) in reading.list(key)?.iter().enumerate() {
                reading.losses.note(key, format!("levels.{name}.{key}[{place}]"), why);
            }
        }
        let seeds: Vec<Point> = graph.nodes.iter().map(|node| node.at).collect();
        let grid = floor::drawn(&reading.at, &floors, &walls, &lifts, &seeds)?;
        let graph = if graph.edges.is_empty() { graph } else { graph.largest_part(&mut losses) };
        Ok((Floor { grid, graph }, losses))
    }

    /// Lifts that have a door on this level: where a vertex says which cabin stands there, else where the lift itself says.
    fn lifts_of(&self, level: &str, reading: &mut Reading<'_>) -> Vec<Lift> {
        let mut out = Vec::new();
        for (name, lift) in &self.lifts {
            let doors = lift.get("level_doors").and_then(|doors| doors.get(level)).and_then(Value::as_array);
            let Some(doors) = doors.filter(|doors| !doors.is_empty()) else { continue };
            let real = |key: &str| lift.get(key).and_then(Value::as_f64);
            let here = lift.get("reference_floor_name").and_then(Value::as_str).is_none_or(|floor| floor == level);
            let middle = reading.cabin(name).or_else(|| {
                let (x, y) = (real("x")?, real("y")?);
                here.then(|| reading.place(x, y, self.pixels))
            });
            let sizes = real("width").zip(real("depth"));
            let (Some(middle), Some((width_m, depth_m))) = (middle, sizes) else {
                reading.losses.note("lifts", format!("lifts.{name}"), "nothing says where it stands on this level");
                continue;
            };
            let all = lift.get("doors").and_then(Value::as_object);
            let door = |(id, door): (&String, &Value)| {
                let value = |key: &str| door.get(key).and_then(Value::as_f64);
                let used = doors.iter().any(|used| used.as_str() == Some(id.as_str()));
                let turn = value("motion_axis_orientation").unwrap_or(0.0);
                used.then_some((Point::new(value("x")?, value("y")?), value("width")?, turn))
            };
            let doors = all.into_iter().flatten().filter_map(door).collect();
            let sound = (0.5..=20.0).contains(&width_m) && (0.5..=20.0).contains(&depth_m);
            if sound {
                out.push(Lift { name: name.clone(), middle, yaw: real("yaw").unwrap_or(0.0), width_m, depth_m, doors });
            } else {
                reading.losses.note("lifts", format!("lifts.{name}"), "a cabin is 0.5 to 20 m a side");
            }
        }
        out
    }
}

/// Lists of a level that a location has no place for.
const LEFT: [(&str, &str); 4] = [
    ("models", "furniture and robots are not drawn into the map"),
    ("fiducials", "levels are locations of their own"),
    ("features", "pictures are not read"),
    ("constraints", "pictures are not read"),
];

struct Reading<'a> {
    at: String,
    level: &'a Map<String, Value>,
    /// Places of the vertices, map frame, m.
    points: Vec<Point>,
    losses: &'a mut Losses,
}

/// A wall, lane or door: both vertices, and its parameters.
type Span<'v> = (usize, usize, Option<&'v Map<String, Value>>);

/// The value of a parameter.
fn parameter<'v>(parameters: Option<&'v Map<String, Value>>, key: &str) -> Option<&'v Value> {
    parameters?.get(key)?.as_array()?.get(1)
}

fn text<'v>(parameters: Option<&'v Map<String, Value>>, key: &str) -> Option<&'v str> {
    parameter(parameters, key).and_then(Value::as_str).filter(|text| !text.is_empty())
}

impl<'a> Reading<'a> {
    fn list(&self, key: &str) -> Result<&'a [Value], Unusable> {
        let items = match self.level.get(key) {
            None | Some(Value::Null) => &[],
            Some(Value::Array(items)) => items.as_slice(),
            Some(_) => return Err(Unusable::new(format!("{}.{key}", self.at), "is no list", "it is a list of lists")),
        };
        if items.len() > MOST {
            let problem = format!("has {} elements; allowed: {MOST}", items.len());
            return Err(Unusable::new(format!("{}.{key}", self.at), problem, "cut the level into parts"));
        }
        Ok(items)
    }

    fn spans(&self, key: &str) -> Result<Vec<Span<'a>>, Unusable> {
        let vertices = self.list("vertices")?.len();
        let span = |(place, value): (usize, &'a Value)| {
            let parts = value.as_array().map(Vec::as_slice).unwrap_or_default();
            let end = |at: usize| {
                let number = parts.get(at).and_then(Value::as_u64).and_then(|number| usize::try_from(number).ok());
                number.filter(|number| *number < vertices).ok_or_else(|| {
                    let found = parts.get(at).unwrap_or(&Value::Null);
                    let hint = format!("vertices are numbered from 0 to {}", vertices.saturating_sub(1));
                    Unusable::new(format!("{}.{key}[{place}]", self.at), format!("`{found}` is no vertex"), hint)
                })
            };
            Ok((end(0)?, end(1)?, parts.get(2).and_then(Value::as_object)))
        };
        self.list(key)?.iter().enumerate().map(span).collect()
    }

    /// Meters of a pixel.
    fn scale(&self, pixels: bool, raw: &[(f64, f64)]) -> Result<f64, Unusable> {
        if !pixels {
            return Ok(1.0);
        }
        let mut scales = Vec::new();
        for (from, to, parameters) in self.spans("measurements")? {
            let ends = raw.get(from).zip(raw.get(to));
            let length = ends.map_or(0.0, |(a, b)| (b.0 - a.0).hypot(b.1 - a.1));
            let told = parameter(parameters, "distance").and_then(Value::as_f64).unwrap_or(0.0);
            if length > 0.0 && told > 0.0 {
                scales.push(told / length);
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "a file has few measurements")]
        let count = scales.len() as f64;
        Ok(if scales.is_empty() { PIXEL_M } else { scales.iter().sum::<f64>() / count })
    }

    fn vertices(&mut self, pixels: bool) -> Result<Vec<Point>, Unusable> {
        let items = self.list("vertices")?;
        let mut raw = Vec::new();
        for (place, item) in items.iter().enumerate() {
            let numbers: Vec<f64> = item.as_array().into_iter().flatten().take(2).filter_map(Value::as_f64).collect();
            match numbers.as_slice() {
                [x, y] if x.abs() < 1e7 && y.abs() < 1e7 => raw.push((*x, *y)),
                _ => {
                    let hint = "a vertex is [x, y, z, name, parameters]";
                    return Err(Unusable::new(format!("{}.vertices[{place}]", self.at), format!("is `{item}`"), hint));
                }
            }
        }
        let scale = self.scale(pixels, &raw)?;
        let up = if pixels { -scale } else { scale };
        if pixels && self.list("measurements")?.is_empty() {
            self.losses.note(
                "scale",
                format!("{}.measurements", self.at),
                "there is none; a pixel was taken to be 0.05 m",
            );
        }
        Ok(raw.into_iter().map(|(x, y)| Point::new(x * scale, y * up)).collect())
    }

    /// A place of a lift, in the units of the level.
    fn place(&self, x: f64, y: f64, pixels: bool) -> Point {
        let raw: Vec<(f64, f64)> = self
            .list("vertices")
            .unwrap_or_default()
            .iter()
            .map(|item| {
                let real = |at: usize| item.get(at).and_then(Value::as_f64).unwrap_or(0.0);
                (real(0), real(1))
            })
            .collect();
        let scale = self.scale(pixels, &raw).unwrap_or(PIXEL_M);
        Point::new(x * scale, if pixels { -y * scale } else { y * scale })
    }

    fn parameters(&self, vertex: usize) -> Option<&'a Map<String, Value>> {
        self.level.get("vertices")?.get(vertex)?.get(4)?.as_object()
    }

    fn name(&self, vertex: usize) -> &'a str {
        let name = self.level.get("vertices").and_then(|all| all.get(vertex)).and_then(|item| item.get(3));
        name.and_then(Value::as_str).unwrap_or_default()
    }

    fn point(&self, vertex: usize) -> Point {
        self.points.get(vertex).copied().unwrap_or_else(Point::origin)
    }

    /// Where the vertex lies that says that this cabin stands there.
    fn cabin(&self, lift: &str) -> Option<Point> {
        let vertex =
            (0..self.points.len()).find(|vertex| text(self.parameters(*vertex), "lift_cabin") == Some(lift))?;
        Some(self.point(vertex))
    }

    fn doors(&mut self, lifts: &[Lift]) -> Result<Vec<Door>, Unusable> {
        let mut out: Vec<Door> = Vec::new();
        for (place, (from, to, parameters)) in self.spans("doors")?.into_iter().enumerate() {
            let kind = if text(parameters, KIND) == Some("elevator") { DoorKind::Elevator } else { DoorKind::Room };
            let id = text(parameters, "name").map_or_else(|| format!("door_{place}"), str::to_owned);
            let id = if out.iter().any(|door| door.id == id) { format!("{id}_{place}") } else { id };
            out.push(door(id, kind, (self.point(from), self.point(to))));
        }
        for lift in lifts {
            for (place, ends) in lift.door_lines().into_iter().enumerate() {
                let id = if place == 0 { lift.name.clone() } else { format!("{}_{place}", lift.name) };
                out.push(door(id, DoorKind::Elevator, ends));
            }
        }
        Ok(out)
    }

    fn walls(&self) -> Result<Vec<(Point, Point)>, Unusable> {
        Ok(self.spans("walls")?.into_iter().map(|(from, to, _)| (self.point(from), self.point(to))).collect())
    }

    fn floors(&self) -> Result<Vec<Vec<Point>>, Unusable> {
        let corner =
            |value: &Value| value.as_u64().and_then(|number| self.points.get(usize::try_from(number).ok()?)).copied();
        let polygon = |floor: &Value| -> Vec<Point> {
            floor.get("vertices").and_then(Value::as_array).into_iter().flatten().filter_map(corner).collect()
        };
        Ok(self.list("floors")?.iter().map(polygon).filter(|corners| corners.len() >= 3).collect())
    }

    fn graph(&mut self, doors: Vec<Door>, lifts: &[Lift]) -> Result<Graph, Unusable> {
        let lanes = self.spans("lanes")?;
        let mut graph = Graph { doors, ..Graph::default() };
        let bend =
            |reading: &Self, vertex: usize| parameter(reading.parameters(vertex), BEND) == Some(&Value::Bool(true));
        let used: BTreeSet<usize> = lanes.iter().flat_map(|(from, to, _)| [*from, *to]).collect();
        let mut taken: BTreeSet<NodeId> = BTreeSet::new();
        let mut ids: Vec<Option<NodeId>> = vec![None; self.points.len()];
        let places: Vec<usize> = used.into_iter().filter(|vertex| !bend(self, *vertex)).collect();
        for vertex in places {
            let node = self.node(vertex, lifts, &mut graph, &mut taken)?;
            if let Some(slot) = ids.get_mut(vertex) {
                *slot = Some(node.id.clone());
            }
            graph.nodes.push(node);
        }
        let mut joined = BTreeSet::new();
        for (first, lane) in lanes.iter().enumerate() {
            let (from, to, parameters) = *lane;
            let Some(start) = ids.get(from).cloned().flatten() else { continue };
            // A lane that ends at a bend goes on with the lanes behind it.
            let (mut via, mut end, mut next) = (Vec::new(), to, first + 1);
            while bend(self, end) {
                via.push(self.point(end));
                let Some((_, on, _)) = lanes.get(next).filter(|(from, _, _)| *from == end) else { break };
                (end, next) = (*on, next + 1);
            }
            let Some(end) = ids.get(end).cloned().flatten().filter(|end| *end != start) else { continue };
            if parameter(parameters, "bidirectional") == Some(&Value::Bool(false)) {
                self.losses.note(
                    "one-way lanes",
                    format!("{}.lanes[{first}]", self.at),
                    "ways of a scene graph lead both ways",
                );
            }
            for key in ["speed_limit", "orientation", "mutex"] {
                let said = parameter(parameters, key);
                let says =
                    said.is_some_and(|said| said.as_f64().map_or_else(|| said.as_str() != Some(""), |real| real > 0.0));
                if says {
                    self.losses.note(
                        "parameters of lanes",
                        format!("{}.lanes[{first}]: {key}", self.at),
                        "a way has a type alone",
                    );
                }
            }
            let kind = match text(parameters, TYPE) {
                Some(kind) => kind.to_owned(),
                None => way_type(&graph, &(self.point(from), self.point(to))),
            };
            graph.join(GraphEdge { from: start, to: end, kind, via }, &mut joined);
        }
        Ok(graph)
    }

    /// The node of a vertex, with the names that it brings.
    fn node(
        &mut self,
        vertex: usize,
        lifts: &[Lift],
        graph: &mut Graph,
        taken: &mut BTreeSet<NodeId>,
    ) -> Result<GraphNode, Unusable> {
        let (name, parameters, at) = (self.name(vertex), self.parameters(vertex), self.point(vertex));
        let id = node_id(name, &format!("v{vertex}"), taken)?;
        taken.insert(id.clone());
        let ours = text(parameters, TYPE);
        let names: Vec<&str> = match (text(parameters, NAMES), ours) {
            (Some(names), _) => names.lines().collect(),
            // The name of a place of theirs is what people call it, spelled as no id can be.
            (None, None) if !name.trim().is_empty() => vec![name.trim()],
            (None, _) => Vec::new(),
        };
        for name in names {
            match graph.names.iter_mut().find(|area| area.name.to_lowercase() == name.to_lowercase()) {
                Some(area) => area.nodes.push(id.clone()),
                None => graph.names.push(AreaName { name: name.to_owned(), nodes: vec![id.clone()] }),
            }
        }
        let cabin = lifts.iter().find(|lift| lift.holds(&at));
        let kind = match (ours, cabin) {
            (Some(kind), _) => kind.to_owned(),
            (None, Some(lift)) => format!("WITHIN ELEVATOR {}", lift.name),
            (None, None) if parameter(parameters, "is_charger") == Some(&Value::Bool(true)) => {
                "CHARGING AREA".to_owned()
            }
            (None, None) => PLAIN_NODE.to_owned(),
        };
        if let Some(lift) = cabin {
            graph.doors.iter_mut().filter(|door| door.id == lift.name).for_each(|door| door.inside.push(id.clone()));
        }
        let known = [TYPE, NAMES, BEND, "is_charger", "lift_cabin"];
        for key in parameters.into_iter().flat_map(Map::keys).filter(|key| !known.contains(&key.as_str())) {
            self.losses.note(
                "parameters of vertices",
                format!("{}.vertices[{vertex}]: {key}", self.at),
                "a node has a type alone",
            );
        }
        Ok(GraphNode { id, kind, at })
    }
}

fn door(id: String, kind: DoorKind, (from, to): (Point, Point)) -> Door {
    Door { id, kind, from, to, opens: DoorOpens::Always, hold_s: 12.0, inside: Vec::new() }
}

/// The type of a way whose lane says nothing: what it crosses.
fn way_type(graph: &Graph, (a, b): &(Point, Point)) -> String {
    let crossed = graph.doors.iter().find(|door| segments_meet((a, b), (&door.from, &door.to)));
    match crossed.map(|door| door.kind) {
        Some(DoorKind::Elevator) => "ELEVATOR DOORWAY".to_owned(),
        Some(DoorKind::Room) => "DOORWAY".to_owned(),
        None => PLAIN_EDGE.to_owned(),
    }
}
