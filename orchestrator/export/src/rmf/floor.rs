//! A level drawn into cells: floors, then walls, then cabins with their doors.

use socrates_model::geometry::nearest_on_segment;
use socrates_model::{Cell, Grid, Point, Pose, Vector};

use crate::graph::Unusable;

/// Size of a cell, m.
const CELL_M: f64 = 0.05;
/// Thickness of a wall: RMF draws walls 0.1 m thick.
const WALL_M: f64 = 0.1;
/// Unknown floor round everything, m.
const MARGIN_M: f64 = 0.5;
/// At most so many cells are drawn.
const MOST_CELLS: usize = 36_000_000;
/// How far in front of and behind a cabin's door walls are cut, m: the landing's own wall stands before that of the cabin.
const CUT_M: f64 = 0.4;

/// A cabin on a level.
#[derive(Debug, Clone)]
pub(super) struct Lift {
    pub(super) name: String,
    pub(super) middle: Point,
    pub(super) yaw: f64,
    pub(super) width_m: f64,
    pub(super) depth_m: f64,
    /// Middle in the cabin's frame, width, and direction of each door, m and rad.
    pub(super) doors: Vec<(Point, f64, f64)>,
}

impl Lift {
    fn map_from_cabin(&self, at: Point) -> Point {
        let (sin, cos) = libm::sincos(self.yaw);
        Point::new(self.middle.x + at.x * cos - at.y * sin, self.middle.y + at.x * sin + at.y * cos)
    }

    /// Whether a point lies in the cabin.
    pub(super) fn holds(&self, at: &Point) -> bool {
        let (sin, cos) = libm::sincos(self.yaw);
        let (dx, dy) = (at.x - self.middle.x, at.y - self.middle.y);
        let (x, y) = (dx * cos + dy * sin, dy * cos - dx * sin);
        x.abs() <= self.width_m * 0.5 && y.abs() <= self.depth_m * 0.5
    }

    /// Both ends of each door, map frame, m. A door stands a little before its cabin; its line is in the wall that it opens.
    pub(super) fn door_lines(&self) -> Vec<(Point, Point)> {
        let (w, d) = self.half_sides();
        let in_wall = |off: f64, wall: f64| {
            let near = (off.abs() - wall).abs() <= CUT_M;
            if near { wall.copysign(off) } else { off }
        };
        let ends = |(at, width, turn): &(Point, f64, f64)| {
            let (sin, cos) = libm::sincos(*turn);
            let half = width * 0.5;
            let at = if cos.abs() > sin.abs() {
                Point::new(at.x, in_wall(at.y, d))
            } else {
                Point::new(in_wall(at.x, w), at.y)
            };
            let end = |side: f64| self.map_from_cabin(Point::new(at.x + side * half * cos, at.y + side * half * sin));
            (end(-1.0), end(1.0))
        };
        self.doors.iter().map(ends).collect()
    }

    /// From the middle of the cabin to the middles of its walls, m.
    fn half_sides(&self) -> (f64, f64) {
        ((self.width_m + WALL_M) * 0.5, (self.depth_m + WALL_M) * 0.5)
    }

    fn sides(&self) -> Vec<(Point, Point)> {
        let (w, d) = self.half_sides();
        let corners = [(-w, -d), (w, -d), (w, d), (-w, d)].map(|(x, y)| self.map_from_cabin(Point::new(x, y)));
        corners.iter().copied().zip(corners.iter().copied().cycle().skip(1)).collect()
    }
}

/// Draws a level. Free floor that holds none of the seeds is unknown: it lies within walls or outside of the building.
pub(super) fn drawn(
    at: &str,
    floors: &[Vec<Point>],
    walls: &[(Point, Point)],
    lifts: &[Lift],
    seeds: &[Point],
) -> Result<Grid, Unusable> {
    let cabins: Vec<(Point, Point)> = lifts.iter().flat_map(Lift::sides).collect();
    let all = || floors.iter().flatten().chain(walls.iter().chain(&cabins).flat_map(|(a, b)| [a, b]));
    let least = |value: fn(&Point) -> f64| all().map(value).fold(f64::INFINITY, f64::min) - MARGIN_M;
    let most = |value: fn(&Point) -> f64| all().map(value).fold(f64::NEG_INFINITY, f64::max) + MARGIN_M;
    let (x0, y0) = ((least(|p| p.x) / CELL_M).floor() * CELL_M, (least(|p| p.y) / CELL_M).floor() * CELL_M);
    let (wide, high) = ((most(|p| p.x) - x0) / CELL_M, (most(|p| p.y) - y0) / CELL_M);
    #[expect(clippy::cast_precision_loss, reason = "the limit is far below 2^53")]
    let fits = wide.is_finite() && high.is_finite() && wide * high <= MOST_CELLS as f64;
    if floors.is_empty() || !fits {
        let problem = format!("{} floors on {:.0} by {:.0} m", floors.len(), wide * CELL_M, high * CELL_M);
        let hint = format!("a level has a floor, and at most {MOST_CELLS} cells of {CELL_M} m");
        return Err(Unusable::new(format!("{at}.floors"), problem, hint));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked against the limit")]
    let (width, height) = (wide.ceil() as usize, high.ceil() as usize);
    let mut grid = Grid {
        width,
        height,
        resolution_m: CELL_M,
        origin: Pose::new((x0 * 1e6).round() / 1e6, (y0 * 1e6).round() / 1e6, 0.0),
        cells: vec![Cell::Unknown; width.saturating_mul(height)],
    };
    for floor in floors {
        fill(&mut grid, floor, Cell::Free);
    }
    for wall in walls.iter().chain(&cabins) {
        line(&mut grid, wall, WALL_M * 0.5, Cell::Occupied);
    }
    for lift in lifts {
        for (a, b) in lift.door_lines() {
            let along = (b - a).normalize();
            let across = quarter_turn(along) * CUT_M;
            fill(&mut grid, &[a + across, b + across, b - across, a - across], Cell::Free);
        }
    }
    keep(&mut grid, seeds);
    Ok(grid)
}

/// A quarter turn to the left.
fn quarter_turn(along: Vector) -> Vector {
    Vector::new(-along.y, along.x)
}

/// Columns and rows of cells near a box.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the grid")]
fn window(grid: &Grid, points: &[Point], more: f64) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
    let (mut columns, mut rows) = ((usize::MAX, 0), (usize::MAX, 0));
    for point in points {
        let (px, py) = grid.pixel_from_world(point);
        let more = more / grid.resolution_m + 1.0;
        columns = (columns.0.min((px - more).max(0.0) as usize), columns.1.max((px + more).max(0.0) as usize + 1));
        rows = (rows.0.min((py - more).max(0.0) as usize), rows.1.max((py + more).max(0.0) as usize + 1));
    }
    (columns.0.min(grid.width)..columns.1.min(grid.width), rows.0.min(grid.height)..rows.1.min(grid.height))
}

