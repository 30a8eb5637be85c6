//! Ways through the scene graph: shortest ones round what is barred, and the robot's ways over a meeting node.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_maps::openings::Enclosures;
use socrates_model::{HumanId, Location, NodeId, PlaceClass, Point};

/// A way that begins or ends where the task says by name is better than any other; else the nearer the better, per m.
const CALLED: f64 = 40.0;
const OFF: f64 = 0.6;
/// What a meeting costs per m beyond so many from where the task begins and ends.
const ASTRAY: f64 = 0.3;
const NEARBY_M: f64 = 12.0;

/// The scene graph by index.
pub(crate) struct Net<'a> {
    pub(crate) location: &'a Location,
    ids: Vec<NodeId>,
    at: Vec<Point>,
    near: Vec<Vec<(usize, f64)>>,
    inside: Vec<bool>,
    /// The rooms and cars.
    pub(crate) enclosures: Arc<Enclosures>,
    /// How far each node is from the places where the robot's task begins and ends by name, m; empty without such places.
    start_m: Vec<f64>,
    goal_m: Vec<f64>,
    /// The rooms that people come out of by name.
    rooms: BTreeMap<HumanId, Vec<usize>>,
}

/// Shortest ways from one node to all others.
pub(crate) struct Tree {
    from: usize,
    length_m: Vec<f64>,
    before: Vec<usize>,
}

