//! Rooms and elevator cars by geometry: what is inside of them, and through which openings they are left and entered.
//!
//! ```text
//! doors of location.toml ─┐
//! doorway nodes ──────────┼─► gates: lines from wall to wall ─► free floor between closed gates ─► Enclosure
//! edges out of a room ────┘
//! ```
//!
//! A node is inside where a door names it, or where its type is that of a room or a car. The gates of such nodes are closed and the
//! free floor is filled from the nodes: what the floor reaches is one place, whatever its nodes are called, so that two cars of
//! one type are two places and several nodes of a room are one. Floor that runs on to the other side of a gate is no enclosed
//! place: it is listed as open plan, with the reason.

mod chords;
mod find;
mod flood;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use socrates_model::{Door, DoorKind, DoorOpens, Location, NodeId, Point, SceneGraph, Vector};

use crate::ground::{Ground, Kept};
use crate::layer::{Layer, Raster};

/// What an opening lies on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Across {
    /// A door of `location.toml`, by its id.
    Door(String),
    /// A node whose type is a doorway.
    Node(NodeId),
    /// The edge between a node inside and a node outside.
    Edge(NodeId, NodeId),
}

/// A line from wall to wall through which a place is left and entered.
#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    /// One end in the map frame, m.
    pub from: Point,
    /// The other end.
    pub to: Point,
    /// Unit vector across the line, into the place.
    pub inward: Vector,
    /// Free width, m: the length of the line.
    pub width_m: f64,
    /// What it lies on.
    pub across: Across,
}

impl Opening {
    /// Middle of the line.
    #[must_use]
    pub fn middle(&self) -> Point {
        self.from + (self.to - self.from) / 2.0
    }

    /// Signed distance of a point from the line, m; positive on the inner side.
    #[must_use]
    pub fn depth_m(&self, point: &Point) -> f64 {
        (point - self.from).dot(&self.inward)
    }

    /// Id of the door that `location.toml` declares here, if it does.
    #[must_use]
    pub fn door(&self) -> Option<&str> {
        if let Across::Door(id) = &self.across { Some(id) } else { None }
    }

    /// What the opening is called: the id of its door or node, or its two nodes with a dash.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.across {
            Across::Door(id) => id.clone(),
            Across::Node(node) => node.to_string(),
            Across::Edge(inner, outer) => format!("{inner}-{outer}"),
        }
    }
}

/// A room or an elevator car.
#[derive(Debug, Clone, PartialEq)]
pub struct Enclosure {
    /// Id of its first declared door, else of its first node; unique in the location.
    pub id: String,
    /// Room or car.
    pub kind: DoorKind,
    /// Its nodes in file order.
    pub nodes: Vec<NodeId>,
    /// Its openings: declared doors in file order, then doorway nodes and edges. At least one.
    pub openings: Vec<Opening>,
    /// Whether walls and the closed openings bound its floor. Where they do not, declared doors name its nodes, and the lines of
    /// those doors alone tell what is inside.
    pub walled: bool,
}

impl Enclosure {
    /// Whether a node lies in it.
    #[must_use]
    pub fn holds(&self, node: &NodeId) -> bool {
        self.nodes.contains(node)
    }

    /// The openings by which the place is left, one for each way out: of doors that lie one behind the other, a landing door and
    /// the door of its car, the first.
    #[must_use]
    pub fn ways_out(&self) -> Vec<&Opening> {
        let mut found: Vec<&Opening> = Vec::new();
        for opening in &self.openings {
            let behind = |other: &&Opening| {
                other.inward.dot(&opening.inward) > 0.9 && (other.middle() - opening.middle()).norm() <= GATE_M
            };
            if !found.iter().any(behind) {
                found.push(opening);
            }
        }
        found
    }

