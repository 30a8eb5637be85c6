//! Across: in by one way that the robot does not use, out by another. Somebody who is to come from where the robot goes to goes out
//! by a way of their own.

use socrates_model::{HumanProposal, PlaceClass};

use super::{Taken, Way, extend, ideal_m, onward, onward_m};
use crate::edit::LEAST_HUMAN_M;
use crate::robot_way::Route;
use crate::sides;

/// Cost of a way that ends right after the meeting.
const SHORT_TAIL: f64 = 3.0;

/// A path that is hardly longer than the least one, m, may be too short once it is written; and the cost of a path that is too short.
const ROUNDED_M: f64 = 0.05;
const TOO_SHORT: f64 = 20.0;

/// Cost of turning into the robot's own way instead of crossing it: a room on the other side is better.
const OWN_WAY: f64 = 3.0;

/// Cost per what two ways over a corner are more alike than this, as the cosine between them.
const SAME_CORNER: f64 = 16.0;
const CROSSES: f64 = 0.75;

/// Across: in by one way that the robot does not use, out by another.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let meet = *route.nodes.get(route.meet)?;
    let used =
        [route.meet.checked_sub(1).and_then(|i| route.nodes.get(i)).copied(), route.nodes.get(route.meet + 1).copied()];
    let free: Vec<usize> = net
        .near(meet)
        .iter()
        .map(|(node, _)| *node)
        .filter(|node| !used.contains(&Some(*node)) && !route.nodes.contains(node))
        .collect();
    let ideal = ideal_m(human, net, route);
    let into = used.first().copied().flatten()?;
    let mut best: Option<Way> = None;
    let mut entries = taken.entry.map_or_else(|| free.clone(), |entry| vec![entry]);
    entries.retain(|entry| sides::enters(net, route, human, *entry));
    for entry in &entries {
        let own_entry = used.contains(&Some(*entry));
        // Somebody who comes along the way that the robot goes on by comes from farther on there.
        let before = route.nodes.get(..=route.meet).unwrap_or_default();
        let barred = |node: usize| if own_entry { before.contains(&node) } else { route.nodes.contains(&node) };
        let tree = net.tree(*entry, &barred);
        let step = onward_m(net, meet, &[*entry]);
        // Out by a free way if there is one, else along the robot's own; where it came from before where it goes to.
        let back = used.iter().copied().flatten().filter(|_| !own_entry);
        let exits = free.iter().copied().filter(|exit| exit != entry).chain(back);
        let tails: Vec<(usize, Vec<usize>, f64)> = exits
            .flat_map(|exit| {
                let mut tail = vec![*entry, meet, exit];
                let short = (exit, vec![meet, exit], taken.end_cost(&tail) + SHORT_TAIL);
                extend(net, &mut tail, meet, &|node| route.nodes.contains(&node) && node != exit);
                onward(&mut tail, taken, Taken::can_end);
                let cost = taken.end_cost(&tail);
                [(exit, tail.split_off(1), cost), short]
            })
            .collect();
        for start in (0..net.len()).filter(|start| tree.length_m(*start).is_finite() && taken.free(*start)) {
            let length = tree.length_m(start) + step;
            let way = tree.way(start);
            for (exit, tail, end_cost) in &tails {
                if way.iter().any(|node| tail.contains(node)) {
                    continue;
                }
                let side = net.straight(into, meet, *entry).abs();
                let turn = net.straight(*entry, meet, *exit);
                let own = if own_entry || used.contains(&Some(*exit)) { OWN_WAY } else { 0.0 };
                // Where the robot turns, a way that cuts the same corner does not cross its own.
                let along = used.get(1).copied().flatten().map_or(0.0, |out| net.alike((into, out), (*entry, *exit)));
                let own = own + SAME_CORNER * (along - CROSSES).max(0.0);
                let into = net.inside(*exit) || net.kind(*exit) == PlaceClass::Doorway;
                let inside =
                    way.iter().filter(|node| net.inside(**node)).count() as f64 * 3.0 + if into { 2.0 } else { 0.0 };
                let cost = 0.2 * (length - ideal).abs() + if length < 3.0 { 10.0 } else { 0.0 } + 2.0 * side
                    - 0.5 * turn
                    + own
                    + inside
                    + end_cost
                    + if length + net.length_m(tail) < LEAST_HUMAN_M + ROUNDED_M { TOO_SHORT } else { 0.0 };
                if best.as_ref().is_none_or(|best| cost < best.cost - 1e-9) {
                    let mut nodes: Vec<usize> = way.iter().rev().copied().collect();
                    nodes.extend(tail);
                    best = Some(Way { nodes, meet, cost });
                }
            }
        }
    }
    best
}
