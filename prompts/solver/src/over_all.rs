//! The robot's ways over several places: people who meet it elsewhere than the others, and what its task names on the way.

use socrates_model::{HumanProposal, PlaceClass, Relation};

use crate::candidates::{Scene, best};
use crate::everybody::{Solution, everybody};
use crate::graph::Net;
use crate::robot_way::{Route, Wish, score};
use crate::{inside, meant};

/// Places beside the first that one way is led over at most; more are left to chance.
const MOST: usize = 4;
/// Starts, nodes of each place and goals that are tried.
const STARTS: usize = 32;
const NODES: usize = 3;
const GOALS: usize = 3;
/// Ways that are scored at most.
const WAYS: usize = 4000;

/// Ways that lead over the places of all who meet the robot, in any order, by shortest ways that touch no node twice; where there are none, by
/// ways that come back over nodes between the places.
pub(crate) fn over_all(scene: &Scene<'_>, wish: &Wish, inside: Option<&[usize]>) -> Vec<Solution> {
    let Scene { net, proposal, .. } = *scene;
    let first = place_of_others(scene, wish);
    let mut stops: Vec<Vec<usize>> = Vec::new();
    let others = net.elsewhere.values().chain(std::iter::once(&net.past));
    for stop in std::iter::once(&first).chain(others) {
        if !stop.is_empty() && !stops.contains(stop) && stops.len() <= MOST {
            stops.push(stop.clone());
        }
    }
    let starts = ends(net, wish.start, false, None);
    let step = starts.len().div_ceil(STARTS).max(1);
    let goals = ends(net, wish.goal, true, inside);
    let alone = |human: &HumanProposal| !net.elsewhere.contains_key(&human.id);
    let met = proposal.humans.iter().any(alone);
    let routes = |again: bool| {
        let mut ways = Search { net, stops: &stops, goals: &goals, aim_m: wish.aim_m, again, found: Vec::new() };
        for start in starts.iter().step_by(step) {
            ways.from(&mut vec![*start], &mut Vec::new());
        }
        // People without a place of their own are met at any node of the first place.
        let over = |nodes: Vec<usize>| {
            let last = nodes.len().saturating_sub(1);
            let of_place = |at: &usize| nodes.get(*at).is_some_and(|node| first.contains(node));
            let mut meets: Vec<usize> = (1..last).filter(of_place).collect();
            if meets.is_empty() && (!met || first.is_empty()) {
                meets.push(last / 2);
            }
            let routes = meets.into_iter().map(|meet| {
                let score = score(net, &nodes, meet, wish);
                Route { nodes: nodes.clone(), meet, score }
            });
            routes.filter(|route| route.score.is_finite()).collect::<Vec<Route>>()
        };
        let mut routes: Vec<Route> = ways.found.into_iter().flat_map(over).collect();
        best(scene, &mut routes);
        routes.into_iter().flat_map(|route| everybody(scene, &route)).collect::<Vec<Solution>>()
    };
    let once = routes(false);
    if once.is_empty() { routes(true) } else { once }
}

/// Nodes of the meeting of all people without a place of their own: by name, or of the class; people of a room are met before it unless they
/// stand in it.
fn place_of_others(scene: &Scene<'_>, wish: &Wish) -> Vec<usize> {
    let Scene { net, proposal, .. } = *scene;
    if wish.place == PlaceClass::Plain {
        return Vec::new();
    }
    let meant = meant::indices(net, proposal);
    let class = || socrates_maps::place::nodes_of(net.location, wish.place);
    let nodes = if meant.is_empty() { class().iter().filter_map(|id| net.index(id)).collect() } else { meant };
    let closed = nodes.iter().all(|node| net.inside(*node));
    let mut alone = proposal.humans.iter().filter(|human| !net.elsewhere.contains_key(&human.id));
    if !closed || alone.all(|human| human.relation == Relation::Static) {
        return nodes;
    }
    let doors = nodes.iter().flat_map(|node| net.near(*node)).map(|(door, _)| *door);
    let before = doors.flat_map(|door| {
        let beyond = net.near(door).iter().map(|(node, _)| *node);
        std::iter::once(door).chain(beyond).collect::<Vec<_>>()
    });
    before.filter(|node| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway).collect()
}

