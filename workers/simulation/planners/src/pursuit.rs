//! Following a way, at the largest speed at which nobody is hit.

use socrates_model::geometry::wrap_angle;
use socrates_model::{Command, Observation, Point, Polyline, RobotModel};

use crate::ground::{Ground, STANDING_MPS};

/// Length of the way the robot steers at, m.
const LOOK_AHEAD_M: f64 = 0.55;
/// The same where a corner must not be cut, longest first, m: the farthest that nothing stands between counts.
const AHEAD_M: [f64; 6] = [0.7, 0.5, 0.35, 0.25, 0.15, 0.08];
/// Where it steers at a point so near, it goes so slowly, 1/s.
const NEAR_PER_S: f64 = 1.4;
/// It sees walls in front of it so far, m.
const FRONT_M: f64 = 1.0;
/// Room to walls that rounding may take, m.
const ROUNDING_M: f64 = 0.005;
/// Gap to a person below which the robot goes slowly, m.
const PERSONAL_M: f64 = 0.45;
/// Gap to somebody who walks that is kept even at a crawl, m.
const CLOSE_M: f64 = 0.36;
/// How far ahead in time people are looked at, s.
const HORIZON_S: f64 = 2.6;

/// Steering to a point ahead on a way: full speed straight on, a turn on the spot for a way behind.
pub(crate) fn steer(seen: &Observation<'_>, way: &Polyline, s: f64, speed: f64, robot: &RobotModel) -> Command {
    let at = seen.pose.point();
    let target = way.point(s + LOOK_AHEAD_M);
    let left = left_m(way, &at, s);
    let way_to = target - at;
    let turn = if way_to.norm() > 0.02 { wrap_angle(libm::atan2(way_to.y, way_to.x) - seen.pose.yaw) } else { 0.0 };
    let straight = if turn.abs() > 1.0 { 0.0 } else { 1.0 - 0.8 * turn.abs() };
    // Comes to rest at the end of the way.
    let v = (speed * straight).min(libm::sqrt(2.0 * 0.7 * robot.a_max_mps2 * (left - 0.05).max(0.0)));
    let omega = (2.4 * turn).clamp(-robot.omega_max_radps, robot.omega_max_radps);
    Command { v, omega: if left < 0.08 { 0.0 } else { omega }, ..Command::default() }
}

/// A way passes its own end nearer than this, m, with more than so much of it left, m.
const PASSES_M: f64 = 2.0;
const LEFT_M: f64 = 3.0;

/// Distance to the end of a way, m; where a way passes its own end on the way there, what is left of it.
pub(crate) fn left_m(way: &Polyline, at: &Point, s: f64) -> f64 {
    let straight = (way.end().unwrap_or(*at) - at).norm();
    let along = way.length_m() - s;
    if straight < PASSES_M && along > straight + LEFT_M { along } else { straight }
}

/// As [`steer`], without cutting a corner: to the farthest point a little ahead that can be reached straight, and never faster
/// than it can stop before a wall in front of it.
pub(crate) fn pursue(
    seen: &Observation<'_>,
    ground: &Ground,
    (way, s): (&Polyline, f64),
    speed: f64,
    robot: &RobotModel,
) -> Command {
    let at = seen.pose.point();
    // Pushed nearer to a wall than it is wide it needs no more room than it has.
    let margin_m = (ground.clearance_m(&at) - ROUNDING_M - robot.radius_m).min(0.0);
    let reached = |ahead: &f64| ground.straight(&at, &way.point(s + ahead), margin_m);
    let ahead = AHEAD_M.into_iter().find(reached).unwrap_or(ROUNDING_M);
    let way_to = way.point(s + ahead) - at;
    let turn = if way_to.norm() > 0.02 { wrap_angle(libm::atan2(way_to.y, way_to.x) - seen.pose.yaw) } else { 0.0 };
    let straight = if turn.abs() > 1.0 { 0.0 } else { 1.0 - 0.8 * turn.abs() };
    let stops = |left_m: f64| libm::sqrt(1.4 * robot.a_max_mps2 * left_m.max(0.0));
    // A way may pass over its own end before it comes there.
    let left_m = (way.end().unwrap_or(at) - at).norm().max(way.length_m() - s) - 0.05;
    let front_m = ground.front_m(&seen.pose, margin_m, FRONT_M);
    let v = (speed * straight).min(NEAR_PER_S * ahead).min(stops(left_m)).min(stops(front_m));
    let omega = (2.4 * turn).clamp(-robot.omega_max_radps, robot.omega_max_radps);
    Command { v, omega, ..Command::default() }
}

