//! The grid as beams see it: how far a ray goes before it enters a cell that is not free floor.

use socrates_model::{Cell, Grid, Point, Vector};

/// Two borders nearer than this along a ray, m, are one corner.
const CORNER_M: f64 = 1e-12;

/// Cells with their distance to the nearest blocked one, so that a ray takes open floor in a few leaps.
///
/// Where a cell is `g` cells (in the larger of rows and columns) from the nearest blocked cell, the square
/// of half side `g - 1` round it is free: a ray goes to the border of that square at once. With `g = 1` this is
/// the walk of Amanatides and Woo (1987).
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    width: i32,
    height: i32,
    /// Cells per meter.
    per_m: f64,
    origin: Point,
    cos: f64,
    sin: f64,
    /// 0 in a blocked cell; outside the map everything is blocked.
    gaps: Vec<u8>,
}

impl Cells {
    pub(crate) fn new(grid: &Grid) -> Self {
        let (sin, cos) = libm::sincos(grid.origin.yaw);
        Self {
            width: i32::try_from(grid.width).unwrap_or(0),
            height: i32::try_from(grid.height).unwrap_or(0),
            per_m: 1.0 / grid.resolution_m,
            origin: grid.origin.point(),
            cos,
            sin,
            gaps: gaps(grid),
        }
    }

    /// Continuous cell position of a point (rows from the top), and the turn that makes map directions cell directions.
    pub(crate) fn position(&self, point: &Point) -> (f64, f64) {
        let away = point - self.origin;
        let along = away.x * self.cos + away.y * self.sin;
        let up = away.y * self.cos - away.x * self.sin;
        (along * self.per_m, f64::from(self.height) - up * self.per_m)
    }

    /// Cells per meter along a unit direction of the map frame.
    pub(crate) fn direction(&self, heading: &Vector) -> (f64, f64) {
        let along = heading.x * self.cos + heading.y * self.sin;
        let up = heading.y * self.cos - heading.x * self.sin;
        (along * self.per_m, -up * self.per_m)
    }

    fn gap(&self, column: i32, row: i32) -> u8 {
        if column < 0 || row < 0 || column >= self.width || row >= self.height {
            return 0;
        }
        let place = i64::from(row) * i64::from(self.width) + i64::from(column);
        usize::try_from(place).ok().and_then(|place| self.gaps.get(place)).copied().unwrap_or(0)
    }

    /// Whether the straight line between two points meets only free floor.
    pub(crate) fn clear(&self, a: &Point, b: &Point) -> bool {
        let (from, to) = (self.position(a), self.position(b));
        let ((column, row), (to_column, to_row)) = ((whole(from.0), whole(from.1)), (whole(to.0), whole(to.1)));
        let apart = (column - to_column).abs().max((row - to_row).abs());
        // On open floor one of the two stands in a free square that holds the other.
        if apart < i32::from(self.gap(column, row).max(self.gap(to_column, to_row))) {
            return true;
        }
        self.ray(from, (to.0 - from.0, to.1 - from.1), 1.0) >= 1.0
    }

    /// Distance to the first blocked cell, m, at most `max_m`; 0 from inside one or from outside the map.
    pub(crate) fn ray(&self, from: (f64, f64), step: (f64, f64), max_m: f64) -> f64 {
        let inside =
            from.0 >= 0.0 && from.1 >= 0.0 && from.0 < f64::from(self.width) && from.1 < f64::from(self.height);
        if !inside {
            return 0.0;
        }
        let (mut column, mut row) = (whole(from.0), whole(from.1));
        // Meters per cell; infinite along an axis that the ray does not move on.
        let (per_column, per_row) = (1.0 / step.0, 1.0 / step.1);
        loop {
            let gap = i32::from(self.gap(column, row));
            if gap == 0 {
                return 0.0;
            }
            let (right, left) = (column + gap, column - gap + 1);
            let (below, above) = (row + gap, row - gap + 1);
            let across = if step.0 > 0.0 { right } else { left };
            let down = if step.1 > 0.0 { below } else { above };
            let to_column = if step.0 == 0.0 { f64::INFINITY } else { (f64::from(across) - from.0) * per_column };
            let to_row = if step.1 == 0.0 { f64::INFINITY } else { (f64::from(down) - from.1) * per_row };
            let gone = to_column.min(to_row);
            if gone >= max_m || gone.is_nan() {
                return max_m;
            }
            let next_column = if step.0 > 0.0 { across } else { across - 1 };
            let next_row = if step.1 > 0.0 { down } else { down - 1 };
            if (to_column - to_row).abs() < CORNER_M {
                // Two blocks that touch at a corner leave no gap.
                let (last_column, last_row) = (inner(next_column, step.0), inner(next_row, step.1));
                if self.gap(next_column, last_row) == 0 && self.gap(last_column, next_row) == 0 {
                    return gone;
                }
                (column, row) = (next_column, next_row);
            } else if to_column < to_row {
                row = whole(from.1 + gone * step.1).clamp(above, below - 1);
                column = next_column;
            } else {
                column = whole(from.0 + gone * step.0).clamp(left, right - 1);
                row = next_row;
            }
            if self.gap(column, row) == 0 {
                return gone;
            }
        }
    }
}

/// The last cell inside the square before `next` outside it.
const fn inner(next: i32, step: f64) -> i32 {
    if step > 0.0 { next - 1 } else { next + 1 }
}

