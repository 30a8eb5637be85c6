//! Out of a room or car, through its door, over the meeting node and on.

use socrates_model::{HumanProposal, PlaceClass};

use super::{HUMAN_MPS, ROBOT_MPS, Taken, Way, before_m, extend, onward, sources};
use crate::inside::{self, same_door};
use crate::robot_way::Route;
use crate::sides;

/// Longest wait behind a door before somebody comes out, s: people are held for 10 s at most, and a little is needed for the rest.
const WAITS_S: f64 = 8.0;
/// Cost per second that somebody would have to wait longer.
const LATE_PER_S: f64 = 0.8;

/// Cost of coming out straight towards the robot instead of from its side.
const HEAD_ON: f64 = 4.0;
/// Cost of walking on along the robot's own way: a meeting with a way on for people is better.
const OWN_WAY: f64 = 3.0;

/// Out of a room or car, through its door, over the meeting node and on.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let meet = *route.nodes.get(route.meet)?;
    let car = sources(human, net.location) == Some(PlaceClass::Elevator);
    let before: Vec<usize> = route.nodes.get(..route.meet)?.to_vec();
    let beyond = route.nodes.get(route.meet + 1).copied();
    let inside = net.rooms_of(human.id, inside::nodes(net, sources(human, net.location)));
    // A room with one place only is the robot's when it ends there: nobody else comes out of it.
    let last = route.nodes.last().copied();
    let shared = |node: &usize| Some(*node) != last && same_door(net, *node, last);
    let enters = last.is_some_and(|last| net.inside(last)) && (car || inside.iter().any(shared));
    // Out of the very room that the robot enters, or of any other near by that is not on its way.
    let tree = net.tree(meet, &|node| before.contains(&node) || !enters && Some(node) == beyond);
    let same = |node: usize| !enters || same_door(net, node, route.nodes.last().copied());
    let start = inside
        .into_iter()
        .filter(|node| {
            same(*node)
                && sides::lies(net, route, human, *node)
                && tree.length_m(*node) >= 1.0
                && tree.length_m(*node) <= if car { 8.0 } else { 12.0 }
                && (car || Some(*node) != last)
        })
        .min_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)))?;
    let inward = tree.way(start);
    let mut nodes: Vec<usize> = inward.iter().rev().copied().collect();
    let entry = inward.get(1).copied()?;
    // Away from the robot if there is a way, else past it.
    let exits: Vec<usize> = net
        .near(meet)
        .iter()
        .map(|(node, _)| *node)
        .filter(|node| !nodes.contains(node) && !net.inside(*node))
        .collect();
    let from = route.meet.checked_sub(1).and_then(|i| route.nodes.get(i)).copied();
    let rank = |node: &usize| {
        let own = if Some(*node) == from {
            2.0
        } else if Some(*node) == beyond {
            1.0
        } else {
            0.0
        };
        let used = if taken.goals.contains(node) { 1.5 } else { 0.0 };
        net.straight(entry, meet, *node) - own - used
    };
    let exit = exits.into_iter().max_by(|a, b| rank(a).total_cmp(&rank(b)));
    nodes.extend(exit);
    extend(net, &mut nodes, meet, &|node| route.nodes.contains(&node) && Some(node) != exit);
    onward(&mut nodes, taken, Taken::can_end);
    let length = tree.length_m(start);
    // Nobody waits behind the door until a robot comes that is still far away; of many scenarios some are so.
    let waits_s = before_m(net, route) / ROBOT_MPS - length / human.speed_mps.unwrap_or(HUMAN_MPS);
    let early = if taken.wide { 0.0 } else { LATE_PER_S * (waits_s - WAITS_S).max(0.0) };
    let along = match exit {
        None => 4.0,
        Some(exit) if Some(exit) == from || Some(exit) == beyond => OWN_WAY,
        Some(_) => 0.0,
    };
    // Where the robot goes in itself, everybody comes out straight towards it.
    let head_on = if enters { 0.0 } else { from.map_or(0.0, |from| HEAD_ON * net.straight(from, meet, entry).abs()) };
    Some(Way { nodes, meet, cost: 0.4 * (length - 4.0).max(0.0) + early + along + head_on })
}
