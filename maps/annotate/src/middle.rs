//! The middle of a region.

use socrates_model::Vector;

use crate::cells::Cell;
use crate::floor::{Floor, Spot};
use crate::region::{Regions, roomiest};
use crate::way::{LEAST_M, is_straight};

/// The middle is looked for on a lattice of this step, m.
const LATTICE_M: f64 = 0.25;
/// Clearance beyond which more is no better, m.
const ROOMY_M: f64 = 1.0;

/// Where somebody stands who is in the middle of a region: roomy, near the middle of its floor, in sight of its doors.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells of a map"
)]
pub(crate) fn middle(floor: &Floor, regions: &Regions, region: usize, doors: &[Spot]) -> Spot {
    let Some(known) = regions.all.get(region) else { return Spot::origin() };
    let every = ((LATTICE_M / floor.cell_m) as usize).max(1);
    let cells: Vec<Cell> = (known.extent.rows.0..=known.extent.rows.1)
        .step_by(every)
        .flat_map(|row| {
            (known.extent.columns.0..=known.extent.columns.1).step_by(every).map(move |column| (column, row))
        })
        .chain([known.roomiest])
        .filter(|cell| regions.of(*cell) == Some(region))
        .collect();
    let count = cells.len().max(1) as f64;
    let sum = cells.iter().map(|cell| floor.spot(*cell).coords).fold(Vector::zeros(), |a, b| a + b);
    let center = Spot::from(sum / count);
    let score = |spot: &Spot| {
        let seen = doors.iter().filter(|door| is_straight(floor, spot, door, LEAST_M)).count();
        let clear_m = floor.raw_m(spot);
        let stands = if clear_m >= LEAST_M { 0.0 } else { -10.0 };
        stands + 2.0 * clear_m.min(ROOMY_M) + 0.8 * seen as f64 - 0.2 * (spot - center).norm()
    };
    let spots = cells.iter().map(|cell| floor.spot(*cell));
    let best = spots.map(|spot| (score(&spot), spot)).reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map_or_else(|| roomiest(floor, known), |(_, spot)| spot)
}
