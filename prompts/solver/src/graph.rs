//! The scene graph by index: nodes, what joins them, and shortest ways round what is barred.

use std::cell::RefCell;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::rc::Rc;
use std::sync::Arc;

use socrates_maps::openings::Enclosures;
use socrates_model::{HumanId, Location, NodeId, PlaceClass, Point};

use crate::cost::{FARTHEST, WEIGHTS};
use crate::measure::SHORTEST_M;
use crate::passable::{Closed, floor_m};
use crate::{Problem, meant, named_way, passable};

/// Half the width of floor that people get through, m: their radius of 0.28 m, and what keeps them off walls. In the simulation
/// they come through 0.65 m and stay before 0.6 m.
const PERSON_M: f64 = 0.32;

/// The scene graph by index.
pub(crate) struct Net<'a> {
    pub(crate) location: &'a Location,
    /// Radius of the disc that gets through every edge that is left, m; 0 where all are.
    pub(crate) radius_m: f64,
    ids: Vec<NodeId>,
    at: Vec<Point>,
    near: Vec<Vec<(usize, f64)>>,
    inside: Vec<bool>,
    /// The rooms and cars.
    pub(crate) enclosures: Arc<Enclosures>,
    /// How far each node is from the places where the robot's task begins and ends by name, m; empty without such places.
    start_m: Vec<f64>,
    goal_m: Vec<f64>,
    /// Length of the shortest way between the two, m; infinite where one of them is left open.
    between_m: f64,
    /// The rooms that people come out of by name.
    rooms: BTreeMap<HumanId, Vec<usize>>,
    /// The places by name where people's ways end.
    ends: BTreeMap<HumanId, Vec<usize>>,
    /// Nodes by name of which the robot's way has to lead past one; empty where it has not.
    pub(crate) past: Vec<usize>,
    /// The places where people meet the robot elsewhere than at the place of the proposal.
    pub(crate) elsewhere: BTreeMap<HumanId, Vec<usize>>,
    /// Edges that nobody gets through.
    closed: Vec<Closed>,
    /// Shortest ways from nodes, nothing barred, as they were asked for.
    trees: RefCell<BTreeMap<usize, Rc<Tree>>>,
}

/// Shortest ways from one node to all others.
pub(crate) struct Tree {
    from: usize,
    length_m: Vec<f64>,
    before: Vec<usize>,
}

impl<'a> Net<'a> {
    /// The graph of a problem, with the places that its task names.
    pub(crate) fn of(problem: &Problem<'a>) -> Self {
        let avoided = named_way::avoided(problem.proposal);
        let of = |radius_m: f64| {
            let mut net = Self::passable(problem.location, radius_m);
            net.keep_out(&avoided);
            net.with_ends(&problem.starts, &problem.goals)
        };
        // Nobody is met where only the robot gets through, unless its task leads there.
        let (own, wide) = (of(problem.radius_m), of(problem.radius_m.max(PERSON_M)));
        let net = if wide.serves(&own, problem) { wide } else { own };
        let index = |ids: &Vec<NodeId>| ids.iter().filter_map(|id| net.index(id)).collect();
        let indexed =
            |all: &BTreeMap<HumanId, Vec<NodeId>>| all.iter().map(|(human, ids)| (*human, index(ids))).collect();
        let (rooms, ends) = (indexed(&problem.rooms), indexed(&problem.ends));
        let past = named_way::via(problem.proposal).iter().filter_map(|id| net.index(id)).collect();
        let elsewhere = meant::elsewhere(&net, problem.proposal);
        Self { rooms, ends, past, elsewhere, ..net }
    }

    /// Whether edges are closed here and not there, and the task can be done without them.
    fn serves(&self, other: &Self, problem: &Problem<'_>) -> bool {
        let open = |ids: &[NodeId]| {
            let mut nodes = ids.iter().filter_map(|id| self.index(id));
            ids.is_empty() || nodes.any(|node| !self.near(node).is_empty())
        };
        let joined = problem.starts.is_empty() || problem.goals.is_empty() || self.between_m.is_finite();
        let closes_more = self.closed.len() > other.closed.len();
        let long = || self.longest(SHORTEST_M).0 >= SHORTEST_M;
        closes_more && joined && open(&problem.starts) && open(&problem.goals) && long()
    }