/// Stands and turns to a point: by so much a radian off it, rad/s, and at most this fast, rad/s.
pub(crate) fn face(seen: &Observation<'_>, to: &Point, gain: f64, most_radps: f64) -> Command {
    let way = to - seen.pose.point();
    let turn = wrap_angle(libm::atan2(way.y, way.x) - seen.pose.yaw);
    let omega = if turn.abs() > 0.1 { (gain * turn).clamp(-most_radps, most_radps) } else { 0.0 };
    Command { omega, ..Command::default() }
}

/// The largest share of full speed (1, ¾, ½, ¼, 0) at which nobody is nearer than allowed along the way.
pub(crate) fn safe_share(
    seen: &Observation<'_>,
    way: &Polyline,
    s: f64,
    robot: &RobotModel,
    standing_gap_m: f64,
) -> f64 {
    for share in [1.0, 0.75, 0.5, 0.25] {
        // Near people it goes slowly: only at half speed and below may somebody come nearer than personal space.
        let moving_gap_m = if share > 0.5 { PERSONAL_M } else { CLOSE_M };
        let gaps = (standing_gap_m, moving_gap_m);
        if clear(seen, way, s, share * robot.v_max_mps, robot, gaps) {
            return share;
        }
    }
    0.0
}

/// Whether nobody who stands comes nearer than the first gap, and nobody who walks nearer than the second.
fn clear(seen: &Observation<'_>, way: &Polyline, s: f64, v: f64, robot: &RobotModel, gaps: (f64, f64)) -> bool {
    let at = seen.pose.point();
    let ahead = way.direction(s + 0.3);
    seen.people.iter().all(|person| {
        let to = person.at - at;
        let reach = robot.radius_m + person.radius_m;
        let now = to.norm() - reach;
        if now > 6.0 || to.dot(&ahead) < -0.05 && now > 0.02 {
            // Far away, or behind: who comes from behind keeps the distance.
            return true;
        }
        let stands = person.velocity.norm() < STANDING_MPS;
        let gap = if stands { gaps.0 } else { gaps.1 };
        let mut t = 0.1;
        while t <= HORIZON_S {
            let me: Point = way.point(s + v * t);
            let them = person.at + person.velocity * t;
            let apart = (me - them).norm() - reach;
            // Growing distance is allowed even from too near, else nobody ever gets free.
            if apart < gap && apart < now - 1e-6 {
                return false;
            }
            // After the time to stop only standing people and near ones matter.
            t += 0.1;
            if stands && v * t > 1.8 {
                break;
            }
        }
        true
    })
}

/// Share of full speed beside people: half where somebody is nearer than personal space allows and not yet passed.
pub(crate) fn beside_people(seen: &Observation<'_>, robot: &RobotModel) -> f64 {
    let at = seen.pose.point();
    let near = seen.people.iter().any(|person| {
        let to = person.at - at;
        to.norm() < robot.radius_m + person.radius_m + PERSONAL_M
            && wrap_angle(libm::atan2(to.y, to.x) - seen.pose.yaw).abs() < 1.9
    });
    if near { 0.5 } else { 1.0 }
}

/// Whether somebody is close ahead, so that the robot stands because of a person.
pub(crate) fn somebody_ahead(seen: &Observation<'_>, reach_m: f64) -> bool {
    let at = seen.pose.point();
    seen.people.iter().any(|person| {
        let to = person.at - at;
        to.norm() < reach_m && wrap_angle(libm::atan2(to.y, to.x) - seen.pose.yaw).abs() < 0.9
    })
}
