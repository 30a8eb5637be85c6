//! A person as the forces see it.

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};

/// Where a person wants to go.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Position, m.
    pub at: Point2<f64>,
    /// Within this distance the goal no longer pulls and the person comes to rest, m.
    pub radius_m: f64,
}

/// Somebody who walks (or stands).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Person {
    /// Any number; the forces do not read it.
    pub id: u32,
    /// Center, m.
    pub position: Point2<f64>,
    /// Velocity, m/s.
    pub velocity: Vector2<f64>,
    /// Heading, rad, in (-pi, pi].
    pub yaw: f64,
    /// Body radius, m. Felt from walls and inside a group, not between strangers.
    pub radius_m: f64,
    /// Desired speed and the largest speed of a step, m/s.
    pub speed_mps: f64,
    /// Goal; without one the person comes to rest.
    pub goal: Option<Goal>,
    /// People of equal group number keep together.
    pub group: Option<u32>,
}

impl Person {
    /// A person at rest without a goal or group, 0.28 m wide in radius, who would walk at 1.2 m/s.
    #[must_use]
    pub fn standing(id: u32, position: Point2<f64>) -> Self {
        Self {
            id,
            position,
            velocity: Vector2::zeros(),
            yaw: 0.0,
            radius_m: 0.28,
            speed_mps: 1.2,
            goal: None,
            group: None,
        }
    }
}
