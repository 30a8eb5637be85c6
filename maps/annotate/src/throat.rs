//! Throats: places where two wall ends face each other, with wider floor before and behind.
//!
//! ```text
//!            before
//!   ───────┐        ┌───────      the jambs are the ends of two walls;
//!          │ width  │             depth is that of the wall,
//!   ───────┘        └───────      shoulders the floor beside the opening
//!            behind
//! ```

use socrates_model::Vector;

use crate::floor::{Floor, Spot};

/// Widest opening that is a door, m: two leaves of 0.75 m, and a cell on each side.
const WIDEST_M: f64 = 1.7;
/// Widest opening that parts the floor, m: one of several leaves or none.
const WIDEST_OPEN_M: f64 = 3.6;
/// Widths of the mouth of a bay, m.
const MOUTH_M: (f64, f64) = (3.6, 9.0);
/// Deepest wall of a door, m: what is longer is a passage, or the gap beside furniture.
const DEEPEST_M: f64 = 0.75;
/// A wall thinner than this has a door even where one jamb is flush with another wall, m.
const THIN_M: f64 = 0.45;
/// A point with less clearance than this is at the wall, m.
const WALL_M: f64 = 0.02;
/// So much wider is the floor where a throat ends, m.
const WIDER_M: f64 = 0.3;
/// A shoulder is at least so wide, m.
const SHOULDER_M: f64 = 0.2;
/// A wall of a door goes on for at least this beside the opening, m, on one of its faces.
const TONGUE_M: f64 = 0.45;
/// The wall behind a jamb is measured so far from it, m: a wall in line with the opening has one thickness, a corner ever more, and
/// a wall askew is left. At the last one another wall may meet it.
const OUTWARD_M: [f64; 3] = [0.12, 0.25, 0.5];
/// A wall may bend at the jamb, so it is looked for in these directions beside the line of the opening, rad.
const BENDS_RAD: [f64; 5] = [0.0, 0.2, -0.2, 0.4, -0.4];
/// A wall that bends goes on for at least this, m: an askew wall does, the side of a thing beside the opening does not.
const BENT_M: f64 = 0.9;
/// Thicknesses that differ by less than this are one, m: what a cell makes of it.
const EVEN_M: f64 = 0.12;
/// Shoulders are measured up to so far, m.
const BESIDE_M: f64 = 1.2;
/// Step along and across a throat, m.
const STEP_M: f64 = 0.05;
/// Directions in a half circle that are tried for the narrowest line.
const TURNS: u32 = 24;

/// What stands at one side of a throat.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Jamb {
    /// The end of a wall, which goes on beside the opening for so far on both faces, m.
    End { tongue_m: f64 },
    /// A wall that the opening lies against.
    Flush,
    /// Floor beside the opening on one face only.
    Step,
    /// The corner of something thick.
    Corner,
}

/// Kinds of openings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Opening {
    /// A doorway.
    Door,
    /// Wider than any door: what lies beyond is a place of its own, and open to this one.
    Wide,
    /// The whole side of a bay: the walls of a way go on beside it, and those of the bay begin at it. True where the bay lies behind.
    Mouth(bool),
}

/// An opening between two wall ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Throat {
    /// The jambs.
    pub(crate) from: Spot,
    pub(crate) to: Spot,
    pub(crate) width_m: f64,
    pub(crate) opening: Opening,
    /// Unit vector through the opening.
    pub(crate) ahead: Vector,
    /// How far the opening goes along `ahead` from its middle, and against it, m.
    pub(crate) reach_m: (f64, f64),
    /// Floor beside the opening: left and right before it, left and right behind it, m.
    shoulders: [f64; 4],
}

impl Throat {
    pub(crate) fn middle(&self) -> Spot {
        self.from + (self.to - self.from) / 2.0
    }

    pub(crate) fn depth_m(&self) -> f64 {
        self.reach_m.0 + self.reach_m.1
    }

    /// A spot this far beyond the opening, before it or behind it.
    pub(crate) fn beyond(&self, behind: bool, off_m: f64) -> Spot {
        let way = if behind { -(self.reach_m.1 + off_m) } else { self.reach_m.0 + off_m };
        self.middle() + self.ahead * way
    }

