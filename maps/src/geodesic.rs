//! Walking distance to a goal round walls, for every place at once.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use socrates_model::{Point, Vector};

use crate::field::{DistanceField, nearest_cell};
use crate::layer::{Layer, Raster, floor_index};

/// How far a start or goal may be from floor where the disc fits, m (somebody leans on a wall).
pub(crate) const SNAP_M: f64 = 1.0;
/// Cells round the goal that get their exact straight distance, so that the front starts round.
const SEED_CELLS: f64 = 3.0;

/// Shortest walking distance of a disc to one goal, over the whole map.
///
/// First-order fast marching (Sethian 1996) over the cells where the disc fits: within about 2 % of
/// the true any-angle distance, a little above it.
#[derive(Debug, Clone)]
pub struct Geodesic {
    raster: Raster,
    distance_m: Layer<f64>,
    goal: Point,
}

impl Geodesic {
    /// Distances of a disc of `radius_m` to `goal`; a goal too near a wall is taken to the nearest fitting place.
    #[must_use]
    pub fn to(field: &DistanceField, goal: &Point, radius_m: f64) -> Self {
        let raster = field.raster.clone();
        let mut distance_m = Layer::filled(raster.width, raster.height, f64::INFINITY);
        let radius_m = radius_m.max(f64::MIN_POSITIVE);
        let fits = |column: usize, row: usize| field.clearance_of_cell(column, row) >= radius_m;
        let mut front: BinaryHeap<Reverse<(u64, u32, u32)>> = BinaryHeap::new();
        let entry = |away: f64, column: usize, row: usize| {
            // Bits of floats that are not negative sort as the floats do; a map has fewer than 2^32 cells a side.
            let short = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
            Reverse((away.to_bits(), short(column), short(row)))
        };
        let mut push = |layer: &mut Layer<f64>, column: usize, row: usize, away: f64| {
            if layer.get(column, row).is_some_and(|known| away < known) {
                layer.set(column, row, away);
                front.push(entry(away, column, row));
            }
        };
        if let Some(start) = nearest_cell(field, goal, radius_m, SNAP_M) {
            let middle = raster.center(start.0, start.1);
            push(&mut distance_m, start.0, start.1, (middle - goal).norm());
            let (px, py) = raster.pixel(goal);
            // Only where every cell of the little square fits is the straight distance sure to be walkable.
            let square: Vec<(usize, usize)> = raster.cells_around(px, py, SEED_CELLS).collect();
            if square.iter().all(|(column, row)| fits(*column, *row)) {
                for (column, row) in square {
                    push(&mut distance_m, column, row, (raster.center(column, row) - goal).norm());
                }
            }
        }
        let step = raster.resolution_m;
        while let Some(Reverse((bits, column, row))) = front.pop() {
            let (column, row) = (column as usize, row as usize);
            if distance_m.get(column, row).is_none_or(|known| known.to_bits() != bits) {
                continue;
            }
            for (column, row) in four_neighbors(column, row) {
                let known = distance_m.get(column, row).unwrap_or(0.0);
                // What the front has passed stays, and most neighbors are passed.
                if known.to_bits() <= bits || !fits(column, row) {
                    continue;
                }
                let at = |column: Option<usize>, row: Option<usize>| {
                    column.zip(row).and_then(|(column, row)| distance_m.get(column, row)).unwrap_or(f64::INFINITY)
                };
                let (here, there) = (Some(column), Some(row));
                let a = at(column.checked_sub(1), there).min(at(column.checked_add(1), there));
                let b = at(here, row.checked_sub(1)).min(at(here, row.checked_add(1)));
                let away = upwind(a, b, step);
                if away < known - 1e-12 {
                    distance_m.set(column, row, away);
                    front.push(entry(away, column, row));
                }
            }
        }
        Self { raster, distance_m, goal: *goal }
    }

    /// Walking distance from a point, m; `None` where the goal cannot be reached.
    #[must_use]
    pub fn distance(&self, from: &Point) -> Option<f64> {
        let (px, py) = self.raster.pixel(from);
        if !px.is_finite() || !py.is_finite() {
            return None;
        }
        if let Some(smooth) = self.between_cells(px, py) {
            return Some(smooth.max(0.0));
        }
        let mut best: Option<f64> = None;
        let mut half = 1.5;
        while half * self.raster.resolution_m <= SNAP_M + self.raster.resolution_m {
            for (column, row) in self.raster.cells_around(px, py, half) {
                let Some(away) = self.distance_m.get(column, row).filter(|away| away.is_finite()) else { continue };
                let gap = (self.raster.center(column, row) - from).norm();
                if gap <= SNAP_M && best.is_none_or(|least| away + gap < least) {
                    best = Some(away + gap);
                }
            }
            if best.is_some() {
                return best;
            }
            half *= 2.0;
        }
        best
    }

