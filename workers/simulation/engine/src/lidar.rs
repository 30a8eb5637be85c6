//! A 360-beam scan over walls, doors and people.
//!
//! Each disc and each segment is projected to the interval of beams that can meet it; only those are solved.
//! The interval comes from a rough bearing with slack, so no arc function is called; whether a beam meets a
//! shape is decided by the exact test alone. The grid is walked in leaps over open floor. The loops over beams
//! are compiled for several instruction sets and chosen at run time; each beam is reckoned by itself, without
//! fused operations, so the same scene gives the same bytes on all of them.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::sync::LazyLock;

use socrates_model::{Point, Pose, Vector};

use crate::cells::Cells;
use crate::floor::Floor;
use crate::walls::{Eye, Steps};

/// Beams of a scan; beam 0 is straight ahead, then counter-clockwise by one degree.
pub const BEAMS: usize = 360;

/// More than the error of [`bearing`] (0.004 rad), rad.
pub(crate) const SLACK_RAD: f64 = 0.006;
/// A beam and a segment with a smaller sine of the angle between them are parallel.
const PARALLEL: f64 = 1e-12;

/// A round body that beams meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Center in the map frame, m.
    pub center: Point,
    /// Radius, m; 0 is met by no beam.
    pub radius_m: f64,
}

/// A scene that cannot be scanned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BadScan {
    /// The pose of the scanner is not finite.
    #[error("the scanner stands at `{x}, {y}` with heading `{yaw}`: allowed are finite numbers")]
    Pose {
        /// Its x, m.
        x: f64,
        /// Its y, m.
        y: f64,
        /// Its heading, rad.
        yaw: f64,
    },
    /// The range is not a finite number above 0.
    #[error("the range is `{max_m}` m: allowed is a finite number above 0")]
    Range {
        /// It, m.
        max_m: f64,
    },
    /// A disc is not finite or has a negative radius.
    #[error("disc {place} is at `{x}, {y}` with radius `{radius_m}` m: allowed are finite numbers, radius at least 0")]
    Disc {
        /// Its place in the list, from 0.
        place: usize,
        /// Its x, m.
        x: f64,
        /// Its y, m.
        y: f64,
        /// Its radius, m.
        radius_m: f64,
    },
    /// An end of a segment is not finite.
    #[error("segment {place} goes from `{from}` to `{to}`: allowed are finite numbers")]
    Segment {
        /// Its place in the list, from 0.
        place: usize,
        /// One end, m.
        from: Point,
        /// The other, m.
        to: Point,
    },
}

/// Unit vectors of the beams in the scanner's frame.
struct Headings {
    cos: [f64; BEAMS],
    sin: [f64; BEAMS],
}

static HEADINGS: LazyLock<Headings> = LazyLock::new(|| {
    #[expect(clippy::cast_precision_loss, reason = "360 beams")]
    let angle = |beam: usize| (beam as f64).to_radians();
    Headings {
        cos: std::array::from_fn(|beam| libm::cos(angle(beam))),
        sin: std::array::from_fn(|beam| libm::sin(angle(beam))),
    }
});

/// Ranges of one scan over a floor with its closed doors, and over people, m; a beam that meets nothing reads
/// `max_m`, every beam of a scanner inside a body reads 0.
///
/// People with a place that is not finite are not met.
#[must_use]
pub fn scan(floor: &Floor, from: &Pose, people: &[Disc], max_m: f64) -> Vec<f64> {
    let frame = Frame::new(from);
    let mut ranges = wall_ranges(floor, &frame, max_m);
    meet_shapes(&mut ranges, &frame, people, floor.closed(), max_m);
    ranges.to_vec()
}

/// Ranges of one scan over discs and segments alone, m: no map. A beam that meets nothing reads `max_m`.
///
/// Every beam of a scanner inside a disc reads 0. A beam along a segment meets the nearer end; a segment
/// without length is met by no beam.
///
/// # Errors
/// [`BadScan`] for the first pose, range, disc or segment that is not finite or has a negative size.
pub fn scan_shapes(
    from: &Pose,
    discs: &[Disc],
    segments: &[(Point, Point)],
    max_m: f64,
) -> Result<[f64; BEAMS], BadScan> {
    check(from, discs, segments, max_m)?;
    let mut ranges = [max_m; BEAMS];
    meet_shapes(&mut ranges, &Frame::new(from), discs, segments, max_m);
    Ok(ranges)
}

/// Ranges over the walls of the map alone.
fn wall_ranges(floor: &Floor, frame: &Frame, max_m: f64) -> [f64; BEAMS] {
    let mut ranges = [max_m; BEAMS];
    pulp::Arch::new().dispatch(|| meet_walls(&mut ranges, frame, floor, max_m));
    ranges
}

