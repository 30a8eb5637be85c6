//! One way from here to there: short, smooth, and not along the wall.

use socrates_model::{Grid, Point};

use crate::cheapest::cheapest_way;
use crate::field::{DistanceField, nearest_cell};
use crate::geodesic::SNAP_M;
use crate::layer::Raster;

/// Clearance beyond the radius from which on a way is not made dearer, m. About one person's width.
const COMFORT_M: f64 = 0.5;
/// How much dearer a meter along the wall is than one in the open.
const WALL_COST: f64 = 1.0;
/// Shortcuts that fail one after another before the smoothing moves on.
const PATIENCE: usize = 12;

/// The way of a disc between two points as a polyline, both ends included; `None` where there is none.
///
/// A* over the cells where the disc fits, dearer near walls, then pulled straight wherever the straight
/// line is not dearer. Ends too near a wall are joined to the nearest fitting place.
#[must_use]
pub fn shortest_path(
    grid: &Grid,
    field: &DistanceField,
    from: &Point,
    to: &Point,
    radius_m: f64,
) -> Option<Vec<Point>> {
    let raster = Raster::of(grid);
    let radius_m = radius_m.max(f64::MIN_POSITIVE);
    let start = nearest_cell(field, from, radius_m, SNAP_M)?;
    let goal = nearest_cell(field, to, radius_m, SNAP_M)?;
    let cells = search(&raster, field, start, goal, radius_m)?;
    let mut way: Vec<Point> = cells.into_iter().map(|(column, row)| raster.center(column, row)).collect();
    // The ends themselves stand for their cells where the disc fits there; else they are joined on.
    let (head, tail) = (field.clearance(from) >= radius_m, field.clearance(to) >= radius_m);
    if head && let Some(first) = way.first_mut() {
        *first = *from;
    }
    if tail && way.len() > 1 {
        way.pop();
    }
    if tail {
        way.push(*to);
    }
    let mut way = pulled_straight(field, &way, radius_m);
    if !head {
        way.insert(0, *from);
    }
    if !tail {
        way.push(*to);
    }
    way.dedup_by(|b, a| (*b - *a).norm() < 1e-9);
    if way.len() == 1 {
        way.push(*to);
    }
    Some(way)
}

/// Cost of a meter at this clearance.
fn price(clearance_m: f64, radius_m: f64) -> f64 {
    1.0 + WALL_COST * (1.0 - (clearance_m - radius_m) / COMFORT_M).clamp(0.0, 1.0)
}

fn search(
    raster: &Raster,
    field: &DistanceField,
    start: (usize, usize),
    goal: (usize, usize),
    radius_m: f64,
) -> Option<Vec<(usize, usize)>> {
    let ahead = |cell: (usize, usize)| (raster.center(cell.0, cell.1) - raster.center(goal.0, goal.1)).norm();
    let clearance_m = |cell: (usize, usize)| field.clearance_of_cell(cell.0, cell.1);
    cheapest_way((raster.width, raster.height), (start, goal), ahead, |here, next, cells| {
        let there = clearance_m(next);
        (there >= radius_m)
            .then(|| cells * raster.resolution_m * price(f64::midpoint(clearance_m(here), there), radius_m))
    })
}

/// Cost of a straight line, or `None` where the disc does not fit on it.
fn line_cost(field: &DistanceField, from: &Point, to: &Point, radius_m: f64) -> Option<f64> {
    let along = to - from;
    let length = along.norm();
    let step = field.raster.resolution_m * 0.5;
    let parts = (length / step).ceil().max(1.0);
    let mut cost = 0.0;
    let mut at = 0.5;
    while at < parts {
        let clearance = field.clearance(&(from + along * (at / parts)));
        // Between lattice points the field is a hair below the true distance; cells were taken at their middles.
        if clearance < radius_m - 0.25 * step {
            return None;
        }
        cost += price(clearance, radius_m) * length / parts;
        at += 1.0;
    }
    Some(cost)
}

/// Replaces stretches of the way by straight lines where those are not dearer.
fn pulled_straight(field: &DistanceField, way: &[Point], radius_m: f64) -> Vec<Point> {
    let legs: Vec<f64> = way
        .windows(2)
        .map(|pair| {
            if let [a, b] = pair {
                line_cost(field, a, b, radius_m).unwrap_or_else(|| 2.0 * (b - a).norm())
            } else {
                0.0
            }
        })
        .collect();
    let mut out: Vec<Point> = way.first().copied().into_iter().collect();
    let mut at = 0;
    while at + 1 < way.len() {
        let Some(from) = way.get(at) else { break };
        let (mut best, mut along, mut failed) = (at + 1, 0.0, 0);
        for (next, leg) in legs.iter().enumerate().skip(at) {
            along += leg;
            let Some(to) = way.get(next + 1) else { break };
            if line_cost(field, from, to, radius_m).is_some_and(|straight| straight <= along * 1.001) {
                best = next + 1;
                failed = 0;
            } else {
                failed += 1;
                if failed > PATIENCE {
                    break;
                }
            }
        }
        out.extend(way.get(best).copied());
        at = best;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::{Cell, Pose};

    fn rooms() -> Grid {
        let mut cells = Vec::new();
        for row in 0..60 {
            for column in 0..100 {
                let edge = row == 0 || column == 0 || row == 59 || column == 99;
                let wall = column == 50 && !(10..20).contains(&row);
                cells.push(if edge || wall { Cell::Occupied } else { Cell::Free });
            }
        }
        Grid { width: 100, height: 60, resolution_m: 0.1, origin: Pose::new(-2.0, -1.0, 0.0), cells }
    }

    fn length(way: &[Point]) -> f64 {
        way.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    #[test]
    fn a_way_goes_through_the_gap_and_keeps_the_radius() {
        let grid = rooms();
        let field = DistanceField::new(&grid);
        let (from, to) = (Point::new(-1.0, 0.5), Point::new(6.0, 0.5));
        let way = shortest_path(&grid, &field, &from, &to, 0.3).unwrap();
        assert_eq!((way.first(), way.last()), (Some(&from), Some(&to)));
        for pair in way.windows(2) {
            for share in 0..=20 {
                let point = pair[0] + (pair[1] - pair[0]) * (f64::from(share) / 20.0);
                assert!(field.clearance(&point) > 0.27, "{point}");
            }
        }
        assert!(way.len() < 25 && length(&way) < 10.5, "{} points, {} m", way.len(), length(&way));
    }

    #[test]
    fn a_free_line_stays_straight_and_a_closed_wall_has_no_way() {
        let grid = rooms();
        let field = DistanceField::new(&grid);
        let (from, to) = (Point::new(-0.8, 0.0), Point::new(2.0, 3.0));
        assert_eq!(shortest_path(&grid, &field, &from, &to, 0.3), Some(vec![from, to]));
        assert_eq!(shortest_path(&grid, &field, &from, &Point::new(6.0, 0.5), 0.6), None);
    }

    #[test]
    fn an_end_at_the_wall_is_joined() {
        let grid = rooms();
        let field = DistanceField::new(&grid);
        let (from, to) = (Point::new(-1.8, 0.5), Point::new(1.0, 0.5));
        let way = shortest_path(&grid, &field, &from, &to, 0.4).unwrap();
        assert_eq!((way.first(), way.last()), (Some(&from), Some(&to)));
    }
}