/// The nodes at which a way may begin or end: by name, inside what it leads into, of the class, or anywhere outside of rooms.
fn ends(net: &Net<'_>, class: Option<PlaceClass>, goal: bool, within: Option<&[usize]>) -> Vec<usize> {
    let named: Vec<usize> = (0..net.len()).filter(|node| net.called(*node, goal) > 0.0).collect();
    if !named.is_empty() {
        return named;
    }
    if let Some(within) = within {
        return within.to_vec();
    }
    let open = |node: &usize| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
    let of_class = |node: &usize| class.is_some_and(|class| net.is(*node, class));
    let all: Vec<usize> = (0..net.len()).filter(|node| of_class(node)).collect();
    if all.is_empty() { (0..net.len()).filter(open).collect() } else { all }
}

/// A search for ways from one node on.
struct Search<'a> {
    net: &'a Net<'a>,
    stops: &'a [Vec<usize>],
    goals: &'a [usize],
    aim_m: f64,
    /// Whether a way may come back over nodes other than its start and the stops.
    again: bool,
    found: Vec<Vec<usize>>,
}

impl Search<'_> {
    /// Leads a way on to the stops that it does not touch yet, and to a goal after the last of them; `touched` are those at which it stopped.
    fn from(&mut self, way: &mut Vec<usize>, touched: &mut Vec<usize>) {
        if self.found.len() >= WAYS {
            return;
        }
        let (Some(last), Some(first)) = (way.last().copied(), way.first().copied()) else { return };
        let open: Vec<&Vec<usize>> =
            self.stops.iter().filter(|stop| !way.iter().skip(1).any(|node| stop.contains(node))).collect();
        let once = |node: &usize| !self.again || *node == first || touched.contains(node);
        let barred: Vec<usize> = way.iter().copied().filter(|node| *node != last && once(node)).collect();
        let tree = self.net.tree(last, &|node| barred.contains(&node));
        // Through rooms no way leads, but out of that in which it begins, and in and out of one for a stop.
        let (net, again) = (self.net, self.again);
        let passable = |node: &usize| {
            let way = tree.way(*node);
            let mut inner = way.iter().skip(1).rev().skip(1);
            let own = |inner: usize| {
                let same = |other: usize| inside::same_door(net, inner, Some(other));
                same(first) || again && (same(last) || same(*node))
            };
            inner.all(|node| !net.inside(*node) || own(*node))
        };
        if open.is_empty() {
            let length_m = self.net.length_m(way);
            let off = |node: usize| (length_m + tree.length_m(node) - self.aim_m).abs();
            let reached = self.goals.iter().copied();
            let mut goals: Vec<usize> = reached
                .filter(|goal| *goal != last && !barred.contains(goal) && tree.length_m(*goal).is_finite())
                .filter(passable)
                .collect();
            goals.sort_by(|a, b| off(*a).total_cmp(&off(*b)).then(a.cmp(b)));
            for goal in goals.into_iter().take(GOALS) {
                let mut nodes = way.clone();
                nodes.extend(tree.way(goal).into_iter().skip(1));
                self.found.push(nodes);
            }
            return;
        }
        for stop in open {
            let mut near: Vec<usize> = stop
                .iter()
                .copied()
                .filter(|node| !barred.contains(node) && *node != last && tree.length_m(*node).is_finite())
                .filter(passable)
                .collect();
            near.sort_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)).then(a.cmp(b)));
            for node in near.into_iter().take(NODES) {
                let length = way.len();
                way.extend(tree.way(node).into_iter().skip(1));
                touched.push(node);
                self.from(way, touched);
                touched.pop();
                way.truncate(length);
            }
        }
    }
}
