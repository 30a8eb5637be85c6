//! The static layer: walls of the map.

use socrates_model::{Cell, Grid, Point};

use super::grid::{Bounds, Costmap, FREE, LETHAL, UNKNOWN};
use super::layered::{CostmapParams, Layer, Merge, Sensed};

/// Parameters of the static layer. A map cell is free, occupied or unknown: Nav2's `trinary` mode. An unknown cell is
/// unknown where the costmap tracks that, else free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StaticParams {
    /// Whether the larger cost is kept where a layer before this one wrote; default false: the map overwrites.
    pub use_maximum: bool,
}

/// The static layer.
#[derive(Debug)]
pub struct StaticLayer {
    params: StaticParams,
    walls: Costmap,
    /// Whether the costmap is a window elsewhere, so that cells are looked up by place.
    rolling: bool,
    written: bool,
}

impl StaticLayer {
    /// A map of the size of a location, every cell at the same cost. One whose origin is turned is covered by a box along the axes.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a map has fewer than 2^52 cells a side"
    )]
    pub(super) fn frame(walls: &Grid, cost: u8) -> Costmap {
        let (width, height) = (walls.width as f64, walls.height as f64);
        let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
        let corners = corners.map(|(x, y)| walls.world_from_pixel(x, y));
        let of = |pick: fn(&Point) -> f64, best: fn(f64, f64) -> f64| corners.iter().map(pick).reduce(best);
        let (left, right) = (of(|at| at.x, f64::min).unwrap_or(0.0), of(|at| at.x, f64::max).unwrap_or(0.0));
        let (bottom, top) = (of(|at| at.y, f64::min).unwrap_or(0.0), of(|at| at.y, f64::max).unwrap_or(0.0));
        // Rounding of the corners must not add a row.
        let cells = |size_m: f64| (size_m / walls.resolution_m - 1e-6).ceil().max(1.0) as usize;
        Costmap::new(cells(right - left), cells(top - bottom), walls.resolution_m, Point::new(left, bottom), cost)
    }

    /// The layer over a location; `default` is the cost of cells beyond it.
    #[must_use]
    pub fn new(params: &StaticParams, grid: &Grid, costmap: &CostmapParams, default: u8) -> Self {
        let mut walls = Self::frame(grid, default);
        let unknown = if costmap.track_unknown_space { UNKNOWN } else { FREE };
        for row in 0..walls.height() {
            for column in 0..walls.width() {
                let Some((x, y)) = grid.cell_of(&walls.center(column, row)) else { continue };
                let cost = match grid.at(x, y) {
                    Cell::Free => FREE,
                    Cell::Occupied => LETHAL,
                    Cell::Unknown => unknown,
                };
                walls.set(column, row, cost);
            }
        }
        Self { params: *params, walls, rolling: costmap.rolling_window, written: false }
    }
}

impl Layer for StaticLayer {
    fn look(&mut self, map: &Costmap, _sensed: &Sensed<'_>, bounds: &mut Bounds) {
        if self.rolling || !self.written {
            bounds.join(&map.whole());
        }
        self.written = true;
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, _sensed: &Sensed<'_>) {
        if self.rolling {
            for row in bounds.bottom..bounds.top {
                for column in bounds.left..bounds.right {
                    // Beyond the location nothing is known of a window's cell.
                    let Some((x, y)) = self.walls.cell(&map.center(column, row)) else { continue };
                    let new = self.walls.cost(x, y);
                    let old = map.cost(column, row);
                    let cost = if self.params.use_maximum { Merge::Max.merged(old, new) } else { new };
                    map.set(column, row, cost);
                }
            }
        } else if self.params.use_maximum {
            Merge::Max.merge(map, &self.walls, bounds);
        } else {
            map.rows_mut(bounds).zip(self.walls.rows(bounds)).for_each(|(row, walls)| row.copy_from_slice(walls));
        }
    }

    fn roll(&mut self, _columns: isize, _rows: isize) {}

    fn clear(&mut self) {
        self.written = false;
    }
}
