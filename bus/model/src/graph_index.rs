//! What a scene graph is asked again and again, computed once: places by name, ways at each place, classes, lengths,
//! shortest ways.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};
use std::sync::OnceLock;

use petgraph::graph::{NodeIndex, UnGraph};
use petgraph::visit::EdgeRef as _;

use crate::geometry::Point;
use crate::graph::{GraphEdge, GraphNode};
use crate::ids::NodeId;
use crate::place::PlaceClass;

/// Largest graph whose shortest ways are kept, places: all trees together take 4 bytes a pair, so at most 4 MiB.
const MAX_KEPT: usize = 1024;
/// No place: before the root of a tree, and before what cannot be reached.
const NOBODY: u32 = u32::MAX;

/// The index of one graph. A place is a number: that of the first node with its id, or, for an id that only an edge
/// names, a number after the last node.
#[derive(Debug)]
pub(crate) struct Index {
    /// Places in order of their ids.
    by_id: Vec<u32>,
    /// Ids that only edges name, in file order.
    strays: Vec<NodeId>,
    /// Place of each node; another number than its own where an earlier node has the same id.
    place_of: Vec<u32>,
    /// What lies at each place.
    places: Vec<Place>,
    /// Class of each node's own type name.
    kinds: Vec<PlaceClass>,
    /// Length of each edge from `from` to `to` and back, m: sums in the other order may differ in the last bit.
    lengths_m: Vec<[f64; 2]>,
    /// The nodes and ways in file order, as petgraph walks them.
    net: UnGraph<(), f64>,
    /// The tree of shortest ways from each place, made when somebody first asks.
    trees: Vec<OnceLock<Vec<u32>>>,
}

/// One place.
#[derive(Debug, Default)]
struct Place {
    /// Its neighbors in file order, each once, with the first edge to it.
    arms: Vec<(u32, u32)>,
    /// Ids of the neighbors.
    neighbors: Vec<NodeId>,
    /// Classes in order; none for a place that no node has.
    classes: Vec<PlaceClass>,
    /// The same as a set of bits.
    bits: u16,
}

const fn bit(class: PlaceClass) -> u16 {
    1 << class as u16
}

/// A number that fits: a graph has fewer than 2^32 nodes and edges.
fn short(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(NOBODY)
}

impl Index {
    pub(crate) fn of(nodes: &[GraphNode], edges: &[GraphEdge]) -> Self {
        let (by_id, strays, place_of) = names(nodes, edges);
        // A map has a dozen type names.
        let mut classes: BTreeMap<&str, PlaceClass> = BTreeMap::new();
        for kind in nodes.iter().map(|node| &node.kind).chain(edges.iter().map(|edge| &edge.kind)) {
            classes.entry(kind).or_insert_with(|| PlaceClass::of_type(kind));
        }
        let class_of = |kind: &str| classes.get(kind).copied().unwrap_or(PlaceClass::Plain);
        let mut index = Self {
            by_id,
            strays,
            place_of,
            places: Vec::new(),
            kinds: nodes.iter().map(|node| class_of(&node.kind)).collect(),
            lengths_m: Vec::with_capacity(edges.len()),
            net: UnGraph::default(),
            trees: Vec::new(),
        };
        index.places = index.arms(nodes, edges, &class_of);
        let both = |(number, edge): (usize, &GraphEdge)| {
            [(&edge.from, &edge.to), (&edge.to, &edge.from)]
                .map(|(a, b)| index.points(nodes, edges, number, a, b).map_or(0.0, |points| length_m(&points)))
        };
        index.lengths_m = edges.iter().enumerate().map(both).collect();
        index.net = index.net(nodes, edges);
        if nodes.len() <= MAX_KEPT {
            index.trees.resize_with(nodes.len(), OnceLock::new);
        }
        index
    }

