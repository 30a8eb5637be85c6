//! The way between two nodes, and whether a straight line is free.

use serde::Serialize;
use socrates_maps::{Ground, shortest_path};
use socrates_model::{Location, NodeId, Point};

use crate::check::tightest;
use crate::sketch::Spot;

/// Radius with which a way beside the graph is looked for, m: a robot's.
const BODY_M: f64 = 0.3;

/// A way between two nodes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// The nodes along it, both ends included; empty where the graph has no way and the floor has one.
    pub nodes: Vec<NodeId>,
    /// The line, points of the map frame, m.
    #[serde(skip)]
    pub points: Vec<Point>,
    /// Its length, m.
    pub length_m: f64,
    /// The nearest that it comes to a wall, m.
    pub least_m: f64,
}

/// Why there is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoWay {
    /// There is no such node.
    #[error("there is no node `{id}`")]
    NoNode {
        /// The name.
        id: NodeId,
    },
    /// Neither edges nor free floor lead there.
    #[error("no edges lead from `{from}` to `{to}`, and no free floor where a robot of {BODY_M} m radius fits")]
    Apart {
        /// Where from.
        from: NodeId,
        /// Where to.
        to: NodeId,
    },
}

/// The shortest way over the edges of a location; where they lead nowhere, the shortest free way over its floor.
///
/// # Errors
/// [`NoWay`].
pub fn way(location: &Location, from: &NodeId, to: &NodeId) -> Result<Way, NoWay> {
    let node = |id: &NodeId| location.graph.node(id).ok_or_else(|| NoWay::NoNode { id: id.clone() });
    let (start, goal) = (node(from)?, node(to)?);
    let ground = Ground::of(&location.grid);
    let nodes = location.graph.shortest(from, to).unwrap_or_default();
    let points = if nodes.is_empty() {
        shortest_path(&location.grid, ground.field(), &start.at, &goal.at, BODY_M)
            .ok_or_else(|| NoWay::Apart { from: from.clone(), to: to.clone() })?
    } else {
        location.graph.polyline(&nodes)
    };
    let length = |pair: &[Point]| if let [a, b] = pair { (b - a).norm() } else { 0.0 };
    let length_m = points.windows(2).map(length).sum();
    let least_m = tightest(&ground, &points).map_or_else(|| ground.field().clearance(&start.at), |(least, _)| least);
    Ok(Way { nodes, points, length_m, least_m })
}

/// What a straight line between two places of the image meets.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Its length, m.
    pub length_m: f64,
    /// Whether it meets only free floor.
    pub clear: bool,
    /// The nearest that it comes to a wall, m; 0 where it is not clear.
    pub least_m: f64,
}

/// Looks along a straight line.
#[must_use]
pub fn line(location: &Location, from: Spot, to: Spot) -> Line {
    let ground = Ground::of(&location.grid);
    let (a, b) = (from.point(&location.grid), to.point(&location.grid));
    let clear = ground.sight().clear(&a, &b);
    let least_m = tightest(&ground, &[a, b]).filter(|_| clear).map_or(0.0, |(least, _)| least);
    Line { length_m: (b - a).norm(), clear, least_m }
}
