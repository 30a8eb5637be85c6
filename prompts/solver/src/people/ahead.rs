//! Ahead: the robot's way from a node further on, so that the robot comes up at the meeting node.

use socrates_model::{HumanProposal, PlaceClass, Relation};

use super::{ROBOT_MPS, Taken, Way, before_m};
use crate::robot_way::Route;

/// Somebody who starts where the robot meets the others is met at least so far from there, m.
const FURTHER_M: f64 = 2.0;
/// Cost of such a start, and of one from which nobody is met further on.
const LATE: f64 = 4.0;
const AT_ONCE: f64 = 12.0;

/// Ahead: the robot's way from a node further on, so that the robot comes up at the meeting node.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let reach = before_m(net, route);
    let lead = (reach * (1.0 - human.speed_mps.unwrap_or(0.5).min(0.75) / ROBOT_MPS)).max(2.0);
    let wanted = if human.relation == Relation::Abreast { 1.5 } else { lead };
    let start =
        (1..=route.meet).filter(|i| route.nodes.get(*i).is_some_and(|node| taken.free(*node))).min_by(|a, b| {
            let off = |i: usize| (net.length_m(route.nodes.get(..=i).unwrap_or_default()) - wanted).abs();
            off(*a).total_cmp(&off(*b))
        })?;
    let mut nodes = route.nodes.get(start..)?.to_vec();
    // Into a car or room the robot goes alone: whoever walks ahead ends before its door and lets it through.
    let shared = (route.meet - start + 2).min(nodes.len());
    let out = nodes.iter().skip(shared).position(|node| net.inside(*node)).map_or(nodes.len(), |n| shared + n);
    if out < nodes.len() {
        nodes.truncate(out);
        while nodes.len() > shared && nodes.last().is_some_and(|node| net.kind(*node) == PlaceClass::Doorway) {
            nodes.pop();
        }
    }
    // Nor does it stand in the robot's way there: it goes on past the door.
    if let (Some(last), Some(previous)) = (nodes.last().copied(), nodes.len().checked_sub(2).and_then(|i| nodes.get(i)))
        && route.nodes.get(start..).is_some_and(|own| nodes.len() < own.len())
    {
        let on =
            net.near(last).iter().map(|(node, _)| *node).filter(|node| {
                !route.nodes.contains(node) && !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway
            });
        let turn = |node: usize| net.straight(*previous, last, node);
        let on = on.max_by(|a, b| turn(*a).total_cmp(&turn(*b)));
        nodes.extend(on);
    }
    let meet = *route.nodes.get(route.meet)?;
    if start < route.meet {
        return Some(Way { nodes, meet, cost: 0.0 });
    }
    // Somebody who can only start where the robot meets others is met further on, but not where the robot's way ends.
    let on = |at: &usize| {
        let from = route.nodes.get(start..=*at).unwrap_or_default();
        net.length_m(from) >= FURTHER_M && from.last().is_some_and(|node| net.is(*node, taken.place))
    };
    let further = (start + 1..route.nodes.len().saturating_sub(1)).find(on);
    let further = further.and_then(|at| route.nodes.get(at)).filter(|node| nodes.contains(node));
    let cost = if further.is_some() { LATE } else { AT_ONCE };
    Some(Way { meet: further.copied().unwrap_or(meet), nodes, cost })
}