    /// The opening nearest to a point.
    #[must_use]
    pub fn nearest(&self, at: &Point) -> Option<&Opening> {
        let far = |opening: &Opening| socrates_model::geometry::nearest_on_segment(at, &opening.from, &opening.to).0;
        self.openings.iter().min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// An opening as a door: the declared one, else one that always stands open, called after the opening.
    #[must_use]
    pub fn door(&self, opening: &Opening, location: &Location) -> Door {
        let declared = opening.door().and_then(|id| location.door(id));
        declared.cloned().unwrap_or_else(|| Door {
            id: opening.name(),
            kind: self.kind,
            from: opening.from,
            to: opening.to,
            opens: DoorOpens::Always,
            hold_s: 0.0,
            inside: self.nodes.clone(),
        })
    }
}

/// Why nodes that are inside by their type lie in no enclosed place.
#[derive(Debug, Clone, PartialEq)]
pub enum OpenPlan {
    /// No edge leads out of it.
    NoWayOut,
    /// No wall stands on both sides of the edge, within 2.5 m, that would be an opening there.
    NoWalls {
        /// The node inside.
        from: NodeId,
        /// The node outside.
        to: NodeId,
    },
    /// The free floor runs on round the narrowest place of the edge.
    FloorRunsOn {
        /// The node inside.
        from: NodeId,
        /// The node outside.
        to: NodeId,
        /// Width of that place, m.
        width_m: f64,
    },
    /// The node is not on free floor.
    InWall,
}

impl fmt::Display for OpenPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoWayOut => write!(f, "no edge leads out of it"),
            Self::NoWalls { from, to } => write!(f, "no walls bound an opening between `{from}` and `{to}`"),
            Self::FloorRunsOn { from, to, width_m } => write!(
                f,
                "the free floor runs on round the narrowest place between `{from}` and `{to}`, {width_m:.1} m wide"
            ),
            Self::InWall => write!(f, "it is not on free floor"),
        }
    }
}

/// Scene graphs of one map whose rooms and cars are kept.
const MAX_GRAPHS: usize = 4;

/// Rooms and cars of a graph and doors.
type Entry = (SceneGraph, Vec<Door>, Arc<Enclosures>);

/// Those of the last few graphs of each kept map, the newest last.
static SHELVES: Kept<Mutex<VecDeque<Entry>>> = Kept::new();

/// The rooms and cars of a location.
#[derive(Debug, Clone)]
pub struct Enclosures {
    places: Vec<Enclosure>,
    open: Vec<(Vec<NodeId>, OpenPlan)>,
    of_node: BTreeMap<NodeId, usize>,
    raster: Raster,
    /// Number of the place of each cell, from 1; 0 is outside.
    floor: Layer<u16>,
}

impl Enclosures {
    /// Those of a location; computed once for each location of the same map, graph and doors, as long as it is kept.
    #[must_use]
    pub fn of(location: &Location) -> Arc<Self> {
        let shelf = SHELVES.of(&location.grid, |_| Mutex::default());
        let lock = || shelf.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |(graph, doors, _): &&Entry| *graph == location.graph && *doors == location.doors;
        let known = lock().iter().find(same).map(|(.., made)| Arc::clone(made));
        known.unwrap_or_else(|| {
            // Not under the lock: others have other graphs.
            let made = Arc::new(Self::new(location, Ground::of(&location.grid).field()));
            let mut kept = lock();
            while kept.len() >= MAX_GRAPHS {
                kept.pop_front();
            }
            kept.push_back((location.graph.clone(), location.doors.clone(), Arc::clone(&made)));
            made
        })
    }

    /// Every room and car, in the order of their first nodes.
    #[must_use]
    pub fn all(&self) -> &[Enclosure] {
        &self.places
    }

    /// Nodes that are inside by their type but lie in no enclosed place, and why.
    #[must_use]
    pub fn open_plan(&self) -> &[(Vec<NodeId>, OpenPlan)] {
        &self.open
    }

    /// The place of a node.
    #[must_use]
    pub fn of_node(&self, node: &NodeId) -> Option<&Enclosure> {
        self.places.get(*self.of_node.get(node)?)
    }

    /// Whether a node is inside of a place.
    #[must_use]
    pub fn is_inside(&self, node: &NodeId) -> bool {
        self.of_node.contains_key(node)
    }

    /// Whether a node is in an elevator car.
    #[must_use]
    pub fn is_car(&self, node: &NodeId) -> bool {
        self.of_node(node).is_some_and(|place| place.kind == DoorKind::Elevator)
    }

