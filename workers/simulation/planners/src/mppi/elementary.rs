//! Exponential, logarithm, sine, cosine and arc tangent out of plain multiplications and additions, in f32.
//!
//! The coefficients are fits on Chebyshev nodes, made with 50 digits and rounded to f32. Reductions take the nearest whole number by
//! adding a large one; constants are split so that its product with the high parts is exact.

use pulp::Simd;

use super::lanes::{Lanes, Mask};

/// Added to a number below 2^22, this rounds it to a whole number in the low bits of the sum: 1.5 * 2^23.
const ROUNDER: f32 = 12_582_912.0;
/// 2^23: numbers from here on have no fraction.
const WHOLE: f32 = 8_388_608.0;
/// Bits of the mantissa of an f32, and its mask.
const MANTISSA_BITS: u32 = 23;
const MANTISSA: u32 = (1 << MANTISSA_BITS) - 1;
/// Bits of 1.0.
const ONE: u32 = 0x3F80_0000;
/// Bits of the square root of a half: mantissas are taken from there to its double.
const SQRT_HALF: u32 = 0x3F35_04F3;

/// pi/2 in three parts.
const QUARTER: [f32; 3] = [1.570_312_5, 0.000_483_751_3, 7.549_79e-8];
/// 2 pi in three parts.
const TURN: [f32; 3] = [6.281_25, 0.001_935_005_2, 3.019_916e-7];
/// ln 2 in two parts.
const LN_2: [f32; 2] = [0.693_115_23, 3.194_618_3e-5];
/// Below this the exponential is taken as 0: a weight of e^-60 is lost in any sum with one of 1, and products with smaller ones come
/// near to subnormal numbers, which are slow.
const LOWEST: f32 = -60.0;
/// tan(pi/8): where the arc tangent changes its reduction.
const TAN_PI_8: f32 = 0.414_213_57;

/// (sin r / r - 1) / r² in powers of r², |r| <= pi/4; relative error of the sine 1.2e-8 before rounding.
const SIN: [f32; 3] = [-0.166_666_64, 0.008_332_725, -0.000_195_828_31];
/// (cos r - 1 + r²/2) / r⁴ in powers of r², |r| <= pi/4; error 7e-10.
const COS: [f32; 3] = [0.041_666_664, -0.001_388_827_9, 2.454_287e-5];
/// (e^r - 1 - r) / r² in powers of r, |r| <= ln 2 / 2; relative error 7e-10.
const EXP: [f32; 6] = [0.5, 0.166_666_67, 0.041_666_463, 0.008_333_31, 0.001_393_373_1, 0.000_198_910_8];
/// (atan w / w - 1) / w² in powers of w², |w| <= tan(pi/8); relative error 3e-9.
const ATAN: [f32; 5] = [-0.333_333_3, 0.199_995_4, -0.142_639_56, 0.107_437_31, -0.064_519_28];
/// (atanh s / s - 1) / s² in powers of s², s of at most 0.172; relative error 2e-9.
const ATANH: [f32; 3] = [0.333_333_43, 0.199_943_9, 0.147_899_75];

/// Sum of coefficients times powers of `x`.
#[inline(always)]
fn polynomial<S: Simd, const N: usize>(coefficients: &[f32; N], x: Lanes<S>) -> Lanes<S> {
    coefficients.iter().rev().fold(x.like(0.0), |sum, coefficient| sum * x + x.like(*coefficient))
}

/// `x` less the nearest whole multiple of a constant given in three parts, and the multiple in the low bits of a number.
#[inline(always)]
fn reduced<S: Simd>(x: Lanes<S>, [high, middle, low]: [f32; 3]) -> (Lanes<S>, Lanes<S>) {
    let shifted = x * x.like(1.0 / (high + middle)) + x.like(ROUNDER);
    let count = shifted - x.like(ROUNDER);
    let rest = ((x - count * x.like(high)) - count * x.like(middle)) - count * x.like(low);
    (rest, shifted)
}

