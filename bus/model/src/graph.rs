//! The scene graph: places a person can name, and the ways between them.

use std::collections::BTreeMap;

use petgraph::graph::{NodeIndex, UnGraph};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::Point;
use crate::ids::NodeId;
use crate::place::PlaceClass;

/// A place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GraphNode {
    /// Id as the map spells it.
    pub id: NodeId,
    /// The map's own type name, free text.
    pub kind: String,
    /// Position in the map frame, m: `[x, y]`.
    #[schemars(with = "[f64; 2]")]
    pub at: Point,
}

/// A way between two places.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GraphEdge {
    /// One end.
    pub from: NodeId,
    /// The other end.
    pub to: NodeId,
    /// The map's own type name, free text.
    pub kind: String,
    /// Points between the two ends where the straight line is not free; empty for a straight way.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<[f64; 2]>")]
    pub via: Vec<Point>,
}

/// Nodes and undirected edges over a map.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneGraph {
    /// Places in file order.
    pub nodes: Vec<GraphNode>,
    /// Ways in file order.
    pub edges: Vec<GraphEdge>,
}

impl SceneGraph {
    /// The node of this id.
    #[must_use]
    pub fn node(&self, id: &NodeId) -> Option<&GraphNode> {
        self.nodes.iter().find(|node| node.id == *id)
    }

    /// The edge between two nodes, in either direction.
    #[must_use]
    pub fn edge(&self, a: &NodeId, b: &NodeId) -> Option<&GraphEdge> {
        self.edges.iter().find(|edge| edge.from == *a && edge.to == *b || edge.from == *b && edge.to == *a)
    }

    /// Neighbors of a node, in file order.
    #[must_use]
    pub fn neighbors(&self, id: &NodeId) -> Vec<NodeId> {
        let mut found = Vec::new();
        for edge in &self.edges {
            let other = if edge.from == *id {
                &edge.to
            } else if edge.to == *id {
                &edge.from
            } else {
                continue;
            };
            if !found.contains(other) {
                found.push(other.clone());
            }
        }
        found
    }

    /// Number of ways at a node.
    #[must_use]
    pub fn degree(&self, id: &NodeId) -> usize {
        self.neighbors(id).len()
    }

    /// Whether the node belongs to the class: by its type name, or as an intersection by its degree.
    #[must_use]
    pub fn node_is(&self, id: &NodeId, class: PlaceClass) -> bool {
        self.classes(id).contains(&class)
    }

    /// Classes of a node: of its type name, of the ways at it, and intersection from degree 3 on.
    #[must_use]
    pub fn classes(&self, id: &NodeId) -> Vec<PlaceClass> {
        let Some(node) = self.node(id) else { return Vec::new() };
        let mut classes = vec![PlaceClass::of_type(&node.kind)];
        if self.degree(id) >= 3 {
            classes.push(PlaceClass::Intersection);
        }
        for edge in self.edges.iter().filter(|edge| edge.from == *id || edge.to == *id) {
            classes.push(PlaceClass::of_type(&edge.kind));
        }
        classes.sort();
        classes.dedup();
        classes
    }

    /// Length of an edge along its via points, m.
    #[must_use]
    pub fn edge_length_m(&self, a: &NodeId, b: &NodeId) -> Option<f64> {
        let points = self.edge_points(a, b)?;
        Some(points.windows(2).map(|pair| if let [p, q] = pair { (q - p).norm() } else { 0.0 }).sum())
    }

    /// Points of an edge walked from `a` to `b`, ends included.
    #[must_use]
    pub fn edge_points(&self, a: &NodeId, b: &NodeId) -> Option<Vec<Point>> {
        let edge = self.edge(a, b)?;
        let (from, to) = (self.node(a)?.at, self.node(b)?.at);
        let mut points = vec![from];
        if edge.from == *a {
            points.extend(edge.via.iter().copied());
        } else {
            points.extend(edge.via.iter().rev().copied());
        }
        points.push(to);
        Some(points)
    }

