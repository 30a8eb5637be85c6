//! The obstacle layer: what the lidar sees.
//!
//! It keeps a grid of its own: a cell stays marked until a beam passes through it. What leaves the range of clearing, or is hidden,
//! stays in the map: the ghosts behind people who walk, well known of Nav2.

use std::f64::consts::TAU;

use socrates_model::{Point, Pose, Vector};

use super::grid::{Bounds, Costmap, FREE, LETHAL};
use super::layered::{Layer, Merge, Scan, Sensed};
use super::raytrace::Line;

/// Parameters of the obstacle layer; defaults are Nav2's. A lidar sees one plane, so Nav2's voxel layer would hold the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObstacleParams {
    /// Hits nearer than this are not marked, m; default 0.
    pub obstacle_min_range: f64,
    /// Hits farther than this are not marked, m; default 2.5.
    pub obstacle_max_range: f64,
    /// Cells nearer than this are not cleared, m; default 0.
    pub raytrace_min_range: f64,
    /// Cells farther than this are not cleared, m; default 3.
    pub raytrace_max_range: f64,
    /// Whether hits are marked; default true.
    pub marking: bool,
    /// Whether beams clear what they pass; default true.
    pub clearing: bool,
    /// Whether a beam that met nothing clears up to the range of the lidar; default false: it is left out.
    pub inf_is_valid: bool,
    /// Whether the floor under the robot is free; default true.
    pub footprint_clearing_enabled: bool,
    /// How its cells become the map's; default [`Merge::Max`].
    pub combination_method: Merge,
}

impl Default for ObstacleParams {
    fn default() -> Self {
        Self {
            obstacle_min_range: 0.0,
            obstacle_max_range: 2.5,
            raytrace_min_range: 0.0,
            raytrace_max_range: 3.0,
            marking: true,
            clearing: true,
            inf_is_valid: false,
            footprint_clearing_enabled: true,
            combination_method: Merge::Max,
        }
    }
}

/// Beams of a scan, one a degree.
const BEAMS: u32 = 360;

/// The obstacle layer.
#[derive(Debug)]
pub struct ObstacleLayer {
    params: ObstacleParams,
    own: Costmap,
    default: u8,
    /// Directions of the beams in the lidar's frame.
    beams: Vec<Vector>,
}

impl ObstacleLayer {
    /// The layer for a map of this size; `default` is the cost of a cell never seen.
    #[must_use]
    pub fn new(params: &ObstacleParams, map: &Costmap, default: u8) -> Self {
        let beam = |beam: u32| {
            let angle = f64::from(beam) * (TAU / f64::from(BEAMS));
            Vector::new(libm::cos(angle), libm::sin(angle))
        };
        let mut own = map.clone();
        own.costs_mut().fill(default);
        Self { params: *params, own, default, beams: (0..BEAMS).map(beam).collect() }
    }

    /// What the layer itself has marked and cleared.
    #[must_use]
    pub const fn own(&self) -> &Costmap {
        &self.own
    }
}

/// Column and row of a point, inside the map or not.
#[expect(clippy::cast_possible_truncation, reason = "a lidar reaches fewer than 2^52 cells")]
fn cell_of(map: &Costmap, point: &Point) -> (isize, isize) {
    let of = |at: f64, from: f64| ((at - from) / map.resolution_m()).floor() as isize;
    (of(point.x, map.origin().x), of(point.y, map.origin().y))
}

/// The cell, held inside a map; none of a map without cells.
fn held(map: &Costmap, cell: (isize, isize), bounds: &mut Bounds) {
    let hold = |at: isize, size: usize| usize::try_from(at).unwrap_or(0).min(size.saturating_sub(1));
    if !map.whole().is_empty() {
        bounds.add(hold(cell.0, map.width()), hold(cell.1, map.height()));
    }
}

fn set(map: &mut Costmap, cell: (isize, isize), cost: u8) {
    if let (Ok(column), Ok(row)) = (usize::try_from(cell.0), usize::try_from(cell.1)) {
        map.set(column, row, cost);
    }
}

