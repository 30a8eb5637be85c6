//! The monitor of a side: from which side of the robot's way somebody comes, on which they stand, on which they walk.

use socrates_model::{HumanId, Polyline, Relation, Side, Vector};

use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::absent;
use crate::fidelity::signals::{Moment, Signals};
use crate::tracks::{MOVING_MPS, Sample};

/// Least distance beside the robot's way of somebody who comes from a side, before they come to it, m.
const COMES_M: f64 = 0.8;
/// And has come so far nearer by then, or by when they are nearest, m.
const CAME_M: f64 = 0.5;
/// So near to its middle they are on the robot's way, m.
const ON_WAY_M: f64 = 0.4;
/// Least distance beside the robot's way of somebody who stands, m, as it is nearest, and the largest at which that counts, m.
const STANDS_M: f64 = 0.3;
const PASSED_M: f64 = 3.5;
/// Least distance beside it of somebody who walks, m, and the part of the time for which it need not be kept.
const WALKS_M: f64 = 0.2;
const FIFTH: usize = 5;
/// Two are level where the one is no more ahead of the other than this, m, and no farther apart than this, m.
const LEVEL_M: f64 = 0.7;
const BESIDE_M: f64 = 4.0;
/// Distance within which somebody who is never level is judged, m, and how long that has to last, s.
const NEAR_M: f64 = 6.0;
const LASTS_S: f64 = 1.0;
/// A time between two moments, s, and how long both are level at least.
const MOMENT_S: f64 = super::signals::MOMENT_SECS;
const LEVEL_S: f64 = 0.2;
/// So much of the robot's drive before and after its place at a time is the way that counts then, m.
const STRETCH_M: f64 = 6.0;
/// Points of the drive are so far apart, m: shorter steps would take every sway for a turn.
const STEP_M: f64 = 0.2;

/// The human is on this side of the robot's way, as the relation of the two has it.
pub(super) fn on_side(signals: &Signals<'_>, human: HumanId, side: Side) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let moments = signals.of(human);
    let Some(nearest) = moments.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m)) else {
        return Finding::not_applicable("the recording is empty");
    };
    let relation = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map(|human| human.relation);
    let drive = Drive::of(moments);
    if !drive.moves() {
        return Finding::never(-1.0, vec![], "the robot does not drive: its way has no sides");
    }
    match relation {
        Some(Relation::Crossing) => comes(&drive, moments, nearest, (human, side, false)),
        Some(Relation::Leaving) => comes(&drive, moments, nearest, (human, side, true)),
        // A robot that goes round them on either side leaves them on that side of its way.
        Some(Relation::Static | Relation::Aside) | None => {
            stands(Drive::planned(signals).as_ref().unwrap_or(&drive), nearest, (human, side))
        }
        Some(Relation::Staying) => Finding::fails(-1.0, vec![], format!("{human} stays inside, on no side")),
        Some(Relation::Frontal | Relation::Behind | Relation::Ahead | Relation::Abreast) => {
            walks(&drive, moments, (human, side, relation == Some(Relation::Ahead)))
        }
    }
}

/// The robot's drive: points with the direction in which it goes on from each, and how far it has gone by then.
struct Drive {
    points: Vec<(socrates_model::Point, f64)>,
}

impl Drive {
    fn of(moments: &[Moment]) -> Self {
        let mut points: Vec<(socrates_model::Point, f64)> = Vec::new();
        for moment in moments {
            let at = moment.robot.at;
            match points.last().copied() {
                Some((last, _)) if (at - last).norm() < STEP_M => {}
                Some((last, gone)) => points.push((at, gone + (at - last).norm())),
                None => points.push((at, 0.0)),
            }
        }
        Self { points }
    }

    /// The way that the robot was to go.
    fn planned(signals: &Signals<'_>) -> Option<Self> {
        let (paths, location) = (signals.evidence.paths?, signals.evidence.location?);
        let way = Polyline::new(&location.graph.polyline(&paths.robot));
        let marks = (0..).map(|step| f64::from(step) * STEP_M).take_while(|s| *s <= way.length_m());
        let points: Vec<_> = marks.map(|s| (way.point(s), s)).collect();
        (points.len() > 1).then_some(Self { points })
    }

    fn moves(&self) -> bool {
        self.points.len() > 1
    }

    /// How far the robot has gone by a moment, m.
    fn gone_m(&self, moment: &Moment) -> f64 {
        let near = self.points.iter().min_by(|a, b| {
            let off = |point: &socrates_model::Point| (point - moment.robot.at).norm();
            off(&a.0).total_cmp(&off(&b.0))
        });
        near.map_or(0.0, |(_, gone)| *gone)
    }

    /// How far a human is to the left of the way that the robot goes about so much of its drive, m.
    fn left_m(&self, human: &Sample, gone_m: f64) -> f64 {
        let pieces = self.points.windows(2).filter_map(|pair| {
            let &[(a, from_m), (b, to_m)] = pair else { return None };
            let counts = to_m >= gone_m - STRETCH_M && from_m <= gone_m + STRETCH_M;
            counts.then_some((a, b))
        });
        let off = pieces.map(|(a, b)| {
            let along = b - a;
            let share = ((human.at - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            let off: Vector = human.at - (a + along * share);
            (off.norm(), along.perp(&off) / along.norm())
        });
        // Before its first and after its last point the line goes on straight: what counts is how far beside it somebody is.
        off.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, left)| left)
    }
}

