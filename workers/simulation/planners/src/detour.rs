//! A way round people near the robot: A* over a small window of floor.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use socrates_model::{Point, Polyline, Vector};

use crate::ground::{Ground, Obstacle};

/// Cell of the window, m.
const CELL_M: f64 = 0.15;
/// Cells from the middle of the window to its rim: 4.8 m.
const HALF: i32 = 32;
/// Cells of a side.
const SIDE: usize = 65;
/// Never nearer to a body's surface than the first of these where there is such a way, else than the second, m.
const HARD_GAPS_M: [f64; 2] = [0.32, 0.1];
/// A way with a wide berth that is longer than so many times the straight line, and so much more, m, is taken only where the
/// narrower berth leads nowhere: it would lead round a whole rack instead of past who stands beside it.
const FAR: f64 = 1.35;
const FAR_M: f64 = 0.6;
/// Nearer than this to a body's surface is dear, m: a meter that touches it costs so many more. A higher price would be a wide
/// berth round whoever stands beside the way, where a small step aside is enough.
const SOFT_GAP_M: f64 = 0.65;
const SOFT_PRICE: f64 = 5.0;
/// How much dearer a meter is on the left of the way, 1 m off it.
const KEEP_RIGHT: f64 = 0.3;
/// Nearer than this to a wall is dear, m.
const WALL_SOFT_M: f64 = 0.25;

#[derive(Debug, Clone, Copy)]
struct Open {
    rank: f64,
    cost: f64,
    cell: usize,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        // A max-heap: the smallest rank is the largest; equal ranks go by cell, so that the order is one.
        other.rank.total_cmp(&self.rank).then_with(|| other.cell.cmp(&self.cell))
    }
}

/// The window round a center.
struct Window<'a> {
    center: Point,
    ground: &'a Ground,
    obstacles: &'a [Obstacle],
    route: &'a Polyline,
    weights: Vec<Option<Option<f64>>>,
    hard_gap_m: f64,
}

impl Window<'_> {
    fn point(&self, cell: usize) -> Point {
        let (column, row) = split(cell);
        self.center + Vector::new(f64::from(column) * CELL_M, f64::from(row) * CELL_M)
    }

    fn cell(&self, point: &Point) -> Option<usize> {
        let way = (point - self.center) / CELL_M;
        #[expect(clippy::cast_possible_truncation, reason = "checked against the window next")]
        let (column, row) = (way.x.round() as i32, way.y.round() as i32);
        join(column, row)
    }

    /// Cost of a meter in a cell; `None` where the robot cannot be.
    fn weight(&mut self, cell: usize) -> Option<f64> {
        if let Some(Some(known)) = self.weights.get(cell) {
            return *known;
        }
        let weight = self.weigh(&self.point(cell));
        if let Some(slot) = self.weights.get_mut(cell) {
            *slot = Some(weight);
        }
        weight
    }

    fn weigh(&self, at: &Point) -> Option<f64> {
        let wall = self.ground.clearance_m(at) - self.ground.radius_m;
        if wall < 0.02 {
            return None;
        }
        let (s, off) = self.route.project(at);
        let left = self.route.direction(s).perp(&(at - self.route.point(s))).clamp(0.0, 1.0);
        let mut weight = 1.0 + 2.0 * ((WALL_SOFT_M - wall) / WALL_SOFT_M).max(0.0) + 0.25 * off.min(4.0);
        // Where both sides are as good it keeps to the right, like those who come towards it.
        weight += KEEP_RIGHT * left;
        for obstacle in self.obstacles {
            let gap = obstacle.gap_m(at) - self.ground.radius_m;
            if obstacle.hard && gap < self.hard_gap_m {
                return None;
            }
            weight += SOFT_PRICE * ((SOFT_GAP_M - gap) / SOFT_GAP_M).clamp(0.0, 1.0);
        }
        Some(weight)
    }
}

fn split(cell: usize) -> (i32, i32) {
    let column = i32::try_from(cell % SIDE).unwrap_or(0) - HALF;
    let row = i32::try_from(cell / SIDE).unwrap_or(0) - HALF;
    (column, row)
}