    fn shoulder_count(&self) -> usize {
        self.shoulders.iter().filter(|beside| **beside >= SHOULDER_M).count()
    }

    /// How surely this is a door, 0 to 1: wall ends on both sides of both faces, thin walls and usual widths speak for it.
    pub(crate) fn confidence(&self) -> f64 {
        let [a, b, c, d] = self.shoulders.map(|beside| f64::from(u8::from(beside >= SHOULDER_M)));
        let ends = (a + b + c + d) / 4.0;
        let thin = 1.0 - ((self.depth_m() - 0.25) / (DEEPEST_M - 0.25)).clamp(0.0, 1.0);
        let usual = 1.0 - ((self.width_m - 1.3) / (WIDEST_M - 1.3)).clamp(0.0, 1.0);
        0.35 + 0.35 * ends + 0.2 * thin + 0.1 * usual
    }

    /// Shoulders on the side of `from`, or of `to`.
    fn beside(&self, to: bool) -> [f64; 2] {
        let [left_before, right_before, left_behind, right_behind] = self.shoulders;
        // Seen along `ahead`, `to` lies on the left.
        if to { [right_before, right_behind] } else { [left_before, left_behind] }
    }

    /// What stands at a jamb.
    fn jamb(&self, floor: &Floor, to: bool) -> Jamb {
        let out = (self.to - self.from) / self.width_m.max(1e-9);
        let (at, out) = if to { (self.to, out) } else { (self.from, -out) };
        let [before, behind] = self.beside(to);
        let (least, most) = (before.min(behind), before.max(behind));
        if most < SHOULDER_M {
            return Jamb::Flush;
        }
        let goes_on = |bend: &f64| {
            let (sin, cos) = libm::sincos(*bend);
            let along = Vector::new(out.x * cos - out.y * sin, out.x * sin + out.y * cos);
            let thick_m = OUTWARD_M.map(|off_m| thickness_m(floor, &(at + along * off_m), &self.ahead));
            let [near_m, next_m, far_m] = thick_m;
            // A thick wall has two faces that are as far apart as the opening is deep.
            let even = (next_m - near_m).abs() <= EVEN_M
                && next_m <= DEEPEST_M
                && (next_m - self.depth_m()).abs() <= 2.0 * EVEN_M;
            let long = bend.abs() < 1e-9 || thickness_m(floor, &(at + along * BENT_M), &self.ahead) > 0.0;
            near_m > 0.0 && next_m > 0.0 && far_m > 0.0 && long && (near_m.max(next_m) <= THIN_M || even)
        };
        match (BENDS_RAD.iter().any(goes_on), least >= SHOULDER_M) {
            (true, _) => Jamb::End { tongue_m: least },
            (false, false) => Jamb::Step,
            (false, true) => Jamb::Corner,
        }
    }

    /// What the opening is, if walls stand on both sides of it and not things beside a wall.
    fn kind(&self, floor: &Floor) -> Option<Opening> {
        if self.depth_m() > DEEPEST_M || self.width_m > WIDEST_OPEN_M {
            return None;
        }
        let jambs = [self.jamb(floor, false), self.jamb(floor, true)];
        let thin = self.depth_m() <= THIN_M;
        if self.width_m > WIDEST_M {
            // So wide an opening has two whole wall ends.
            let whole = |jamb: &Jamb| matches!(jamb, Jamb::End { tongue_m } if *tongue_m >= TONGUE_M);
            return (thin && jambs.iter().all(whole)).then_some(Opening::Wide);
        }
        let door = match jambs {
            [Jamb::End { .. }, Jamb::End { .. }] => true,
            [Jamb::End { tongue_m }, Jamb::Flush | Jamb::Step] | [Jamb::Flush | Jamb::Step, Jamb::End { tongue_m }] => {
                thin && tongue_m >= TONGUE_M
            }
            [Jamb::Flush | Jamb::Step | Jamb::Corner, _] | [_, Jamb::Corner] => false,
        };
        door.then_some(Opening::Door)
    }

