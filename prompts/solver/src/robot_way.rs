//! The robot's ways over a meeting node.

use socrates_model::PlaceClass;

use crate::cost::WEIGHTS;
use crate::graph::Net;

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
    /// Ends per branch that are tried in earnest.
    pub(crate) ends: usize,
}

/// Shortest way of the robot over a meeting, m.
pub(crate) const LEAST_M: f64 = 6.5;

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
            found.truncate(wish.ends);
            found.iter().map(|(_, end)| tree.way(*end)).filter(|way| !way.is_empty()).collect::<Vec<_>>()
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
    let w = &WEIGHTS;
    let total = net.length_m(nodes);
    if nodes.len() < 4 || total < wish.least_m {
        return f64::NEG_INFINITY;
    }
    let mut score = -w.length_per_m * (total - wish.aim_m).abs() - w.detours(times_shortest(net, nodes, wish.via));
    score -= w.room_per_m * missing(net, nodes, meet, total);
    if let (Some(a), Some(b), Some(c)) =
        (meet.checked_sub(1).and_then(|i| nodes.get(i)), nodes.get(meet), nodes.get(meet + 1))
    {
        score += w.straight * wish.straight * net.straight(*a, *b, *c);
        // Nobody turns back on the spot.
        if net.straight(*a, *b, *c) < -0.8 {
            score -= w.turn_back;
        }
    }
    // Nor anywhere else on the way.
    let back = |triple: &[usize]| matches!(triple, [a, b, c] if net.straight(*a, *b, *c) < -0.5);
    score -= w.sharp_turn * nodes.windows(3).filter(|triple| back(triple)).count() as f64;
    let mid = nodes.get(1..nodes.len().saturating_sub(1)).unwrap_or_default();
    score -= w.through_room * mid.iter().filter(|node| net.inside(**node)).count() as f64;
    if wish.via.is_some_and(|class| passes(net, nodes, class)) {
        score += w.via;
    }
    let past = |node: &usize| net.past.contains(node);
    if mid.iter().any(past) && ![nodes.first(), nodes.last()].into_iter().flatten().any(past) {
        score += w.named_end;
    }
    score -=
        w.elsewhere * net.elsewhere.values().filter(|own| !nodes.iter().any(|node| own.contains(node))).count() as f64;
    let of_place = mid.iter().filter(|node| net.is(**node, wish.place)).count();
    score += w.of_place * of_place as f64;
    for (end, class, goal) in [(nodes.first(), wish.start, false), (nodes.last(), wish.goal, true)] {
        let Some(end) = end else { continue };
        score += net.called(*end, goal);
        match class {
            Some(class) if net.is(*end, class) => score += w.end_class,
            Some(_) => {}
            None if net.inside(*end) => score -= w.end_inside,
            // Nobody stays in a doorway, where others have to get through.
            None if net.kind(*end) == PlaceClass::Doorway => score -= w.end_doorway,
            None => {}
        }
    }
    score
}

/// Before the meeting the robot needs room to be seen, after it room to get away, m.
const BEFORE_M: f64 = 5.0;
const AFTER_M: f64 = 3.0;

/// How much of that a way lacks, m.
pub(crate) fn missing_m(net: &Net<'_>, route: &Route) -> f64 {
    missing(net, &route.nodes, route.meet, net.length_m(&route.nodes))
}

fn missing(net: &Net<'_>, nodes: &[usize], meet: usize, total_m: f64) -> f64 {
    let before = net.length_m(nodes.get(..=meet).unwrap_or_default());
    (BEFORE_M - before).max(0.0) + (AFTER_M - (total_m - before)).max(0.0)
}

/// Whether a way leads past a class of place between its ends.
fn passes(net: &Net<'_>, nodes: &[usize], class: PlaceClass) -> bool {
    nodes.get(1..nodes.len().saturating_sub(1)).unwrap_or_default().iter().any(|node| net.is(*node, class))
}

/// How many times as long a way is as the shortest from its start to its goal, past what the task names where it leads past that.
pub(crate) fn times_shortest(net: &Net<'_>, nodes: &[usize], via: Option<PlaceClass>) -> f64 {
    let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else { return 1.0 };
    let shortest_m = net.shortest_m(*first, *last, via.filter(|class| passes(net, nodes, *class)));
    if shortest_m > 1e-9 { net.length_m(nodes) / shortest_m } else { f64::INFINITY }
}
