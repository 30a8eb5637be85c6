//! The social force of many pairs at once in f32, where the error bound leaves room for its rounding.
//!
//! The same law as in [`super::pairs`]. The way to the other and the relative velocity are taken in f64 and rounded
//! once, so that the place on the floor does not matter. Where rounding could decide a side (interaction nearly
//! straight at the other or straight away from it) or blur a direction (hardly any interaction), the pair is handed on
//! to be worked out in f64. What is left was measured: at most
//! 1e-5 m/s² for a pair and less than 1e-6 on average, so that a tenth of the bound is more than hard scenes take.

use nalgebra::Vector2;

use super::pairs::{Body, LANES, Pairs, add};
use crate::params::Params;

/// From this error bound on f32 is good enough, m/s².
pub(super) const FROM_MPS2: f64 = 1e-3;
/// Share of the error bound that is left to the rounding of f32.
pub(super) const SHARE: f64 = 0.1;
/// Pairs that are gathered before they are worked out.
const CAPACITY: usize = 256;
/// Angles this near to straight ahead or straight behind are for f64, rad.
const TIE_RAD: f32 = 2e-4;
/// Interactions weaker than this are for f64.
const WEAKEST: f32 = 0.1;
/// Added to a number below 2^22, this rounds it to a whole number in the low bits of the sum.
const ROUNDER: f32 = 12_582_912.0;
/// ln 2 in two parts; the high one has enough zeros at its end to be multiplied without rounding.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Below this the exponential is no normal f32.
const LOWEST: f32 = -86.0;
const BIAS: u32 = 127;
const MANTISSA_BITS: u32 = 23;
/// tan(pi/8): where the arc tangent changes its reduction.
const TAN_PI_8: f32 = 0.414_213_57;

/// Constants of the pair force, ready for use.
#[derive(Debug, Clone, Copy)]
struct Constants {
    lambda: f32,
    gamma_m: f32,
    per_gamma: f32,
    epsilon: f32,
    n2: f32,
    n_prime2: f32,
    social: f32,
}

/// Some pairs, field by field.
#[derive(Debug, Clone)]
struct Block {
    dx: [f32; LANES],
    dy: [f32; LANES],
    dvx: [f32; LANES],
    dvy: [f32; LANES],
    fx: [f32; LANES],
    fy: [f32; LANES],
    first: [u32; LANES],
    second: [u32; LANES],
}

/// Gathers pairs and adds their forces to both of each pair, as [`Pairs`] does.
#[derive(Debug, Clone)]
pub(super) struct Rough {
    blocks: Vec<Block>,
    len: usize,
    constants: Constants,
}

impl Rough {
    #[expect(clippy::cast_possible_truncation, reason = "f32 on purpose")]
    pub(super) fn new(params: &Params) -> Self {
        // A pair far apart in every lane, so that lanes without a pair are harmless.
        let empty = Block {
            dx: [1.0; LANES],
            dy: [1.0; LANES],
            dvx: [0.0; LANES],
            dvy: [0.0; LANES],
            fx: [0.0; LANES],
            fy: [0.0; LANES],
            first: [0; LANES],
            second: [0; LANES],
        };
        Self {
            blocks: vec![empty; CAPACITY / LANES],
            len: 0,
            constants: Constants {
                lambda: params.lambda as f32,
                gamma_m: params.gamma_m as f32,
                per_gamma: (1.0 / params.gamma_m) as f32,
                epsilon: params.epsilon as f32,
                n2: (params.n * params.n) as f32,
                n_prime2: (params.n_prime * params.n_prime) as f32,
                social: params.social as f32,
            },
        }
    }

