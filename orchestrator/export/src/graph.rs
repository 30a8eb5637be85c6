//! A graph as formats carry it: in the map frame, with names and doors, without a map.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::{AreaName, Door, GraphEdge, GraphNode, Location, NodeId, Point};

use crate::not_carried::Losses;

/// Type of a node whose file says nothing of it.
pub(crate) const PLAIN_NODE: &str = "SIMPLE NODE";
/// Type of an edge whose file says nothing of it.
pub(crate) const PLAIN_EDGE: &str = "SIMPLE EDGE";
/// At most so many nodes and edges of a file are read.
pub(crate) const MOST: usize = 100_000;

/// What was read of a file of another tool.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Graph {
    /// Places in file order.
    pub nodes: Vec<GraphNode>,
    /// Ways in file order; each pair of nodes once.
    pub edges: Vec<GraphEdge>,
    /// Names of areas.
    pub names: Vec<AreaName>,
    /// Doors; they stand open where the file has no rule for them.
    pub doors: Vec<Door>,
}

/// A file of another tool that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{at}: {problem}")]
pub struct Unusable {
    /// Where in the file: a path of keys, or a line.
    pub at: String,
    /// What is wrong there, with the value.
    pub problem: String,
    /// What to do about it.
    pub hint: String,
}

impl Unusable {
    pub(crate) fn new(at: impl Into<String>, problem: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { at: at.into(), problem: problem.into(), hint: hint.into() }
    }
}

impl Graph {
    /// Leaves what does not hang together with the largest part behind: a location is one part.
    pub(crate) fn largest_part(mut self, losses: &mut Losses) -> Self {
        let mut beside: BTreeMap<&NodeId, Vec<&NodeId>> = BTreeMap::new();
        for edge in &self.edges {
            beside.entry(&edge.from).or_default().push(&edge.to);
            beside.entry(&edge.to).or_default().push(&edge.from);
        }
        let mut seen: BTreeSet<&NodeId> = BTreeSet::new();
        let mut largest: BTreeSet<NodeId> = BTreeSet::new();
        for node in &self.nodes {
            let mut part: BTreeSet<NodeId> = BTreeSet::new();
            let mut open = vec![&node.id];
            while let Some(id) = open.pop() {
                if seen.insert(id) {
                    part.insert(id.clone());
                    open.extend(beside.get(id).into_iter().flatten());
                }
            }
            if part.len() > largest.len() {
                largest = part;
            }
        }
        for node in self.nodes.iter().filter(|node| !largest.contains(&node.id)) {
            losses.note(
                "nodes that hang together with nothing",
                node.id.as_str(),
                "the scene graph is one part; the largest was kept",
            );
        }
        self.nodes.retain(|node| largest.contains(&node.id));
        self.edges.retain(|edge| largest.contains(&edge.from));
        for area in &mut self.names {
            area.nodes.retain(|id| largest.contains(id));
        }
        self.names.retain(|area| !area.nodes.is_empty());
        self
    }

    /// Adds an edge, or says that a way between the two is there already.
    pub(crate) fn join(&mut self, edge: GraphEdge, taken: &mut BTreeSet<(NodeId, NodeId)>) -> bool {
        let pair = if edge.from < edge.to {
            (edge.from.clone(), edge.to.clone())
        } else {
            (edge.to.clone(), edge.from.clone())
        };
        let fresh = taken.insert(pair);
        if fresh {
            self.edges.push(edge);
        }
        fresh
    }
}

/// A node id made of a text that people wrote: blanks and quotes become `_`, and a number is added where it is taken.
///
/// # Errors
/// Where no id can be made of the text, which no text of a file is known to do.
pub(crate) fn node_id(text: &str, or: &str, taken: &BTreeSet<NodeId>) -> Result<NodeId, Unusable> {
    let fit = |c: char| if c.is_control() || c.is_whitespace() || matches!(c, '"' | '`') { '_' } else { c };
    let spelled: String = text.trim().chars().map(fit).take(56).collect();
    let stem = if spelled.is_empty() { or.to_owned() } else { spelled };
    let tries = std::iter::once(stem.clone()).chain((2..=MOST + 1).map(|number| format!("{stem}_{number}")));
    let mut free = tries.filter_map(|text| NodeId::new(text).ok()).filter(|id| !taken.contains(id));
    free.next().ok_or_else(|| Unusable::new("nodes", format!("`{stem}` makes no id"), "give the node another name"))
}

/// Doors of a location whose line an edge crosses, by the place of the edge.
pub(crate) fn crossed<'a>(location: &'a Location, edge: &GraphEdge) -> Vec<&'a Door> {
    let points = location.graph.edge_points(&edge.from, &edge.to).unwrap_or_default();
    let crosses = |door: &Door| {
        points.windows(2).any(|pair| matches!(pair, [a, b] if segments_meet((a, b), (&door.from, &door.to))))
    };
    location.doors.iter().filter(|door| crosses(door)).collect()
}

/// Whether two line segments share a point.
pub(crate) fn segments_meet((a, b): (&Point, &Point), (c, d): (&Point, &Point)) -> bool {
    let side = |p: &Point, q: &Point, r: &Point| (q - p).perp(&(r - p));
    let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    !apart(side(a, b, c), side(a, b, d)) && !apart(side(c, d, a), side(c, d, b))
}

/// A length or coordinate to a millionth of a meter, without a negative zero, so that the same place gives the same bytes.
pub(crate) fn micro(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// What of a door's rule a format without rules leaves behind.
pub(crate) fn door_rule(door: &Door, losses: &mut Losses) {
    if door.opens != socrates_model::DoorOpens::Always {
        losses.note(
            "door rules",
            format!("location.toml door `{}`: opens, hold_s", door.id),
            "the format has no rule for when a door opens; the door stands open when it is read back",
        );
    }
    if !door.inside.is_empty() {
        losses.note(
            "sides of doors",
            format!("location.toml door `{}`: inside", door.id),
            "the format does not say which side of a door is inside",
        );
    }
}
