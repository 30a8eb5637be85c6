//! Small vector functions with a written order of operations.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

/// Dot product, x first.
pub(crate) fn dot(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    a.x * b.x + a.y * b.y
}

/// Length; the square root is exact in IEEE 754.
pub(crate) fn norm(v: &Vector2<f64>) -> f64 {
    dot(v, v).sqrt()
}

/// Direction, or zero for zero.
pub(crate) fn unit(v: &Vector2<f64>) -> Vector2<f64> {
    let length = norm(v);
    if length > 0.0 { Vector2::new(v.x / length, v.y / length) } else { Vector2::zeros() }
}

/// Turned a quarter to the left.
pub(crate) fn left(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Beyond this many radians an angle is first brought near by the remainder, so that wrapping ends.
const FAR_RAD: f64 = 1e3;

/// A sum or difference of two angles brought back into (-pi, pi].
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    let mut turned = if angle.abs() > FAR_RAD { angle % TAU } else { angle };
    while turned > PI && turned.is_finite() {
        turned -= TAU;
    }
    while turned <= -PI && turned.is_finite() {
        turned += TAU;
    }
    turned
}

/// The vector with every component that is not a number taken as 0.
pub(crate) fn known(v: Vector2<f64>) -> Vector2<f64> {
    v.map(|component| if component.is_nan() { 0.0 } else { component })
}