    /// Adds the pairs of one person with others; those there is no room for are worked out with those before.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "f32 on purpose; places are u32 in the order as well")]
    pub(super) fn extend(
        &mut self,
        first: usize,
        others: &[u32],
        bodies: &[Body],
        pairs: &mut Pairs,
        sums: &mut [Vector2<f64>],
    ) {
        let Some(me) = bodies.get(first) else { return };
        for other in others {
            let Some(body) = bodies.get(*other as usize) else { continue };
            let lane = self.len % LANES;
            if let Some(block) = self.blocks.get_mut(self.len / LANES)
                && let (Some(dx), Some(dy)) = (block.dx.get_mut(lane), block.dy.get_mut(lane))
                && let (Some(dvx), Some(dvy)) = (block.dvx.get_mut(lane), block.dvy.get_mut(lane))
                && let (Some(i), Some(j)) = (block.first.get_mut(lane), block.second.get_mut(lane))
            {
                *dx = (body.x - me.x) as f32;
                *dy = (body.y - me.y) as f32;
                *dvx = (me.vx - body.vx) as f32;
                *dvy = (me.vy - body.vy) as f32;
                *i = first as u32;
                *j = *other;
                self.len += 1;
            }
            if self.len == CAPACITY {
                self.flush(bodies, pairs, sums);
            }
        }
    }

    /// Works out the gathered pairs and adds their forces to `sums`; those for f64 go to `pairs`.
    #[inline(always)]
    pub(super) fn flush(&mut self, bodies: &[Body], pairs: &mut Pairs, sums: &mut [Vector2<f64>]) {
        let constants = self.constants;
        for block in self.blocks.iter_mut().take(self.len.div_ceil(LANES)) {
            work_out(block, &constants);
        }
        let (mut current, mut sum) = (0, Vector2::zeros());
        let mut left = self.len;
        for block in &self.blocks {
            let lanes = block.first.iter().zip(&block.second).zip(block.fx.iter().zip(&block.fy));
            for ((first, second), (fx, fy)) in lanes.take(left) {
                let (first, second) = (*first as usize, *second as usize);
                if first != current {
                    add(sums, current, sum);
                    (current, sum) = (first, Vector2::zeros());
                }
                if fx.is_nan() {
                    exactly(first, second, bodies, pairs, sums);
                } else {
                    let force = Vector2::new(f64::from(*fx), f64::from(*fy));
                    sum += force;
                    add(sums, second, -force);
                }
            }
            left = left.saturating_sub(LANES);
            if left == 0 {
                break;
            }
        }
        add(sums, current, sum);
        self.len = 0;
    }
}

/// Hands a pair on.
#[cold]
#[inline(never)]
#[expect(clippy::cast_possible_truncation, reason = "places are u32 in the order as well")]
fn exactly(first: usize, second: usize, bodies: &[Body], pairs: &mut Pairs, sums: &mut [Vector2<f64>]) {
    if let (Some(me), Some(other)) = (bodies.get(first), bodies.get(second)) {
        pairs.push(first as u32, me, second as u32, other, sums);
    }
}

/// e^x for x of at most 80; below -86 it stays at e^-86, and what is not a number counts as below.
#[inline(always)]
fn exp(x: f32) -> f32 {
    let x = if x > LOWEST { x } else { LOWEST };
    let shifted = x * std::f32::consts::LOG2_E + ROUNDER;
    let k = shifted - ROUNDER;
    let r = (x - k * LN_2_HIGH) - k * LN_2_LOW;
    let r2 = r * r;
    let low = 0.5 + r * (1.0 / 6.0);
    let high = (1.0 / 24.0) + r * (1.0 / 120.0) + r2 * (1.0 / 720.0);
    let mantissa = 1.0 + (r + r2 * (low + r2 * high));
    mantissa * f32::from_bits((shifted.to_bits() << MANTISSA_BITS).wrapping_add(BIAS << MANTISSA_BITS))
}

