//! Behind: the robot's way, from its start or from before it.

use socrates_model::HumanProposal;

use super::{Taken, Way, follows};
use crate::robot_way::Route;

/// Who overtakes comes level with the robot after so much of its way, m.
const EARLY_M: f64 = 4.0;

/// Behind: the robot's way, from its start or from before it.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>, along: bool) -> Option<Way> {
    let net = taken.net;
    let start = *route.nodes.first()?;
    let second = *route.nodes.get(1)?;
    // A node before the robot's start lets it be behind from the first moment on.
    let before = net
        .near(start)
        .iter()
        .filter(|(node, length)| !route.nodes.contains(node) && *length >= 1.5 && !net.inside(*node))
        .map(|(node, _)| *node)
        .max_by(|a, b| net.straight(*a, start, second).total_cmp(&net.straight(*b, start, second)));
    let mut nodes: Vec<usize> = before.into_iter().collect();
    nodes.extend(&route.nodes);
    // Somebody who only walks along is met on the way, before others are.
    let meet = if along && route.meet > 1 { route.meet - 1 } else { route.meet };
    // Who overtakes is level with the robot early, so that the way is long enough to get past it.
    let early = (1..=meet).find(|i| {
        let known = route.nodes.get(*i).is_some_and(|node| net.is(*node, taken.place));
        known && net.length_m(route.nodes.get(..=*i).unwrap_or_default()) >= EARLY_M
    });
    let meet = if follows(human) { meet } else { early.unwrap_or(meet) };
    let cost = if before.is_some() { 0.0 } else { 1.0 };
    Some(Way { nodes, meet: *route.nodes.get(meet)?, cost })
}
