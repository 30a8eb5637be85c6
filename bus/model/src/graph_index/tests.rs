//! The index against plain scans over nodes and edges.

use std::collections::BTreeMap;

use super::*;
use crate::graph::SceneGraph;

/// What the graph says when everything is looked for anew, name by name.
struct Scans<'a>(&'a SceneGraph);

impl Scans<'_> {
    fn node(&self, id: &NodeId) -> Option<&GraphNode> {
        self.0.nodes().iter().find(|node| node.id == *id)
    }

    fn edge(&self, a: &NodeId, b: &NodeId) -> Option<&GraphEdge> {
        self.0.edges().iter().find(|edge| edge.from == *a && edge.to == *b || edge.from == *b && edge.to == *a)
    }

    fn neighbors(&self, id: &NodeId) -> Vec<NodeId> {
        let mut found: Vec<NodeId> = Vec::new();
        for edge in self.0.edges() {
            let other = if edge.from == *id { &edge.to } else { &edge.from };
            if (edge.from == *id || edge.to == *id) && !found.contains(other) {
                found.push(other.clone());
            }
        }
        found
    }

    fn classes(&self, id: &NodeId) -> Vec<PlaceClass> {
        let Some(node) = self.node(id) else { return Vec::new() };
        let mut classes = vec![PlaceClass::of_type(&node.kind)];
        if self.neighbors(id).len() >= 3 {
            classes.push(PlaceClass::Intersection);
        }
        let at = |edge: &&GraphEdge| edge.from == *id || edge.to == *id;
        classes.extend(self.0.edges().iter().filter(at).map(|edge| PlaceClass::of_type(&edge.kind)));
        classes.sort();
        classes.dedup();
        classes
    }

    fn edge_length_m(&self, a: &NodeId, b: &NodeId) -> Option<f64> {
        let edge = self.edge(a, b)?;
        let mut via = edge.via.clone();
        if edge.from != *a {
            via.reverse();
        }
        let points: Vec<Point> = [self.node(a)?.at].into_iter().chain(via).chain([self.node(b)?.at]).collect();
        Some(points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum())
    }

    fn shortest(&self, from: &NodeId, to: &NodeId) -> Option<Vec<NodeId>> {
        let mut graph: UnGraph<NodeId, f64> = UnGraph::default();
        let mut index = BTreeMap::new();
        for node in self.0.nodes() {
            index.entry(node.id.clone()).or_insert_with(|| graph.add_node(node.id.clone()));
        }
        for edge in self.0.edges() {
            if let (Some(a), Some(b)) = (index.get(&edge.from), index.get(&edge.to)) {
                graph.add_edge(*a, *b, self.edge_length_m(&edge.from, &edge.to).unwrap_or(0.0));
            }
        }
        let (start, end) = (*index.get(from)?, *index.get(to)?);
        let (_, way) = petgraph::algo::astar(&graph, start, |n| n == end, |edge| *edge.weight(), |_| 0.0)?;
        Some(way.into_iter().map(|n| graph[n].clone()).collect())
    }
}

/// A graph on a lattice, where many ways are of the same length; with names twice, ways twice, loops, and ways to
/// names that no node has.
fn graph(seed: u64) -> SceneGraph {
    let mut state = seed;
    let mut roll = |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let kinds = ["ROOM", "NARROW AISLE", "PASSAGEWAY END", "plain", "ELEVATOR_DOORWAY", "blind corner"];
    let id = |number: u64| NodeId::new(format!("n{}", number * 7919 % 64)).unwrap();
    let mut nodes: Vec<GraphNode> = Vec::new();
    for number in 0..36 {
        let at = Point::new((number % 6) as f64, (number / 6) as f64);
        nodes.push(GraphNode { id: id(number), kind: kinds[roll(6) as usize].into(), at });
    }
    for _ in 0..roll(3) {
        let twice = nodes[roll(36) as usize].clone();
        nodes.push(GraphNode { kind: "GATE".into(), at: Point::new(0.5, 0.5), ..twice });
    }
    let mut edges = Vec::new();
    for _ in 0..90 {
        let from = roll(38);
        let to = match roll(8) {
            0 => roll(40),
            1 => from,
            2..=4 => from + 1,
            _ => from + 6,
        };
        let via = (0..roll(3)).map(|k| Point::new(0.1 * k as f64, 3.3 / (1.0 + from as f64))).collect();
        let via = if roll(4) == 0 { via } else { Vec::new() };
        edges.push(GraphEdge { from: id(from), to: id(to), kind: kinds[roll(6) as usize].into(), via });
    }
    SceneGraph::new(nodes, edges)
}

