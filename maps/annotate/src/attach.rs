//! What ends at open floor or at a door is led to the ways before it.

use crate::floor::{Floor, Spot};
use crate::middle::middle;
use crate::network::{Branch, Held, Network};
use crate::sketch::Ground;
use crate::way::{LEAST_M, approach, is_straight};

/// Ways this near to a door are looked at first, m.
const NEAR_M: f64 = 8.0;
/// Places of ways that are tried, the nearest first, before a door is led round something.
const SEEN_MOST: usize = 400;

/// Adds the places on open floor, and leads what ends at its rim to them.
pub(crate) fn open_floor(ground: &Ground<'_>, network: &mut Network) {
    let floor = ground.floor;
    let from = network.branches.len();
    for lattice in &ground.open.lattices {
        let knots: Vec<usize> = lattice.spots.iter().map(|spot| network.add(*spot, Some(Held::Open))).collect();
        for way in &lattice.ways {
            let [Some(from), Some(to)] = way.map(|end| knots.get(end).copied()) else { continue };
            let [Some(a), Some(b)] = [from, to].map(|knot| network.knots.get(knot).map(|knot| knot.at)) else {
                continue;
            };
            network.branches.push(Branch { ends: [from, to], path: dense(floor, &a, &b) });
        }
    }
    let rims: Vec<usize> = (0..network.knots.len())
        .filter(|knot| network.knots.get(*knot).is_some_and(|knot| knot.held == Some(Held::Rim)))
        .collect();
    for rim in rims {
        let Some(knot) = network.knots.get_mut(rim) else { continue };
        knot.held = None;
        let at = knot.at;
        let mut near: Vec<(f64, usize, usize)> = Vec::new();
        for (number, branch) in network.branches.iter().enumerate().skip(from) {
            let spots = branch.path.iter().enumerate();
            near.extend(spots.map(|(place, spot)| ((spot - at).norm(), number, place)));
        }
        join(floor, network, (rim, &at), near, &|spot| is_straight(floor, &at, spot, LEAST_M));
    }
}

/// A straight way with a place at every other cell.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few cells of a way")]
fn dense(floor: &Floor, from: &Spot, to: &Spot) -> Vec<Spot> {
    let steps = ((to - from).norm() / (2.0 * floor.cell_m)).ceil().clamp(1.0, 1e4) as u32;
    (0..=steps).map(|step| from + (to - from) * (f64::from(step) / f64::from(steps))).collect()
}

/// Leads a knot to the nearest of the places of branches that it sees, or round something to the nearest one.
fn join(
    floor: &Floor,
    network: &mut Network,
    (knot, before): (usize, &Spot),
    mut near: Vec<(f64, usize, usize)>,
    sees: &dyn Fn(&Spot) -> bool,
) -> bool {
    let Some(at) = network.knots.get(knot).map(|knot| knot.at) else { return false };
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let seen = near.iter().take(SEEN_MOST).find(|(_, branch, place)| {
        let spot = network.branches.get(*branch).and_then(|branch| branch.path.get(*place));
        spot.is_some_and(sees)
    });
    let Some((_, branch, place)) = seen.or_else(|| near.first()).copied() else { return false };
    let Some(other) = network.parted(branch, place) else { return false };
    lead(floor, network, (at, *before), knot, other);
    true
}

/// A branch between two knots, straight or round something.
fn lead(floor: &Floor, network: &mut Network, (at, before): (Spot, Spot), knot: usize, other: usize) {
    let Some(to) = network.knots.get(other).map(|knot| knot.at).filter(|_| other != knot) else { return };
    if let Some(path) = approach(floor, &at, &before, &to) {
        network.branches.push(Branch { ends: [knot, other], path });
    }
}

/// Leads a door to the nearest way of the region before it.
pub(crate) fn attach(ground: &Ground<'_>, network: &mut Network, door: usize, (region, before): (usize, Spot)) {
    let Some(at) = network.knots.get(door).map(|knot| knot.at) else { return };
    let floor = ground.floor;
    let mut near: Vec<(f64, usize, usize)> = Vec::new();
    for within_m in [NEAR_M, f64::INFINITY] {
        for (number, branch) in network.branches.iter().enumerate().filter(|(_, branch)| !branch.ends.contains(&door)) {
            for (place, spot) in branch.path.iter().enumerate() {
                let off_m = (spot - before).norm();
                if off_m <= within_m && ground.regions.of(floor.cell(spot)) == Some(region) {
                    near.push((off_m, number, place));
                }
            }
        }
        if !near.is_empty() {
            break;
        }
    }
    // On this side of the door, which is closed on the clean map.
    let through = is_straight(floor, &at, &before, LEAST_M);
    let sees = |spot: &Spot| {
        let straight = is_straight(floor, &at, spot, LEAST_M);
        floor.clean_line_m(&before, spot) > 0.0 && (straight || through && is_straight(floor, &before, spot, LEAST_M))
    };
    if !join(floor, network, (door, &before), near, &sees) {
        // A piece of floor without a way of its own.
        let middle = middle(floor, ground.regions, region, &[before]);
        let known = network.knots.iter().position(|knot| knot.held.is_none() && knot.at == middle);
        let knot = known.unwrap_or_else(|| network.add(middle, None));
        lead(floor, network, (at, before), door, knot);
    }
}