    /// Whether it is the mouth of a bay, and on which side the bay lies: true behind it.
    fn mouth(&self) -> Option<bool> {
        if !(MOUTH_M.0..=MOUTH_M.1).contains(&self.width_m) {
            return None;
        }
        let [[left_before, left_behind], [right_before, right_behind]] = [self.beside(false), self.beside(true)];
        let (before, behind) = (self.reach_m.0, self.reach_m.1);
        // The walls of the way go on on both sides, right at the line; those of the bay go straight in.
        let is_way = |left: f64, right: f64, reach: f64| left.min(right) >= 2.0 * SHOULDER_M && reach <= 0.15;
        let is_bay = |left: f64, right: f64, reach: f64| left.max(right) < SHOULDER_M && reach > DEEPEST_M;
        if is_way(left_before, right_before, before) && is_bay(left_behind, right_behind, behind) {
            return Some(true);
        }
        (is_way(left_behind, right_behind, behind) && is_bay(left_before, right_before, before)).then_some(false)
    }

    /// Whether two lines are openings of the same place.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        (self.middle() - other.middle()).norm() < 0.5 * self.width_m.min(other.width_m) + 0.25
    }
}

/// Every door and wide opening on the floor, by the cells of its skeleton.
pub(crate) fn openings(floor: &Floor, spots: &[Spot]) -> Vec<Throat> {
    let between_walls = |throat: &Throat| {
        let outward = (throat.to - throat.from).normalize() * (2.0 * floor.map_cell_m);
        let jambs = [throat.from - outward, throat.to + outward];
        // The two jambs of a booth are of one block; a gap between two blocks, or between one and a wall, is no door.
        let [from, to] = jambs.map(|jamb| floor.blocks.at(floor.cell(&jamb)));
        jambs.iter().all(|jamb| !floor.things.holds(floor.pixel(jamb))) && from == to
    };
    let sense = |spot: &Spot| floor.clean_m(spot);
    let probed = spots.iter().filter_map(|spot| probe(&sense, spot, WIDEST_OPEN_M)).filter_map(|throat| {
        let opening = throat.kind(floor)?;
        Some(Throat { opening, ..throat })
    });
    best(probed.filter(between_walls).collect())
}

/// The best opening of each place: the surest, of equally sure ones the narrowest.
fn best(mut found: Vec<Throat>) -> Vec<Throat> {
    found.sort_by(|a, b| {
        let wide = |throat: &Throat| throat.opening == Opening::Wide;
        let order = wide(a)
            .cmp(&wide(b))
            .then(b.shoulder_count().cmp(&a.shoulder_count()))
            .then(a.width_m.total_cmp(&b.width_m));
        order.then(a.from.x.total_cmp(&b.from.x)).then(a.from.y.total_cmp(&b.from.y))
    });
    let mut kept: Vec<Throat> = Vec::new();
    for throat in found {
        if kept.iter().all(|other| !other.meets(&throat)) {
            kept.push(throat);
        }
    }
    kept.sort_by(|a, b| {
        let (a, b) = (a.middle(), b.middle());
        a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))
    });
    kept
}

/// Every mouth of a bay on the floor without furniture, by the cells of its skeleton.
pub(crate) fn mouths(floor: &Floor, spots: &[Spot]) -> Vec<Throat> {
    let sense = |spot: &Spot| floor.bare_at(spot);
    let probed = spots.iter().filter_map(|spot| probe(&sense, spot, MOUTH_M.1)).filter_map(|throat| {
        let behind = throat.mouth()?;
        Some(Throat { opening: Opening::Mouth(behind), ..throat })
    });
    best(probed.collect())
}

/// Whether a place on the skeleton with this clearance can be in a mouth, m.
pub(crate) fn is_in_mouth(clear_m: f64) -> bool {
    (0.4 * MOUTH_M.0..=0.5 * MOUTH_M.1 + 0.3).contains(&clear_m)
}

/// Whether a place on the skeleton with this clearance can be in a door, m.
pub(crate) fn is_narrow(clear_m: f64) -> bool {
    clear_m <= 0.5 * WIDEST_OPEN_M + 0.05
}

