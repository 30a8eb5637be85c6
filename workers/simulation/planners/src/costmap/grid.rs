//! One grid of costs.

use socrates_model::{Point, Vector};

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

    /// The rows of a box, each from the left edge of the box to its right edge, bottom row first.
    pub(crate) fn rows_mut(&mut self, bounds: &Bounds) -> impl Iterator<Item = &mut [u8]> {
        let Bounds { left, bottom, right, top } = *bounds;
        let rows = self.costs.chunks_exact_mut(self.width.max(1)).take(top).skip(bottom);
        rows.filter_map(move |row| row.get_mut(left..right))
    }

    /// The same, to be read.
    pub(crate) fn rows(&self, bounds: &Bounds) -> impl Iterator<Item = &[u8]> {
        let Bounds { left, bottom, right, top } = *bounds;
        let rows = self.costs.chunks_exact(self.width.max(1)).take(top).skip(bottom);
        rows.filter_map(move |row| row.get(left..right))
    }

    /// The cells of a square round a point, cut at the edges of the map.
    #[must_use]
    pub fn square(&self, center: &Point, reach_m: f64) -> Bounds {
        let reach = Vector::new(reach_m, reach_m);
        self.rectangle(&(center - reach), &(center + reach))
    }

    /// The cells of a rectangle between two corners, cut at the edges of the map.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "held to the size of the map")]
    pub fn rectangle(&self, least: &Point, most: &Point) -> Bounds {
        let cell = |at: f64, size: usize| at.floor().clamp(0.0, size as f64) as usize;
        let column = |x: f64| cell((x - self.origin.x) / self.resolution_m, self.width);
        let row = |y: f64| cell((y - self.origin.y) / self.resolution_m, self.height);
        // The far edge is exclusive.
        let (right, top) = (column(most.x + self.resolution_m), row(most.y + self.resolution_m));
        let bounds = Bounds { left: column(least.x), bottom: row(least.y), right, top };
        if bounds.is_empty() { Bounds::EMPTY } else { bounds }
    }

    /// Every cell.
    #[must_use]
    pub const fn whole(&self) -> Bounds {
        Bounds { left: 0, bottom: 0, right: self.width, top: self.height }
    }

    /// Moves the window by whole cells: what both windows cover is kept, what is new costs `cost`.
    pub fn roll(&mut self, columns: isize, rows: isize, cost: u8) {
        if columns == 0 && rows == 0 {
            return;
        }
        self.origin.x += columns as f64 * self.resolution_m;
        self.origin.y += rows as f64 * self.resolution_m;
        let (across, up) = (columns.unsigned_abs(), rows.unsigned_abs());
        if across >= self.width || up >= self.height {
            self.costs.fill(cost);
            return;
        }
        let kept = self.width - across;
        let (from_column, to_column) = if columns > 0 { (across, 0) } else { (0, across) };
        let mut copy = |from_row: usize, to_row: usize| {
            let from = from_row * self.width + from_column;
            self.costs.copy_within(from..from + kept, to_row * self.width + to_column);
        };
        // Rows are taken in the order in which none is overwritten before it is read.
        if rows >= 0 {
            (0..self.height - up).for_each(|row| copy(row + up, row));
        } else {
            (up..self.height).rev().for_each(|row| copy(row - up, row));
        }
        let (bottom, top) = if rows >= 0 { (self.height - up, self.height) } else { (0, up) };
        let (left, right) = if columns >= 0 { (kept, self.width) } else { (0, across) };
        self.rows_mut(&Bounds { left: 0, bottom, right: self.width, top }).for_each(|row| row.fill(cost));
        self.rows_mut(&Bounds { left, bottom: 0, right, top: self.height }).for_each(|row| row.fill(cost));
    }
}

/// A box of cells; the right and the top edge do not belong to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bounds {
    /// First column.
    pub left: usize,
    /// First row.
    pub bottom: usize,
    /// Column after the last.
    pub right: usize,
    /// Row after the last.
    pub top: usize,
}

impl Bounds {
    /// No cell at all; the neutral box of [`Bounds::join`].
    pub const EMPTY: Self = Self { left: usize::MAX, bottom: usize::MAX, right: 0, top: 0 };

    /// Whether no cell is inside.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.left >= self.right || self.bottom >= self.top
    }

    /// Whether a cell is inside.
    #[must_use]
    pub const fn holds(&self, column: usize, row: usize) -> bool {
        column >= self.left && column < self.right && row >= self.bottom && row < self.top
    }

    /// Widens the box so that it holds another one too.
    pub fn join(&mut self, other: &Self) {
        if other.is_empty() {
            return;
        }
        self.left = self.left.min(other.left);
        self.bottom = self.bottom.min(other.bottom);
        self.right = self.right.max(other.right);
        self.top = self.top.max(other.top);
    }

    /// Widens the box so that it holds a cell.
    pub fn add(&mut self, column: usize, row: usize) {
        self.join(&Self { left: column, bottom: row, right: column + 1, top: row + 1 });
    }

    /// The box with so many cells more on each side, cut at the edges of a map.
    #[must_use]
    pub fn grown(&self, cells: usize, width: usize, height: usize) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self {
            left: self.left.saturating_sub(cells),
            bottom: self.bottom.saturating_sub(cells),
            right: self.right.saturating_add(cells).min(width),
            top: self.top.saturating_add(cells).min(height),
        }
    }

    /// What both boxes hold.
    #[must_use]
    pub fn meet(&self, other: &Self) -> Self {
        let both = Self {
            left: self.left.max(other.left),
            bottom: self.bottom.max(other.bottom),
            right: self.right.min(other.right),
            top: self.top.min(other.top),
        };
        if both.is_empty() { Self::EMPTY } else { both }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rolled_window_keeps_what_both_windows_cover() {
        for (columns, rows) in [(2, 1), (-2, 1), (2, -1), (-3, -2), (0, 3), (3, 0), (7, 0), (0, -9), (6, 4)] {
            let mut map = Costmap::new(7, 5, 0.5, Point::new(1.0, 2.0), 0);
            for row in 0..5 {
                for column in 0..7 {
                    map.set(column, row, u8::try_from(10 * row + column).unwrap());
                }
            }
            let before = map.clone();
            map.roll(columns, rows, 99);
            for row in 0..5_usize {
                for column in 0..7_usize {
                    let from = (column.checked_add_signed(columns), row.checked_add_signed(rows));
                    let old = match from {
                        (Some(column), Some(row)) if column < 7 && row < 5 => before.cost(column, row),
                        _ => 99,
                    };
                    assert_eq!(map.cost(column, row), old, "moved by {columns}, {rows}: cell {column}, {row}");
                }
            }
            let moved = map.origin() - before.origin();
            assert!((moved.x - 0.5 * columns as f64).abs() < 1e-12 && (moved.y - 0.5 * rows as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn a_square_holds_every_cell_whose_center_is_in_it_and_ends_at_the_map() {
        let map = Costmap::new(20, 10, 0.1, Point::new(0.0, 0.0), 0);
        let square = map.square(&Point::new(0.52, 0.33), 0.2);
        assert_eq!(square, Bounds { left: 3, bottom: 1, right: 8, top: 6 });
        assert_eq!(map.square(&Point::new(9.0, 0.5), 0.2), Bounds::EMPTY);
        assert_eq!(map.square(&Point::new(1.0, 0.5), 50.0), map.whole());
    }
}
