//! Two small tools of the grid's questions: a table of values per cell, and the map's frame.

use socrates_model::{Grid, Point};

/// A value per cell (or lattice point), row by row from the top; reading outside gives `None`.
#[derive(Debug, Clone)]
pub struct Layer<T> {
    /// Columns.
    pub width: usize,
    /// Values row by row from the top.
    pub values: Vec<T>,
}

impl<T: Copy> Layer<T> {
    /// The same value everywhere.
    #[must_use]
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self { width, values: vec![value; width.saturating_mul(height)] }
    }

    /// The value at a column and row; `None` outside.
    #[must_use]
    pub fn get(&self, column: usize, row: usize) -> Option<T> {
        if column >= self.width {
            return None;
        }
        self.values.get(row.checked_mul(self.width)?.checked_add(column)?).copied()
    }

    /// The value here and the one to its right; outside they are the default.
    pub(crate) fn pair(&self, column: usize, row: usize) -> [T; 2]
    where
        T: Default,
    {
        let start = row.saturating_mul(self.width).saturating_add(column);
        // Inside a row both are found with one look at the bounds.
        if column.saturating_add(1) < self.width
            && let Some([here, right]) = self.values.get(start..start.saturating_add(2))
        {
            return [*here, *right];
        }
        [column, column.saturating_add(1)].map(|column| self.get(column, row).unwrap_or_default())
    }

    /// Writes a value; nothing happens outside.
    pub fn set(&mut self, column: usize, row: usize, value: T) {
        if column >= self.width {
            return;
        }
        if let Some(slot) = self.values.get_mut(row.saturating_mul(self.width).saturating_add(column)) {
            *slot = value;
        }
    }
}

/// Where the cells lie in the world, with the turn of the origin worked out once.
#[derive(Debug, Clone)]
pub(crate) struct Raster {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) resolution_m: f64,
    origin: Point,
    cos: f64,
    sin: f64,
}

#[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
impl Raster {
    pub(crate) fn of(grid: &Grid) -> Self {
        let (sin, cos) = libm::sincos(grid.origin.yaw);
        let origin = grid.origin.point();
        Self { width: grid.width, height: grid.height, resolution_m: grid.resolution_m, origin, cos, sin }
    }

    /// Continuous pixel position of a world point; (0, 0) is the top left corner of the image.
    pub(crate) fn pixel(&self, point: &Point) -> (f64, f64) {
        let away = point - self.origin;
        let along = away.x * self.cos + away.y * self.sin;
        let up = away.y * self.cos - away.x * self.sin;
        (along / self.resolution_m, self.height as f64 - up / self.resolution_m)
    }

    /// World point of a continuous pixel position.
    pub(crate) fn world(&self, px: f64, py: f64) -> Point {
        let (along, up) = (px * self.resolution_m, (self.height as f64 - py) * self.resolution_m);
        Point::new(self.origin.x + along * self.cos - up * self.sin, self.origin.y + along * self.sin + up * self.cos)
    }

    /// World point of the middle of a cell.
    pub(crate) fn center(&self, column: usize, row: usize) -> Point {
        self.world(column as f64 + 0.5, row as f64 + 0.5)
    }

    /// Cell under a pixel position, if the map covers it.
    pub(crate) fn cell(&self, px: f64, py: f64) -> Option<(usize, usize)> {
        let inside = px >= 0.0 && py >= 0.0 && px < self.width as f64 && py < self.height as f64;
        inside.then(|| (floor_index(px), floor_index(py)))
    }

    /// Cells whose middle lies in the square of this half side round a pixel position, row by row.
    pub(crate) fn cells_around(&self, px: f64, py: f64, half: f64) -> impl Iterator<Item = (usize, usize)> + use<> {
        let columns = floor_index((px - half).max(0.0))..floor_index((px + half + 1.0).max(0.0)).min(self.width);
        let rows = floor_index((py - half).max(0.0))..floor_index((py + half + 1.0).max(0.0)).min(self.height);
        rows.flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }
}

/// The whole part of a number that is not negative.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "callers pass values that are not negative"
)]
pub(crate) fn floor_index(value: f64) -> usize {
    value as usize
}
