//! Lines from wall to wall across a way.

use socrates_model::{Point, Vector};

use crate::field::DistanceField;

/// Distance between the places along a way that are tried, m.
const STEP_M: f64 = 0.05;
/// A way is looked at for so many steps at most.
const STEPS: u32 = 2000;
/// A wall farther from the way than this bounds no opening, m.
const REACH_M: f64 = 2.5;
/// A point with less clearance than this is at the wall, m.
const WALL_M: f64 = 0.02;
/// Places that differ in width by less than this are equally narrow, m: what a cell of a map makes of it.
const EQUAL_M: f64 = 0.1;
/// Lines nearer to each other than this are one, m.
const SAME_M: f64 = 0.2;
/// Turns of a line against the right angle to its way that are tried, rad: a way may pass an opening obliquely.
const TURNS: [f64; 7] = [0.0, 0.175, -0.175, 0.35, -0.35, 0.525, -0.525];
/// So much wider than the opening is the floor before or behind it, m.
const WIDER_M: f64 = 0.3;
/// The floor before and behind an opening is measured so far from it, m.
const BESIDE_M: [f64; 3] = [0.4, 0.8, 1.2];

/// A line from wall to wall across a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chord {
    pub(super) from: Point,
    pub(super) to: Point,
    /// Where the way meets it.
    pub(super) at: Point,
    /// Direction of the way there, a unit vector.
    pub(super) ahead: Vector,
    pub(super) width_m: f64,
}

/// The lines across a way that might be openings, the likeliest first: the narrowest, of equally narrow ones the nearest to a
/// point; within a distance of that point.
pub(super) fn chords(field: &DistanceField, way: &[Point], near: &Point, within_m: f64) -> Vec<Chord> {
    let mut found: Vec<(f64, Chord)> = Vec::new();
    for pair in way.windows(2) {
        let [a, b] = pair else { continue };
        let length = (b - a).norm();
        if length <= 0.0 || !length.is_finite() {
            continue;
        }
        let ahead = (b - a) / length;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most STEPS")]
        let steps = (length / STEP_M).min(f64::from(STEPS)) as u32;
        for step in 0..=steps {
            let at = a + ahead * (f64::from(step) * STEP_M);
            let off = (at - near).norm();
            if off <= within_m
                && let Some(chord) = narrowest(field, &at, &ahead)
            {
                found.push((off, chord));
            }
        }
    }
    let least = found.iter().map(|(_, chord)| chord.width_m).fold(f64::INFINITY, f64::min);
    let rank = |(off, chord): &(f64, Chord)| {
        if chord.width_m < least + EQUAL_M { (0, *off) } else { (1, chord.width_m) }
    };
    found.sort_by(|a, b| {
        let (one, other) = (rank(a), rank(b));
        one.0.cmp(&other.0).then(one.1.total_cmp(&other.1))
    });
    let mut apart: Vec<Chord> = Vec::new();
    for (_, chord) in found {
        if apart.iter().all(|known| (known.at - chord.at).norm() >= SAME_M) {
            apart.push(chord);
        }
    }
    apart
}

/// The shortest line through a point of a way that is about at right angles to it.
fn narrowest(field: &DistanceField, at: &Point, ahead: &Vector) -> Option<Chord> {
    let lines = TURNS.iter().filter_map(|turn| {
        let (sin, cos) = libm::sincos(*turn);
        let across = Vector::new(-ahead.y * cos - ahead.x * sin, ahead.x * cos - ahead.y * sin);
        let wall = |along: &Vector| field.to_wall(at, along, WALL_M, REACH_M);
        let (from, to) = wall(&across).zip(wall(&-across))?;
        Some(Chord { from, to, at: *at, ahead: *ahead, width_m: (to - from).norm() })
    });
    // At a right angle unless another one is shorter by more than a cell makes of it.
    lines.reduce(|best, line| if line.width_m < best.width_m - EQUAL_M / 2.0 { line } else { best })
}

/// Whether the floor is wider than the line right before it or right behind it: across a corridor of one width there is no opening.
pub(super) fn is_narrow(field: &DistanceField, chord: &Chord) -> bool {
    let wider = |off: f64| {
        let at = chord.at + chord.ahead * off;
        // Behind a wall nothing is told.
        field.clearance(&at) > WALL_M
            && narrowest(field, &at, &chord.ahead).is_none_or(|line| line.width_m >= chord.width_m + WIDER_M)
    };
    BESIDE_M.iter().any(|off| wider(*off) || wider(-off))
}

/// The point so far along a way.
pub(super) fn along(way: &[Point], mut length_m: f64) -> Option<Point> {
    for pair in way.windows(2) {
        let [a, b] = pair else { continue };
        let piece = (b - a).norm();
        if piece >= length_m && piece > 0.0 {
            return Some(a + (b - a) * (length_m / piece));
        }
        length_m -= piece;
    }
    way.last().copied()
}

/// Length of a way, m.
pub(super) fn length_m(way: &[Point]) -> f64 {
    way.windows(2).map(|pair| if let [a, b] = pair { (b - a).norm() } else { 0.0 }).sum()
}
