//! Ways round what stands on the floor, and ways as few straight pieces.

use socrates_maps::cheapest_way;
use socrates_model::geometry::nearest_on_segment;

use crate::cells::Cell;
use crate::floor::{BODY_M, Floor, Spot};

/// Clearance from which on a way is not made dearer, m.
const COMFORT_M: f64 = 0.8;
/// A way is looked for in the box round both ends and so far beyond it, m.
const BEYOND_M: f64 = 5.0;
/// A straight piece keeps this from walls where there is room, m.
pub(crate) const KEPT_M: f64 = 0.42;
/// A straight piece never keeps less than this: the robot's half width, less what half a cell makes of it, m.
pub(crate) const LEAST_M: f64 = BODY_M - 0.02;
/// How far a straight piece may lie from the way, as a share of the clearance there, and within which bounds, m.
const ASIDE_SHARE: f64 = 0.5;
/// See [`ASIDE_SHARE`].
const ASIDE_M: (f64, f64) = (0.25, 1.2);

/// Whether the robot gets along the straight line between two spots, with as much beside it as a share of what the way keeps.
pub(crate) fn is_straight(floor: &Floor, from: &Spot, to: &Spot, kept_m: f64) -> bool {
    floor.line_m(from, to) >= kept_m.clamp(LEAST_M, KEPT_M)
}

/// Least raw clearance on a way, m.
pub(crate) fn least_m(floor: &Floor, path: &[Spot]) -> f64 {
    path.iter().map(|spot| floor.raw_m(spot)).fold(f64::INFINITY, f64::min)
}

/// The way as few straight pieces that keep off the walls as it does and lie near it; both ends included.
pub(crate) fn simplified(floor: &Floor, path: &[Spot]) -> Vec<Spot> {
    let mut out: Vec<Spot> = path.first().copied().into_iter().collect();
    let mut open: Vec<&[Spot]> = vec![path];
    while let Some(piece) = open.pop() {
        let (Some(from), Some(to)) = (piece.first(), piece.last()) else { continue };
        let aside = |spot: &Spot| nearest_on_segment(spot, from, to).0;
        let farthest = piece.iter().enumerate().max_by(|a, b| aside(a.1).total_cmp(&aside(b.1)));
        let (place, spot) = farthest.map_or((0, *from), |(place, spot)| (place, *spot));
        let allowed = (ASIDE_SHARE * floor.clean_m(&spot)).clamp(ASIDE_M.0, ASIDE_M.1);
        let fits = aside(&spot) <= allowed && is_straight(floor, from, to, 0.85 * least_m(floor, piece));
        if fits || piece.len() <= 2 {
            out.push(*to);
            continue;
        }
        let inner = if aside(&spot) < 0.5 * floor.cell_m { piece.len() / 2 } else { place };
        let inner = inner.clamp(1, piece.len() - 2);
        // The first half is looked at first.
        open.extend(piece.get(inner..));
        open.extend(piece.get(..=inner));
    }
    out
}

/// The way from a door, or from any other spot, past a spot straight before it.
pub(crate) fn approach(floor: &Floor, from: &Spot, before: &Spot, to: &Spot) -> Option<Vec<Spot>> {
    if is_straight(floor, from, to, LEAST_M) {
        return Some(vec![*from, *to]);
    }
    if before == from || !is_straight(floor, from, before, LEAST_M) {
        return way(floor, from, to);
    }
    // Through a narrow door the way is straight, whatever the cells beside it say.
    if is_straight(floor, before, to, LEAST_M) {
        return Some(vec![*from, *before, *to]);
    }
    way(floor, before, to).map(|path| [*from].into_iter().chain(path).collect())
}

/// The way of the robot between two spots over the map as it is, cell by cell; `None` where it does not get there nearby.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cells of a map, far below 2^32")]
pub(crate) fn way(floor: &Floor, from: &Spot, to: &Spot) -> Option<Vec<Spot>> {
    let (start, goal) = (floor.cell(from), floor.cell(to));
    let (width, height) = floor.size();
    let margin = (BEYOND_M / floor.cell_m) as usize;
    let low = (start.0.min(goal.0).saturating_sub(margin), start.1.min(goal.1).saturating_sub(margin));
    let high = ((start.0.max(goal.0) + margin + 1).min(width), (start.1.max(goal.1) + margin + 1).min(height));
    let (wide, tall) = (high.0.checked_sub(low.0)?, high.1.checked_sub(low.1)?);
    let own = |cell: Cell| (cell.0.wrapping_sub(low.0), cell.1.wrapping_sub(low.1));
    let spot = |cell: Cell| floor.spot((cell.0 + low.0, cell.1 + low.1));
    let (start, goal) = (own(start), own(goal));
    let ahead = |cell: Cell| (spot(cell) - spot(goal)).norm();
    let cells = cheapest_way((wide, tall), (start, goal), ahead, |_here, next, cells| {
        let clear_m = floor.raw_m(&spot(next));
        let price = || 1.0 + ((COMFORT_M - clear_m) / (COMFORT_M - LEAST_M)).clamp(0.0, 1.0);
        (clear_m >= LEAST_M || next == goal).then(|| cells * floor.cell_m * price())
    })?;
    let mut path: Vec<Spot> = cells.into_iter().map(spot).collect();
    if let Some(last) = path.last_mut() {
        *last = *to;
    }
    if let Some(first) = path.first_mut() {
        *first = *from;
    }
    Some(path)
}