fn set(grid: &mut Grid, column: usize, row: usize, cell: Cell) {
    if let Some(place) = grid.cells.get_mut(row * grid.width + column) {
        *place = cell;
    }
}

fn fill(grid: &mut Grid, corners: &[Point], cell: Cell) {
    let (columns, rows) = window(grid, corners, 0.0);
    for row in rows {
        for column in columns.clone() {
            let at = grid.center_of(column, row);
            let sides = corners.iter().zip(corners.iter().cycle().skip(1));
            let crossings = sides
                .filter(|(a, b)| (a.y > at.y) != (b.y > at.y) && at.x < (b.x - a.x) * (at.y - a.y) / (b.y - a.y) + a.x);
            if crossings.count() % 2 == 1 {
                set(grid, column, row, cell);
            }
        }
    }
}

fn line(grid: &mut Grid, (a, b): &(Point, Point), reach: f64, cell: Cell) {
    let (columns, rows) = window(grid, &[*a, *b], reach);
    for row in rows {
        for column in columns.clone() {
            if nearest_on_segment(&grid.center_of(column, row), a, b).0 <= reach {
                set(grid, column, row, cell);
            }
        }
    }
}

/// Makes free floor unknown where no seed leads to; without seeds, all but the largest floor.
fn keep(grid: &mut Grid, seeds: &[Point]) {
    let (width, height) = (grid.width, grid.height);
    let mut part: Vec<usize> = vec![0; grid.cells.len()];
    let mut sizes = vec![0_usize];
    for start in 0..grid.cells.len() {
        if grid.cells.get(start) != Some(&Cell::Free) || part.get(start) != Some(&0) {
            continue;
        }
        let number = sizes.len();
        sizes.push(0);
        let mut open = vec![start];
        while let Some(at) = open.pop() {
            let Some(slot) = part.get_mut(at).filter(|slot| **slot == 0) else { continue };
            if grid.cells.get(at) != Some(&Cell::Free) {
                continue;
            }
            *slot = number;
            if let Some(size) = sizes.last_mut() {
                *size += 1;
            }
            let (column, row) = (at % width, at / width);
            open.extend((column > 0).then(|| at - 1));
            open.extend((column + 1 < width).then_some(at + 1));
            open.extend((row > 0).then(|| at - width));
            open.extend((row + 1 < height).then_some(at + width));
        }
    }
    let mut kept: Vec<usize> = seeds
        .iter()
        .filter_map(|seed| grid.cell_of(seed))
        .filter_map(|(column, row)| part.get(row * width + column).copied())
        .filter(|number| *number > 0)
        .collect();
    if kept.is_empty() {
        kept.extend((1..sizes.len()).max_by_key(|number| sizes.get(*number).copied()));
    }
    for (cell, number) in grid.cells.iter_mut().zip(&part) {
        if *number > 0 && !kept.contains(number) {
            *cell = Cell::Unknown;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_a_cabins_door_is_in_the_wall_that_it_opens() {
        let doors = vec![(Point::new(0.0, 1.62), 1.4, 0.0), (Point::new(-1.3, 0.2), 1.0, std::f64::consts::FRAC_PI_2)];
        let lift = Lift {
            name: "lift_1".into(),
            middle: Point::new(10.0, 5.0),
            yaw: 0.0,
            width_m: 2.4,
            depth_m: 3.0,
            doors: [doors, vec![(Point::new(0.0, 3.0), 1.0, 0.0)]].concat(),
        };
        let near = |(a, b): (Point, Point), c: (f64, f64), d: (f64, f64)| {
            assert!((a - Point::new(c.0, c.1)).norm() < 1e-9 && (b - Point::new(d.0, d.1)).norm() < 1e-9, "{a} {b}");
        };
        let lines = lift.door_lines();
        near(lines[0], (9.3, 6.55), (10.7, 6.55));
        near(lines[1], (8.75, 4.7), (8.75, 5.7));
        // What is not at the cabin stays where it is.
        near(lines[2], (9.5, 8.0), (10.5, 8.0));
    }
}
