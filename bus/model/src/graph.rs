//! The scene graph: places a person can name, and the ways between them.

use std::fmt;
use std::sync::{Arc, OnceLock};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::Point;
use crate::graph_index::{Index, length_m};
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
///
/// A graph never changes: [`SceneGraph::edited`] makes another one. What it is asked again and again (nodes by name,
/// neighbors, classes, lengths, shortest ways) is therefore computed once, at the first question, and clones share it.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneGraph {
    /// Places in file order.
    nodes: Vec<GraphNode>,
    /// Ways in file order.
    edges: Vec<GraphEdge>,
    #[serde(skip)]
    index: Kept,
}

/// The index of a graph once it was asked something; says nothing that nodes and edges do not say.
#[derive(Clone, Default)]
struct Kept(Arc<OnceLock<Index>>);

impl PartialEq for Kept {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl fmt::Debug for SceneGraph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SceneGraph").field("nodes", &self.nodes).field("edges", &self.edges).finish()
    }
}

impl SceneGraph {
    /// The graph of these nodes and edges, in this order.
    #[must_use]
    pub fn new(nodes: Vec<GraphNode>, edges: Vec<GraphEdge>) -> Self {
        Self { nodes, edges, index: Kept::default() }
    }

    /// Another graph: this one with changed nodes or edges.
    #[must_use]
    pub fn edited(&self, edit: impl FnOnce(&mut Vec<GraphNode>, &mut Vec<GraphEdge>)) -> Self {
        let (mut nodes, mut edges) = (self.nodes.clone(), self.edges.clone());
        edit(&mut nodes, &mut edges);
        Self::new(nodes, edges)
    }

    /// Places in file order.
    #[must_use]
    pub fn nodes(&self) -> &[GraphNode] {
        &self.nodes
    }

    /// Ways in file order.
    #[must_use]
    pub fn edges(&self) -> &[GraphEdge] {
        &self.edges
    }

    fn index(&self) -> &Index {
        self.index.0.get_or_init(|| Index::of(&self.nodes, &self.edges))
    }

    /// Place of a node in [`SceneGraph::nodes`].
    #[must_use]
    pub fn position(&self, id: &NodeId) -> Option<usize> {
        self.index().node(&self.nodes, id)
    }

    /// The node of this id.
    #[must_use]
    pub fn node(&self, id: &NodeId) -> Option<&GraphNode> {
        self.nodes.get(self.position(id)?)
    }

    /// The edge between two nodes, in either direction.
    #[must_use]
    pub fn edge(&self, a: &NodeId, b: &NodeId) -> Option<&GraphEdge> {
        self.edges.get(self.index().edge(&self.nodes, a, b)?)
    }

    /// Neighbors of a node, in file order.
    #[must_use]
    pub fn neighbors(&self, id: &NodeId) -> &[NodeId] {
        self.index().neighbors(&self.nodes, id)
    }

    /// Number of ways at a node.
    #[must_use]
    pub fn degree(&self, id: &NodeId) -> usize {
        self.neighbors(id).len()
    }

    /// Whether the node belongs to the class: by its type name, or as an intersection by its degree.
    #[must_use]
    pub fn node_is(&self, id: &NodeId, class: PlaceClass) -> bool {
        self.position(id).is_some_and(|node| self.is_at(node, class))
    }

    /// The same by the node's place in [`SceneGraph::nodes`].
    #[must_use]
    pub fn is_at(&self, node: usize, class: PlaceClass) -> bool {
        self.index().is(node, class)
    }

    /// Classes of a node: of its type name, of the ways at it, and intersection from degree 3 on.
    #[must_use]
    pub fn classes(&self, id: &NodeId) -> &[PlaceClass] {
        self.position(id).map_or(&[], |node| self.index().classes(node))
    }

    /// Class of a node's own type name, by its place in [`SceneGraph::nodes`]; plain where there is no such node.
    #[must_use]
    pub fn kind_at(&self, node: usize) -> PlaceClass {
        self.index().kind(node).unwrap_or(PlaceClass::Plain)
    }

