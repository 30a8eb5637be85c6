//! Passing somebody who walks ahead, the same way and slower: out into a lane beside the way, past them, and back.
//!
//! The lane lies beside the way at a constant distance, on the side with more floor. It is as long as passing takes at the speeds
//! of both, and is laid anew at every look: where the other walks faster, or no lane of that length is free, the robot stays behind.

use socrates_model::{HumanId, Observation, Point, Polyline, RobotModel, SeenPerson};

use crate::ground::Ground;

/// Nearer than this behind somebody the robot moves out, m center to center along the way.
const OUT_M: f64 = 3.2;
/// So far ahead of them it moves in again, m center to center along the way.
const IN_M: f64 = 1.4;
/// The other has to be slower than the robot by so much, m/s; slower than this they stand, which is no overtaking.
const SLOWER_MPS: f64 = 0.15;
const STANDS_MPS: f64 = 0.1;
/// Gap to them, surface to surface: what is aimed at, and what is enough in a narrow aisle, m.
const GAPS_M: [f64; 3] = [0.7, 0.5, 0.36];
/// Room between the robot and walls in the lane, m.
const WALL_M: f64 = 0.06;
/// Length over which the robot moves out and in, m.
const SWING_M: f64 = 1.5;
/// Passing never takes more of the way than this, m: who is hardly slower is not passed.
const LONGEST_M: f64 = 16.0;
/// Cosine of the turn of the way up to which somebody is passed: round a corner nobody overtakes.
const STRAIGHT: f64 = 0.9;
/// Step at which the lane is looked at, m.
const STEP_M: f64 = 0.25;

/// Somebody who is to be passed.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Overtaking {
    /// Side of the lane: 1 left, -1 right; nothing while the robot is behind them.
    side: Option<f64>,
    /// Whether they are passed.
    done: bool,
}

impl Overtaking {
    /// The lane past them, from where the robot is, for a robot that has come `s` along its route; nothing where it keeps to the route.
    pub(crate) fn lane(
        &mut self,
        seen: &Observation<'_>,
        whom: HumanId,
        (route, s): (&Polyline, f64),
        ground: &Ground,
        robot: &RobotModel,
    ) -> Option<Polyline> {
        let person = seen.people.iter().find(|person| person.id == whom).filter(|_| !self.done)?;
        let (theirs, aside_m) = route.project_within(&person.at, s - LONGEST_M, s + LONGEST_M);
        let ahead_m = theirs - s;
        if self.side.is_some() && ahead_m < -IN_M {
            self.done = true;
            return None;
        }
        let along = person.velocity.dot(&route.direction(theirs));
        let slower = robot.v_max_mps - along;
        // Somebody who left the way, stands or hurries is not passed by a lane.
        let passable = aside_m < 2.0 && along > STANDS_MPS && slower > SLOWER_MPS;
        if !passable || self.side.is_none() && !(0.0..OUT_M).contains(&ahead_m) {
            self.side = None;
            return None;
        }
        let passing_m = (ahead_m + IN_M) / slower * robot.v_max_mps;
        let sides = self.side.map_or_else(|| vec![1.0, -1.0], |side| vec![side]);
        let lane = GAPS_M.into_iter().find_map(|gap_m| {
            let beside = |side: &f64| {
                let off_m = side * (robot.radius_m + person.radius_m + gap_m) + route.lateral_m(&person.at, theirs);
                beside(seen, (route, s), ground, off_m, passing_m).map(|(lane, free_m)| (lane, free_m, *side))
            };
            // The side with more floor; of two that are as free the left, as on a road.
            sides.iter().filter_map(beside).reduce(|a, b| if b.1 > a.1 + 1e-9 { b } else { a })
        });
        self.side = lane.as_ref().map(|(_, _, side)| *side);
        lane.map(|(lane, _, _)| lane)
    }
}

/// A lane at a distance beside the route, left of it where that is positive, and the least distance to walls in it, m; nothing where
/// it does not fit between walls, leads round a corner, or is longer than what is left of the route.
fn beside(
    seen: &Observation<'_>,
    (route, s): (&Polyline, f64),
    ground: &Ground,
    off_m: f64,
    passing_m: f64,
) -> Option<(Polyline, f64)> {
    if passing_m > LONGEST_M || s + passing_m > route.length_m() {
        return None;
    }
    let at = seen.pose.point();
    let now_m = route.lateral_m(&at, s);
    let point = |ahead_m: f64, off_m: f64| -> Point {
        let (on, dir) = (route.point(s + ahead_m), route.direction(s + ahead_m));
        Point::new(on.x - dir.y * off_m, on.y + dir.x * off_m)
    };
    let mut lane = Polyline::new(&[at]);
    let mut free_m = f64::INFINITY;
    let mut ahead_m = STEP_M;
    while ahead_m < passing_m + SWING_M && s + ahead_m < route.length_m() {
        let out = (ahead_m / SWING_M).min(1.0);
        let back = ((passing_m + SWING_M - ahead_m) / SWING_M).clamp(0.0, 1.0);
        let next = point(ahead_m, (now_m + (off_m - now_m) * out) * back);
        let clear_m = ground.clearance_m(&next);
        let turned = route.direction(s + ahead_m).dot(&route.direction(s)) < STRAIGHT;
        if turned || clear_m < ground.radius_m + WALL_M {
            return None;
        }
        free_m = free_m.min(clear_m);
        lane.push(next);
        ahead_m += STEP_M;
    }
    Some((lane, free_m))
}

/// Whether somebody else is on a lane: then it is not taken.
pub(crate) fn is_taken(seen: &Observation<'_>, whom: HumanId, lane: &Polyline, robot: &RobotModel) -> bool {
    let on = |person: &SeenPerson| {
        let (_, off_m) = lane.project(&person.at);
        off_m < robot.radius_m + person.radius_m + GAPS_M[2]
    };
    seen.people.iter().any(|person| person.id != whom && on(person))
}