/// Sine and cosine of an angle of at most some thousand turns, rad; error 1e-7 within ten turns.
#[inline(always)]
pub(crate) fn sin_cos<S: Simd>(angle: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let simd = angle.simd();
    let (r, shifted) = reduced(angle, QUARTER);
    let square = r * r;
    let sine = r + r * square * polynomial(&SIN, square);
    let cosine = angle.like(1.0) - square * angle.like(0.5) + square * square * polynomial(&COS, square);
    let (one, two, top) = (simd.splat_u32s(1), simd.splat_u32s(2), simd.splat_u32s(30));
    let quarters = shifted.bits();
    let odd = Mask::of(simd, simd.equal_u32s(simd.and_u32s(quarters, one), one));
    let sign = |quarters| simd.wrapping_dyn_shl_u32s(simd.and_u32s(quarters, two), top);
    let flipped = |value: Lanes<S>, sign| value.with_bits(simd.xor_u32s(value.bits(), sign));
    let next = simd.add_u32s(quarters, one);
    (flipped(odd.select(cosine, sine), sign(quarters)), flipped(odd.select(sine, cosine), sign(next)))
}

/// The angle less whole turns: in [-pi, pi].
#[inline(always)]
pub(crate) fn wrapped<S: Simd>(angle: Lanes<S>) -> Lanes<S> {
    reduced(angle, TURN).0
}

/// e^x for x of at most 0; 0 below -60.
#[inline(always)]
pub(crate) fn exp<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let simd = x.simd();
    let lowest = x.like(LOWEST);
    let bounded = x.max(lowest);
    let shifted = bounded * x.like(std::f32::consts::LOG2_E) + x.like(ROUNDER);
    let k = shifted - x.like(ROUNDER);
    let r = (bounded - k * x.like(LN_2[0])) - k * x.like(LN_2[1]);
    let mantissa = x.like(1.0) + (r + r * r * polynomial(&EXP, r));
    let exponent = simd.wrapping_dyn_shl_u32s(shifted.bits(), simd.splat_u32s(MANTISSA_BITS));
    let scale = x.with_bits(simd.add_u32s(exponent, simd.splat_u32s(ONE)));
    x.below(lowest).select(x.like(0.0), mantissa * scale)
}

/// Natural logarithm of a normal number above 0.
#[inline(always)]
pub(crate) fn ln<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let simd = x.simd();
    let lifted = simd.add_u32s(x.bits(), simd.splat_u32s(ONE - SQRT_HALF));
    let exponent = simd.wrapping_dyn_shr_u32s(lifted, simd.splat_u32s(MANTISSA_BITS));
    // The exponent as a number: put behind the bits of 2^23.
    let whole = x.with_bits(simd.or_u32s(exponent, x.like(WHOLE).bits()));
    let k = whole - x.like(WHOLE + 127.0);
    let kept = simd.and_u32s(lifted, simd.splat_u32s(MANTISSA));
    let m = x.with_bits(simd.add_u32s(kept, simd.splat_u32s(SQRT_HALF)));
    let s = (m - x.like(1.0)) / (m + x.like(1.0));
    let square = s * s;
    let half = s + s * square * polynomial(&ATANH, square);
    k * x.like(LN_2[0]) + (half + half + k * x.like(LN_2[1]))
}

/// The angle of (x, y) from the x axis, rad, in [-pi, pi]; not a number for the origin.
#[inline(always)]
pub(crate) fn atan2<S: Simd>(y: Lanes<S>, x: Lanes<S>) -> Lanes<S> {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    let zero = x.like(0.0);
    let (side, ahead) = (y.abs(), x.abs());
    let (small, large) = (side.min(ahead), side.max(ahead));
    let steep = (large * x.like(TAN_PI_8)).below(small);
    let w = steep.select(small - large, small) / steep.select(small + large, large);
    let square = w * w;
    let angle = steep.select(x.like(FRAC_PI_4), zero) + (w + w * square * polynomial(&ATAN, square));
    let angle = ahead.below(side).select(x.like(FRAC_PI_2) - angle, angle);
    let angle = x.below(zero).select(x.like(PI) - angle, angle);
    y.below(zero).select(-angle, angle)
}

