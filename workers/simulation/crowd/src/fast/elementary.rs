//! Exponential and arc tangent out of plain multiplications and additions.
//!
//! Written without branches and without calls, so that the compiler turns a loop over them into vector
//! instructions; rounded the same whatever the width of the registers, because nothing is fused. The
//! coefficients are fits on Chebyshev nodes, made with 40 digits and rounded to f64.

/// Added to a number below 2^51, this rounds it to a whole number in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts; the high one has enough zeros at its end to be multiplied without rounding.
const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// Below this the exponential would lose bits: e^-708 is close to the smallest normal f64.
const LOWEST: f64 = -708.0;
/// Exponent bias and its place in an f64.
const BIAS: u64 = 1023;
const MANTISSA_BITS: u32 = 52;

/// (e^r - 1 - r) / r², |r| <= ln 2 / 2; relative error of e^r below 2e-17 before rounding.
const EXP: [f64; 10] = [
    0.500_000_000_000_000_1,
    0.166_666_666_666_666_69,
    0.041_666_666_666_624_164,
    0.008_333_333_333_330_065,
    0.001_388_888_891_719_688_1,
    0.000_198_412_698_630_406_7,
    2.480_152_132_211_682_5e-5,
    2.755_726_848_011_633_3e-6,
    2.762_007_599_981_065e-7,
    2.510_037_592_470_971_7e-8,
];

/// (atan(w)/w - 1) / w² in powers of w², |w| <= tan(pi/8); relative error of atan below 2e-16.
const ATAN: [f64; 10] = [
    -0.333_333_333_333_332_5,
    0.199_999_999_998_984_07,
    -0.142_857_142_660_964_8,
    0.111_111_096_365_254_89,
    -0.090_908_525_568_891_7,
    0.076_910_551_532_101_08,
    -0.066_496_136_405_386_89,
    0.057_363_318_301_716_995,
    -0.044_833_335_160_855_5,
    0.022_750_511_855_604_35,
];

/// tan(pi/8): where the arc tangent changes its reduction.
pub(super) const TAN_PI_8: f64 = 0.414_213_562_373_095_03;

/// Sum of `coefficients` times powers of `x`.
#[inline(always)]
fn polynomial(coefficients: &[f64; 10], x: f64) -> f64 {
    let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9] = coefficients;
    // Pairs first: shorter chains than Horner's, in one fixed order.
    let x2 = x * x;
    let x4 = x2 * x2;
    let low = (c0 + c1 * x) + (c2 + c3 * x) * x2;
    let high = (c4 + c5 * x) + (c6 + c7 * x) * x2;
    low + (high + (c8 + c9 * x) * x4) * x4
}

/// e^x for x of at most 709; below -708 it stays at e^-708 (3e-308), and what is not a number counts as
/// below.
#[inline(always)]
pub(super) fn exp(x: f64) -> f64 {
    let x = if x > LOWEST { x } else { LOWEST };
    let shifted = x * std::f64::consts::LOG2_E + ROUNDER;
    let k = shifted - ROUNDER;
    let r = (x - k * LN_2_HIGH) - k * LN_2_LOW;
    let mantissa = 1.0 + (r + r * r * polynomial(&EXP, r));
    mantissa * f64::from_bits((shifted.to_bits() << MANTISSA_BITS).wrapping_add(BIAS << MANTISSA_BITS))
}

/// atan(w) for |w| of at most tan(pi/8).
#[inline(always)]
pub(super) fn atan_small(w: f64) -> f64 {
    let w2 = w * w;
    w + w * w2 * polynomial(&ATAN, w2)
}

/// The angle of (x, y) from the x axis, rad, in [-pi, pi]; not a number for the origin.
#[inline(always)]
pub(super) fn atan2(y: f64, x: f64) -> f64 {
    let reduced = Reduced::of(y, x);
    reduced.angle(reduced.numerator / reduced.denominator)
}

/// An angle brought into the range of [`atan_small`], with the division still to be done.
///
/// Left apart because a caller with several divisions does them as one.
#[derive(Clone, Copy)]
pub(super) struct Reduced {
    pub(super) numerator: f64,
    pub(super) denominator: f64,
    eighth: f64,
    swapped: bool,
    behind: bool,
    right: bool,
}

impl Reduced {
    /// The angle of (x, y).
    #[inline(always)]
    pub(super) fn of(y: f64, x: f64) -> Self {
        let (side, ahead) = (y.abs(), x.abs());
        let swapped = side > ahead;
        let (small, large) = if swapped { (ahead, side) } else { (side, ahead) };
        let steep = small > TAN_PI_8 * large;
        Self {
            numerator: if steep { small - large } else { small },
            denominator: if steep { small + large } else { large },
            eighth: if steep { std::f64::consts::FRAC_PI_4 } else { 0.0 },
            swapped,
            behind: x < 0.0,
            right: y < 0.0,
        }
    }

    /// The angle, given the quotient of numerator and denominator.
    #[inline(always)]
    pub(super) fn angle(&self, quotient: f64) -> f64 {
        let angle = self.eighth + atan_small(quotient);
        let angle = if self.swapped { std::f64::consts::FRAC_PI_2 - angle } else { angle };
        let angle = if self.behind { std::f64::consts::PI - angle } else { angle };
        if self.right { -angle } else { angle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;

    #[test]
    fn the_exponential_is_right_to_two_units_in_the_last_place() {
        let mut random = SplitMix64::new(1);
        for _ in 0..200_000 {
            let x = -707.0 + 1400.0 * random.next_f64();
            let (found, wanted) = (exp(x), libm::exp(x));
            assert!((found / wanted - 1.0).abs() < 4.5e-16, "{x}: {found} {wanted}");
        }
        assert!((exp(0.0) - 1.0).abs() < 1e-300);
        assert!(exp(-1e9) < 1e-307 && exp(f64::NAN) < 1e-307);
    }

    #[test]
    fn the_arc_tangent_is_right_in_every_direction() {
        let mut random = SplitMix64::new(2);
        for _ in 0..200_000 {
            let (x, y) = (random.next_f64() - 0.5, random.next_f64() - 0.5);
            let (found, wanted) = (atan2(y, x), libm::atan2(y, x));
            assert!((found - wanted).abs() <= 9e-16 * wanted.abs().max(0.1), "{x} {y}: {found} {wanted}");
        }
        for (y, x) in [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, -1.0)] {
            assert!((atan2(y, x) - libm::atan2(y, x)).abs() < 5e-16, "{y} {x}");
        }
    }
}
