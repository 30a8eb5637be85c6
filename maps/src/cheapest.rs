//! The cheapest way over the cells of a grid.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::layer::Layer;

/// The eight neighbors of a cell.
const AROUND: [(isize, isize); 8] = [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];

/// The cells of the cheapest way on a grid of this width and height, start and goal included; `None` where there is no way.
///
/// A* over the eight neighbors of a cell. `ahead` is what it costs at least from a cell to the goal. `step` is the cost of a step
/// from a cell to its neighbor at this distance in cells (1 or √2); `None` where there is no step. Of open cells with the same
/// cost the one with the smaller column, then row, comes first.
#[must_use]
pub fn cheapest_way(
    (width, height): (usize, usize),
    (start, goal): ((usize, usize), (usize, usize)),
    ahead: impl Fn((usize, usize)) -> f64,
    step: impl Fn((usize, usize), (usize, usize), f64) -> Option<f64>,
) -> Option<Vec<(usize, usize)>> {
    let mut cost = Layer::filled(width, height, f64::INFINITY);
    let mut came: Layer<(u32, u32)> = Layer::filled(width, height, (u32::MAX, u32::MAX));
    // Bits of floats that are not negative sort as the floats do.
    let mut open = BinaryHeap::from([Reverse((ahead(start).to_bits(), 0.0_f64.to_bits(), start))]);
    cost.set(start.0, start.1, 0.0);
    while let Some(Reverse((_, bits, cell))) = open.pop() {
        if cell == goal {
            return Some(walked_back(&came, start, goal));
        }
        let Some(so_far) = cost.get(cell.0, cell.1).filter(|known| known.to_bits() == bits) else { continue };
        for (dx, dy) in AROUND {
            let next = match (cell.0.checked_add_signed(dx), cell.1.checked_add_signed(dy)) {
                (Some(column), Some(row)) if column < width && row < height => (column, row),
                (Some(_), Some(_)) | (None, _) | (_, None) => continue,
            };
            let cells = if dx == 0 || dy == 0 { 1.0 } else { std::f64::consts::SQRT_2 };
            let Some(total) = step(cell, next, cells).map(|price| so_far + price) else { continue };
            if cost.get(next.0, next.1).is_some_and(|known| total < known) {
                cost.set(next.0, next.1, total);
                let back = (u32::try_from(cell.0).unwrap_or(u32::MAX), u32::try_from(cell.1).unwrap_or(u32::MAX));
                came.set(next.0, next.1, back);
                open.push(Reverse(((total + ahead(next)).to_bits(), total.to_bits(), next)));
            }
        }
    }
    None
}

fn walked_back(came: &Layer<(u32, u32)>, start: (usize, usize), goal: (usize, usize)) -> Vec<(usize, usize)> {
    let mut way = vec![goal];
    let mut at = goal;
    while at != start {
        let Some((column, row)) = came.get(at.0, at.1).filter(|back| back.0 != u32::MAX) else { break };
        at = (column as usize, row as usize);
        way.push(at);
    }
    way.reverse();
    way
}