/// The force on the first of each pair; not a number where f64 must decide.
#[inline(always)]
#[expect(clippy::indexing_slicing, reason = "every array has LANES items; an indexed loop becomes vector code")]
fn work_out(block: &mut Block, c: &Constants) {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
    for k in 0..LANES {
        let (dx, dy) = (block.dx[k], block.dy[k]);
        let r2 = dx * dx + dy * dy;
        let r = r2.sqrt();
        let scale = c.lambda * r;
        // J = d I.
        let (jx, jy) = (scale * block.dvx[k] + dx, scale * block.dvy[k] + dy);
        let j2 = jx * jx + jy * jy;
        let product = j2.sqrt() * r;
        let (sine, cosine) = (jx * dy - jy * dx, jx * dx + jy * dy);
        let (side, ahead) = (sine.abs(), cosine.abs());
        let swapped = side > ahead;
        let (small, large) = if swapped { (ahead, side) } else { (side, ahead) };
        let steep = small > TAN_PI_8 * large;
        let numerator = if steep { small - large } else { small };
        let denominator = if steep { small + large } else { large };
        let per_product = 1.0 / product;
        let w = numerator / denominator;
        let w2 = w * w;
        let series = -0.333_329_5 + w2 * (0.199_777_11 + w2 * (-0.138_776_86 + w2 * 0.080_537_44));
        let angle = if steep { FRAC_PI_4 } else { 0.0 } + (w + w * w2 * series);
        let angle = if swapped { FRAC_PI_2 - angle } else { angle };
        let angle = if cosine < 0.0 { PI - angle } else { angle };
        let angle = if sine < 0.0 { -angle } else { angle };
        let range = c.gamma_m * j2 * per_product;
        let turned = angle + c.epsilon * range;
        let theta = if turned > PI { turned - TAU } else { turned };
        let near = r2 * r * per_product * c.per_gamma;
        let width = range * theta;
        let width2 = width * width;
        let slow = -exp(-(near + c.n_prime2 * width2));
        let size = exp(-(near + c.n2 * width2));
        let turn = if theta > 0.0 { -size } else { size };
        let to_unit = r * per_product * c.social;
        let (along_x, along_y) = (jx * to_unit, jy * to_unit);
        let fx = slow * along_x - turn * along_y;
        let fy = slow * along_y + turn * along_x;
        let aside = theta.abs();
        let plain = (aside > TIE_RAD)
            & (aside < PI - TIE_RAD)
            & (range > WEAKEST * c.gamma_m)
            & (c.epsilon * range < PI)
            & (fx + fy).is_finite();
        block.fx[k] = if plain { fx } else { f32::NAN };
        block.fy[k] = fy;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;
    use crate::forces::pair;
    use crate::math::Portable;
    use crate::vector::known;

    /// The largest and the mean difference from the portable functions over random pairs.
    fn worst(params: &Params, size_m: f64, speed_mps: f64, seed: u64) -> (f64, f64) {
        let mut random = SplitMix64::new(seed);
        let (mut rough, mut pairs) = (Rough::new(params), Pairs::new(params));
        let (mut worst, mut total): (f64, f64) = (0.0, 0.0);
        let count = 60_000;
        for _ in 0..count {
            let mut number = |size: f64| (random.next_f64() - 0.5) * size;
            let (x, y) = (number(400.0), number(400.0));
            let me = Body { x, y, vx: number(speed_mps), vy: number(speed_mps) };
            let (dx, dy) = (number(size_m), number(size_m));
            let other = Body { x: x + dx, y: y + dy, vx: number(speed_mps), vy: number(speed_mps) };
            let mut sums = [Vector2::zeros(); 2];
            let bodies = [me, other];
            rough.extend(0, &[1], &bodies, &mut pairs, &mut sums);
            rough.flush(&bodies, &mut pairs, &mut sums);
            pairs.flush(&mut sums);
            let way = Vector2::new(other.x - me.x, other.y - me.y);
            let closing = Vector2::new(me.vx - other.vx, me.vy - other.vy);
            let off = (sums[0] - known(pair::<Portable>(&way, &closing, params))).norm();
            worst = worst.max(off);
            total += off;
        }
        (worst, total / f64::from(count))
    }

    #[test]
    fn pairs_in_f32_are_within_a_hundred_thousandth() {
        let mut largest: f64 = 0.0;
        for params in [Params::lightsfm_hunav(), Params::lightsfm_batch(), Params::default()] {
            for (seed, size_m) in (0..).zip([0.05, 0.5, 2.0, 8.0, 40.0]) {
                for speed_mps in [1e-5, 0.01, 0.5, 3.0, 8.0] {
                    let (worst, mean) = worst(&params, size_m, speed_mps, seed);
                    largest = largest.max(worst);
                    assert!(mean < 2e-6, "{size_m} {speed_mps}: {mean}");
                }
            }
        }
        assert!(largest < 1.2e-5, "{largest}");
    }
}