    fn arms(&self, nodes: &[GraphNode], edges: &[GraphEdge], class_of: &dyn Fn(&str) -> PlaceClass) -> Vec<Place> {
        let mut places: Vec<Place> = Vec::new();
        places.resize_with(nodes.len() + self.strays.len(), Place::default);
        for (number, edge) in edges.iter().enumerate() {
            let (Some(from), Some(to)) = (self.place(nodes, &edge.from), self.place(nodes, &edge.to)) else { continue };
            let class = bit(class_of(&edge.kind));
            for (place, other, id) in [(from, to, &edge.to), (to, from, &edge.from)] {
                let Some(place) = places.get_mut(place) else { continue };
                place.bits |= class;
                if !place.arms.iter().any(|(known, _)| *known == short(other)) {
                    place.arms.push((short(other), short(number)));
                    place.neighbors.push(id.clone());
                }
            }
        }
        for (number, place) in places.iter_mut().enumerate() {
            let own = self.place_of.get(number).filter(|first| **first == short(number));
            let Some(kind) = own.and_then(|_| self.kinds.get(number)) else {
                // The ways at a place are of no class where no node is.
                place.bits = 0;
                continue;
            };
            place.bits |= bit(*kind);
            if place.arms.len() >= 3 {
                place.bits |= bit(PlaceClass::Intersection);
            }
            place.classes = PlaceClass::ALL.into_iter().filter(|class| place.bits & bit(*class) != 0).collect();
        }
        places
    }

    fn net(&self, nodes: &[GraphNode], edges: &[GraphEdge]) -> UnGraph<(), f64> {
        let mut net = UnGraph::default();
        for _ in nodes {
            net.add_node(());
        }
        for edge in edges {
            let ends = self.place(nodes, &edge.from).zip(self.place(nodes, &edge.to));
            let Some((a, b)) = ends.filter(|(a, b)| *a < nodes.len() && *b < nodes.len()) else { continue };
            let length_m = self.edge_length_m(nodes, edges, &edge.from, &edge.to).unwrap_or(0.0);
            net.add_edge(NodeIndex::new(a), NodeIndex::new(b), length_m);
        }
        net
    }

    /// The place of an id, its own or one that only an edge names.
    fn place(&self, nodes: &[GraphNode], id: &NodeId) -> Option<usize> {
        let at = |place: &u32| name(nodes, &self.strays, *place as usize).map_or(Ordering::Less, |other| other.cmp(id));
        let found = self.by_id.binary_search_by(at).ok()?;
        self.by_id.get(found).map(|place| *place as usize)
    }

    /// Number of the first node with this id.
    pub(crate) fn node(&self, nodes: &[GraphNode], id: &NodeId) -> Option<usize> {
        self.place(nodes, id).filter(|place| *place < nodes.len())
    }

    /// Number of the first edge between two ids, in either direction.
    pub(crate) fn edge(&self, nodes: &[GraphNode], a: &NodeId, b: &NodeId) -> Option<usize> {
        let (a, b) = (self.place(nodes, a)?, self.place(nodes, b)?);
        let arms = &self.places.get(a)?.arms;
        arms.iter().find(|(other, _)| *other as usize == b).map(|(_, edge)| *edge as usize)
    }

    pub(crate) fn neighbors(&self, nodes: &[GraphNode], id: &NodeId) -> &[NodeId] {
        self.place(nodes, id).and_then(|place| self.places.get(place)).map_or(&[], |place| place.neighbors.as_slice())
    }

    /// Classes at a node, by its number.
    pub(crate) fn classes(&self, node: usize) -> &[PlaceClass] {
        self.at(node).map_or(&[], |place| place.classes.as_slice())
    }

    pub(crate) fn is(&self, node: usize, class: PlaceClass) -> bool {
        self.at(node).is_some_and(|place| place.bits & bit(class) != 0)
    }

    pub(crate) fn kind(&self, node: usize) -> Option<PlaceClass> {
        self.kinds.get(node).copied()
    }

    fn at(&self, node: usize) -> Option<&Place> {
        self.place_of.get(node).and_then(|place| self.places.get(*place as usize))
    }

    pub(crate) fn edge_length_m(
        &self,
        nodes: &[GraphNode],
        edges: &[GraphEdge],
        a: &NodeId,
        b: &NodeId,
    ) -> Option<f64> {
        let at = self.edge(nodes, a, b)?;
        (self.node(nodes, a).is_some() && self.node(nodes, b).is_some()).then_some(())?;
        let forth = edges.get(at)?.from == *a;
        self.lengths_m.get(at).map(|[there, back]| if forth { *there } else { *back })
    }

    /// Points of the edge with this number, walked from `a` to `b`, ends included.
    pub(crate) fn points(
        &self,
        nodes: &[GraphNode],
        edges: &[GraphEdge],
        edge: usize,
        a: &NodeId,
        b: &NodeId,
    ) -> Option<Vec<Point>> {
        let edge = edges.get(edge)?;
        let (from, to) = (nodes.get(self.node(nodes, a)?)?.at, nodes.get(self.node(nodes, b)?)?.at);
        let mut points = vec![from];
        if edge.from == *a {
            points.extend(edge.via.iter().copied());
        } else {
            points.extend(edge.via.iter().rev().copied());
        }
        points.push(to);
        Some(points)
    }