#[test]
fn every_answer_is_that_of_a_scan_over_nodes_and_edges() {
    let mut ways = 0;
    for seed in 0..12 {
        let graph = graph(seed);
        let scans = Scans(&graph);
        let mut ids: Vec<NodeId> = graph.nodes().iter().map(|node| node.id.clone()).collect();
        ids.extend(graph.edges().iter().flat_map(|edge| [edge.from.clone(), edge.to.clone()]));
        ids.push(NodeId::new("nowhere").unwrap());
        ids.sort();
        ids.dedup();
        for a in &ids {
            assert_eq!(graph.node(a), scans.node(a), "{seed} {a}");
            assert_eq!(graph.neighbors(a), scans.neighbors(a), "{seed} {a}");
            assert_eq!(graph.classes(a), scans.classes(a), "{seed} {a}");
            assert_eq!(graph.kind(a), scans.node(a).map(|node| PlaceClass::of_type(&node.kind)));
            for class in PlaceClass::ALL {
                assert_eq!(graph.node_is(a, class), scans.classes(a).contains(&class), "{seed} {a} {class}");
            }
            for b in &ids {
                assert_eq!(graph.edge(a, b), scans.edge(a, b), "{seed} {a} {b}");
                // To the last bit, in either direction.
                let bits = |length: Option<f64>| length.map(f64::to_bits);
                assert_eq!(bits(graph.edge_length_m(a, b)), bits(scans.edge_length_m(a, b)), "{seed} {a} {b}");
                assert_eq!(graph.shortest(a, b), scans.shortest(a, b), "{seed} {a} {b}");
                ways += usize::from(graph.shortest(a, b).is_some_and(|way| way.len() > 4));
            }
        }
        for (number, node) in graph.nodes().iter().enumerate() {
            assert_eq!(graph.kind_at(number), PlaceClass::of_type(&node.kind));
            assert!(graph.classes(&node.id).iter().all(|class| graph.is_at(number, *class)));
        }
        let parts = graph.parts();
        for a in &ids {
            let of = |id: &NodeId| parts.iter().position(|part| part.contains(id));
            for b in &ids {
                let joined = of(a).is_some() && of(a) == of(b);
                assert_eq!(joined, scans.shortest(a, b).is_some() && scans.node(a).is_some(), "{seed} {a} {b}");
            }
        }
    }
    assert!(ways > 300, "{ways}");
}

#[test]
fn a_graph_too_large_to_keep_its_ways_finds_them_too() {
    let id = |number: usize| NodeId::new(format!("n{number}")).unwrap();
    let last = MAX_KEPT + 20;
    let nodes = (0..=last).map(|n| GraphNode { id: id(n), kind: String::new(), at: Point::new(n as f64, 0.0) });
    let edges = (0..last).map(|n| GraphEdge { from: id(n), to: id(n + 1), kind: String::new(), via: Vec::new() });
    let graph = SceneGraph::new(nodes.collect(), edges.collect());
    let way = graph.shortest(&id(last), &id(0)).unwrap();
    assert!(way.len() == last + 1 && way[1] == id(last - 1), "{}", way.len());
}
