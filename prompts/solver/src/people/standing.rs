//! Standing: on the robot's way or at its end; who goes on later has a way for that.

use socrates_model::{HumanProposal, PlaceClass};

use super::{Taken, Way};
use crate::Ends;
use crate::robot_way::Route;
use crate::sides;

/// The robot starts at least so far from those who stand at a place by name, so that it comes to them, m.
const SEEN_M: f64 = 6.0;

/// Whoever stands on a side of the robot's way stands so far from where somebody comes towards it, along the way, m.
const CLEAR_M: f64 = 5.0;

/// No node: somebody with whom the robot starts is met nowhere.
const NOWHERE: usize = usize::MAX;

/// Standing: at the meeting node, or at the free node of the robot's way nearest to it; at a place by name with the others.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    // With the robot at one end of its way they are on no side of it.
    if human.side.is_some() && taken.ends != Ends::Past {
        return None;
    }
    match taken.ends {
        Ends::Past if !taken.meant.is_empty() => return together(human, route, taken),
        Ends::Past => {}
        Ends::With => {
            let at = *route.nodes.last()?;
            return Some(Way { nodes: vec![at], meet: at, cost: 0.0 });
        }
        Ends::From => return Some(Way { nodes: vec![*route.nodes.first()?], meet: NOWHERE, cost: 0.0 }),
    }
    let last = route.nodes.len().checked_sub(1)?;
    let mut places: Vec<usize> = (1..last).collect();
    // Round somebody who comes towards it a robot would pass whoever stands right there on the side where there is room.
    let apart_m = |i: usize| {
        let between = route.nodes.get(i.min(route.meet)..=i.max(route.meet));
        taken.net.length_m(between.unwrap_or_default())
    };
    let is_place = |i: usize| route.nodes.get(i).is_some_and(|node| taken.net.is(*node, taken.place));
    let clear = |i: usize| apart_m(i) >= CLEAR_M && is_place(i);
    let sided = human.side.is_some() && taken.toward;
    places.sort_by_key(|i| (sided && !clear(*i), i.abs_diff(route.meet), *i));
    let floor = |i: &usize| sides::has_floor(taken.net, route, human, *i);
    let at =
        places.into_iter().filter(floor).filter_map(|i| route.nodes.get(i).copied()).find(|node| taken.free(*node))?;
    Some(Way { nodes: vec![at], meet: at, cost: 0.0 })
}

/// On from where somebody stood: off the robot's way if there is one, else along it, to where it turns off or ends.
pub(super) fn walking_on(mut way: Way, route: &Route, taken: &Taken<'_>) -> Way {
    let net = taken.net;
    let Some(from) = way.nodes.first().and_then(|at| route.nodes.iter().position(|node| node == at)) else {
        return way;
    };
    for at in route.nodes.get(from..).unwrap_or_default() {
        if way.nodes.last() != Some(at) {
            way.nodes.push(*at);
        }
        let off =
            |node: &usize| !route.nodes.contains(node) && !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
        let off = net.near(*at).iter().map(|(node, _)| *node).filter(off);
        if let Some(off) = off.max_by_key(|node| taken.can_end(*node)) {
            way.nodes.push(off);
            break;
        }
    }
    way
}

/// At the node of a place by name that has the fewest people so far.
fn together(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let there = |i: &usize| {
        route.nodes.get(*i).is_some_and(|node| taken.meant.contains(node)) && sides::has_floor(net, route, human, *i)
    };
    // Where the robot's way ends they are last: it has to pass the others to get to them.
    let rank = |i: &usize| {
        let node = route.nodes.get(*i);
        let others = taken.standing.iter().filter(|other| Some(*other) == node).count();
        (others + usize::from(i + 1 == route.nodes.len()), i.abs_diff(route.meet), *i)
    };
    let at = (1..route.nodes.len()).filter(there).min_by_key(rank)?;
    let near = (SEEN_M - net.length_m(route.nodes.get(..=at)?)).max(0.0);
    let node = *route.nodes.get(at)?;
    Some(Way { nodes: vec![node], meet: node, cost: near })
}
