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

use crate::floor::Floor;

/// Beams of a scan; beam 0 is straight ahead, then counter-clockwise by one degree.
pub const BEAMS: usize = 360;

/// More than the error of [`bearing`] (0.004 rad), rad.
const SLACK_RAD: f64 = 0.006;
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
    let mut ranges = [max_m; BEAMS];
    floor.wall_ranges(&frame.origin, &mut ranges, |beam| frame.heading(beam));
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

    /// Direction of a beam in the map frame.
    fn heading(&self, beam: usize) -> Vector {
        let (cos, sin) = (HEADINGS.cos.get(beam), HEADINGS.sin.get(beam));
        let (x, y) = (cos.copied().unwrap_or(1.0), sin.copied().unwrap_or(0.0));
        Vector::new(x * self.cos - y * self.sin, x * self.sin + y * self.cos)
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
fn span(from: f64, to: f64) -> [std::ops::Range<usize>; 2] {
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
fn bearing(to: &Vector) -> f64 {
    let (x, y) = (to.x.abs(), to.y.abs());
    let share = x.min(y) / x.max(y).max(f64::MIN_POSITIVE);
    let octant = share * (FRAC_PI_4 + 0.273 * (1.0 - share));
    let quadrant = if y > x { FRAC_PI_2 - octant } else { octant };
    let half = if to.x < 0.0 { PI - quadrant } else { quadrant };
    if to.y < 0.0 { -half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn the_rough_bearing_is_within_its_slack() {
        for step in 0..3600_u32 {
            let angle = -PI + f64::from(step) * TAU / 3600.0 + 1e-6;
            let found = bearing(&Vector::new(libm::cos(angle), libm::sin(angle)));
            assert!((found - angle).abs() < 0.005, "{angle}: {found}");
        }
    }

    #[test]
    fn a_person_ahead_shortens_the_beams_that_meet_it() {
        let discs = [Disc { center: Point::new(5.0, 1.0), radius_m: 0.5 }];
        let ranges = scan_shapes(&Pose::new(1.0, 1.0, 0.0), &discs, &[], 12.0).unwrap();
        assert!((ranges[0] - 3.5).abs() < 1e-12);
        // asin(0.5 / 4) is 7.18 degrees.
        assert_eq!(ranges.iter().filter(|range| **range < 12.0).count(), 15);
        assert!(ranges[7] < 12.0 && ranges[353] < 12.0 && (ranges[8] - 12.0).abs() < 1e-12);
    }

    #[test]
    fn the_floor_and_its_closed_doors_and_people_are_one_scan() {
        let mut floor = Floor::new(&fixture::hall(20.0, 10.0));
        let from = Pose::new(5.0, 5.0, std::f64::consts::FRAC_PI_2);
        let open = scan(&floor, &from, &[], 12.0);
        assert!((open[0] - 4.9).abs() < 1e-9 && (open[270] - 12.0).abs() < 1e-9 && (open[90] - 4.9).abs() < 1e-9);
        floor.close(vec![(Point::new(8.0, 4.0), Point::new(8.0, 6.0))]);
        let people = [
            Disc { center: Point::new(5.0, 7.0), radius_m: 0.3 },
            Disc { center: Point::new(f64::NAN, 7.0), radius_m: 0.3 },
        ];
        let shut = scan(&floor, &from, &people, 12.0);
        assert!((shut[270] - 3.0).abs() < 1e-9 && (shut[0] - 1.7).abs() < 1e-9 && (shut[90] - 4.9).abs() < 1e-9);
        // Beam by beam the same as one ray at a time.
        for (beam, range) in shut.iter().enumerate() {
            let angle = from.yaw + (beam as f64).to_radians();
            let wall = floor.ray_m(&from.point(), angle, 12.0);
            let heading = Vector::new(libm::cos(angle), libm::sin(angle));
            let body = crate::floor::ray_disc(&from.point(), &heading, &people[0].center, 0.3);
            assert!((range - body.unwrap_or(12.0).min(wall)).abs() < 1e-9, "beam {beam}: {range}");
        }
    }

    #[test]
    fn a_scene_with_a_number_that_is_none_is_refused_with_its_place() {
        let (here, nan) = (Pose::new(0.0, 0.0, 0.0), f64::NAN);
        let disc = |x: f64, radius_m: f64| Disc { center: Point::new(x, 0.0), radius_m };
        let line = (Point::new(1.0, 0.0), Point::new(nan, 0.0));
        let refused = [
            (scan_shapes(&Pose::new(nan, 0.0, 0.0), &[], &[], 12.0), "scanner stands at `NaN"),
            (scan_shapes(&here, &[], &[], nan), "range is `NaN` m"),
            (scan_shapes(&here, &[], &[], -1.0), "range is `-1` m"),
            (scan_shapes(&here, &[disc(1.0, 0.3), disc(nan, 0.3)], &[], 12.0), "disc 1 is at `NaN"),
            (scan_shapes(&here, &[disc(1.0, -0.3)], &[], 12.0), "radius `-0.3` m"),
            (scan_shapes(&here, &[], &[line], 12.0), "segment 0 goes"),
        ];
        for (found, wanted) in refused {
            let message = found.unwrap_err().to_string();
            assert!(message.contains(wanted), "{message}");
        }
    }
}