/// The whole number at or below one of 0 to 2^22.
#[inline(always)]
pub(crate) fn floor<S: Simd>(x: Lanes<S>) -> S::u32s {
    let simd = x.simd();
    let nearest = (x + x.like(WHOLE)) - x.like(WHOLE);
    let whole = nearest - x.below(nearest).select(x.like(1.0), x.like(0.0));
    simd.and_u32s((whole + x.like(WHOLE)).bits(), simd.splat_u32s(MANTISSA))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scalar(value: f32) -> Lanes<pulp::Scalar> {
        Lanes::splat(pulp::Scalar::new(), value)
    }

    /// Numbers from `from` to `to`, evenly.
    fn spread(from: f32, to: f32) -> impl Iterator<Item = f32> {
        (0..20_000_u16).map(move |step| from + (to - from) * f32::from(step) / 19_999.0)
    }

    #[test]
    fn sine_and_cosine_are_right_within_ten_turns() {
        for angle in spread(-63.0, 63.0) {
            let (sine, cosine) = sin_cos(scalar(angle));
            let (wanted_sine, wanted_cosine) = libm::sincos(f64::from(angle));
            assert!((f64::from(sine.raw) - wanted_sine).abs() < 1.5e-7, "{angle}: {} {wanted_sine}", sine.raw);
            assert!((f64::from(cosine.raw) - wanted_cosine).abs() < 1.5e-7, "{angle}: {} {wanted_cosine}", cosine.raw);
        }
    }

    #[test]
    fn the_exponential_is_right_and_ends_in_zero() {
        for x in spread(-59.9, 0.0) {
            let (found, wanted) = (f64::from(exp(scalar(x)).raw), libm::exp(f64::from(x)));
            assert!((found / wanted - 1.0).abs() < 2.5e-7, "{x}: {found} {wanted}");
        }
        assert_eq!(exp(scalar(-1e9)).raw.to_bits(), 0);
        assert_eq!(exp(scalar(0.0)).raw.to_bits(), 1.0_f32.to_bits());
    }

    #[test]
    fn the_logarithm_is_right_where_the_noise_takes_it() {
        for exponent in -25..=0_i32 {
            for share in spread(0.5, 1.0) {
                let x = share * libm::exp2f(exponent as f32);
                let (found, wanted) = (f64::from(ln(scalar(x)).raw), libm::log(f64::from(x)));
                assert!((found - wanted).abs() <= 2.0e-7 * wanted.abs() + 1e-12, "{x}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn the_arc_tangent_is_right_in_every_direction() {
        for angle in spread(-3.13, 3.13) {
            let (y, x) = (2.5 * libm::sinf(angle), 2.5 * libm::cosf(angle));
            let wanted = libm::atan2(f64::from(y), f64::from(x));
            assert!((f64::from(atan2(scalar(y), scalar(x)).raw) - wanted).abs() < 4e-7, "{angle}");
        }
    }

    #[test]
    fn angles_are_brought_into_half_a_turn_either_way() {
        for angle in spread(-30.0, 30.0) {
            let (found, wanted) = (wrapped(scalar(angle)).raw, socrates_model::geometry::wrap_angle(f64::from(angle)));
            assert!((f64::from(found) - wanted).abs() < 3e-6 || (found.abs() - std::f32::consts::PI).abs() < 1e-5);
        }
    }

    #[test]
    fn whole_numbers_are_their_own_floor() {
        for whole in 0..5000_u32 {
            assert_eq!(floor(scalar(whole as f32)), whole);
            assert_eq!(floor(scalar(whole as f32 + 0.5)), whole);
            assert_eq!(floor(scalar(whole as f32 + 0.999)), whole);
        }
    }
}
