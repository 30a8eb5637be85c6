//! How many others somebody can have within a distance: what the error bound counts.

use super::cells::Extent;
use super::pairs::Body;

/// At most so many counting cells along a side.
const MOST_CELLS: f64 = 64.0;

/// Nobody of the crowd has more than so many others within a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Within {
    pub(super) distance_m: f64,
    pub(super) others: f64,
}

/// The crowd counted in square cells, as a table of sums over rectangles.
#[derive(Debug, Clone, Default)]
pub(super) struct Density {
    /// People below and to the left of each corner, row by row.
    sums: Vec<u32>,
    columns: usize,
    rows: usize,
    side_m: f64,
}

impl Density {
    /// Counts the people of a crowd in cells of at least `side_m`.
    pub(super) fn count<'a>(&mut self, bodies: impl Iterator<Item = &'a Body>, extent: &Extent, side_m: f64) {
        self.side_m = side_m.max(extent.size_m() / MOST_CELLS).max(f64::MIN_POSITIVE);
        let cell = |from: f64, to: f64| whole((to - from) / self.side_m);
        self.columns = cell(extent.left, extent.right) + 1;
        self.rows = cell(extent.bottom, extent.top) + 1;
        let stride = self.columns + 1;
        self.sums.clear();
        self.sums.resize(stride * (self.rows + 1), 0);
        for body in bodies {
            let corner = (cell(extent.bottom, body.y) + 1) * stride + cell(extent.left, body.x) + 1;
            if let Some(count) = self.sums.get_mut(corner) {
                *count += 1;
            }
        }
        for corner in stride..self.sums.len() {
            let left = if corner % stride == 0 { 0 } else { self.at(corner - 1) };
            let diagonal = if corner % stride == 0 { 0 } else { self.at(corner - stride - 1) };
            let sum = self.at(corner) + left + self.at(corner - stride) - diagonal;
            if let Some(count) = self.sums.get_mut(corner) {
                *count = sum;
            }
        }
    }

    /// A bound for a distance of at least `distance_m`, rounded up to whole cells.
    pub(super) fn within(&self, distance_m: f64) -> Within {
        let all = self.columns.max(self.rows);
        let rings = whole((distance_m / self.side_m).ceil()).min(all);
        let mut most = 0;
        for row in 0..self.rows {
            for column in 0..self.columns {
                if self.people(row, column, row + 1, column + 1) > 0 {
                    let (bottom, left) = (row.saturating_sub(rings), column.saturating_sub(rings));
                    let top = (row + rings + 1).min(self.rows);
                    let right = (column + rings + 1).min(self.columns);
                    most = most.max(self.people(bottom, left, top, right));
                }
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "few cells")]
        let reached_m = if rings < all { rings as f64 * self.side_m } else { f64::INFINITY };
        Within { distance_m: reached_m, others: f64::from(most.saturating_sub(1)) }
    }

    /// People in the cells from a row and column up to, and without, another.
    fn people(&self, bottom: usize, left: usize, top: usize, right: usize) -> u32 {
        let stride = self.columns + 1;
        let at = |row: usize, column: usize| self.at(row * stride + column);
        at(top, right) + at(bottom, left) - at(top, left) - at(bottom, right)
    }

    fn at(&self, corner: usize) -> u32 {
        self.sums.get(corner).copied().unwrap_or(0)
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast keeps to the range, NaN becomes 0")]
fn whole(number: f64) -> usize {
    number as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;

    #[test]
    fn nobody_has_more_others_around_than_the_bound() {
        let mut random = SplitMix64::new(6);
        for (width, height) in [(30.0, 70.0), (200.0, 3.0), (0.0, 0.0)] {
            let mut number = |size: f64| size * random.next_f64() * random.next_f64();
            let bodies: Vec<Body> =
                (0..600).map(|_| Body { x: number(width), y: number(height), ..Body::default() }).collect();
            let mut density = Density::default();
            density.count(bodies.iter(), &Extent::of(bodies.iter()).unwrap(), 2.0);
            for distance in [0.0, 1.0, 2.0, 7.5, 20.0, 1e3, f64::INFINITY] {
                let within = density.within(distance);
                let near = |me: &Body| {
                    let apart = |other: &&Body| (other.x - me.x).hypot(other.y - me.y) <= distance;
                    bodies.iter().filter(apart).count() - 1
                };
                let most = bodies.iter().map(near).max().unwrap();
                assert!(most as f64 <= within.others && within.others <= 599.0, "{distance}: {most} {within:?}");
            }
        }
    }
}