/// How far it is to the nearest wall, m.
type Sense<'a> = &'a dyn Fn(&Spot) -> f64;

/// The throat through a spot, if walls stand near on both sides.
fn probe(sense: Sense<'_>, spot: &Spot, widest_m: f64) -> Option<Throat> {
    let (left, right, along) = narrowest(sense, spot, widest_m)?;
    let middle = spot + along * (0.5 * (left - right));
    let width_m = left + right;
    let (from, to) = (middle - along * (0.5 * width_m), middle + along * (0.5 * width_m));
    let ahead = Vector::new(-along.y, along.x);
    let mut throat =
        Throat { from, to, width_m, opening: Opening::Door, ahead, reach_m: (0.0, 0.0), shoulders: [0.0; 4] };
    let before = end(sense, &middle, &along, &ahead, width_m)?;
    let behind = end(sense, &middle, &along, &-ahead, width_m)?;
    throat.reach_m = (before.0, behind.0);
    throat.shoulders = [before.1, before.2, behind.1, behind.2];
    Some(throat)
}

/// The shortest line from wall to wall through a spot: how far to both sides, and its direction.
fn narrowest(sense: Sense<'_>, spot: &Spot, widest_m: f64) -> Option<(f64, f64, Vector)> {
    let mut best: Option<(f64, f64, Vector)> = None;
    for turn in 0..TURNS {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(turn) / f64::from(TURNS));
        let along = Vector::new(cos, sin);
        let Some(left) = to_wall(sense, spot, &-along, widest_m) else { continue };
        let Some(right) = to_wall(sense, spot, &along, widest_m) else { continue };
        if best.is_none_or(|(a, b, _)| left + right < a + b - 1e-6) {
            best = Some((right, left, along));
        }
    }
    best
}

/// How thick the wall is at a spot, along a direction, m; 0 where there is none.
fn thickness_m(floor: &Floor, at: &Spot, ahead: &Vector) -> f64 {
    let one = |way: f64| {
        let solid = |step: &u32| floor.clean_m(&(at + ahead * (way * f64::from(*step) * WALL_M))) < WALL_M;
        f64::from((1..=40).take_while(solid).last().unwrap_or(0)) * WALL_M
    };
    if floor.clean_m(at) < WALL_M { one(1.0) + one(-1.0) } else { 0.0 }
}

/// How far it is to the wall, m, if at most so far.
fn to_wall(sense: Sense<'_>, from: &Spot, along: &Vector, most_m: f64) -> Option<f64> {
    let mut gone_m = 0.0;
    while gone_m <= most_m {
        let clear_m = sense(&(from + along * gone_m));
        if clear_m < WALL_M {
            return Some(gone_m);
        }
        gone_m += (0.8 * clear_m).max(WALL_M);
    }
    None
}

/// Where a throat ends in one direction: how far from its middle, and the shoulders on both sides there. None where a wall ends it.
fn end(sense: Sense<'_>, middle: &Spot, along: &Vector, ahead: &Vector, width_m: f64) -> Option<(f64, f64, f64)> {
    let half = 0.5 * width_m;
    let beside = |at: &Spot| {
        let side = |way: &Vector| to_wall(sense, at, way, half + BESIDE_M).map_or(BESIDE_M, |m| (m - half).max(0.0));
        (side(&-along), side(along))
    };
    let mut gone_m = 0.0;
    let (mut left, mut right) = (0.0_f64, 0.0_f64);
    while gone_m <= DEEPEST_M + STEP_M {
        let at = middle + ahead * gone_m;
        if sense(&at) < WALL_M {
            return None;
        }
        (left, right) = beside(&at);
        if left + right >= WIDER_M {
            break;
        }
        gone_m += STEP_M;
    }
    // The floor may widen a little later on the other side.
    for more in 1..=4_u32 {
        let at = middle + ahead * (gone_m + f64::from(more) * STEP_M);
        if sense(&at) < WALL_M {
            break;
        }
        let (l, r) = beside(&at);
        (left, right) = (left.max(l), right.max(r));
    }
    Some((gone_m, left, right))
}
