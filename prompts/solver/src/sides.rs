//! Sides of the robot's way: who comes from a side, stands or walks on one, does so as the proposal says, or there is no way.

use socrates_maps::Ground;
use socrates_model::geometry::nearest_on_segment;
use socrates_model::{HumanProposal, Point, Relation, Side};

use crate::graph::Net;
use crate::robot_way::Route;
use crate::{Miss, Problem, search};

/// Least sine of the angle to the robot's way at which somebody comes from a side.
const SINE: f64 = 0.5;
/// The room that somebody comes out of lies so far beside the robot's way, m.
const ROOM_M: f64 = 1.0;
/// Free floor round who stands and who walks on a side, m: their body and a little; walkers keep farther from walls.
const STANDS_M: f64 = 0.32;
const WALKS_M: f64 = 0.38;

/// Whether a node from which somebody comes to the meeting lies on the side of the robot's way that the proposal names.
pub(crate) fn enters(net: &Net<'_>, route: &Route, human: &HumanProposal, entry: usize) -> bool {
    let Some(side) = human.side else { return true };
    let [before, meet] = [route.meet.checked_sub(1), Some(route.meet)];
    let at = |index: Option<usize>| index.and_then(|index| route.nodes.get(index)).map(|node| net.at(*node));
    let (Some(before), Some(meet)) = (at(before), at(meet)) else { return false };
    let (into, from) = (meet - before, net.at(entry) - meet);
    let norms = into.norm() * from.norm();
    norms > 1e-9 && side.sign() * into.perp(&from) / norms >= SINE
}

/// Whether a room lies on the side of the robot's way that the proposal names.
pub(crate) fn lies(net: &Net<'_>, route: &Route, human: &HumanProposal, node: usize) -> bool {
    let Some(side) = human.side else { return true };
    let (_, left_m) = beside(net, route, &net.at(node));
    side.sign() * left_m >= ROOM_M
}

/// How far a point is from the robot's way, and how far to the left of it, m.
pub(crate) fn beside(net: &Net<'_>, route: &Route, at: &Point) -> (f64, f64) {
    let pieces = route.nodes.windows(2).filter_map(|pair| {
        let &[a, b] = pair else { return None };
        let (a, b) = (net.at(a), net.at(b));
        let (off_m, nearest) = nearest_on_segment(at, &a, &b);
        let along = b - a;
        (along.norm() > 1e-9).then(|| (off_m, along.perp(&(at - nearest)) / along.norm()))
    });
    pieces.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0.0))
}

/// Whether there is floor for somebody on the side of the robot's way that the proposal names, about a node of it.
pub(crate) fn has_floor(net: &Net<'_>, route: &Route, human: &HumanProposal, index: usize) -> bool {
    let Some(side) = human.side else { return true };
    let node = |index: usize| route.nodes.get(index).map(|node| net.at(*node));
    let (Some(at), Some(along)) = (
        node(index),
        index.checked_sub(1).and_then(node).or_else(|| node(index)).zip(node(index + 1).or_else(|| node(index))),
    ) else {
        return false;
    };
    let along = along.1 - along.0;
    if along.norm() < 1e-9 {
        return false;
    }
    let left = socrates_model::Vector::new(-along.y, along.x) / along.norm();
    let ground = Ground::of(&net.location.grid);
    let body_m = if walks_along(human.relation) { WALKS_M } else { STANDS_M };
    ground.field().clearance(&(at + left * (side.sign() * Side::BESIDE_M))) >= body_m
}

/// How those who walk the robot's way need floor beside it where they meet it.
pub(crate) const fn walks_along(relation: Relation) -> bool {
    match relation {
        Relation::Frontal | Relation::Behind | Relation::Ahead | Relation::Abreast => true,
        Relation::Crossing | Relation::Static | Relation::Leaving | Relation::Staying | Relation::Aside => false,
    }
}

/// The people whose side no way of the map gives, where there would be ways without it.
pub(crate) fn missing(problem: &Problem<'_>, net: &Net<'_>) -> Option<Miss> {
    let sided = || problem.proposal.humans.iter().filter(|human| human.side.is_some());
    sided().next()?;
    let has_ways = |change: &dyn Fn(&mut HumanProposal)| {
        let mut proposal = problem.proposal.clone();
        proposal.humans.iter_mut().for_each(change);
        !search::solutions(&Problem { proposal: &proposal, ..problem.clone() }, net).is_empty()
    };
    if has_ways(&|_| {}) || !has_ways(&|human| human.side = None) {
        return None;
    }
    // Those without whose side there are ways, each alone; all where it takes more than one.
    let alone = |human: &&HumanProposal| {
        has_ways(&|other| {
            if other.id == human.id {
                other.side = None;
            }
        })
    };
    let named = |human: &HumanProposal| (human.id, human.relation, human.side.unwrap_or(Side::Left));
    let mut who: Vec<_> = sided().filter(alone).map(named).collect();
    if who.is_empty() {
        who = sided().map(named).collect();
    }
    Some(Miss::Side { who, class: problem.proposal.place })
}
