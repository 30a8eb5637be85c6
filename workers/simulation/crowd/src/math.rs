//! Where the functions that IEEE 754 leaves open come from.

use nalgebra::Vector2;

use crate::vector::wrap;

/// Exponential, angles and hyperbolic tangent: the part of arithmetic that differs between machines.
///
/// The force law is written once over this trait. [`Portable`] gives the same bytes everywhere;
/// [`Platform`] gives the bytes of the reference library on the same platform.
pub(crate) trait Math {
    fn exp(x: f64) -> f64;
    fn acos(x: f64) -> f64;
    fn tanh(x: f64) -> f64;
    fn sin_cos(x: f64) -> (f64, f64);
    /// Angle of `v` from the x axis, rad.
    fn angle(v: &Vector2<f64>) -> f64;
}

/// The `libm` crate: the same bytes on every machine.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Portable;

impl Math for Portable {
    fn exp(x: f64) -> f64 {
        libm::exp(x)
    }

    fn acos(x: f64) -> f64 {
        libm::acos(x)
    }

    fn tanh(x: f64) -> f64 {
        libm::tanh(x)
    }

    fn sin_cos(x: f64) -> (f64, f64) {
        (libm::sin(x), libm::cos(x))
    }

    fn angle(v: &Vector2<f64>) -> f64 {
        libm::atan2(v.y, v.x)
    }
}

/// The C library of the machine, through `std`: bit for bit the reference where both use the same one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Platform;

impl Math for Platform {
    fn exp(x: f64) -> f64 {
        x.exp()
    }

    fn acos(x: f64) -> f64 {
        x.acos()
    }

    fn tanh(x: f64) -> f64 {
        x.tanh()
    }

    fn sin_cos(x: f64) -> (f64, f64) {
        (x.sin(), x.cos())
    }

    /// The reference keeps every angle in (-pi, pi], so -pi (from a negative zero) becomes pi.
    fn angle(v: &Vector2<f64>) -> f64 {
        wrap(v.y.atan2(v.x))
    }
}