    /// Numbers of the nodes on the shortest way between two nodes, both included.
    pub(crate) fn shortest(&self, from: usize, to: usize) -> Option<Vec<usize>> {
        let made;
        let before = match self.trees.get(from) {
            Some(kept) => kept.get_or_init(|| self.tree(from)),
            None => {
                made = self.tree(from);
                &made
            }
        };
        let mut way = vec![to];
        let mut at = to;
        while at != from {
            let next = before.get(at).copied().filter(|next| *next != NOBODY && way.len() < before.len())?;
            at = next as usize;
            way.push(at);
        }
        way.reverse();
        Some(way)
    }

    /// The place before each place on the shortest way to it: petgraph's A* without an estimate and without a goal, so
    /// that of ways of the same length the same one is taken.
    fn tree(&self, from: usize) -> Vec<u32> {
        let mut length_m = vec![f64::INFINITY; self.net.node_count()];
        let mut before = vec![NOBODY; self.net.node_count()];
        if let Some(start) = length_m.get_mut(from) {
            *start = 0.0;
        }
        let mut open = BinaryHeap::from([Nearest(0.0, from)]);
        while let Some(Nearest(gone_m, node)) = open.pop() {
            if length_m.get(node).is_none_or(|known| *known < gone_m) {
                continue;
            }
            for edge in self.net.edges(NodeIndex::new(node)) {
                let (next, total_m) = (edge.target().index(), gone_m + edge.weight());
                if let (Some(known), Some(back)) = (length_m.get_mut(next), before.get_mut(next))
                    && total_m < *known
                {
                    (*known, *back) = (total_m, short(node));
                    open.push(Nearest(total_m, next));
                }
            }
        }
        before
    }

    /// Numbers of the nodes that hang together, part by part in file order of their first nodes.
    pub(crate) fn parts(&self) -> Vec<Vec<usize>> {
        let mut seen = vec![false; self.place_of.len()];
        let mut parts = Vec::new();
        for (start, place) in self.place_of.iter().enumerate() {
            if *place as usize != start || seen.get(start).copied().unwrap_or(true) {
                continue;
            }
            let (mut part, mut open) = (Vec::new(), vec![start]);
            while let Some(node) = open.pop() {
                match seen.get_mut(node) {
                    Some(flag) if !*flag => *flag = true,
                    Some(_) | None => continue,
                }
                part.push(node);
                let arms = self.places.get(node).map_or(&[][..], |place| &place.arms);
                open.extend(arms.iter().map(|(other, _)| *other as usize));
            }
            parts.push(part);
        }
        parts
    }
}

/// The id of a place.
fn name<'a>(nodes: &'a [GraphNode], strays: &'a [NodeId], place: usize) -> Option<&'a NodeId> {
    match place.checked_sub(nodes.len()) {
        None => nodes.get(place).map(|node| &node.id),
        Some(stray) => strays.get(stray),
    }
}

/// Places in order of their ids, the ids that only edges name, and the place of each node.
fn names(nodes: &[GraphNode], edges: &[GraphEdge]) -> (Vec<u32>, Vec<NodeId>, Vec<u32>) {
    let mut first = BTreeMap::new();
    let mut place_of = Vec::with_capacity(nodes.len());
    for (number, node) in nodes.iter().enumerate() {
        place_of.push(*first.entry(&node.id).or_insert_with(|| short(number)));
    }
    let mut strays = Vec::new();
    for id in edges.iter().flat_map(|edge| [&edge.from, &edge.to]) {
        first.entry(id).or_insert_with(|| {
            strays.push(id.clone());
            short(nodes.len() + strays.len() - 1)
        });
    }
    (first.into_values().collect(), strays, place_of)
}

/// Length of a line of points, m.
pub(crate) fn length_m(points: &[Point]) -> f64 {
    points.windows(2).map(|pair| if let [p, q] = pair { (q - p).norm() } else { 0.0 }).sum()
}

/// A place that is reached, m and number; the heap gives the nearest first and knows no order among equals.
struct Nearest(f64, usize);

impl PartialEq for Nearest {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Nearest {}

impl PartialOrd for Nearest {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Nearest {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0)
    }
}

#[cfg(test)]
mod tests;
