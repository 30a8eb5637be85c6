//! A grid over the crowd, in which the people of neighboring cells lie side by side in memory.

use super::pairs::Body;

/// At most this many rows; cells of larger crowds grow.
const MOST_ROWS: f64 = 256.0;
/// At most this many columns.
const MOST_COLUMNS: f64 = 512.0;

/// Rows of cells, each row from left to right.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cells {
    left: f64,
    bottom: f64,
    width_m: f64,
    height_m: f64,
    columns: usize,
    rows: usize,
    /// Where each cell begins in the sorted crowd; one more entry for the end.
    starts: Vec<u32>,
    /// Cell of each person, in the order given.
    cell_of: Vec<u32>,
}

/// What the finite part of a crowd covers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
    pub(crate) top: f64,
}

impl Extent {
    /// The rectangle around all bodies; `None` without any.
    pub(crate) fn of<'a>(bodies: impl Iterator<Item = &'a Body>) -> Option<Self> {
        bodies.fold(None, |extent, body| {
            let point = Self { left: body.x, right: body.x, bottom: body.y, top: body.y };
            Some(extent.map_or(point, |extent: Self| Self {
                left: extent.left.min(body.x),
                right: extent.right.max(body.x),
                bottom: extent.bottom.min(body.y),
                top: extent.top.max(body.y),
            }))
        })
    }

    /// The longer side, m.
    pub(crate) fn size_m(&self) -> f64 {
        (self.right - self.left).max(self.top - self.bottom)
    }

    /// The middle.
    pub(crate) fn middle(&self) -> (f64, f64) {
        (self.left / 2.0 + self.right / 2.0, self.bottom / 2.0 + self.top / 2.0)
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast keeps to the range, NaN becomes 0")]
fn whole(number: f64) -> usize {
    number as usize
}

impl Cells {
    /// Sorts the bodies by cell; `order` becomes the place of each sorted one in `bodies`. People whose
    /// state is not finite are left out.
    pub(crate) fn sort(&mut self, bodies: &[Body], extent: &Extent, width_m: f64, height_m: f64, order: &mut Vec<u32>) {
        let (across, up) = (extent.right - extent.left, extent.top - extent.bottom);
        self.left = extent.left;
        self.bottom = extent.bottom;
        // A side of zero or of no size at all is one cell.
        self.width_m = width_m.max(across / MOST_COLUMNS).max(f64::MIN_POSITIVE);
        self.height_m = height_m.max(up / MOST_ROWS).max(f64::MIN_POSITIVE);
        self.columns = whole(across / self.width_m) + 1;
        self.rows = whole(up / self.height_m) + 1;
        let cells = self.columns * self.rows;
        self.starts.clear();
        self.starts.resize(cells + 1, 0);
        self.cell_of.clear();
        for body in bodies {
            // Those who are left out go to a cell beyond the last.
            let cell = if body.is_finite() { self.row(body.y) * self.columns + self.column(body.x) } else { cells };
            self.cell_of.push(u32::try_from(cell).unwrap_or(u32::MAX));
            if let Some(count) = self.starts.get_mut(cell) {
                *count += 1;
            }
        }
        // Counts become ends, and filling from behind turns ends into starts.
        let mut sum = 0;
        for (cell, count) in self.starts.iter_mut().enumerate() {
            if cell < cells {
                sum += *count;
            }
            *count = sum;
        }
        order.clear();
        order.resize(usize::try_from(sum).unwrap_or(0), 0);
        for (place, cell) in self.cell_of.iter().enumerate().rev() {
            let cell = *cell as usize;
            if cell < cells
                && let Some(start) = self.starts.get_mut(cell)
            {
                *start -= 1;
                if let Some(slot) = order.get_mut(*start as usize) {
                    *slot = u32::try_from(place).unwrap_or(u32::MAX);
                }
            }
        }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Row of a height.
    #[inline(always)]
    pub(crate) fn row(&self, y: f64) -> usize {
        whole((y - self.bottom) / self.height_m).min(self.rows - 1)
    }

    #[inline(always)]
    fn column(&self, x: f64) -> usize {
        whole((x - self.left) / self.width_m).min(self.columns - 1)
    }

    /// How far a height is below (negative) or above (positive) a row; 0 within it.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "there are few rows")]
    pub(crate) fn off_row(&self, row: usize, y: f64) -> f64 {
        let low = self.bottom + row as f64 * self.height_m;
        let high = low + self.height_m;
        if y < low {
            y - low
        } else if y > high {
            y - high
        } else {
            0.0
        }
    }

    /// Where the people of a row from `left` to `right` stand in the sorted crowd; some more may be
    /// among them.
    #[inline(always)]
    pub(crate) fn span(&self, row: usize, left: f64, right: f64) -> (usize, usize) {
        let start = row * self.columns;
        let at = |cell: usize| self.starts.get(cell).map_or(0, |start| *start as usize);
        (at(start + self.column(left)), at(start + self.column(right) + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;

    #[test]
    fn a_span_holds_everybody_of_its_row_who_is_within_it() {
        let mut random = SplitMix64::new(4);
        let mut number = |size: f64| (random.next_f64() - 0.5) * size;
        let mut bodies: Vec<Body> =
            (0..500).map(|_| Body { x: number(40.0), y: number(25.0), vx: 0.0, vy: 0.0 }).collect();
        bodies[7].x = f64::NAN;
        bodies[9].vy = f64::INFINITY;
        let extent = Extent::of(bodies.iter().filter(|body| body.is_finite())).unwrap();
        let (mut cells, mut order) = (Cells::default(), Vec::new());
        cells.sort(&bodies, &extent, 1.5, 4.0, &mut order);
        let mut seen: Vec<u32> = order.clone();
        seen.sort_unstable();
        let wanted: Vec<u32> = (0..500).filter(|place| ![7, 9].contains(place)).collect();
        assert_eq!(seen, wanted);
        for row in 0..cells.rows() {
            let (from, to) = cells.span(row, -7.0, 5.0);
            for (place, index) in order.iter().enumerate() {
                let body = bodies[*index as usize];
                if cells.row(body.y) == row && (-7.0..=5.0).contains(&body.x) {
                    assert!((from..to).contains(&place));
                }
            }
        }
    }

    #[test]
    fn a_crowd_on_one_spot_is_one_cell() {
        let bodies = vec![Body { x: 3.0, y: -2.0, vx: 0.0, vy: 0.0 }; 5];
        let extent = Extent::of(bodies.iter()).unwrap();
        let (mut cells, mut order) = (Cells::default(), Vec::new());
        cells.sort(&bodies, &extent, 1.0, 1.0, &mut order);
        assert_eq!(order, [0, 1, 2, 3, 4]);
        assert_eq!(cells.span(0, 3.0, 3.0), (0, 5));
    }
}