    /// The graph of a map without the edges that a disc of this radius does not get through.
    pub(crate) fn passable(location: &'a Location, radius_m: f64) -> Self {
        let mut net = Self { radius_m, ..Self::new(location) };
        net.close(passable::closed(location, radius_m));
        net
    }

    pub(crate) fn new(location: &'a Location) -> Self {
        let graph = &location.graph;
        let ids: Vec<NodeId> = graph.nodes().iter().map(|node| node.id.clone()).collect();
        let mut near = vec![Vec::new(); ids.len()];
        for edge in graph.edges() {
            let (Some(a), Some(b)) = (graph.position(&edge.from), graph.position(&edge.to)) else { continue };
            let length = graph.edge_length_m(&edge.from, &edge.to).unwrap_or(0.0);
            for (one, other) in [(a, b), (b, a)] {
                if let Some(list) = near.get_mut(one) {
                    list.push((other, length));
                }
            }
        }
        let enclosures = Enclosures::of(location);
        let inside = ids.iter().map(|id| enclosures.is_inside(id)).collect();
        Self {
            location,
            radius_m: 0.0,
            at: graph.nodes().iter().map(|node| node.at).collect(),
            ids,
            near,
            inside,
            enclosures,
            start_m: Vec::new(),
            goal_m: Vec::new(),
            between_m: f64::INFINITY,
            rooms: BTreeMap::new(),
            ends: BTreeMap::new(),
            past: Vec::new(),
            elsewhere: BTreeMap::new(),
            closed: Vec::new(),
            trees: RefCell::default(),
        }
    }

    /// Takes the edges of nodes out that the robot is to keep out of.
    fn keep_out(&mut self, nodes: &[NodeId]) {
        let barred: Vec<usize> = nodes.iter().filter_map(|id| self.index(id)).collect();
        for (node, list) in self.near.iter_mut().enumerate() {
            list.retain(|(next, _)| !barred.contains(&node) && !barred.contains(next));
        }
    }

    /// Takes edges out that nobody gets through.
    fn close(&mut self, closed: Vec<Closed>) {
        for edge in &closed {
            let [a, b] = &edge.between;
            let (Some(a), Some(b)) = (self.index(a), self.index(b)) else { continue };
            for (one, other) in [(a, b), (b, a)] {
                if let Some(list) = self.near.get_mut(one) {
                    list.retain(|(node, _)| *node != other);
                }
            }
        }
        self.closed = closed;
    }

    /// Length and ends of the longest way outside of rooms, m; the first that is long enough ends the search.
    pub(crate) fn longest(&self, enough_m: f64) -> (f64, Option<(usize, usize)>) {
        self.longest_past(enough_m, &|_| false)
    }

    /// The same round nodes that are barred.
    pub(crate) fn longest_past(&self, enough_m: f64, barred: &dyn Fn(usize) -> bool) -> (f64, Option<(usize, usize)>) {
        let open = |node: &usize| !self.inside(*node) && self.kind(*node) != PlaceClass::Doorway && !barred(*node);
        let nodes: Vec<usize> = (0..self.len()).filter(open).collect();
        let mut longest: Option<(f64, usize, usize)> = None;
        for from in &nodes {
            let tree = self.tree(*from, barred);
            for to in &nodes {
                let length_m = tree.length_m(*to);
                if length_m.is_finite() && longest.is_none_or(|(most, ..)| length_m > most) {
                    longest = Some((length_m, *from, *to));
                }
            }
            if longest.is_some_and(|(most, ..)| most >= enough_m) {
                break;
            }
        }
        longest.map_or((0.0, None), |(length_m, from, to)| (length_m, Some((from, to))))
    }

    /// Edges that nobody gets through.
    pub(crate) fn closed(&self) -> &[Closed] {
        &self.closed
    }