/// From the side: far enough beside the way before they come to it, and then nearer; `out` of a room: they start there too.
fn comes(drive: &Drive, moments: &[Moment], nearest: &Moment, (human, side, out): (HumanId, Side, bool)) -> Finding {
    let gone_m = drive.gone_m(nearest);
    let left = |moment: &Moment| side.sign() * drive.left_m(&moment.human, gone_m);
    let reaches = moments.iter().position(|moment| left(moment).abs() <= ON_WAY_M);
    let until = reaches.unwrap_or_else(|| moments.iter().position(|m| m.index == nearest.index).unwrap_or(0));
    let before = moments.get(..=until).unwrap_or_default();
    let (Some(last), Some(first)) = (before.iter().rev().find(|m| left(m).abs() >= COMES_M), before.first()) else {
        let text = format!("{human} is never {COMES_M} m beside the robot's way before they come to it");
        return Finding::never(-1.0, vec![nearest.t], text);
    };
    let came_m = before
        .last()
        .map_or(0.0, |end| (end.human.at - last.human.at).norm().max((end.human.at - first.human.at).norm()));
    let mut margin = left(last) - COMES_M;
    if out {
        margin = margin.min(left(first) - COMES_M);
    }
    let text = format!(
        "{human} is {:.2} m to the {} of the robot's way at {:.1} s{}, and comes {came_m:.1} m from there (0.8 m on its {} asked)",
        left(last).abs(),
        word(side, left(last)),
        last.t,
        if out { format!(", {:.2} m at first", left(first)) } else { String::new() },
        side.name(),
    );
    if margin < 0.0 {
        return Finding::fails(margin, vec![last.t], text);
    }
    if came_m < CAME_M {
        return Finding::never(came_m - CAME_M, vec![last.t], text);
    }
    Finding::holds(margin, vec![last.t], text)
}

/// Beside the way as the robot is nearest.
fn stands(drive: &Drive, nearest: &Moment, (human, side): (HumanId, Side)) -> Finding {
    let left = side.sign() * drive.left_m(&nearest.human, drive.gone_m(nearest));
    let text = format!(
        "{human} is {:.2} m to the {} of the robot's way as it is nearest, {:.2} m away, at {:.1} s ({STANDS_M} m on its {} asked)",
        left.abs(),
        word(side, left),
        nearest.distance_m,
        nearest.t,
        side.name(),
    );
    if nearest.distance_m > PASSED_M {
        return Finding::never(PASSED_M - nearest.distance_m, vec![nearest.t], text);
    }
    Finding::by_margin(left - STANDS_M, vec![nearest.t], text)
}

/// Beside the way for most of the time that both are level; who walks ahead, and who is never level, of the time that both are near.
fn walks(drive: &Drive, moments: &[Moment], (human, side, ahead): (HumanId, Side, bool)) -> Finding {
    let walks = |moment: &&Moment| moment.human.speed() > MOVING_MPS;
    let level: Vec<&Moment> = moments
        .iter()
        .filter(|moment| !ahead && moment.distance_m <= BESIDE_M && moment.ahead_m.abs() <= LEVEL_M)
        .filter(walks)
        .collect();
    let near: Vec<&Moment> = moments.iter().filter(|moment| moment.distance_m <= NEAR_M).filter(walks).collect();
    let long = |list: &[&Moment]| MOMENT_S * f64::from(u32::try_from(list.len()).unwrap_or(u32::MAX));
    let (list, what) = if long(&level) >= LEVEL_S { (level, "level with the robot") } else { (near, "near the robot") };
    if long(&list) < LEVEL_S.max(if what == "near the robot" { LASTS_S } else { 0.0 }) {
        return Finding::never(-1.0, vec![], format!("{human} does not walk beside the robot or near it"));
    }
    let left = |moment: &&Moment| side.sign() * drive.left_m(&moment.human, drive.gone_m(moment));
    let mut lefts: Vec<f64> = list.iter().map(left).collect();
    lefts.sort_by(f64::total_cmp);
    let kept = lefts.get(lefts.len() / FIFTH).copied().unwrap_or(f64::NEG_INFINITY);
    let middle = lefts.get(lefts.len() / 2).copied().unwrap_or(0.0);
    let t = list.first().map_or(0.0, |moment| moment.t);
    let text = format!(
        "{human} walks {:.2} m to the {} of the robot's way, {kept:.2} m or more for 80 % of the {:.1} s that they are {what} \
         ({WALKS_M} m on its {} asked)",
        middle.abs(),
        word(side, middle),
        long(&list),
        side.name(),
    );
    Finding::by_margin(kept - WALKS_M, vec![t], text)
}

/// The side on which somebody is who is so far on the asked one, m.
const fn word(side: Side, left_m: f64) -> &'static str {
    match (side, left_m >= 0.0) {
        (Side::Left, true) | (Side::Right, false) => "left",
        (Side::Left, false) | (Side::Right, true) => "right",
    }
}