    /// Unit vector of the shortest way on from a point; `None` at the goal and where it cannot be reached.
    #[must_use]
    pub fn direction(&self, from: &Point) -> Option<Vector> {
        let reach = 1.5 * self.raster.resolution_m;
        let to_goal = self.goal - from;
        if to_goal.norm() <= reach {
            return to_goal.try_normalize(1e-9);
        }
        let here = self.distance(from)?;
        let at = |x: f64, y: f64| self.distance(&Point::new(from.x + x, from.y + y)).unwrap_or(here + reach);
        let slope = Vector::new(at(-reach, 0.0) - at(reach, 0.0), at(0.0, -reach) - at(0.0, reach));
        slope.try_normalize(1e-9)
    }

    /// Bilinear value between the four cells round a pixel position, where all four are reached.
    fn between_cells(&self, px: f64, py: f64) -> Option<f64> {
        let (u, v) = (px - 0.5, py - 0.5);
        if u < 0.0 || v < 0.0 {
            return None;
        }
        let (column, row) = (floor_index(u), floor_index(v));
        let reached = |column: usize, row: usize| self.distance_m.get(column, row).filter(|away| away.is_finite());
        #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
        let (right, down) = (u - column as f64, v - row as f64);
        let top = reached(column, row)? * (1.0 - right) + reached(column + 1, row)? * right;
        let bottom = reached(column, row + 1)? * (1.0 - right) + reached(column + 1, row + 1)? * right;
        Some(top * (1.0 - down) + bottom * down)
    }
}

/// Solves `(t - a)^2 + (t - b)^2 = step^2` for the later side, or steps from the nearer one alone.
fn upwind(a: f64, b: f64, step: f64) -> f64 {
    let gap = (a - b).abs();
    if gap >= step || !gap.is_finite() {
        return a.min(b) + step;
    }
    (a + b + libm::sqrt(2.0 * step * step - gap * gap)) / 2.0
}

fn four_neighbors(column: usize, row: usize) -> impl Iterator<Item = (usize, usize)> {
    let left = column.checked_sub(1).map(|column| (column, row));
    let up = row.checked_sub(1).map(|row| (column, row));
    [left, up, Some((column + 1, row)), Some((column, row + 1))].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::{Cell, Grid, Pose};

    /// 10 m by 10 m at 0.1 m, walls round it, and a wall from the bottom up to y = 7 at x = 5.
    fn bent() -> Grid {
        let mut cells = Vec::new();
        for row in 0..100 {
            for column in 0..100 {
                let edge = row == 0 || column == 0 || row == 99 || column == 99;
                let wall = column == 50 && row >= 30;
                cells.push(if edge || wall { Cell::Occupied } else { Cell::Free });
            }
        }
        Grid { width: 100, height: 100, resolution_m: 0.1, origin: Pose::new(0.0, 0.0, 0.0), cells }
    }

    #[test]
    fn distances_round_a_wall_are_near_the_true_ones() {
        let field = DistanceField::new(&bent());
        let goal = Point::new(8.0, 2.0);
        let geodesic = Geodesic::to(&field, &goal, 0.05);
        let straight = geodesic.distance(&Point::new(6.0, 6.5)).unwrap();
        assert!((straight / 4.9244 - 1.0).abs() < 0.03, "{straight}");
        // Over the wall's upper end near (5.0, 7.0) and (5.1, 7.0).
        let round = geodesic.distance(&Point::new(2.0, 2.0)).unwrap();
        let want = (3.0_f64).hypot(5.0) + 0.1 + (2.9_f64).hypot(5.0);
        assert!((round / want - 1.0).abs() < 0.03, "{round} but {want}");
    }

    #[test]
    fn a_disc_that_does_not_fit_has_no_way() {
        let mut grid = bent();
        for row in 0..30 {
            grid.cells[row * 100 + 50] = if (10..16).contains(&row) { Cell::Free } else { Cell::Occupied };
        }
        let field = DistanceField::new(&grid);
        let (from, goal) = (Point::new(2.0, 2.0), Point::new(8.0, 2.0));
        assert!(Geodesic::to(&field, &goal, 0.2).distance(&from).is_some());
        assert!(Geodesic::to(&field, &goal, 0.4).distance(&from).is_none());
    }

    #[test]
    fn the_direction_leads_to_the_goal() {
        let field = DistanceField::new(&bent());
        let goal = Point::new(8.0, 2.0);
        let geodesic = Geodesic::to(&field, &goal, 0.2);
        let mut at = Point::new(2.0, 2.0);
        for _ in 0..400 {
            let Some(way) = geodesic.direction(&at) else { break };
            at += way * 0.05;
            assert!(field.clearance(&at) > 0.05, "{at}");
        }
        assert!((at - goal).norm() < 0.2, "{at}");
    }
}
