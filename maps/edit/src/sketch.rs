//! What is drawn on a map: nodes, edges, doors, and the sentence about the place.

use serde::{Deserialize, Serialize};
use socrates_maps::{EXTRA, GRAPH, written};
use socrates_model::{AreaName, DoorKind, DoorOpens, GraphEdge, GraphNode, Grid, Location, NodeId, Point, SceneGraph};

/// Positions that differ by less than this are one, pixels.
const SAME_PX: f64 = 1e-6;
/// Decimals of a position in a file, at most: a thousandth of a pixel.
const DECIMALS: usize = 3;

/// A place on the image, pixels from its top left corner, y downward; `[x, y]` in JSON.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Spot {
    /// To the right.
    pub x: f64,
    /// Down.
    pub y: f64,
}

impl From<[f64; 2]> for Spot {
    fn from([x, y]: [f64; 2]) -> Self {
        Self { x, y }
    }
}

impl From<Spot> for [f64; 2] {
    fn from(spot: Spot) -> Self {
        [spot.x, spot.y]
    }
}

impl Spot {
    /// The place of a point of the map frame. What is a whole pixel but for rounding is one.
    #[must_use]
    pub fn of(grid: &Grid, point: &Point) -> Self {
        let (x, y) = grid.pixel_from_world(point);
        let tidy = |value: f64| {
            let near = libm::round(value * 1000.0) / 1000.0;
            if (near - value).abs() < SAME_PX { near } else { value }
        };
        Self { x: tidy(x), y: tidy(y) }
    }

    /// The point in the map frame, m.
    #[must_use]
    pub fn point(self, grid: &Grid) -> Point {
        grid.world_from_pixel(self.x, self.y)
    }
}

/// A node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// Its name, unique among the nodes.
    pub id: NodeId,
    /// Kind of place, as it is written in the file.
    pub kind: String,
    /// Where.
    pub at: Spot,
}

/// An edge; it has no direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edge {
    /// One end.
    pub from: NodeId,
    /// The other end.
    pub to: NodeId,
    /// Kind of way, as it is written in the file.
    pub kind: String,
}

impl Edge {
    /// Whether it joins these two, in either order.
    #[must_use]
    pub fn joins(&self, a: &NodeId, b: &NodeId) -> bool {
        (&self.from, &self.to) == (a, b) || (&self.from, &self.to) == (b, a)
    }
}

/// A door.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Door {
    /// Its name, unique among the doors.
    pub id: String,
    /// Of a room, or the landing door of an elevator.
    pub kind: DoorKind,
    /// One end of its line.
    pub from: Spot,
    /// The other end.
    pub to: Spot,
    /// What opens it.
    pub opens: DoorOpens,
    /// Seconds it stays open with nobody near.
    pub hold_s: f64,
    /// Nodes behind it.
    pub inside: Vec<NodeId>,
}

/// Everything that is drawn, in the order of the files.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sketch {
    /// A sentence or two about the place.
    pub description: String,
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Edges.
    pub edges: Vec<Edge>,
    /// Doors.
    pub doors: Vec<Door>,
    /// Names of areas, with their nodes; they go with these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<AreaName>,
}

impl Sketch {
    /// What is drawn in a location. Points through which an edge was led round a wall are left out: they are found anew.
    #[must_use]
    pub fn of(location: &Location) -> Self {
        let grid = &location.grid;
        let node =
            |node: &GraphNode| Node { id: node.id.clone(), kind: node.kind.clone(), at: Spot::of(grid, &node.at) };
        let edge = |edge: &GraphEdge| Edge { from: edge.from.clone(), to: edge.to.clone(), kind: edge.kind.clone() };
        let door = |door: &socrates_model::Door| Door {
            id: door.id.clone(),
            kind: door.kind,
            from: Spot::of(grid, &door.from),
            to: Spot::of(grid, &door.to),
            opens: door.opens.clone(),
            hold_s: door.hold_s,
            inside: door.inside.clone(),
        };
        Self {
            description: location.description.clone(),
            nodes: location.graph.nodes().iter().map(node).collect(),
            edges: location.graph.edges().iter().map(edge).collect(),
            doors: location.doors.iter().map(door).collect(),
            names: location.names.clone(),
        }
    }

