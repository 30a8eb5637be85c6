//! Who waits before an elevator or a room and goes in: it stands there at first, and its way leads on through the door.

use socrates_model::{HumanProposal, PlaceClass, Proposal, Relation};

use super::{Taken, Way};
use crate::graph::Net;
use crate::inside::{self, same_door};
use crate::robot_way::Route;

/// Nobody waits for a door farther from the place behind it than this, m.
const BEFORE_M: f64 = 8.0;

/// Whether somebody stands before a door at first and goes in.
pub(crate) fn boards(human: &HumanProposal) -> bool {
    human.relation == Relation::Static && human.goal.is_some()
}

/// How many do.
pub(crate) fn count(proposal: &Proposal) -> usize {
    proposal.humans.iter().filter(|human| boards(human)).count()
}

/// The places behind the same door as one of them.
fn behind(net: &Net<'_>, class: Option<PlaceClass>, node: usize) -> Vec<usize> {
    inside::nodes(net, class).into_iter().filter(|other| same_door(net, *other, Some(node))).collect()
}

/// Nodes right before the doors of other cars, where those who go in do not fit into the robot's; none where they do.
pub(crate) fn doors_beside(net: &Net<'_>, proposal: &Proposal, goal: usize) -> Vec<usize> {
    let Some(class) = proposal.humans.iter().filter(|human| boards(human)).find_map(|human| human.goal) else {
        return Vec::new();
    };
    let own = behind(net, Some(class), goal);
    if count(proposal) < own.len() || own.is_empty() {
        return Vec::new();
    }
    let others = inside::nodes(net, Some(class)).into_iter().filter(|node| !own.contains(node));
    let mut found: Vec<usize> = Vec::new();
    for node in others.flat_map(|node| net.near(node).iter()).map(|(node, _)| *node) {
        if !net.inside(node) && !found.contains(&node) {
            found.push(node);
        }
    }
    found
}

/// A way from the goal over a node to a start.
pub(crate) fn way_past(net: &Net<'_>, (goal, by): (usize, usize), start: usize) -> Option<Vec<usize>> {
    let mut nodes = net.tree(goal, &|_| false).way(by);
    let on = net.tree(by, &|node| nodes.contains(&node) || net.inside(node)).way(start);
    if nodes.is_empty() || on.len() < 2 {
        return None;
    }
    nodes.extend(on.into_iter().skip(1));
    Some(nodes)
}

/// From where somebody stands before the door to a place behind it: the robot's own if there is room for all, else another.
pub(crate) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let robot = *route.nodes.last()?;
    let all = inside::nodes(net, human.goal);
    let shared = net.inside(robot) && taken.boards < behind(net, human.goal, robot).len();
    let other = all.iter().any(|node| !same_door(net, *node, Some(robot)));
    let fits =
        |node: &usize| *node != robot && (!net.inside(robot) || !other || same_door(net, *node, Some(robot)) == shared);
    let last = route.nodes.len().checked_sub(1)?;
    let open = |node: &usize| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
    let places: Vec<usize> = route.nodes.get(1..last)?.iter().copied().filter(open).collect();
    let mut best: Option<(f64, Vec<usize>)> = None;
    for at in places {
        let tree = net.tree(at, &|_| false);
        let there = taken.standing.iter().filter(|other| **other == at).count() as f64;
        for end in all.iter().copied().filter(|node| fits(node) && tree.length_m(*node) <= BEFORE_M) {
            let ends = taken.goals.iter().filter(|other| **other == end).count() as f64;
            // Few at one place, near the door; the deepest place behind it first, so that the next one finds room.
            let nodes = tree.way(end);
            let before_m = nodes
                .iter()
                .position(|node| net.inside(*node))
                .map_or(0.0, |n| net.length_m(nodes.get(..=n).unwrap_or_default()));
            let deep_m = tree.length_m(end) - before_m;
            let deep = if ends > 0.0 { deep_m } else { -deep_m };
            let cost = before_m + 2.0 * there + 6.0 * ends + 0.5 * deep;
            if best.as_ref().is_none_or(|(least, _)| cost < least - 1e-9) {
                best = Some((cost, nodes));
            }
        }
    }
    let (_, nodes) = best?;
    Some(Way { meet: *nodes.first()?, nodes, cost: 0.0 })
}
