//! Where the robot waits while people come out of a door: near enough to keep it open, beside their way.

use socrates_model::geometry::segments_cross;
use socrates_model::{Door, DoorOpens, Point, Polyline, Vector};

use crate::ground::Ground;

/// Distance beside the middle of the door that is aimed at, m.
const ASIDE_M: f64 = 1.25;
/// Distance in front of the door line that is aimed at, m.
const BEFORE_M: f64 = 1.6;

/// Largest length behind a door of a way that leads in there, m.
const INSIDE_M: f64 = 10.0;
/// Largest distance of a door beside a way that leads past it, m, and distance before it at which the robot waits, m.
const PAST_M: f64 = 3.5;
const SHORT_M: f64 = 2.4;

/// A place to wait at.
#[derive(Debug, Clone)]
pub(crate) struct WaitingSpot {
    /// The spot.
    pub(crate) at: Point,
    /// Length along the way at which the robot leaves it for the spot, m.
    pub(crate) leave_s: f64,
}

/// The spot for a way: beside the door through which it leads in at last, on it before a door that it leads past, or beside its last stretch
/// where there is neither.
pub(crate) fn spot(ground: &Ground, route: &Polyline, doors: &[Door]) -> Option<WaitingSpot> {
    let entered = last_door(route, doors).filter(|(s, _)| route.length_m() - s <= INSIDE_M);
    if let (None, Some(s)) = (&entered, passed(route, doors)) {
        let stop_s = (s - SHORT_M).max(0.0);
        return Some(WaitingSpot { at: route.point(stop_s), leave_s: (stop_s - 0.5).max(0.0) });
    }
    let (door_s, middle, reach) = match entered {
        Some((s, door)) => (s, door.middle(), opening_reach(door)),
        None => (route.length_m(), route.end()?, f64::INFINITY),
    };
    let back = -route.direction((door_s - 0.05).max(0.0));
    let left = Vector::new(-back.y, back.x);
    let farthest = (reach - 0.25).min(2.7);
    let mut best: Option<(f64, Point)> = None;
    for before in 0..=8_u32 {
        for aside in 0..=10_u32 {
            for side in [1.0, -1.0] {
                let (before, aside) = (0.9 + 0.2 * f64::from(before), 0.6 + 0.15 * f64::from(aside));
                let at = middle + back * before + left * (side * aside);
                let entry = route.point((door_s - before - 0.6).max(0.0));
                if (at - middle).norm() > farthest
                    || ground.clearance_m(&at) < ground.radius_m + 0.08
                    || !ground.straight(&entry, &at, 0.02)
                {
                    continue;
                }
                let cost = (aside - ASIDE_M).abs() + 0.5 * (before - BEFORE_M).abs() + 2.0 * (0.9 - aside).max(0.0);
                if best.is_none_or(|(least, _)| cost < least - 1e-9) {
                    best = Some((cost, at));
                }
            }
        }
    }
    let at = best.map_or_else(|| route.point((door_s - BEFORE_M).max(0.0)), |(_, at)| at);
    Some(WaitingSpot { at, leave_s: (door_s - 4.0).max(0.0) })
}

/// Where a way leads nearest to a door that it does not lead through, m along it.
fn passed(route: &Polyline, doors: &[Door]) -> Option<f64> {
    let crosses = |door: &Door| last_door(route, std::slice::from_ref(door)).is_some();
    let near = doors.iter().filter(|door| !crosses(door)).map(|door| route.project(&door.middle()));
    near.filter(|(_, off_m)| *off_m <= PAST_M).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(s, _)| s)
}

fn last_door<'a>(route: &Polyline, doors: &'a [Door]) -> Option<(f64, &'a Door)> {
    let mut found: Option<(f64, &Door)> = None;
    for (ends, marks) in route.points().windows(2).zip(route.marks_m().windows(2)) {
        let ([a, b], [s0, _]) = (ends, marks) else { continue };
        for door in doors.iter().filter(|door| segments_cross(a, b, &door.from, &door.to)) {
            let s = s0 + (door.middle() - a).dot(&(b - a).normalize()).max(0.0);
            if found.is_none_or(|(most, _)| s > most) {
                found = Some((s, door));
            }
        }
    }
    found
}

/// How near the robot has to be for the door to stay open, m.
const fn opening_reach(door: &Door) -> f64 {
    match door.opens {
        DoorOpens::Near(reach) | DoorOpens::RobotNear(reach) => reach,
        DoorOpens::Always | DoorOpens::AtTimes(_) | DoorOpens::OnEvent(_) | DoorOpens::Never => f64::INFINITY,
    }
}