impl<'a> Net<'a> {
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
            at: graph.nodes().iter().map(|node| node.at).collect(),
            ids,
            near,
            inside,
            enclosures,
            start_m: Vec::new(),
            goal_m: Vec::new(),
            rooms: BTreeMap::new(),
        }
    }

    /// With the places where the robot's task begins and ends by name.
    pub(crate) fn with_ends(mut self, start: &[NodeId], goal: &[NodeId]) -> Self {
        let far = |net: &Self, ids: &[NodeId]| {
            let trees: Vec<Tree> =
                ids.iter().filter_map(|id| net.index(id)).map(|node| net.tree(node, &|_| false)).collect();
            let nearest = |node: usize| trees.iter().map(|tree| tree.length_m(node)).fold(f64::INFINITY, f64::min);
            if trees.is_empty() { Vec::new() } else { (0..net.len()).map(nearest).collect() }
        };
        (self.start_m, self.goal_m) = (far(&self, start), far(&self, goal));
        self
    }

    /// With the rooms that people come out of by name.
    pub(crate) fn with_rooms(mut self, rooms: BTreeMap<HumanId, Vec<usize>>) -> Self {
        self.rooms = rooms;
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

    /// How well a node suits as the end of a way that the robot's task names; 0 where it names none.
    pub(crate) fn called(&self, node: usize, goal: bool) -> f64 {
        match (if goal { &self.goal_m } else { &self.start_m }).get(node) {
            Some(m) if *m < 1e-9 => CALLED,
            Some(m) => -OFF * m.min(100.0),
            None => 0.0,
        }
    }

    /// What it costs a meeting to lie far from where the task begins and ends by name.
    pub(crate) fn astray(&self, node: usize) -> f64 {
        [&self.start_m, &self.goal_m]
            .into_iter()
            .filter_map(|all| all.get(node))
            .map(|m| ASTRAY * (m.min(100.0) - NEARBY_M).max(0.0))
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
        let (mut length_m, mut before, mut done) = (vec![f64::INFINITY; n], vec![usize::MAX; n], vec![false; n]);
        if let Some(start) = length_m.get_mut(from) {
            *start = 0.0;
        }
        loop {
            let open = length_m
                .iter()
                .enumerate()
                .filter(|(i, length)| length.is_finite() && !done.get(*i).copied().unwrap_or(true));
            let Some((node, length)) = open.min_by(|a, b| a.1.total_cmp(b.1)).map(|(i, length)| (i, *length)) else {
                break;
            };
            if let Some(flag) = done.get_mut(node) {
                *flag = true;
            }
            for (next, step) in self.near(node) {
                if barred(*next) {
                    continue;
                }
                if let (Some(known), Some(prev)) = (length_m.get_mut(*next), before.get_mut(*next))
                    && length + step < *known
                {
                    (*known, *prev) = (length + step, node);
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

/// A way of the robot over its meeting node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Route {
    pub(crate) nodes: Vec<usize>,
    /// Index of the meeting node in `nodes`.
    pub(crate) meet: usize,
    pub(crate) score: f64,
}

/// What is wanted of the robot's way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wish {
    pub(crate) start: Option<PlaceClass>,
    pub(crate) goal: Option<PlaceClass>,
    pub(crate) place: PlaceClass,
    /// A class of place that the way should lead past.
    pub(crate) via: Option<PlaceClass>,
    /// Whether doorways and aisles are to be kept away from.
    pub(crate) roomy: bool,
    /// Whether the way may lead into rooms.
    pub(crate) indoors: bool,
    /// 1: straight over the meeting node, -1: round a corner, 0: no matter.
    pub(crate) straight: f64,
    /// Ways shorter than this are not good enough, m.
    pub(crate) least_m: f64,
    /// Length that is aimed at, m.
    pub(crate) aim_m: f64,
}

/// Ends per branch that are tried in earnest.
const ENDS: usize = 9;

type Ways = Vec<Vec<usize>>;

/// The robot's ways over a node, best first.
pub(crate) fn over(net: &Net<'_>, meet: usize, wish: &Wish) -> Vec<Route> {
    let mut arms: Vec<(usize, Ways, Ways)> = Vec::new();
    for (arm, step) in net.near(meet) {
        if net.inside(*arm) && !wish.indoors {
            continue;
        }
        // Rooms are where people come from; the robot goes there only when its task says so.
        let tree = net.tree(*arm, &|node| node == meet);
        let ends = |class: Option<PlaceClass>, goal: bool| {
            let mut found: Vec<(f64, usize)> = (0..net.len())
                .filter(|end| tree.length_m(*end).is_finite() && *end != meet)
                .map(|end| {
                    let score = end_score(net, end, tree.length_m(end) + step, class, wish);
                    (score + net.called(end, goal), end)
                })
                .collect();
            found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            found.into_iter().take(ENDS).map(|(_, end)| tree.way(end)).filter(|way| !way.is_empty()).collect::<Vec<_>>()
        };
        arms.push((*arm, ends(wish.start, false), ends(wish.goal, true)));
    }
    let mut routes = Vec::new();
    for (a, starts, _) in &arms {
        for (b, _, goals) in &arms {
            if a == b {
                continue;
            }
            for start in starts {
                for goal in goals.iter().filter(|goal| goal.iter().all(|node| !start.contains(node))) {
                    let mut nodes: Vec<usize> = start.iter().rev().copied().collect();
                    let at = nodes.len();
                    nodes.push(meet);
                    nodes.extend(goal);
                    let score = score(net, &nodes, at, wish);
                    if score.is_finite() {
                        routes.push(Route { nodes, meet: at, score });
                    }
                }
            }
        }
    }
    routes.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| a.nodes.cmp(&b.nodes)));
    routes
}

fn end_score(net: &Net<'_>, end: usize, length_m: f64, class: Option<PlaceClass>, wish: &Wish) -> f64 {
    let wanted = class.is_some_and(|class| net.is(end, class));
    let inside = net.inside(end) && !wanted;
    let bonus = if wanted { 6.0 } else { 0.0 };
    bonus - (length_m - wish.aim_m / 2.0).abs() - if inside { 20.0 } else { 0.0 }
}

/// How good a way is; minus infinity where it is too short.
pub(crate) fn score(net: &Net<'_>, nodes: &[usize], meet: usize, wish: &Wish) -> f64 {
    let total = net.length_m(nodes);
    if nodes.len() < 4 || total < wish.least_m {
        return f64::NEG_INFINITY;
    }
    let before = net.length_m(nodes.get(..=meet).unwrap_or_default());
    let after = total - before;
    let mut score = -0.3 * (total - wish.aim_m).abs();
    // Before the meeting the robot needs room to be seen, after it room to get away.
    score -= 2.0 * (5.0 - before).max(0.0) + 2.0 * (3.0 - after).max(0.0);
    if let (Some(a), Some(b), Some(c)) =
        (meet.checked_sub(1).and_then(|i| nodes.get(i)), nodes.get(meet), nodes.get(meet + 1))
    {
        score += 3.0 * wish.straight * net.straight(*a, *b, *c);
        // Nobody turns back on the spot.
        if net.straight(*a, *b, *c) < -0.8 {
            score -= 6.0;
        }
    }
    // Nor anywhere else on the way.
    let back = |triple: &[usize]| matches!(triple, [a, b, c] if net.straight(*a, *b, *c) < -0.5);
    score -= 4.0 * nodes.windows(3).filter(|triple| back(triple)).count() as f64;
    let mid = nodes.get(1..nodes.len().saturating_sub(1)).unwrap_or_default();
    score -= 5.0 * mid.iter().filter(|node| net.inside(**node)).count() as f64;
    if wish.via.is_some_and(|class| mid.iter().any(|node| net.is(*node, class))) {
        score += 3.0;
    }
    let of_place = mid.iter().filter(|node| net.is(**node, wish.place)).count();
    score += 0.3 * of_place as f64;
    for (end, class, goal) in [(nodes.first(), wish.start, false), (nodes.last(), wish.goal, true)] {
        let Some(end) = end else { continue };
        score += net.called(*end, goal);
        match class {
            Some(class) if net.is(*end, class) => score += 4.0,
            Some(_) => {}
            None if net.inside(*end) => score -= 4.0,
            // Nobody stays in a doorway, where others have to get through.
            None if net.kind(*end) == PlaceClass::Doorway => score -= 12.0,
            None => {}
        }
    }
    score
}