fn join(column: i32, row: i32) -> Option<usize> {
    if column.abs() > HALF || row.abs() > HALF {
        return None;
    }
    let (column, row) = (usize::try_from(column + HALF).ok()?, usize::try_from(row + HALF).ok()?);
    Some(row * SIDE + column)
}

const STEPS: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// A way from `from` to `to` round the obstacles, at most about 4.5 m long in each direction; `None` where there is none.
pub(crate) fn round(
    ground: &Ground,
    obstacles: &[Obstacle],
    route: &Polyline,
    from: &Point,
    to: &Point,
) -> Option<Polyline> {
    // From too near to somebody there is no way with a wide berth, but there is one that leads away.
    let near = obstacles.iter().filter(|obstacle| obstacle.hard).fold(f64::INFINITY, |least, obstacle| {
        least.min(obstacle.gap_m(from).min(obstacle.gap_m(to)) - ground.radius_m)
    });
    let most_m = (to - from).norm() * FAR + FAR_M;
    let mut far = None;
    for gap in HARD_GAPS_M.iter().filter(|gap| near > **gap || **gap < 0.2) {
        match search(ground, obstacles, route, (from, to), *gap) {
            Some(way) if way.length_m() <= most_m => return Some(way),
            Some(way) => far = far.or(Some(way)),
            None => {}
        }
    }
    far
}

fn search(
    ground: &Ground,
    obstacles: &[Obstacle],
    route: &Polyline,
    (from, to): (&Point, &Point),
    hard_gap_m: f64,
) -> Option<Polyline> {
    let center = nalgebra_center(from, to);
    let near = route.from((route.project(from).0 - 1.0).max(0.0));
    let mut window = Window { center, ground, obstacles, route: &near, weights: vec![None; SIDE * SIDE], hard_gap_m };
    let (start, goal) = (window.cell(from)?, window.cell(to)?);
    window.weight(goal)?;
    let mut best = vec![f64::INFINITY; SIDE * SIDE];
    let mut before = vec![usize::MAX; SIDE * SIDE];
    let mut open = BinaryHeap::from([Open { rank: 0.0, cost: 0.0, cell: start }]);
    *best.get_mut(start)? = 0.0;
    let end = window.point(goal);
    while let Some(Open { cost, cell, .. }) = open.pop() {
        if cell == goal {
            return Some(trace(&window, &before, from, to, cell));
        }
        if cost > best.get(cell).copied().unwrap_or(0.0) + 1e-12 {
            continue;
        }
        let (column, row) = split(cell);
        for (right, up) in STEPS {
            let Some(next) = join(column + right, row + up) else { continue };
            let Some(weight) = window.weight(next) else { continue };
            let step = if right != 0 && up != 0 { CELL_M * std::f64::consts::SQRT_2 } else { CELL_M };
            let total = cost + step * weight;
            if best.get(next).is_some_and(|known| total + 1e-9 < *known) {
                if let (Some(slot), Some(link)) = (best.get_mut(next), before.get_mut(next)) {
                    *slot = total;
                    *link = cell;
                }
                open.push(Open { rank: total + (window.point(next) - end).norm(), cost: total, cell: next });
            }
        }
    }
    None
}

fn nalgebra_center(a: &Point, b: &Point) -> Point {
    socrates_model::nalgebra::center(a, b)
}

fn trace(window: &Window<'_>, before: &[usize], from: &Point, to: &Point, goal: usize) -> Polyline {
    let mut points = vec![*to];
    let mut cell = goal;
    while let Some(previous) = before.get(cell).copied().filter(|previous| *previous != usize::MAX) {
        cell = previous;
        points.push(window.point(cell));
    }
    points.pop();
    points.push(*from);
    points.reverse();
    // Corners of the lattice are rounded off by averaging neighbors; ends stay.
    for _ in 0..3 {
        let old = points.clone();
        for (slot, around) in points.iter_mut().skip(1).zip(old.windows(3)) {
            if let [a, b, c] = around {
                *slot = Point::from((a.coords + b.coords * 2.0 + c.coords) / 4.0);
            }
        }
    }
    Polyline::new(&points)
}
