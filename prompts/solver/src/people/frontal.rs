//! Towards the robot: its own way the other way round, from beyond the meeting node.

use socrates_model::{HumanProposal, PlaceClass};

use super::{HURRY_MPS, ONWARD_M, ROBOT_MPS, Taken, Way, before_m, ideal_m, onward, onward_m};
use crate::graph::Net;
use crate::inside;
use crate::robot_way::Route;

/// What is farther away than a hurry and so much more is too far, m.
const LATE_M: f64 = 2.0;

/// Cost of setting out where the robot goes to, m of wished length.
const AT_ITS_GOAL: f64 = 6.0;

/// Towards the robot: its own way the other way round, from beyond the meeting node.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let meet = *route.nodes.get(route.meet)?;
    let mut back: Vec<usize> = route.nodes.get(..route.meet)?.iter().rev().copied().collect();
    if let Some(class) = human.goal {
        indoors(net, class, &mut back, &taken.goals);
    } else {
        let far = |n: &usize| onward_m(net, meet, back.get(..*n).unwrap_or_default()) >= ONWARD_M;
        let end = |n: &usize| n.checked_sub(1).and_then(|n| back.get(n)).copied();
        let new = |n: &usize| end(n).is_some_and(|node| taken.can_end_past_robot(node));
        let long = (1..=back.len()).find(|n| far(n) && new(n)).or_else(|| (1..=back.len()).find(far));
        back.truncate(long.unwrap_or(back.len()));
    }
    let ideal = ideal_m(human, net, route);
    // Where the robot goes on to, and the nodes beyond its goal.
    let after = route.nodes.get(route.meet + 1..)?;
    let last = *after.last()?;
    let tree = net.tree(last, &|node| route.nodes.contains(&node) && node != last || net.inside(node));
    let mut starts: Vec<Vec<usize>> = (1..=after.len()).filter_map(|n| after.get(..n)).map(<[usize]>::to_vec).collect();
    for beyond in (0..net.len()).filter(|node| tree.length_m(*node) > 0.0 && tree.length_m(*node) <= 10.0) {
        let mut ahead = after.to_vec();
        ahead.extend(tree.way(beyond).into_iter().skip(1));
        starts.push(ahead);
    }
    // Where it turns into a room, others come along the passage from beyond the door instead of out of the doorway.
    let passage = |node: &usize| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
    let out: Vec<usize> = after.iter().copied().take_while(|node| passage(node)).collect();
    let mut beyond_door = Vec::new();
    if let Some(turn) = out.last().copied().filter(|_| net.inside(last)) {
        let tree = net.tree(turn, &|node| route.nodes.contains(&node) || !passage(&node));
        for beyond in (0..net.len()).filter(|node| tree.length_m(*node) > 0.0 && tree.length_m(*node) <= 10.0) {
            let mut ahead = out.clone();
            ahead.extend(tree.way(beyond).into_iter().skip(1));
            beyond_door.push(ahead);
        }
    }
    let cost = |ahead: &Vec<usize>| {
        let length = onward_m(net, meet, ahead);
        let inside = ahead.iter().filter(|node| net.inside(**node)).count() as f64;
        // A person too far away to be in time even in a hurry would have to start in the middle of their way.
        let late = if length > HURRY_MPS * before_m(net, route) / ROBOT_MPS + LATE_M { 30.0 } else { 0.0 };
        let mirrored = if ahead.last().is_some_and(|start| !taken.apart(*start, last)) { AT_ITS_GOAL } else { 0.0 };
        (length - ideal).abs() + if length < 3.0 { 20.0 } else { 0.0 } + 6.0 * inside + late + mirrored
    };
    let free = |ahead: &Vec<usize>| ahead.last().is_some_and(|start| taken.free(*start));
    let pick = |starts: Vec<Vec<usize>>| {
        let costed = starts.into_iter().filter(free).map(|ahead| (cost(&ahead), ahead));
        costed.min_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)))
    };
    let own = pick(starts);
    // One alone may come out of a doorway, several side by side do not.
    let alone = |node: &usize| human.group.is_none() && !net.inside(*node);
    let outside = own.as_ref().and_then(|(_, ahead)| ahead.last()).is_some_and(|node| passage(node) || alone(node));
    let best = if outside { own } else { pick(beyond_door).or(own) }?;
    let mut nodes: Vec<usize> = best.1.into_iter().rev().collect();
    nodes.push(meet);
    nodes.extend(back);
    let mut cost = best.0 * 0.2;
    if human.goal.is_none() {
        onward(&mut nodes, taken, Taken::can_end_past_robot);
        cost += taken.end_cost(&nodes);
    }
    Some(Way { nodes, meet, cost })
}

/// Into the room or car at the end of a way: to a place of it where nobody else goes.
fn indoors(net: &Net<'_>, class: PlaceClass, back: &mut Vec<usize>, taken: &[usize]) {
    let Some(entry) = back.iter().position(|node| net.inside(*node)) else { return };
    back.truncate(entry + 1);
    let Some(first) = back.last().copied() else { return };
    let tree = net.tree(first, &|node| !net.inside(node));
    let free = inside::nodes(net, Some(class)).into_iter().filter(|node| tree.length_m(*node).is_finite());
    // The deepest first, so that the next one finds room.
    let end = free.filter(|node| !taken.contains(node)).max_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)));
    if let Some(end) = end {
        back.extend(tree.way(end).into_iter().skip(1));
    }
}
