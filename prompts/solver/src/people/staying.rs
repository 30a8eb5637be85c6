//! Inside, as far from the door as it goes; met where the robot's way ends, or where it passes.

use socrates_model::HumanProposal;

use super::{Taken, Way, sources};
use crate::inside::{self, same_door};
use crate::robot_way::Route;

/// The robot's way ends at most so far from whoever stays there, m, and what it costs that it does not, per m.
const MET_M: f64 = 2.6;
const UNMET_PER_M: f64 = 2.0;

/// Inside, as far from the door as it goes; met where the robot's way ends, or where it passes.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let last = *route.nodes.last()?;
    let meet = if net.inside(last) { last } else { *route.nodes.get(route.meet)? };
    let tree = net.tree(*route.nodes.get(route.meet)?, &|_| false);
    let all = net.rooms_of(human.id, inside::nodes(net, sources(human, net.location)));
    let far_m = |node: usize| tree.length_m(node);
    let deeper = all.iter().copied().filter(|node| net.inside(last) && same_door(net, *node, Some(last)));
    // As far from the door as the robot still comes near them, else as near to it as there is a place.
    let apart_m = |node: usize| (net.at(node) - net.at(last)).norm();
    let rank = |node: usize| {
        let apart_m = apart_m(node);
        if apart_m <= MET_M { (1, far_m(node)) } else { (0, -apart_m) }
    };
    let order = |a: &usize, b: &usize| rank(*a).0.cmp(&rank(*b).0).then(rank(*a).1.total_cmp(&rank(*b).1));
    if let Some(at) = deeper.max_by(order) {
        return Some(Way { nodes: vec![at], meet, cost: UNMET_PER_M * (apart_m(at) - MET_M).max(0.0) });
    }
    let at = all.into_iter().min_by(|a, b| far_m(*a).total_cmp(&far_m(*b)))?;
    let meet = *route.nodes.get(route.meet)?;
    Some(Way { nodes: vec![at], meet, cost: 0.2 * far_m(at) })
}
