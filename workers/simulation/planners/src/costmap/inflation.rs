//! The inflation layer: the room beside obstacles.

use super::grid::{Bounds, Costmap, INSCRIBED, LETHAL, MOST, UNKNOWN};
use super::layered::{Layer, Sensed};

/// Parameters of the inflation layer; defaults are Nav2's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InflationParams {
    /// Beyond this distance from an obstacle a cell costs nothing more, m; default 0.55.
    pub inflation_radius: f64,
    /// How fast costs fall with the distance, 1/m; default 10. Larger: the robot goes nearer to obstacles.
    pub cost_scaling_factor: f64,
    /// Whether unknown cells are inflated too; default false: only where the robot would touch.
    pub inflate_unknown: bool,
}

impl Default for InflationParams {
    fn default() -> Self {
        Self { inflation_radius: 0.55, cost_scaling_factor: 10.0, inflate_unknown: false }
    }
}

impl InflationParams {
    /// Cost at a distance from the nearest obstacle, both in m: 254 at 0, 253 within the inscribed radius, then
    /// 252 e^(-s (d - r)) cut to a whole number, 0 beyond the inflation radius.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 252")]
    pub fn cost(&self, distance_m: f64, inscribed_m: f64) -> u8 {
        // A distance of whole cells must not miss the radius by rounding.
        const SLACK_M: f64 = 1e-9;
        if distance_m <= 0.0 {
            LETHAL
        } else if distance_m > self.inflation_radius + SLACK_M {
            0
        } else if distance_m <= inscribed_m + SLACK_M {
            INSCRIBED
        } else {
            (f64::from(MOST) * libm::exp(-self.cost_scaling_factor * (distance_m - inscribed_m))) as u8
        }
    }
}

/// The inflation layer. It knows the cost of every offset from an obstacle and stamps it round each obstacle at the rim of others;
/// the largest cost is that of the nearest obstacle, so distances are exact.
#[derive(Debug)]
pub struct InflationLayer {
    inflate_unknown: bool,
    /// Cells from an obstacle to the farthest cell that it makes dearer.
    reach: usize,
    /// Costs of the square of offsets from an obstacle, row by row.
    stamp: Vec<u8>,
    scratch: Vec<u8>,
}

/// So many cells are looked through at once for obstacles.
const LOOK_CELLS: usize = 32;

impl InflationLayer {
    /// The layer for a map and a robot of this inscribed radius.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the size of the map")]
    pub fn new(params: &InflationParams, map: &Costmap, inscribed_m: f64) -> Self {
        let cell_m = map.resolution_m();
        let largest = map.width().max(map.height()) as f64;
        let reach = (params.inflation_radius / cell_m + 1e-6).floor().clamp(0.0, largest) as usize;
        let offsets = || (0..=2 * reach).map(|place| (place as f64 - reach as f64) * cell_m);
        let cost = |x: f64, y: f64| params.cost(libm::sqrt(x * x + y * y), inscribed_m);
        let stamp = offsets().flat_map(|y| offsets().map(move |x| cost(x, y))).collect();
        Self { inflate_unknown: params.inflate_unknown, reach, stamp, scratch: vec![0; map.costs().len()] }
    }

    /// Stamps the costs round one obstacle into the box.
    fn stamp(&mut self, (column, row): (usize, usize), width: usize, bounds: &Bounds) {
        let reach = self.reach;
        let (left, right) = (bounds.left.max(column.saturating_sub(reach)), bounds.right.min(column + reach + 1));
        let (bottom, top) = (bounds.bottom.max(row.saturating_sub(reach)), bounds.top.min(row + reach + 1));
        if left >= right || bottom >= top {
            return;
        }
        let side = 2 * reach + 1;
        let costs = self.stamp.chunks_exact(side).skip(bottom + reach - row);
        let cells = self.scratch.chunks_exact_mut(width).take(top).skip(bottom);
        for (cells, costs) in cells.zip(costs) {
            let costs = costs.get(left + reach - column..).unwrap_or_default();
            for (cell, cost) in cells.get_mut(left..right).unwrap_or_default().iter_mut().zip(costs) {
                *cell = (*cell).max(*cost);
            }
        }
    }
}

impl Layer for InflationLayer {
    fn look(&mut self, map: &Costmap, _sensed: &Sensed<'_>, bounds: &mut Bounds) {
        *bounds = bounds.grown(self.reach, map.width(), map.height());
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, _sensed: &Sensed<'_>) {
        let (width, height) = (map.width(), map.height());
        if width == 0 || bounds.is_empty() {
            return;
        }
        for row in self.scratch.chunks_exact_mut(width).take(bounds.top).skip(bounds.bottom) {
            row.get_mut(bounds.left..bounds.right).unwrap_or_default().fill(0);
        }
        let around = bounds.grown(self.reach, width, height);
        let costs = map.costs();
        let lethal = |place: usize| costs.get(place).is_some_and(|cost| *cost == LETHAL);
        for row in around.bottom..around.top {
            let start = row * width;
            let cells = costs.get(start + around.left..start + around.right).unwrap_or_default();
            for (chunk, cells) in cells.chunks(LOOK_CELLS).enumerate() {
                if !cells.iter().fold(false, |any, cost| any | (*cost == LETHAL)) {
                    continue;
                }
                for (place, _) in cells.iter().enumerate().filter(|(_, cost)| **cost == LETHAL) {
                    let column = around.left + chunk * LOOK_CELLS + place;
                    let here = start + column;
                    // The nearest obstacle of a cell always has a free neighbor towards it.
                    let inner = row > 0 && row + 1 < height && column > 0 && column + 1 < width;
                    let buried =
                        inner && lethal(here - 1) && lethal(here + 1) && lethal(here - width) && lethal(here + width);
                    if !buried {
                        self.stamp((column, row), width, bounds);
                    }
                }
            }
        }
        let scratch = self.scratch.chunks_exact(width).take(bounds.top).skip(bounds.bottom);
        let least_in_unknown = if self.inflate_unknown { 1 } else { INSCRIBED };
        for (row, new) in map.rows_mut(bounds).zip(scratch) {
            let new = new.get(bounds.left..bounds.right).unwrap_or_default();
            for (cell, new) in row.iter_mut().zip(new) {
                let known = (*cell).max(*new);
                let unknown = if *new >= least_in_unknown { *new } else { UNKNOWN };
                *cell = if *cell == UNKNOWN { unknown } else { known };
            }
        }
    }

    fn roll(&mut self, _columns: isize, _rows: isize) {}

    fn clear(&mut self) {}
}
