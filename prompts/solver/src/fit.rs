//! How well a place suits what people do there: room to get past, a layout, a corner that hides, doors that stop a crowd.

use socrates_maps::{DistanceField, Sight};
use socrates_model::{HumanProposal, PlaceClass, Point, Relation};

use crate::Layout;
use crate::graph::Net;
use crate::people::follows;
use crate::robot_way::Route;

/// Free width on each side of the middle of the floor that lets somebody past a robot there, and several at a time, m, and the
/// way that takes, m.
const BESIDE_M: f64 = 1.15;
const SEVERAL_M: f64 = 1.6;
const OVERTAKES_M: f64 = 12.0;
/// The middle of the floor is at most so far from its node, m.
const MIDDLE_M: f64 = 0.5;
/// What a node without that width costs.
pub(crate) const SQUEEZED: f64 = 2.0;

/// Whether somebody comes from behind to get past the robot.
pub(crate) fn overtakes(human: &HumanProposal) -> bool {
    human.relation == Relation::Behind && !follows(human)
}

/// How many nodes from the meeting on, as far as it takes to get past the robot, leave no room for that; of the whole way for
/// somebody who walks beside it.
pub(crate) fn squeezed(net: &Net<'_>, field: &DistanceField, route: &Route, (several, all): (bool, bool)) -> f64 {
    let beside_m = if several { SEVERAL_M } else { BESIDE_M };
    let first = if all { 0 } else { route.meet.saturating_sub(2) };
    let from = route.nodes.get(first..).unwrap_or_default();
    let near = (1..=from.len()).take_while(|n| net.length_m(from.get(..*n).unwrap_or_default()) <= OVERTAKES_M);
    let narrow = near.filter_map(|n| from.get(n - 1)).filter(|node| field.clearance(&net.at(**node)) < beside_m);
    narrow.count() as f64
}

pub(crate) fn tight(net: &Net<'_>, node: usize) -> bool {
    matches!(net.kind(node), PlaceClass::Doorway | PlaceClass::NarrowPassage)
}

/// Whether a node suits the layout that is asked for.
pub(crate) fn suits(layout: &Layout, arms: usize, width_m: impl FnOnce() -> f64) -> bool {
    let wide = |[least, most]: [f64; 2]| (least..=most).contains(&width_m());
    layout.arms.is_none_or(|least| arms >= least) && layout.width_m.is_none_or(wide)
}

/// Free width of the floor across a node, m: twice the way to the nearest wall from the middle of the floor. Nodes are put there by
/// hand, so the middle is looked for a step around them.
pub(crate) fn width_m(field: &DistanceField, at: &Point) -> f64 {
    let around = (-2..=2).flat_map(|x| (-2..=2).map(move |y| (x, y)));
    let clear = around.map(|(x, y)| {
        let (x, y) = (f64::from(x) * MIDDLE_M / 2.0, f64::from(y) * MIDDLE_M / 2.0);
        field.clearance(&Point::new(at.x + x, at.y + y))
    });
    2.0 * clear.fold(0.0, f64::max)
}

/// Whether the nodes before and after the meeting cannot see each other.
pub(crate) fn hides(net: &Net<'_>, sight: &Sight, route: &Route) -> bool {
    let around = route.meet.checked_sub(1).and_then(|i| route.nodes.get(i)).zip(route.nodes.get(route.meet + 1));
    around.is_some_and(|(a, b)| !sight.clear(&net.at(*a), &net.at(*b)))
}