/// Shortens the beams that meet a wall of the map; all to 0 in a wall and outside.
#[inline(always)]
fn meet_walls(ranges: &mut [f64; BEAMS], frame: &Frame, floor: &Floor, max_m: f64) {
    let (cells, walls) = (floor.cells(), floor.walls());
    let at = cells.position(&frame.origin);
    let ahead = cells.direction(&Vector::new(frame.cos, frame.sin));
    let eye = Eye { at, turn: ahead, reach: max_m * libm::hypot(ahead.0, ahead.1) };
    let steps = frame.steps(cells);
    let walk = |beam: usize| {
        let step = steps.right.get(beam).copied().zip(steps.down.get(beam).copied());
        step.map_or(max_m, |step| cells.ray(at, step, max_m))
    };
    if !walls.serves(&eye) {
        ranges.iter_mut().enumerate().for_each(|(beam, range)| *range = walk(beam));
    } else if !cells.clear(&frame.origin, &frame.origin) {
        ranges.fill(0.0);
    } else {
        let mut doubtful = [0.0; BEAMS];
        walls.meet(&eye, &steps, ranges, &mut doubtful);
        for (beam, (range, doubt)) in ranges.iter_mut().zip(&doubtful).enumerate() {
            if *doubt > 0.0 {
                *range = walk(beam);
            }
        }
    }
}

fn meet_shapes(ranges: &mut [f64; BEAMS], frame: &Frame, discs: &[Disc], segments: &[(Point, Point)], max_m: f64) {
    pulp::Arch::new().dispatch(|| {
        let headings = &*HEADINGS;
        for (a, b) in segments {
            meet_segment(ranges, headings, &frame.local_from_map(a), &frame.local_from_map(b), max_m);
        }
        for disc in discs {
            meet_disc(ranges, headings, &frame.local_from_map(&disc.center), disc.radius_m, max_m);
        }
    });
}

fn check(from: &Pose, discs: &[Disc], segments: &[(Point, Point)], max_m: f64) -> Result<(), BadScan> {
    let finite = |point: &Point| point.x.is_finite() && point.y.is_finite();
    if !finite(&from.point()) || !from.yaw.is_finite() {
        return Err(BadScan::Pose { x: from.x, y: from.y, yaw: from.yaw });
    }
    if !max_m.is_finite() || max_m <= 0.0 {
        return Err(BadScan::Range { max_m });
    }
    for (place, disc) in discs.iter().enumerate() {
        if !finite(&disc.center) || !disc.radius_m.is_finite() || disc.radius_m < 0.0 {
            return Err(BadScan::Disc { place, x: disc.center.x, y: disc.center.y, radius_m: disc.radius_m });
        }
    }
    for (place, (from, to)) in segments.iter().enumerate() {
        if !finite(from) || !finite(to) {
            return Err(BadScan::Segment { place, from: *from, to: *to });
        }
    }
    Ok(())
}

/// The scanner's frame: origin at its center, x ahead.
struct Frame {
    origin: Point,
    cos: f64,
    sin: f64,
}

impl Frame {
    fn new(pose: &Pose) -> Self {
        let (sin, cos) = libm::sincos(pose.yaw);
        Self { origin: pose.point(), cos, sin }
    }

    #[inline(always)]
    fn local_from_map(&self, point: &Point) -> Vector {
        let away = point - self.origin;
        Vector::new(away.x * self.cos + away.y * self.sin, away.y * self.cos - away.x * self.sin)
    }

    /// The beams over the cells of a map.
    #[inline(always)]
    fn steps(&self, cells: &Cells) -> Steps {
        let mut steps =
            Steps { right: [0.0; BEAMS], down: [0.0; BEAMS], per_right: [0.0; BEAMS], per_down: [0.0; BEAMS] };
        let both = steps.right.iter_mut().zip(&mut steps.down);
        let per_cell = steps.per_right.iter_mut().zip(&mut steps.per_down);
        let headings = HEADINGS.cos.iter().zip(&HEADINGS.sin);
        for (((right, down), (per_right, per_down)), (x, y)) in both.zip(per_cell).zip(headings) {
            let in_map = Vector::new(x * self.cos - y * self.sin, x * self.sin + y * self.cos);
            (*right, *down) = cells.direction(&in_map);
            (*per_right, *per_down) = (1.0 / *right, 1.0 / *down);
        }
        steps
    }
}

/// Shortens the beams that meet a disc; `to` is its center in the scanner's frame.
#[inline(always)]
fn meet_disc(ranges: &mut [f64; BEAMS], headings: &Headings, to: &Vector, radius_m: f64, max_m: f64) {
    let (distance2, radius2) = (to.x * to.x + to.y * to.y, radius_m * radius_m);
    if distance2 < radius2 {
        ranges.fill(0.0);
        return;
    }
    let reach = max_m + radius_m;
    // A place that is not a number is not in reach either.
    let in_reach = distance2 < reach * reach;
    if !in_reach || radius_m <= 0.0 {
        return;
    }
    let sine = radius_m / distance2.sqrt();
    // No smaller than the arc sine on 0 to 1, and equal at both ends.
    let half = sine + (FRAC_PI_2 - 1.0) * sine * sine * sine + SLACK_RAD;
    let middle = bearing(to);
    for beams in span(middle - half, middle + half) {
        let Some((ranges, cos, sin)) = slices(ranges, headings, beams) else { continue };
        for ((range, cos), sin) in ranges.iter_mut().zip(cos).zip(sin) {
            let along = cos * to.x + sin * to.y;
            let aside = cos * to.y - sin * to.x;
            let inside = radius2 - aside * aside;
            let hit = (along - inside.max(0.0).sqrt()).max(0.0);
            let meets = (inside >= 0.0) & (along > 0.0) & (hit < *range);
            *range = if meets { hit } else { *range };
        }
    }
}