    /// Whether two nodes lie in the same place.
    #[must_use]
    pub fn same(&self, a: &NodeId, b: &NodeId) -> bool {
        self.of_node.get(a).is_some_and(|place| self.of_node.get(b) == Some(place))
    }

    /// Whether a point lies on the floor of a place, or between that floor and one of its lines that was moved outward to keep
    /// a node inside.
    #[must_use]
    pub fn holds(&self, place: &Enclosure, point: &Point) -> bool {
        if !place.walled {
            return place.openings.iter().all(|opening| opening.depth_m(point) > 0.0);
        }
        let (px, py) = self.raster.pixel(point);
        let label = self.raster.cell(px, py).and_then(|(column, row)| self.floor.get(column, row)).unwrap_or(0);
        let own = usize::from(label).checked_sub(1).and_then(|number| self.places.get(number));
        match own {
            Some(own) => std::ptr::eq(own, place) || own.id == place.id,
            None => place.openings.iter().any(|opening| {
                let along = opening.to - opening.from;
                let share = (point - opening.from).dot(&along) / along.norm_squared().max(1e-9);
                (0.0..=THRESHOLD_M).contains(&opening.depth_m(point)) && (0.0..=1.0).contains(&share)
            }),
        }
    }

    /// Free floor of a place, m²; of one that no walls bound, nothing is known.
    #[must_use]
    pub fn floor_m2(&self, place: &Enclosure) -> Option<f64> {
        let number = self.places.iter().position(|other| other.id == place.id)?;
        let own = self.floor.values.iter().filter(|label| usize::from(**label) == number + 1).count();
        let cell_m = self.raster.resolution_m;
        #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells")]
        place.walled.then_some(own as f64 * cell_m * cell_m)
    }

    /// Ids of the declared doors of the place of a node; none where it lies outside.
    pub fn doors_of(&self, node: &NodeId) -> impl Iterator<Item = &str> {
        self.of_node(node).into_iter().flat_map(|place| &place.openings).filter_map(Opening::door)
    }

    /// The opening through which a way first leads out of the place that it begins in.
    #[must_use]
    pub fn way_out(&self, location: &Location, way: &[NodeId]) -> Option<(&Enclosure, &Opening)> {
        let place = self.of_node(way.first()?)?;
        let inside = way.iter().take_while(|node| place.holds(node)).count();
        // The last node inside, and what comes next: a doorway node lies on the line, so one node on.
        let leg = way.get(inside.checked_sub(1)?..way.len().min(inside + 2))?;
        let points = location.graph.polyline(leg);
        let crossed = place.openings.iter().find(|opening| {
            points.windows(2).any(|pair| {
                matches!(pair, [a, b] if socrates_model::geometry::segments_cross(a, b, &opening.from, &opening.to))
            })
        });
        let last = way.get(inside.checked_sub(1)?).and_then(|id| location.graph.node(id))?;
        crossed.or_else(|| place.nearest(&last.at)).map(|opening| (place, opening))
    }

    /// The doors of a location and, for every opening without one, a door that always stands open.
    #[must_use]
    pub fn doors(&self, location: &Location) -> Vec<Door> {
        let mut doors = location.doors.clone();
        for place in &self.places {
            for opening in place.openings.iter().filter(|opening| opening.door().is_none()) {
                let door = place.door(opening, location);
                // The opening between two rooms is one.
                let near = |a: &Point, b: &Point| (a - b).norm() < SAME_M;
                let known = |known: &Door| {
                    near(&known.from, &door.from) && near(&known.to, &door.to)
                        || near(&known.from, &door.to) && near(&known.to, &door.from)
                };
                if !doors.iter().any(known) {
                    doors.push(door);
                }
            }
        }
        doors
    }
}

/// Ends of two lines that are nearer to each other than this are the same, m.
const SAME_M: f64 = 0.2;
/// Two doors of a place that lie one behind the other, a landing door and the door of its car, are at most so far apart, m.
const GATE_M: f64 = 1.0;
/// Largest distance between the walls of an opening and its line where that was moved outward, m.
const THRESHOLD_M: f64 = 0.6;
