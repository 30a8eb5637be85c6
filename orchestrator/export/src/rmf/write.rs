//! A location as a building of one level.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};
use socrates_model::{Cell, DoorKind, Location, NodeId, Point};

use crate::graph::{crossed, door_rule, micro};
use crate::not_carried::Losses;
use crate::outline::{STRAIGHT, outlines, placed};

use super::{BEND, KIND, LEVEL, NAMES, TYPE};

/// The value of a parameter, written with the number of its type.
enum Value {
    Text(String),
    Integer(i64),
    Real(f64),
    Truth(bool),
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Text(text) => (1, text).serialize(serializer),
            Self::Integer(number) => (2, number).serialize(serializer),
            Self::Real(number) => (3, number).serialize(serializer),
            Self::Truth(truth) => (4, truth).serialize(serializer),
        }
    }
}

type Parameters = BTreeMap<&'static str, Value>;
type Vertex = (f64, f64, f64, String, Parameters);
type Line = (usize, usize, Parameters);

#[derive(Serialize)]
struct Building<'a> {
    name: &'a str,
    coordinate_system: &'static str,
    graphs: BTreeMap<u8, ()>,
    levels: BTreeMap<&'static str, Level>,
    lifts: BTreeMap<String, ()>,
}

#[derive(Serialize, Default)]
struct Level {
    elevation: f64,
    vertices: Vec<Vertex>,
    walls: Vec<Line>,
    lanes: Vec<Line>,
    doors: Vec<Line>,
    floors: Vec<Floor>,
    measurements: Vec<Line>,
    models: Vec<()>,
    fiducials: Vec<()>,
}

#[derive(Serialize)]
struct Floor {
    parameters: Parameters,
    vertices: Vec<usize>,
}

impl Level {
    fn vertex(&mut self, at: &Point, name: &str, parameters: Parameters) -> usize {
        self.vertices.push((micro(at.x), micro(at.y), 0.0, name.to_owned(), parameters));
        self.vertices.len() - 1
    }
}

/// The text of a `building.yaml` with one level `L1`, in meters, with what it does not hold.
///
/// Vertices of lanes carry ids as their names; types and names of areas stand in parameters of our own, which other programs skip.
/// Walls are the outlines of the free floor.
#[must_use]
pub fn write(location: &Location) -> (String, Losses) {
    let mut losses = Losses::default();
    let mut level = Level::default();
    lanes(location, &mut level);
    for door in &location.doors {
        let ends = (level.vertex(&door.from, "", Parameters::new()), level.vertex(&door.to, "", Parameters::new()));
        let (kind, form) = match door.kind {
            DoorKind::Room => ("room", "hinged"),
            DoorKind::Elevator => ("elevator", "double_sliding"),
        };
        let text = |text: &str| Value::Text(text.to_owned());
        let parameters = Parameters::from([
            ("motion_axis", text("start")),
            ("motion_degrees", Value::Real(90.0)),
            ("motion_direction", Value::Integer(1)),
            ("name", text(&door.id)),
            ("plugin", text("normal")),
            ("right_left_ratio", Value::Real(1.0)),
            (KIND, text(kind)),
            ("type", text(form)),
        ]);
        level.doors.push((ends.0, ends.1, parameters));
        door_rule(door, &mut losses);
        if door.kind == DoorKind::Elevator {
            losses.note(
                "lifts",
                format!("location.toml door `{}`", door.id),
                "the landing door is written as a door; the file says of no lift which floors it serves",
            );
        }
        if !location.graph.edges().iter().any(|edge| crossed(location, edge).iter().any(|other| other.id == door.id)) {
            losses.note(
                "lanes through doors",
                format!("location.toml door `{}`", door.id),
                "no way of the graph crosses it",
            );
        }
    }
    walls(location, &mut level);
    if !location.description.is_empty() {
        losses.note("description", "location.toml: description", "a building has a name alone");
    }
    losses.note(
        "map",
        "map.yaml and its image",
        "walls are the outlines of the free floor; what is unknown and what is occupied look the same",
    );
    let building = Building {
        name: &location.name,
        coordinate_system: "cartesian_meters",
        graphs: BTreeMap::new(),
        levels: BTreeMap::from([(LEVEL, level)]),
        lifts: BTreeMap::new(),
    };
    (yaml_serde::to_string(&building).unwrap_or_else(|why| why.to_string()), losses)
}

fn lanes(location: &Location, level: &mut Level) {
    let names_of = |id: &NodeId| {
        let names = location.names.iter().filter(|area| area.nodes.contains(id));
        names.map(|area| area.name.as_str()).collect::<Vec<_>>().join("\n")
    };
    for node in location.graph.nodes() {
        let mut parameters = Parameters::from([(TYPE, Value::Text(node.kind.clone()))]);
        let names = names_of(&node.id);
        if !names.is_empty() {
            parameters.insert(NAMES, Value::Text(names));
        }
        level.vertex(&node.at, node.id.as_str(), parameters);
    }
    for edge in location.graph.edges() {
        let Some((from, to)) = location.graph.position(&edge.from).zip(location.graph.position(&edge.to)) else {
            continue;
        };
        let mut ends = vec![from];
        for bend in &edge.via {
            ends.push(level.vertex(bend, "", Parameters::from([(BEND, Value::Truth(true))])));
        }
        ends.push(to);
        for pair in ends.windows(2) {
            let [from, to] = pair else { continue };
            let parameters = Parameters::from([
                ("bidirectional", Value::Truth(true)),
                ("graph_idx", Value::Integer(0)),
                ("orientation", Value::Text(String::new())),
                (TYPE, Value::Text(edge.kind.clone())),
            ]);
            level.lanes.push((*from, *to, parameters));
        }
    }
}

fn walls(location: &Location, level: &mut Level) {
    let grid = &location.grid;
    let text = |text: &str| Value::Text(text.to_owned());
    for line in outlines(grid.width, grid.height, STRAIGHT, |column, row| grid.at(column, row) == Cell::Free) {
        let corners: Vec<usize> =
            line.iter().map(|corner| level.vertex(&placed(grid, *corner), "", Parameters::new())).collect();
        for (place, from) in corners.iter().enumerate() {
            let Some(to) = corners.get((place + 1) % corners.len()) else { continue };
            let parameters = Parameters::from([("alpha", Value::Real(1.0)), ("texture_name", text("default"))]);
            level.walls.push((*from, *to, parameters));
        }
    }
    let known = |column: usize, row: usize| grid.at(column, row) != Cell::Unknown;
    // Outer outlines alone turn the same way as the first; holes of unknown floor are bounded by their walls.
    for line in outlines(grid.width, grid.height, STRAIGHT, known).into_iter().filter(|line| turns_right(line)) {
        let vertices = line.iter().map(|corner| level.vertex(&placed(grid, *corner), "", Parameters::new())).collect();
        let parameters = Parameters::from([
            ("texture_name", text("default")),
            ("texture_rotation", Value::Real(0.0)),
            ("texture_scale", Value::Real(1.0)),
        ]);
        level.floors.push(Floor { parameters, vertices });
    }
}

/// Whether a closed outline has its inside within.
#[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
fn turns_right(line: &[(usize, usize)]) -> bool {
    let next = line.iter().cycle().skip(1);
    let area: f64 = line.iter().zip(next).map(|(a, b)| a.0 as f64 * b.1 as f64 - b.0 as f64 * a.1 as f64).sum();
    area > 0.0
}