    /// Points of a node sequence, via points included. Pairs without an edge are joined straight.
    #[must_use]
    pub fn polyline(&self, nodes: &[NodeId]) -> Vec<Point> {
        let mut points: Vec<Point> =
            nodes.first().and_then(|id| self.node(id)).map(|node| node.at).into_iter().collect();
        for pair in nodes.windows(2) {
            let [a, b] = pair else { continue };
            if let Some(way) = self.edge_points(a, b) {
                points.extend(way.into_iter().skip(1));
            } else if let Some(node) = self.node(b) {
                points.push(node.at);
            }
        }
        points
    }

    /// Length of a node sequence, m.
    #[must_use]
    pub fn length_m(&self, nodes: &[NodeId]) -> f64 {
        self.polyline(nodes).windows(2).map(|pair| if let [p, q] = pair { (q - p).norm() } else { 0.0 }).sum()
    }

    /// Shortest node sequence between two nodes by length, both ends included.
    #[must_use]
    pub fn shortest(&self, from: &NodeId, to: &NodeId) -> Option<Vec<NodeId>> {
        let (graph, index) = self.petgraph();
        let (start, end) = (*index.get(from)?, *index.get(to)?);
        let (_, way) = petgraph::algo::astar(&graph, start, |n| n == end, |edge| *edge.weight(), |_| 0.0)?;
        Some(way.into_iter().filter_map(|n| graph.node_weight(n).cloned()).collect())
    }

    /// Connected parts, each a sorted list of node ids; one part in a good map.
    #[must_use]
    pub fn parts(&self) -> Vec<Vec<NodeId>> {
        let (graph, index) = self.petgraph();
        let mut parts: Vec<Vec<NodeId>> = Vec::new();
        for node in &self.nodes {
            if parts.iter().any(|part| part.contains(&node.id)) {
                continue;
            }
            let Some(start) = index.get(&node.id) else { continue };
            let mut walk = petgraph::visit::Dfs::new(&graph, *start);
            let mut part = Vec::new();
            while let Some(next) = walk.next(&graph) {
                part.extend(graph.node_weight(next).cloned());
            }
            part.sort();
            parts.push(part);
        }
        parts
    }

    /// The graph in petgraph's own form: weights are ids and lengths in m.
    #[must_use]
    pub fn petgraph(&self) -> (UnGraph<NodeId, f64>, BTreeMap<NodeId, NodeIndex>) {
        let mut graph = UnGraph::default();
        let mut index = BTreeMap::new();
        for node in &self.nodes {
            index.entry(node.id.clone()).or_insert_with(|| graph.add_node(node.id.clone()));
        }
        for edge in &self.edges {
            if let (Some(a), Some(b)) = (index.get(&edge.from), index.get(&edge.to)) {
                let length = self.edge_length_m(&edge.from, &edge.to).unwrap_or(0.0);
                graph.add_edge(*a, *b, length);
            }
        }
        (graph, index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(text: &str) -> NodeId {
        NodeId::new(text).unwrap()
    }

    fn star() -> SceneGraph {
        let node =
            |name: &str, x: f64, y: f64| GraphNode { id: id(name), kind: "SIMPLE NODE".into(), at: Point::new(x, y) };
        let edge = |a: &str, b: &str| GraphEdge { from: id(a), to: id(b), kind: "PASSAGEWAY".into(), via: vec![] };
        SceneGraph {
            nodes: vec![node("c", 0., 0.), node("e", 3., 0.), node("n", 0., 4.), node("w", -2., 0.), node("x", 9., 9.)],
            edges: vec![edge("c", "e"), edge("n", "c"), edge("w", "c")],
        }
    }

    #[test]
    fn a_node_of_degree_three_is_an_intersection_whatever_its_type() {
        assert!(star().node_is(&id("c"), PlaceClass::Intersection));
        assert!(!star().node_is(&id("e"), PlaceClass::Intersection));
    }

    #[test]
    fn shortest_ways_and_lengths_follow_the_edges() {
        let way = star().shortest(&id("e"), &id("n")).unwrap();
        assert_eq!(way, [id("e"), id("c"), id("n")]);
        assert!((star().length_m(&way) - 7.0).abs() < 1e-12);
        assert_eq!(star().parts().len(), 2);
    }
}
