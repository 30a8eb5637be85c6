//! Inside, as far from the door as it goes; met where the robot's way ends, or where it passes.

use socrates_model::HumanProposal;

use super::{Taken, Way, sources};
use crate::inside::{self, same_door};
use crate::robot_way::Route;

/// Inside, as far from the door as it goes; met where the robot's way ends, or where it passes.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let last = *route.nodes.last()?;
    let meet = if net.inside(last) { last } else { *route.nodes.get(route.meet)? };
    let tree = net.tree(*route.nodes.get(route.meet)?, &|_| false);
    let mut all = inside::nodes(net, sources(human, net.location));
    if net.inside(last) {
        all.retain(|node| same_door(net, *node, Some(last)));
        let at = all.into_iter().max_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)))?;
        return Some(Way { nodes: vec![at], meet, cost: 0.0 });
    }
    let at = all.into_iter().min_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)))?;
    Some(Way { nodes: vec![at], meet, cost: 0.2 * tree.length_m(at) })
}