/// Directions of the beams that count, their lengths, m, and whether they met something.
fn beams<'a>(
    own: &'a [Vector],
    params: &ObstacleParams,
    scan: &'a Scan,
) -> impl Iterator<Item = (Vector, f64, bool)> + 'a {
    let (sin, cos) = (libm::sin(scan.from.yaw), libm::cos(scan.from.yaw));
    let inf_is_valid = params.inf_is_valid;
    own.iter().zip(&scan.ranges_m).filter_map(move |(beam, range)| {
        let ahead = Vector::new(beam.x * cos - beam.y * sin, beam.x * sin + beam.y * cos);
        let hit = *range < scan.range_max_m;
        // NaN neither meets something nor reaches the end of the range.
        let counts = hit || inf_is_valid && *range >= scan.range_max_m;
        counts.then(|| (ahead, range.min(scan.range_max_m), hit))
    })
}

impl ObstacleLayer {
    /// Clears what the beams pass, then marks what they met.
    fn take(&mut self, scan: &Scan, bounds: &mut Bounds) {
        let Self { params, own, beams: directions, .. } = self;
        let from = scan.from.point();
        let start = cell_of(own, &from);
        if params.clearing {
            let least = params.raytrace_min_range / own.resolution_m();
            for (ahead, range, _) in beams(directions, params, scan) {
                let end = cell_of(own, &(from + ahead * range.min(params.raytrace_max_range)));
                held(own, start, bounds);
                held(own, end, bounds);
                for cell in Line::new(start, end) {
                    let (across, up) = ((cell.0 - start.0) as f64, (cell.1 - start.1) as f64);
                    if across * across + up * up >= least * least {
                        set(own, cell, FREE);
                    }
                }
            }
        }
        if params.marking {
            let near = params.obstacle_min_range..=params.obstacle_max_range;
            for (ahead, range, _) in
                beams(directions, params, scan).filter(|(_, range, hit)| *hit && near.contains(range))
            {
                let end = cell_of(own, &(from + ahead * range));
                set(own, end, LETHAL);
                held(own, end, bounds);
            }
        }
    }

    /// Frees the floor under the robot.
    fn clear_footprint(&mut self, sensed: &Sensed<'_>, bounds: &mut Bounds) {
        let square = footprint_square(&self.own, sensed);
        bounds.join(&square);
        let at = sensed.pose.point();
        for row in square.bottom..square.top {
            for column in square.left..square.right {
                let center = self.own.center(column, row);
                let under = if sensed.footprint.is_empty() {
                    (center - at).norm() <= sensed.radius_m
                } else {
                    covers(sensed.footprint, &sensed.pose, &center)
                };
                if under {
                    self.own.set(column, row, FREE);
                }
            }
        }
    }
}

fn footprint_square(map: &Costmap, sensed: &Sensed<'_>) -> Bounds {
    let reach = sensed.footprint.iter().map(|corner| corner.coords.norm()).fold(sensed.radius_m, f64::max);
    map.square(&sensed.pose.point(), reach)
}

/// Whether an outline in the frame of a pose covers a point: an odd number of edges to the right of it.
fn covers(outline: &[Point], pose: &Pose, point: &Point) -> bool {
    let (sin, cos) = (libm::sin(pose.yaw), libm::cos(pose.yaw));
    let away = point - pose.point();
    let (x, y) = (away.x * cos + away.y * sin, away.y * cos - away.x * sin);
    let ends = outline.iter().cycle().skip(1);
    let crossed = outline.iter().zip(ends).filter(|(from, to)| {
        (from.y > y) != (to.y > y) && x < from.x + (y - from.y) / (to.y - from.y) * (to.x - from.x)
    });
    crossed.count() % 2 == 1
}

impl Layer for ObstacleLayer {
    fn look(&mut self, _map: &Costmap, sensed: &Sensed<'_>, bounds: &mut Bounds) {
        if let Some(scan) = sensed.scan {
            self.take(scan, bounds);
        }
        if self.params.footprint_clearing_enabled {
            self.clear_footprint(sensed, bounds);
        }
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, _sensed: &Sensed<'_>) {
        self.params.combination_method.merge(map, &self.own, bounds);
    }

    fn roll(&mut self, columns: isize, rows: isize) {
        self.own.roll(columns, rows, self.default);
    }

    fn clear(&mut self) {
        self.own.costs_mut().fill(self.default);
    }
}
