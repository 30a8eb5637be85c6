//! How a person's body moves, whatever moves the person: limits, standing on a spot, turning.

use std::f64::consts::{PI, TAU};

use socrates_model::geometry::wrap_angle;
use socrates_model::{Point, Vector};

/// Largest acceleration of a person, m/s².
pub const A_MAX: f64 = 3.0;
/// Nobody is faster, m/s.
pub const V_MAX: f64 = 1.95;
/// Turning rate of somebody who stands and turns, rad/s.
const TURN_STANDING: f64 = PI;
/// Turning rate of the heading of somebody who walks, rad/s.
pub const TURN_WALKING: f64 = TAU;
/// Spring of somebody who keeps a place, 1/s², and its damping, 1/s.
const KEEP: (f64, f64) = (12.0, 7.0);

/// An acceleration of at most [`A_MAX`], m/s².
#[must_use]
pub fn limited(force: &Vector) -> Vector {
    let size = force.norm();
    if size > A_MAX { force * (A_MAX / size) } else { *force }
}

/// Velocity after a step of `dt` s of somebody who stands, m/s: it slows down, then keeps the spot where it came to
/// rest, which is remembered in `anchor`.
pub fn stand(anchor: &mut Option<Point>, at: &Point, velocity: &Vector, dt: f64) -> Vector {
    let Some(spot) = *anchor else {
        let speed = velocity.norm();
        if speed < 0.03 {
            *anchor = Some(*at);
            return Vector::zeros();
        }
        return velocity * ((speed - A_MAX * dt).max(0.0) / speed);
    };
    let pull = limited(&((spot - at) * KEEP.0 - velocity * KEEP.1));
    let velocity = velocity + pull * dt;
    if velocity.norm() < 2e-3 && (spot - at).norm() < 2e-3 { Vector::zeros() } else { velocity }
}

/// Heading, rad, and turning rate, rad/s, after a step of `dt` s: whoever `walks` turns to where it goes, whoever
/// stands to what it faces.
#[must_use]
pub fn turned(yaw: f64, at: &Point, velocity: &Vector, walks: bool, face: Option<&Point>, dt: f64) -> (f64, f64) {
    let (goal, rate) = if velocity.norm() > 0.15 && walks {
        (Some(libm::atan2(velocity.y, velocity.x)), TURN_WALKING)
    } else {
        (face.map(|face| libm::atan2(face.y - at.y, face.x - at.x)), TURN_STANDING)
    };
    let after = goal.map_or(yaw, |goal| wrap_angle(yaw + wrap_angle(goal - yaw).clamp(-rate * dt, rate * dt)));
    (after, wrap_angle(after - yaw) / dt)
}