    /// Class of a node's own type name.
    #[must_use]
    pub fn kind(&self, id: &NodeId) -> Option<PlaceClass> {
        self.index().kind(self.position(id)?)
    }

    /// Length of an edge along its via points, m.
    #[must_use]
    pub fn edge_length_m(&self, a: &NodeId, b: &NodeId) -> Option<f64> {
        self.index().edge_length_m(&self.nodes, &self.edges, a, b)
    }

    /// Points of an edge walked from `a` to `b`, ends included.
    #[must_use]
    pub fn edge_points(&self, a: &NodeId, b: &NodeId) -> Option<Vec<Point>> {
        let edge = self.index().edge(&self.nodes, a, b)?;
        self.index().points(&self.nodes, &self.edges, edge, a, b)
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
        length_m(&self.polyline(nodes))
    }

    /// Shortest node sequence between two nodes by length, both ends included.
    #[must_use]
    pub fn shortest(&self, from: &NodeId, to: &NodeId) -> Option<Vec<NodeId>> {
        let way = self.index().shortest(self.position(from)?, self.position(to)?)?;
        Some(way.into_iter().filter_map(|node| self.nodes.get(node)).map(|node| node.id.clone()).collect())
    }

    /// Connected parts, each a sorted list of node ids; one part in a good map.
    #[must_use]
    pub fn parts(&self) -> Vec<Vec<NodeId>> {
        let named = |part: Vec<usize>| {
            let mut ids: Vec<NodeId> =
                part.into_iter().filter_map(|node| self.nodes.get(node)).map(|node| node.id.clone()).collect();
            ids.sort();
            ids
        };
        self.index().parts().into_iter().map(named).collect()
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
        SceneGraph::new(
            vec![node("c", 0., 0.), node("e", 3., 0.), node("n", 0., 4.), node("w", -2., 0.), node("x", 9., 9.)],
            vec![edge("c", "e"), edge("n", "c"), edge("w", "c")],
        )
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

    #[test]
    fn an_edited_graph_is_another_one_and_clones_share_their_answers() {
        let graph = star();
        let way = graph.shortest(&id("e"), &id("n"));
        assert_eq!(graph.clone(), graph);
        assert!(Arc::ptr_eq(&graph.clone().index.0, &graph.index.0));
        let longer = graph.edited(|nodes, edges| {
            nodes.push(GraphNode { id: id("m"), kind: "ROOM".into(), at: Point::new(0.1, 0.1) });
            edges.retain(|edge| edge.from != id("c"));
            for (a, b) in [("e", "m"), ("m", "n")] {
                edges.push(GraphEdge { from: id(a), to: id(b), kind: "DOOR".into(), via: vec![] });
            }
        });
        assert_eq!(longer.shortest(&id("e"), &id("n")), Some(vec![id("e"), id("m"), id("n")]));
        assert_eq!((longer.degree(&id("c")), graph.degree(&id("c"))), (2, 3));
        assert_eq!(graph.shortest(&id("e"), &id("n")), way);
        assert_ne!(longer, graph);
    }

    #[test]
    fn the_written_form_is_nodes_and_edges_alone() {
        let graph = star();
        let before = serde_json::to_string(&graph).unwrap();
        assert!(graph.node_is(&id("c"), PlaceClass::Intersection));
        assert_eq!(serde_json::to_string(&graph).unwrap(), before);
        assert!(before.starts_with(r#"{"nodes":[{"id":"c","kind":"SIMPLE NODE","at":[0.0,0.0]}"#), "{before}");
        assert_eq!(serde_json::from_str::<SceneGraph>(&before).unwrap(), graph);
        let more = before.replacen('{', r#"{"index":null,"#, 1);
        assert!(serde_json::from_str::<SceneGraph>(&more).unwrap_err().to_string().contains("unknown field `index`"));
    }
}
