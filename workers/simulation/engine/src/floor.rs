//! The still world: walls from the grid, doors as they stand now.

use std::sync::{Arc, OnceLock};

use socrates_maps::{DistanceField, Ground, Kept, shortest_path};
use socrates_model::geometry::{nearest_on_segment, segments_cross};
use socrates_model::{Grid, Point, Polyline, Vector};

use crate::cells::Cells;
use crate::walls::Walls;

/// Reach of the wall points that people feel, m (8 sectors).
const WALL_REACH_M: f64 = 3.0;
/// Sectors of the wall points.
const SECTORS: usize = 8;

/// Walls and doors of a run.
#[derive(Debug, Clone)]
pub struct Floor {
    walls: Arc<Still>,
    field: Arc<DistanceField>,
    closed: Vec<(Point, Point)>,
}

/// What never moves: the same for every run over the same grid.
#[derive(Debug)]
struct Still {
    ground: Arc<Ground>,
    cells: Cells,
    edges: OnceLock<Walls>,
}

static STILL: Kept<Still> = Kept::new();

impl Floor {
    /// The floor of a grid, all doors open.
    #[must_use]
    pub fn new(grid: &Grid) -> Self {
        let walls =
            STILL.of(grid, |grid| Still { ground: Ground::of(grid), cells: Cells::new(grid), edges: OnceLock::new() });
        Self { field: Arc::clone(walls.ground.field()), walls, closed: Vec::new() }
    }

    /// The distance field of the grid, shared: it is dear to compute.
    #[must_use]
    pub const fn field(&self) -> &Arc<DistanceField> {
        &self.field
    }

    /// Takes over which door lines are closed.
    pub fn close(&mut self, lines: Vec<(Point, Point)>) {
        self.closed = lines;
    }

    /// Closed door lines.
    #[must_use]
    pub fn closed(&self) -> &[(Point, Point)] {
        &self.closed
    }

    /// Distance to the nearest wall, closed doors not counted, m.
    #[must_use]
    pub fn wall_clearance_m(&self, point: &Point) -> f64 {
        self.field.clearance(point)
    }

    /// Distance to the nearest wall or closed door, m.
    #[must_use]
    pub fn clearance_m(&self, point: &Point) -> f64 {
        self.closed
            .iter()
            .fold(self.field.clearance(point), |least, (from, to)| least.min(nearest_on_segment(point, from, to).0))
    }

    /// Wall points that somebody at `point` feels: the nearest of each of 8 sectors, and of each closed door.
    #[must_use]
    pub fn felt(&self, point: &Point) -> Vec<Point> {
        let mut points = self.field.sectors(point, WALL_REACH_M, SECTORS);
        for (from, to) in &self.closed {
            let (distance, nearest) = nearest_on_segment(point, from, to);
            if distance < WALL_REACH_M {
                points.push(nearest);
            }
        }
        points
    }

    /// Nearest wall point within reach, closed doors included, with its distance.
    #[must_use]
    pub fn nearest_wall(&self, point: &Point, reach_m: f64) -> Option<(f64, Point)> {
        let wall = self.field.nearest_wall(point, reach_m).map(|wall| ((wall - point).norm(), wall));
        self.closed
            .iter()
            .map(|(from, to)| nearest_on_segment(point, from, to))
            .filter(|(distance, _)| *distance < reach_m)
            .fold(wall, |best, found| match best {
                Some(best) if best.0 <= found.0 => Some(best),
                Some(_) | None => Some(found),
            })
    }

    /// Whatever is nearer than this is seen from a point with this clearance, m: neither wall nor closed door stands
    /// in between.
    pub(crate) fn open_of(&self, clearance_m: f64) -> f64 {
        // The field blurs by less than a cell, and a cell is solid to its corners.
        clearance_m - 2.0 * self.walls.ground.grid().resolution_m
    }

    /// Whatever is nearer than this to a point is seen from it, m; 0 or less where nothing is certain.
    #[must_use]
    pub fn open_m(&self, point: &Point) -> f64 {
        self.open_of(self.clearance_m(point))
    }

    /// Whether two points see each other now.
    #[must_use]
    pub fn sees(&self, a: &Point, b: &Point) -> bool {
        self.closed.iter().all(|(from, to)| !segments_cross(a, b, from, to)) && self.walls.cells.clear(a, b)
    }

    /// Whether a disc can go straight from `a` to `b`, doors taken as open.
    #[must_use]
    pub fn straight(&self, a: &Point, b: &Point, radius_m: f64) -> bool {
        let way = b - a;
        let length = way.norm();
        let mut gone = 0.0;
        // Sphere tracing: each step is as long as the clearance allows.
        loop {
            let here = if length > 0.0 { a + way * (gone / length) } else { *a };
            let free = self.field.clearance(&here);
            if free < radius_m {
                return false;
            }
            if gone >= length {
                return true;
            }
            gone = (gone + (free - radius_m).max(0.04)).min(length);
        }
    }

    /// Whether the straight line between two points goes through a closed door.
    #[must_use]
    pub fn shut_between(&self, a: &Point, b: &Point) -> bool {
        self.closed.iter().any(|(from, to)| segments_cross(a, b, from, to))
    }

    /// The way of a disc between two points, doors taken as open.
    #[must_use]
    pub fn way(&self, from: &Point, to: &Point, radius_m: f64) -> Option<Polyline> {
        if self.straight(from, to, radius_m) {
            return Some(Polyline::new(&[*from, *to]));
        }
        shortest_path(self.walls.ground.grid(), &self.field, from, to, radius_m).map(|points| Polyline::new(&points))
    }

    /// The cells that rays walk over, doors taken as open.
    pub(crate) fn cells(&self) -> &Cells {
        &self.walls.cells
    }

    /// The walls as edges, looked for when somebody first asks.
    pub(crate) fn walls(&self) -> &Walls {
        self.walls.edges.get_or_init(|| Walls::new(self.walls.ground.grid()))
    }

    /// Distance to the first wall or closed door in a direction, m, at most `max_m`.
    #[must_use]
    pub fn ray_m(&self, from: &Point, angle: f64, max_m: f64) -> f64 {
        let mut range = self.walls.ground.sight().ray(from, angle, max_m);
        let heading = Vector::new(libm::cos(angle), libm::sin(angle));
        for (a, b) in &self.closed {
            if let Some(hit) = ray_segment(from, &heading, a, b) {
                range = range.min(hit);
            }
        }
        range
    }
}

/// Distance along a ray (unit heading) to a segment, m.
#[must_use]
pub fn ray_segment(from: &Point, heading: &Vector, a: &Point, b: &Point) -> Option<f64> {
    let along = b - a;
    let across = heading.perp(&along);
    if across.abs() < 1e-12 {
        return None;
    }
    let to_a = a - from;
    let range = to_a.perp(&along) / across;
    let share = to_a.perp(heading) / across;
    (range >= 0.0 && (0.0..=1.0).contains(&share)).then_some(range)
}