/// The whole number below; without the library call that rounding down is on the oldest processors.
fn whole(value: f64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "cell numbers of a map fit")]
    let cut = value as i32;
    if f64::from(cut) > value { cut - 1 } else { cut }
}

/// Distance of every cell to the nearest blocked one or to the outside, in king's moves, at most 255.
fn gaps(grid: &Grid) -> Vec<u8> {
    let width = grid.width.max(1);
    let free = |cell: &Cell| if *cell == Cell::Free { u8::MAX } else { 0 };
    let mut gaps: Vec<u8> = grid.cells.iter().map(free).collect();
    gaps.resize(grid.width.saturating_mul(grid.height), 0);
    let outside = vec![0_u8; grid.width];
    // Down and up again: each cell is at most one more than its neighbors on the side that is done already.
    let mut before = outside.clone();
    for line in gaps.chunks_exact_mut(width) {
        relax(line, &before);
        before.copy_from_slice(line);
    }
    before = outside;
    for line in gaps.chunks_exact_mut(width).rev() {
        relax(line, &before);
        before.copy_from_slice(line);
    }
    gaps
}

/// One line from the line before it and from its own cells to both sides.
fn relax(line: &mut [u8], before: &[u8]) {
    let last = line.len().saturating_sub(1);
    for (column, slot) in line.iter_mut().enumerate() {
        let around = before.get(column.saturating_sub(1)..(column + 2).min(before.len())).unwrap_or(&[]);
        let mut least = around.iter().copied().min().unwrap_or(0);
        if column == 0 || column == last {
            least = 0;
        }
        *slot = (*slot).min(least.saturating_add(1));
    }
    let mut beside = 0_u8;
    for slot in line.iter_mut() {
        *slot = (*slot).min(beside.saturating_add(1));
        beside = *slot;
    }
    beside = 0;
    for slot in line.iter_mut().rev() {
        *slot = (*slot).min(beside.saturating_add(1));
        beside = *slot;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::hall;
    use socrates_maps::Sight;
    use socrates_model::Pose;

    fn speckled(seed: u64, yaw: f64) -> Grid {
        let mut grid = hall(9.0, 7.0);
        let mut state = seed;
        for cell in &mut grid.cells {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            if (state >> 33).is_multiple_of(37) {
                *cell = if state & 1 == 0 { Cell::Occupied } else { Cell::Unknown };
            }
        }
        grid.origin = Pose::new(-2.0, 3.0, yaw);
        grid
    }

    #[test]
    fn gaps_are_kings_moves_to_the_nearest_blocked_cell() {
        let grid = speckled(3, 0.0);
        let cells = Cells::new(&grid);
        let blocked = |column: i32, row: i32| {
            let at = (usize::try_from(column).ok(), usize::try_from(row).ok());
            let (Some(column), Some(row)) = at else { return true };
            grid.at(column, row) != Cell::Free || row >= grid.height
        };
        for row in 0..cells.height {
            for column in 0..cells.width {
                let found = (0..).find(|reach: &i32| {
                    (-reach..=*reach).any(|down| (-reach..=*reach).any(|right| blocked(column + right, row + down)))
                });
                assert_eq!(Some(i32::from(cells.gap(column, row))), found, "{column} {row}");
            }
        }
    }

    #[test]
    fn leaps_end_where_the_walk_over_every_cell_ends() {
        let mut differ = 0;
        let mut rays = 0;
        for (seed, yaw) in [(1, 0.0), (2, 0.7), (3, -2.1)] {
            let grid = speckled(seed, yaw);
            let (cells, sight) = (Cells::new(&grid), Sight::new(&grid));
            for spot in 0..60_u32 {
                let from = grid.world_from_pixel(2.3 + 1.37 * f64::from(spot), 3.1 + (11.73 * f64::from(spot)) % 60.0);
                for turn in 0..97_u32 {
                    let angle = 0.01 + f64::from(turn) / 97.0 * std::f64::consts::TAU;
                    let (sin, cos) = libm::sincos(angle);
                    let found = cells.ray(cells.position(&from), cells.direction(&Vector::new(cos, sin)), 12.0);
                    rays += 1;
                    differ += u32::from((found - sight.ray(&from, angle, 12.0)).abs() > 1e-9);
                }
            }
        }
        // A ray through the corner of a cell may pass on either side of it: rounding decides.
        assert!(differ <= rays / 2000, "{differ} of {rays}");
    }

    #[test]
    fn outside_and_in_walls_there_is_no_range_and_straight_rays_end_at_the_surface() {
        let cells = Cells::new(&hall(4.0, 3.0));
        let ray = |x: f64, y: f64, dx: f64, dy: f64| {
            cells.ray(cells.position(&Point::new(x, y)), cells.direction(&Vector::new(dx, dy)), 12.0)
        };
        assert!(ray(-1.0, 1.0, 1.0, 0.0) < 1e-12 && ray(0.05, 1.0, 1.0, 0.0) < 1e-12);
        assert!((ray(1.0, 1.5, 1.0, 0.0) - 2.9).abs() < 1e-9 && (ray(1.0, 1.5, -1.0, 0.0) - 0.9).abs() < 1e-9);
        assert!((ray(1.0, 1.5, 0.0, 1.0) - 1.4).abs() < 1e-9 && (ray(1.0, 1.5, 0.0, -1.0) - 1.4).abs() < 1e-9);
        assert!(ray(f64::NAN, 1.0, 1.0, 0.0) < 1e-12);
    }
}
