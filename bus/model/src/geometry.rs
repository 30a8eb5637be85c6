//! Geometry in the map frame: meters, radians, x to the right, y up.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A position in the map frame, m.
pub type Point = nalgebra::Point2<f64>;
/// A displacement, velocity or force in the map frame.
pub type Vector = nalgebra::Vector2<f64>;

/// A position with a heading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// x in the map frame, m.
    pub x: f64,
    /// y in the map frame, m.
    pub y: f64,
    /// Heading, rad, counter-clockwise from the x axis, in (-pi, pi].
    pub yaw: f64,
}

impl Pose {
    /// The pose at a point with a heading.
    #[must_use]
    pub const fn new(x: f64, y: f64, yaw: f64) -> Self {
        Self { x, y, yaw }
    }

    /// The position alone.
    #[must_use]
    pub fn point(&self) -> Point {
        Point::new(self.x, self.y)
    }
}

/// The angle brought into (-pi, pi].
#[must_use]
pub fn wrap_angle(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if !angle.is_finite() {
        return 0.0;
    }
    let turned = angle % TAU;
    if turned > PI {
        turned - TAU
    } else if turned <= -PI {
        turned + TAU
    } else {
        turned
    }
}

/// Distance from a point to a segment, m, and the nearest point on it.
#[must_use]
pub fn nearest_on_segment(point: &Point, from: &Point, to: &Point) -> (f64, Point) {
    let along = to - from;
    let length2 = along.norm_squared();
    let share = if length2 > 0.0 { ((point - from).dot(&along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    let nearest = from + along * share;
    ((point - nearest).norm(), nearest)
}

/// Whether two closed segments touch.
#[must_use]
pub fn segments_cross(a: &Point, b: &Point, c: &Point, d: &Point) -> bool {
    let side = |p: &Point, q: &Point, r: &Point| (q - p).perp(&(r - p));
    let (s1, s2) = (side(a, b, c), side(a, b, d));
    let (s3, s4) = (side(c, d, a), side(c, d, b));
    if s1 * s2 < 0.0 && s3 * s4 < 0.0 {
        return true;
    }
    let on = |s: f64, p: &Point, q: &Point, r: &Point| {
        s.abs() <= f64::EPSILON
            && r.x >= p.x.min(q.x)
            && r.x <= p.x.max(q.x)
            && r.y >= p.y.min(q.y)
            && r.y <= p.y.max(q.y)
    };
    on(s1, a, b, c) || on(s2, a, b, d) || on(s3, c, d, a) || on(s4, c, d, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn angles_end_in_the_half_open_circle() {
        assert!((wrap_angle(3.0 * PI) - PI).abs() < 1e-12);
        assert!((wrap_angle(-PI) - PI).abs() < 1e-12);
        assert!(wrap_angle(f64::NAN).abs() < 1e-12);
    }

    #[test]
    fn segments_touch_at_ends_and_crossings_only() {
        let p = |x: f64, y: f64| Point::new(x, y);
        assert!(segments_cross(&p(0., 0.), &p(2., 2.), &p(0., 2.), &p(2., 0.)));
        assert!(segments_cross(&p(0., 0.), &p(2., 0.), &p(1., 0.), &p(1., 3.)));
        assert!(!segments_cross(&p(0., 0.), &p(2., 0.), &p(1., 0.1), &p(1., 3.)));
    }
}
