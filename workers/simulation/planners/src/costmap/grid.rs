//! One grid of costs.

use socrates_model::Point;

/// Nothing is there.
pub const FREE: u8 = 0;
/// The dearest cell that a robot's center may be in.
pub const MOST: u8 = 252;
/// A robot whose center is here touches an obstacle.
pub const INSCRIBED: u8 = 253;
/// An obstacle.
pub const LETHAL: u8 = 254;
/// Never seen.
pub const UNKNOWN: u8 = 255;

/// Costs of square cells, row by row from the lower left.
#[derive(Debug, Clone, PartialEq)]
pub struct Costmap {
    width: usize,
    height: usize,
    resolution_m: f64,
    origin: Point,
    costs: Vec<u8>,
}

impl Costmap {
    /// A map in which every cell costs the same. `origin` is the lower left corner of the first cell, m.
    #[must_use]
    pub fn new(width: usize, height: usize, resolution_m: f64, origin: Point, cost: u8) -> Self {
        Self { width, height, resolution_m, origin, costs: vec![cost; width.saturating_mul(height)] }
    }

    /// Cells from left to right.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Cells from bottom to top.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Side of a cell, m.
    #[must_use]
    pub const fn resolution_m(&self) -> f64 {
        self.resolution_m
    }

    /// Lower left corner of the first cell, m.
    #[must_use]
    pub const fn origin(&self) -> Point {
        self.origin
    }

    /// Every cost, row by row from the lower left.
    #[must_use]
    pub fn costs(&self) -> &[u8] {
        &self.costs
    }

    /// The same, to be written.
    pub fn costs_mut(&mut self) -> &mut [u8] {
        &mut self.costs
    }

    /// Column and row of the cell that a point is in; `None` outside the map. Nav2's costmap takes the floor here, its NavFn rounds.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked against the size of the map")]
    pub fn cell(&self, point: &Point) -> Option<(usize, usize)> {
        let column = ((point.x - self.origin.x) / self.resolution_m).floor();
        let row = ((point.y - self.origin.y) / self.resolution_m).floor();
        // NaN fails both.
        let inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        inside.then_some((column as usize, row as usize))
    }

    /// Middle of a cell, m.
    #[must_use]
    pub fn center(&self, column: usize, row: usize) -> Point {
        Point::new(
            self.origin.x + (column as f64 + 0.5) * self.resolution_m,
            self.origin.y + (row as f64 + 0.5) * self.resolution_m,
        )
    }

    /// Cost of a cell; [`UNKNOWN`] outside the map.
    #[must_use]
    pub fn cost(&self, column: usize, row: usize) -> u8 {
        if column >= self.width {
            return UNKNOWN;
        }
        self.costs.get(row.saturating_mul(self.width).saturating_add(column)).copied().unwrap_or(UNKNOWN)
    }

    /// Cost where a point is; [`UNKNOWN`] outside the map.
    #[must_use]
    pub fn cost_at(&self, point: &Point) -> u8 {
        self.cell(point).map_or(UNKNOWN, |(column, row)| self.cost(column, row))
    }

    /// Sets the cost of a cell; nothing outside the map.
    pub fn set(&mut self, column: usize, row: usize, cost: u8) {
        if column < self.width
            && let Some(cell) = self.costs.get_mut(row.saturating_mul(self.width).saturating_add(column))
        {
            *cell = cost;
        }
    }
}