    /// Whether a way of the graph is at most [`FARTHEST`] times as long as the shortest way of a disc on the floor.
    pub(crate) fn is_short_on_grid(&self, nodes: &[usize], radius_m: f64) -> bool {
        let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else { return true };
        let (from, to) = (self.at(*first), self.at(*last));
        let short = |shortest_m: f64| self.length_m(nodes) <= FARTHEST * shortest_m;
        // No way on the floor is shorter than the straight line, which costs nothing to know.
        short((to - from).norm()) || floor_m(self.location, &from, &to, radius_m).is_none_or(short)
    }

    /// Shortest ways from a node over all others.
    pub(crate) fn ways_from(&self, from: usize) -> Rc<Tree> {
        let known = self.trees.borrow().get(&from).map(Rc::clone);
        known.unwrap_or_else(|| {
            let made = Rc::new(self.tree(from, &|_| false));
            self.trees.borrow_mut().insert(from, Rc::clone(&made));
            made
        })
    }

    /// Length of the shortest way between two nodes, past a node of the class where one is given, m; infinite where there is none.
    pub(crate) fn shortest_m(&self, from: usize, to: usize, via: Option<PlaceClass>) -> f64 {
        let (out, back) = (self.ways_from(from), self.ways_from(to));
        let over = |node: usize| out.length_m(node) + back.length_m(node);
        if !self.past.is_empty() {
            return self.past.iter().map(|node| over(*node)).fold(f64::INFINITY, f64::min);
        }
        match via {
            None => out.length_m(to),
            Some(class) => (0..self.len())
                .filter(|node| self.is(*node, class))
                .map(|node| out.length_m(node) + back.length_m(node))
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// With the places where the robot's task begins and ends by name.
    fn with_ends(mut self, start: &[NodeId], goal: &[NodeId]) -> Self {
        let far = |net: &Self, ids: &[NodeId]| {
            let trees: Vec<Tree> =
                ids.iter().filter_map(|id| net.index(id)).map(|node| net.tree(node, &|_| false)).collect();
            let nearest = |node: usize| trees.iter().map(|tree| tree.length_m(node)).fold(f64::INFINITY, f64::min);
            if trees.is_empty() { Vec::new() } else { (0..net.len()).map(nearest).collect() }
        };
        (self.start_m, self.goal_m) = (far(&self, start), far(&self, goal));
        let between = self.start_m.iter().zip(&self.goal_m).map(|(start_m, goal_m)| start_m + goal_m);
        self.between_m = between.fold(f64::INFINITY, f64::min);
        self
    }

    /// The places inside that somebody may come from: those of the room by name, if it has one.
    pub(crate) fn rooms_of(&self, human: HumanId, all: Vec<usize>) -> Vec<usize> {
        match self.rooms.get(&human) {
            Some(own) if all.iter().any(|node| own.contains(node)) => {
                all.into_iter().filter(|node| own.contains(node)).collect()
            }
            Some(_) | None => all,
        }
    }

    /// The places by name where a person's way ends; empty where it is left open.
    pub(crate) fn ends_of(&self, human: HumanId) -> &[usize] {
        self.ends.get(&human).map_or(&[], Vec::as_slice)
    }

    /// How well a node suits as the end of a way that the robot's task names; 0 where it names none.
    pub(crate) fn called(&self, node: usize, goal: bool) -> f64 {
        match (if goal { &self.goal_m } else { &self.start_m }).get(node) {
            Some(m) if *m < 1e-9 => WEIGHTS.named_end,
            Some(m) => -WEIGHTS.off_end_per_m * m.min(100.0),
            None => 0.0,
        }
    }

    /// What it costs a meeting to lie far from where the task begins and ends by name: off the way between them where both are
    /// named, else far from the one that is.
    pub(crate) fn astray(&self, node: usize) -> f64 {
        if let (Some(start_m), Some(goal_m)) = (self.start_m.get(node), self.goal_m.get(node)) {
            return WEIGHTS.off_way_per_m * (start_m + goal_m - self.between_m).clamp(0.0, 100.0);
        }
        [&self.start_m, &self.goal_m]
            .into_iter()
            .filter_map(|all| all.get(node))
            .map(|m| WEIGHTS.astray_per_m * (m.min(100.0) - WEIGHTS.near_end_m).max(0.0))
            .sum()
    }

    pub(crate) fn len(&self) -> usize {
        self.ids.len()
    }

    pub(crate) fn index(&self, id: &NodeId) -> Option<usize> {
        self.location.graph.position(id)
    }

    pub(crate) fn id(&self, node: usize) -> Option<&NodeId> {
        self.ids.get(node)
    }

    pub(crate) fn named(&self, nodes: &[usize]) -> Vec<NodeId> {
        nodes.iter().filter_map(|node| self.ids.get(*node).cloned()).collect()
    }

    pub(crate) fn at(&self, node: usize) -> Point {
        self.at.get(node).copied().unwrap_or_else(Point::origin)
    }

    pub(crate) fn near(&self, node: usize) -> &[(usize, f64)] {
        self.near.get(node).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn inside(&self, node: usize) -> bool {
        self.inside.get(node).copied().unwrap_or(false)
    }

    pub(crate) fn is(&self, node: usize, class: PlaceClass) -> bool {
        self.location.graph.is_at(node, class)
    }

    /// Class of the node's own type name.
    pub(crate) fn kind(&self, node: usize) -> PlaceClass {
        self.location.graph.kind_at(node)
    }

    pub(crate) fn length_m(&self, nodes: &[usize]) -> f64 {
        nodes
            .windows(2)
            .map(|pair| match pair {
                [a, b] => self.near(*a).iter().find(|(other, _)| other == b).map_or(0.0, |(_, length)| *length),
                _ => 0.0,
            })
            .sum()
    }

    /// Cosine of the turn at the middle of three nodes: 1 straight on, 0 a right angle, -1 back.
    pub(crate) fn straight(&self, a: usize, b: usize, c: usize) -> f64 {
        let (into, out) = (self.at(b) - self.at(a), self.at(c) - self.at(b));
        let norms = into.norm() * out.norm();
        if norms > 1e-9 { into.dot(&out) / norms } else { 0.0 }
    }

    /// How alike the directions of two ways are, either way round: 1 along each other, 0 at right angles.
    pub(crate) fn alike(&self, one: (usize, usize), other: (usize, usize)) -> f64 {
        let (a, b) = (self.at(one.1) - self.at(one.0), self.at(other.1) - self.at(other.0));
        let norms = a.norm() * b.norm();
        if norms > 1e-9 { (a.dot(&b) / norms).abs() } else { 0.0 }
    }

    /// Shortest ways from a node over all nodes that are not barred.
    pub(crate) fn tree(&self, from: usize, barred: &dyn Fn(usize) -> bool) -> Tree {
        let n = self.len();
        let (mut length_m, mut before) = (vec![f64::INFINITY; n], vec![usize::MAX; n]);
        if let Some(start) = length_m.get_mut(from) {
            *start = 0.0;
        }
        let mut front = BinaryHeap::from([Reverse((0, from))]);
        // Of two that are as near the one of the smaller index comes first; bits of floats that are not negative sort as they do.
        while let Some(Reverse((bits, node))) = front.pop() {
            let Some(length) = length_m.get(node).copied().filter(|known| known.to_bits() == bits) else { continue };
            for (next, step) in self.near(node) {
                if barred(*next) {
                    continue;
                }
                if let (Some(known), Some(prev)) = (length_m.get_mut(*next), before.get_mut(*next))
                    && length + step < *known
                {
                    (*known, *prev) = (length + step, node);
                    front.push(Reverse((known.to_bits(), *next)));
                }
            }
        }
        Tree { from, length_m, before }
    }
}

impl Tree {
    pub(crate) fn length_m(&self, to: usize) -> f64 {
        self.length_m.get(to).copied().unwrap_or(f64::INFINITY)
    }

    /// Nodes from the root to `to`; empty where there is no way.
    pub(crate) fn way(&self, to: usize) -> Vec<usize> {
        if !self.length_m(to).is_finite() {
            return Vec::new();
        }
        let mut way = vec![to];
        let mut at = to;
        while at != self.from {
            match self.before.get(at) {
                Some(before) if *before != usize::MAX && way.len() <= self.before.len() => {
                    at = *before;
                    way.push(at);
                }
                Some(_) | None => return Vec::new(),
            }
        }
        way.reverse();
        way
    }
}
