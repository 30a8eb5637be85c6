//! A location: grid, scene graph, doors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::Point;
use crate::graph::SceneGraph;
use crate::grid::Grid;
use crate::ids::NodeId;

/// What kind of door it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DoorKind {
    /// A door of a room or corridor.
    Room,
    /// The landing door of an elevator car.
    Elevator,
}

/// What opens a door. An open door closes again after `hold_s` without anybody within 1 m of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DoorOpens {
    /// Stands open for the whole run.
    Always,
    /// Opens at these times of the run, s, as an elevator that comes again and again.
    AtTimes(Vec<f64>),
    /// Opens when anybody comes this near to the middle of the door line, m.
    Near(f64),
    /// Opens when the robot comes this near to the middle of the door line, m.
    RobotNear(f64),
    /// Opens on a named event; `encounter` is raised by the rendezvous controller.
    OnEvent(String),
    /// Never opens.
    Never,
}

/// A door: a wall segment that can open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Door {
    /// Name, unique in the location.
    pub id: String,
    /// Kind of door.
    pub kind: DoorKind,
    /// One end of the door line in the map frame, m.
    #[schemars(with = "[f64; 2]")]
    pub from: Point,
    /// The other end.
    #[schemars(with = "[f64; 2]")]
    pub to: Point,
    /// What opens it.
    pub opens: DoorOpens,
    /// Seconds it stays open with nobody near; default 12.
    #[serde(default = "default_hold_s")]
    pub hold_s: f64,
    /// Nodes behind the door (in the car, in the room). Leaving means crossing away from them.
    #[serde(default)]
    pub inside: Vec<NodeId>,
}

fn default_hold_s() -> f64 {
    12.0
}

impl Door {
    /// Middle of the door line.
    #[must_use]
    pub fn middle(&self) -> Point {
        nalgebra::center(&self.from, &self.to)
    }

    /// Signed distance of a point from the door line, m; positive on the side of `inside_point`.
    #[must_use]
    pub fn depth_m(&self, point: &Point, inside_point: &Point) -> f64 {
        let along = self.to - self.from;
        let length = along.norm();
        if length <= 0.0 {
            return 0.0;
        }
        let side = |p: &Point| along.perp(&(p - self.from)) / length;
        side(point) * side(inside_point).signum()
    }
}

/// A name that people gave to an area: "the pharmacy" for a room that the map only calls a room.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AreaName {
    /// The name as people say it, without an article; letters of any script, blanks allowed.
    pub name: String,
    /// Nodes of the area, the one to go to first.
    pub nodes: Vec<NodeId>,
}

/// A location, whole: everything that a stage needs to know about the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Location {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// Name of the folder.
    pub name: String,
    /// What kind of place it is, in a sentence or two.
    pub description: String,
    /// The map.
    pub grid: Grid,
    /// The scene graph.
    pub graph: SceneGraph,
    /// Doors, closed and open.
    #[serde(default)]
    pub doors: Vec<Door>,
    /// Names that people gave to areas, in file order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<AreaName>,
    /// Things a reader of the folder should know (an edge that had to be routed round a wall …).
    #[serde(default)]
    pub warnings: Vec<String>,
}

impl Location {
    /// The door that has this node behind it, if any.
    #[must_use]
    pub fn door_of(&self, node: &NodeId) -> Option<&Door> {
        self.doors.iter().find(|door| door.inside.contains(node))
    }

    /// The area of this name; case does not matter.
    #[must_use]
    pub fn named(&self, name: &str) -> Option<&AreaName> {
        let wanted = name.trim().to_lowercase();
        self.names.iter().find(|area| area.name.to_lowercase() == wanted)
    }

    /// The door of this name.
    #[must_use]
    pub fn door(&self, id: &str) -> Option<&Door> {
        self.doors.iter().find(|door| door.id == id)
    }
}
