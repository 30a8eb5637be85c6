//! Who can see whom, and how far a ray goes: walks over the cells of the grid.

use socrates_model::geometry::segments_cross;
use socrates_model::{Cell, Grid, Point};

use crate::layer::{Layer, Raster};

/// Lines of sight over a grid. Occupied and unknown cells, and everything outside the map, block.
#[derive(Debug, Clone)]
pub struct Sight {
    raster: Raster,
    blocked: Layer<bool>,
}

impl Sight {
    /// The sight of a grid.
    #[must_use]
    pub fn new(grid: &Grid) -> Self {
        let mut blocked = Layer::filled(grid.width, grid.height, true);
        for (slot, cell) in blocked.values.iter_mut().zip(&grid.cells) {
            *slot = *cell != Cell::Free;
        }
        Self { raster: Raster::of(grid), blocked }
    }

    /// Whether the straight line between two points meets only free floor.
    #[must_use]
    pub fn clear(&self, a: &Point, b: &Point) -> bool {
        let (from, to) = (self.raster.pixel(a), self.raster.pixel(b));
        self.walk(from, (to.0 - from.0, to.1 - from.1), 1.0).is_none()
    }

    /// Distance from a point to the first wall in a direction (rad, map frame), m; at most `max_m`.
    ///
    /// 0 inside a wall or outside the map.
    #[must_use]
    pub fn ray(&self, point: &Point, angle: f64, max_m: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle);
        let ahead = Point::new(point.x + cos, point.y + sin);
        let (from, to) = (self.raster.pixel(point), self.raster.pixel(&ahead));
        self.walk(from, (to.0 - from.0, to.1 - from.1), max_m).unwrap_or(max_m)
    }

    /// Walks cells along `from + t * step` for t in 0 to `limit`; the t at which a blocked cell is entered.
    fn walk(&self, from: (f64, f64), step: (f64, f64), limit: f64) -> Option<f64> {
        let finite = from.0.is_finite() && from.1.is_finite() && step.0.is_finite() && step.1.is_finite();
        let Some((column, row)) = self.raster.cell(from.0, from.1).filter(|_| finite) else { return Some(0.0) };
        if self.blocked.get(column, row) != Some(false) {
            return Some(0.0);
        }
        let (mut along, mut down) = (Axis::new(from.0, step.0, column), Axis::new(from.1, step.1, row));
        loop {
            let next = along.next.min(down.next);
            if next > limit || !next.is_finite() {
                return None;
            }
            // Through a corner: two blocks that touch there leave no gap.
            if (along.next - down.next).abs() < 1e-12 {
                let (column, row) = (along.stepped(), down.stepped());
                if self.is_blocked(column, Some(down.cell)) && self.is_blocked(Some(along.cell), row) {
                    return Some(next);
                }
                along.advance(column);
                down.advance(row);
            } else if along.next < down.next {
                let column = along.stepped();
                along.advance(column);
            } else {
                let row = down.stepped();
                down.advance(row);
            }
            if along.left_map || down.left_map || self.is_blocked(Some(along.cell), Some(down.cell)) {
                return Some(next);
            }
        }
    }

    fn is_blocked(&self, column: Option<usize>, row: Option<usize>) -> bool {
        column.zip(row).is_none_or(|(column, row)| self.blocked.get(column, row) != Some(false))
    }
}

/// Whether two points see each other, with these door lines closed.
#[must_use]
pub fn sight_clear(sight: &Sight, a: &Point, b: &Point, closed: &[(Point, Point)]) -> bool {
    closed.iter().all(|(from, to)| !segments_cross(a, b, from, to)) && sight.clear(a, b)
}

/// One axis of the walk (Amanatides and Woo 1987).
struct Axis {
    cell: usize,
    forward: bool,
    /// t of the next border, and t per cell.
    next: f64,
    per_cell: f64,
    left_map: bool,
}

impl Axis {
    fn new(from: f64, step: f64, cell: usize) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
        let low = cell as f64;
        let forward = step > 0.0;
        let per_cell = 1.0 / step.abs();
        let gap = if forward { low + 1.0 - from } else { from - low };
        let next = if per_cell.is_finite() { gap * per_cell } else { f64::INFINITY };
        Self { cell, forward, next, per_cell, left_map: false }
    }

    fn stepped(&self) -> Option<usize> {
        if self.forward { self.cell.checked_add(1) } else { self.cell.checked_sub(1) }
    }

    fn advance(&mut self, to: Option<usize>) {
        match to {
            Some(cell) => self.cell = cell,
            None => self.left_map = true,
        }
        self.next += self.per_cell;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::grid;

    const TWO_ROOMS: [&str; 5] = ["#########", "#...#...#", "#.......#", "#...#..?#", "#########"];

    #[test]
    fn a_wall_and_unknown_floor_block_and_a_gap_does_not() {
        let sight = Sight::new(&grid(&TWO_ROOMS));
        let p = |x: f64, y: f64| Point::new(x, y);
        assert!(sight.clear(&p(0.75, 1.25), &p(3.75, 1.25)));
        assert!(!sight.clear(&p(0.75, 1.75), &p(3.75, 1.75)));
        assert!(!sight.clear(&p(2.75, 0.75), &p(3.75, 0.75)));
        assert!(!sight.clear(&p(0.75, 1.25), &p(30.0, 1.25)));
    }

    #[test]
    fn sight_is_the_same_both_ways() {
        let sight = Sight::new(&grid(&TWO_ROOMS));
        for i in 0..60 {
            for j in 0..60 {
                let a = Point::new(0.6 + 0.017 * f64::from(i), 0.61 + 0.013 * f64::from(j));
                let b = Point::new(3.9 - 0.011 * f64::from(j), 1.87 - 0.019 * f64::from(i));
                assert_eq!(sight.clear(&a, &b), sight.clear(&b, &a), "{a} {b}");
            }
        }
    }

    #[test]
    fn a_ray_ends_at_the_surface() {
        let sight = Sight::new(&grid(&TWO_ROOMS));
        let from = Point::new(1.0, 1.75);
        assert!((sight.ray(&from, 0.0, 9.0) - 1.0).abs() < 1e-9);
        assert!((sight.ray(&from, std::f64::consts::FRAC_PI_2, 9.0) - 0.25).abs() < 1e-9);
        assert!((sight.ray(&from, 0.0, 0.3) - 0.3).abs() < 1e-12);
        assert!(sight.ray(&Point::new(0.1, 0.1), 0.0, 9.0) < 1e-12);
    }

    #[test]
    fn blocks_that_touch_at_a_corner_leave_no_gap() {
        let sight = Sight::new(&grid(&["....", "..#.", ".#..", "...."]));
        assert!(!sight.clear(&Point::new(0.5, 1.5), &Point::new(1.5, 0.5)));
    }

    #[test]
    fn a_closed_door_hides_what_is_behind() {
        let sight = Sight::new(&grid(&TWO_ROOMS));
        let (a, b) = (Point::new(0.75, 1.25), Point::new(3.75, 1.25));
        let door = (Point::new(2.25, 1.0), Point::new(2.25, 1.5));
        assert!(sight_clear(&sight, &a, &b, &[]));
        assert!(!sight_clear(&sight, &a, &b, &[door]));
    }
}