/// Shortens the beams that meet a segment; its ends are in the scanner's frame.
#[inline(always)]
fn meet_segment(ranges: &mut [f64; BEAMS], headings: &Headings, a: &Vector, b: &Vector, max_m: f64) {
    let along = b - a;
    let length2 = along.x * along.x + along.y * along.y;
    if length2 <= 0.0 {
        return;
    }
    // Nearest point first: most segments of a large place are out of reach.
    let share = (-(a.x * along.x + a.y * along.y) / length2).clamp(0.0, 1.0);
    let nearest = Vector::new(a.x + along.x * share, a.y + along.y * share);
    let in_reach = nearest.x * nearest.x + nearest.y * nearest.y < max_m * max_m;
    if !in_reach {
        return;
    }
    let area = a.x * along.y - a.y * along.x;
    let length = length2.sqrt();
    let (right, left) = if area > 0.0 { (a, b) } else { (b, a) };
    let (from, to) = if area.abs() < 1e-9 * length {
        meet_edge_on(ranges, headings, a, b, area.abs() < PARALLEL * length);
        // On the segment's line which side the ends are on is rounding: all beams are asked.
        (0.0, TAU)
    } else {
        let (from, to) = (bearing(right), bearing(left));
        (from - SLACK_RAD, if to < from - SLACK_RAD { to + TAU } else { to } + SLACK_RAD)
    };
    for beams in span(from, to) {
        let Some((ranges, cos, sin)) = slices(ranges, headings, beams) else { continue };
        for ((range, cos), sin) in ranges.iter_mut().zip(cos).zip(sin) {
            let across = cos * along.y - sin * along.x;
            let place = a.x * sin - a.y * cos;
            // Parallel beams divide by zero: their range is no number below another.
            let hit = area / across;
            let meets = (hit >= 0.0) & (hit < *range) & (place * across >= 0.0) & (place.abs() <= across.abs());
            *range = if meets { hit } else { *range };
        }
    }
}

/// The beams along a segment that is seen from its own line: they meet the nearer end.
fn meet_edge_on(ranges: &mut [f64; BEAMS], headings: &Headings, a: &Vector, b: &Vector, in_line: bool) {
    let along = b - a;
    for ((range, cos), sin) in ranges.iter_mut().zip(&headings.cos).zip(&headings.sin) {
        let across = cos * along.y - sin * along.x;
        if !in_line || across.abs() >= PARALLEL * along.norm() {
            continue;
        }
        let (first, second) = (cos * a.x + sin * a.y, cos * b.x + sin * b.y);
        let hit = if first.min(second) <= 0.0 && first.max(second) >= 0.0 { 0.0 } else { first.min(second) };
        if hit >= 0.0 && hit < *range {
            *range = hit;
        }
    }
}

/// The beams between two bearings, rad, the second not smaller than the first: one or two runs of numbers.
#[inline(always)]
pub(crate) fn span(from: f64, to: f64) -> [std::ops::Range<usize>; 2] {
    // Two turns added so that cutting off the fraction rounds down.
    let turned = |angle: f64| angle.to_degrees() + 720.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bearing within two turns")]
    let (before, last) = (turned(from) as usize, turned(to) as usize);
    let count = last.saturating_sub(before).min(BEAMS);
    let start = (before + 1) % BEAMS;
    let end = start + count;
    [start..end.min(BEAMS), 0..end.saturating_sub(BEAMS)]
}

type Beams<'a> = (&'a mut [f64], &'a [f64], &'a [f64]);

#[inline(always)]
fn slices<'a>(
    ranges: &'a mut [f64; BEAMS],
    headings: &'a Headings,
    beams: std::ops::Range<usize>,
) -> Option<Beams<'a>> {
    Some((ranges.get_mut(beams.clone())?, headings.cos.get(beams.clone())?, headings.sin.get(beams)?))
}

/// Angle of a vector from the x axis, rad, within 0.004 rad: enough to say which beams to ask.
///
/// Arc tangent of z in 0 to 1 as z (pi/4 + 0.273 (1 - z)), Rajan et al. 2006.
#[inline(always)]
pub(crate) fn bearing(to: &Vector) -> f64 {
    let (x, y) = (to.x.abs(), to.y.abs());
    let share = x.min(y) / x.max(y).max(f64::MIN_POSITIVE);
    let octant = share * (FRAC_PI_4 + 0.273 * (1.0 - share));
    let quadrant = if y > x { FRAC_PI_2 - octant } else { octant };
    let half = if to.x < 0.0 { PI - quadrant } else { quadrant };
    if to.y < 0.0 { -half } else { half }
}

#[cfg(test)]
mod tests;