    /// Puts it into a location in place of what was drawn there; edges are straight.
    pub fn put_into(&self, location: &mut Location) {
        let grid = &location.grid;
        let node = |node: &Node| GraphNode { id: node.id.clone(), kind: node.kind.clone(), at: node.at.point(grid) };
        let edge = |edge: &Edge| GraphEdge {
            from: edge.from.clone(),
            to: edge.to.clone(),
            kind: edge.kind.clone(),
            via: Vec::new(),
        };
        let graph = SceneGraph::new(self.nodes.iter().map(node).collect(), self.edges.iter().map(edge).collect());
        let doors = self.doors.iter().map(|door| door.in_map(grid)).collect();
        location.graph = graph;
        location.doors = doors;
        location.names.clone_from(&self.names);
        location.description.clone_from(&self.description);
        location.warnings.clear();
    }

    /// The node of this id.
    #[must_use]
    pub fn node(&self, id: &NodeId) -> Option<&Node> {
        self.nodes.iter().find(|node| &node.id == id)
    }

    /// The edge between two nodes, in either order.
    #[must_use]
    pub fn edge(&self, a: &NodeId, b: &NodeId) -> Option<&Edge> {
        self.edges.iter().find(|edge| edge.joins(a, b))
    }

    /// The door of this id.
    #[must_use]
    pub fn door(&self, id: &str) -> Option<&Door> {
        self.doors.iter().find(|door| door.id == id)
    }

    /// The files of a location folder that hold it, by name: `scene_graph.json` and `location.toml`.
    ///
    /// Positions of nodes have as many decimals as one of them needs, at most three; coordinates of doors are those of the map frame to
    /// the micrometer. A sketch that was read from files of ours gives the same bytes.
    #[must_use]
    pub fn files(&self, grid: &Grid) -> [(&'static str, String); 2] {
        let nodes = self.nodes.iter().map(|node| (node.id.as_str(), node.kind.as_str(), (node.at.x, node.at.y)));
        let links = self.edges.iter().map(|edge| (edge.kind.as_str(), edge.from.as_str(), edge.to.as_str()));
        let doors: Vec<socrates_model::Door> = self.doors.iter().map(|door| door.in_map(grid)).collect();
        // Adding 0 makes the zero that has a sign one that has none.
        let tidy = |value: f64| libm::round(value * 1e6) / 1e6 + 0.0;
        let at = |point: &Point| format!("[{:?}, {:?}]", tidy(point.x), tidy(point.y));
        [
            (GRAPH, written::graph_json(nodes, links, self.decimals())),
            (EXTRA, written::location_toml(&self.description, &doors, at) + &written::names_toml(&self.names)),
        ]
    }

    /// The fewest decimals with which every node stays where it is.
    fn decimals(&self) -> usize {
        let keeps = |decimals: usize| {
            let scale = (0..decimals).fold(1.0, |scale, _| scale * 10.0);
            let whole = |value: f64| (libm::round(value * scale) / scale - value).abs() < SAME_PX;
            self.nodes.iter().all(|node| whole(node.at.x) && whole(node.at.y))
        };
        (0..DECIMALS).find(|decimals| keeps(*decimals)).unwrap_or(DECIMALS)
    }
}

impl Door {
    /// The door in the map frame.
    #[must_use]
    pub fn in_map(&self, grid: &Grid) -> socrates_model::Door {
        socrates_model::Door {
            id: self.id.clone(),
            kind: self.kind,
            from: self.from.point(grid),
            to: self.to.point(grid),
            opens: self.opens.clone(),
            hold_s: self.hold_s,
            inside: self.inside.clone(),
        }
    }
}
