//! The social force of many pairs at once.

use nalgebra::Vector2;

use super::elementary::{Reduced, exp};
use crate::forces::pair;
use crate::math::Portable;
use crate::params::Params;
use crate::vector::known;

/// Pairs per block: several registers of every width.
pub(super) const LANES: usize = 16;
/// Pairs that are gathered before they are worked out; their blocks fit the first cache.
const CAPACITY: usize = 256;

/// Angles this near to straight ahead (or straight behind) are a tie, rad.
const TIE_RAD: f64 = 1e-12;
/// Below this strength of interaction its direction is rounding.
const WEAKEST: f64 = 1e-6;

/// Position and velocity of somebody.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Body {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) vx: f64,
    pub(crate) vy: f64,
}

impl Body {
    pub(crate) fn is_finite(&self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.vx.is_finite() && self.vy.is_finite()
    }
}

/// Constants of the pair force, ready for use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Constants {
    lambda: f64,
    gamma_m: f64,
    per_gamma: f64,
    epsilon: f64,
    n2: f64,
    n_prime2: f64,
    social: f64,
}

impl Constants {
    pub(super) fn new(params: &Params) -> Self {
        Self {
            lambda: params.lambda,
            gamma_m: params.gamma_m,
            per_gamma: 1.0 / params.gamma_m,
            epsilon: params.epsilon,
            n2: params.n * params.n,
            n_prime2: params.n_prime * params.n_prime,
            social: params.social,
        }
    }
}

/// Some pairs, field by field.
#[derive(Debug, Clone)]
pub(super) struct Block {
    dx: [f64; LANES],
    dy: [f64; LANES],
    dvx: [f64; LANES],
    dvy: [f64; LANES],
    fx: [f64; LANES],
    fy: [f64; LANES],
    first: [u32; LANES],
    second: [u32; LANES],
}

impl Block {
    /// A pair far apart in every lane, so that lanes without a pair are harmless.
    pub(super) const EMPTY: Self = Self {
        dx: [1.0; LANES],
        dy: [1.0; LANES],
        dvx: [0.0; LANES],
        dvy: [0.0; LANES],
        fx: [0.0; LANES],
        fy: [0.0; LANES],
        first: [0; LANES],
        second: [0; LANES],
    };

    /// Puts a pair into a lane: where the other is, and how much faster the first is.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, way: &Vector2<f64>, faster: &Vector2<f64>) {
        let numbers = [way.x, way.y, faster.x, faster.y];
        let fields = [&mut self.dx, &mut self.dy, &mut self.dvx, &mut self.dvy];
        for (field, number) in fields.into_iter().zip(numbers) {
            if let Some(slot) = field.get_mut(lane) {
                *slot = number;
            }
        }
    }

    /// The pair of a lane.
    pub(super) fn pair(&self, lane: usize) -> (Vector2<f64>, Vector2<f64>) {
        let number = |field: &[f64; LANES]| field.get(lane).copied().unwrap_or(f64::NAN);
        (Vector2::new(number(&self.dx), number(&self.dy)), Vector2::new(number(&self.dvx), number(&self.dvy)))
    }

    /// The force on the first of the pair of a lane, once worked out.
    #[inline(always)]
    pub(super) fn force(&self, lane: usize) -> Vector2<f64> {
        let number = |field: &[f64; LANES]| field.get(lane).copied().unwrap_or(0.0);
        Vector2::new(number(&self.fx), number(&self.fy))
    }

    /// Another force for a lane.
    pub(super) fn set_force(&mut self, lane: usize, force: &Vector2<f64>) {
        for (field, number) in [&mut self.fx, &mut self.fy].into_iter().zip([force.x, force.y]) {
            if let Some(slot) = field.get_mut(lane) {
                *slot = number;
            }
        }
    }
}

/// Gathers pairs and adds their forces to both of each pair.
///
/// Every lane is worked out alone and sums run in the order in which pairs were pushed, so the result
/// does not depend on the width of the registers.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    blocks: Vec<Block>,
    len: usize,
    constants: Constants,
    params: Params,
}

impl Pairs {
    pub(super) fn new(params: &Params) -> Self {
        Self {
            blocks: vec![Block::EMPTY; CAPACITY / LANES],
            len: 0,
            constants: Constants::new(params),
            params: params.clone(),
        }
    }

    /// Adds a pair; the pushed ones are worked out when there is no room left.
    #[inline(always)]
    pub(super) fn push(&mut self, first: u32, me: &Body, second: u32, other: &Body, sums: &mut [Vector2<f64>]) {
        let lane = self.len % LANES;
        if let Some(block) = self.blocks.get_mut(self.len / LANES)
            && let (Some(dx), Some(dy)) = (block.dx.get_mut(lane), block.dy.get_mut(lane))
            && let (Some(dvx), Some(dvy)) = (block.dvx.get_mut(lane), block.dvy.get_mut(lane))
            && let (Some(i), Some(j)) = (block.first.get_mut(lane), block.second.get_mut(lane))
        {
            *dx = other.x - me.x;
            *dy = other.y - me.y;
            *dvx = me.vx - other.vx;
            *dvy = me.vy - other.vy;
            *i = first;
            *j = second;
            self.len += 1;
        }
        if self.len == CAPACITY {
            self.flush(sums);
        }
    }

    /// Works out the pushed pairs and adds their forces to `sums`.
    #[inline(always)]
    pub(super) fn flush(&mut self, sums: &mut [Vector2<f64>]) {
        let constants = self.constants;
        for block in self.blocks.iter_mut().take(self.len.div_ceil(LANES)) {
            work_out(block, &constants);
        }
        // Pairs of one person come one after the other: its sum is kept aside while they last.
        let (mut current, mut sum) = (0, Vector2::zeros());
        let mut left = self.len;
        for block in &self.blocks {
            let lanes = block.first.iter().zip(&block.second).zip(block.fx.iter().zip(&block.fy));
            for (lane, ((first, second), (fx, fy))) in lanes.enumerate().take(left) {
                let (first, second) = (*first as usize, *second as usize);
                if first != current {
                    add(sums, current, sum);
                    (current, sum) = (first, Vector2::zeros());
                }
                if fx.is_nan() {
                    self.edge(block, lane, first, second, sums);
                } else {
                    let force = Vector2::new(*fx, *fy);
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

    /// A pair at an edge of the law: both directions as the portable functions take them.
    #[cold]
    #[inline(never)]
    fn edge(&self, block: &Block, lane: usize, first: usize, second: usize, sums: &mut [Vector2<f64>]) {
        let (way, closing) = block.pair(lane);
        add(sums, first, known(pair::<Portable>(&way, &closing, &self.params)));
        add(sums, second, known(pair::<Portable>(&-way, &-closing, &self.params)));
    }
}

#[inline(always)]
pub(super) fn add(sums: &mut [Vector2<f64>], place: usize, force: Vector2<f64>) {
    if let Some(sum) = sums.get_mut(place) {
        *sum += force;
    }
}

/// The force on the first of each pair; not a number where the portable functions must decide.
///
/// The same law as [`pair`], with J = d I instead of the two directions, so that one division serves for
/// all. The force on the second of a pair is the opposite: every part of the law changes its sign when
/// the two change places.
#[inline(always)]
#[expect(clippy::indexing_slicing, reason = "every array has LANES items; an indexed loop becomes vector code")]
pub(super) fn work_out(block: &mut Block, c: &Constants) {
    for k in 0..LANES {
        let (dx, dy) = (block.dx[k], block.dy[k]);
        let r2 = dx * dx + dy * dy;
        let r = r2.sqrt();
        let scale = c.lambda * r;
        let (jx, jy) = (scale * block.dvx[k] + dx, scale * block.dvy[k] + dy);
        let j2 = jx * jx + jy * jy;
        let product = j2.sqrt() * r;
        let reduced = Reduced::of(jx * dy - jy * dx, jx * dx + jy * dy);
        let quotient = 1.0 / (product * reduced.denominator);
        let per_product = quotient * reduced.denominator;
        let range = c.gamma_m * j2 * per_product;
        let turned = reduced.angle(reduced.numerator * (quotient * product)) + c.epsilon * range;
        let theta = if turned > std::f64::consts::PI { turned - std::f64::consts::TAU } else { turned };
        let near = r2 * r * per_product * c.per_gamma;
        let width = range * theta;
        let width2 = width * width;
        let slow = -exp(-(near + c.n_prime2 * width2));
        let size = exp(-(near + c.n2 * width2));
        let turn = if theta > 0.0 { -size } else { size };
        let to_unit = r * per_product;
        let (along_x, along_y) = (jx * to_unit, jy * to_unit);
        let fx = (slow * along_x - turn * along_y) * c.social;
        let fy = (slow * along_y + turn * along_x) * c.social;
        let aside = theta.abs();
        let plain = (aside > TIE_RAD)
            & (aside < std::f64::consts::PI - TIE_RAD)
            & (range > WEAKEST * c.gamma_m)
            & (c.epsilon * range < std::f64::consts::PI)
            & (fx + fy).is_finite();
        block.fx[k] = if plain { fx } else { f64::NAN };
        block.fy[k] = fy;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;

    #[test]
    fn every_lane_gives_the_force_of_the_portable_functions() {
        for params in [Params::lightsfm_hunav(), Params::lightsfm_batch()] {
            let mut random = SplitMix64::new(3);
            let mut pairs = Pairs::new(&params);
            for _ in 0..20_000 {
                let mut number = |size: f64| (random.next_f64() - 0.5) * size;
                let me = Body { x: number(9.0), y: number(9.0), vx: number(3.0), vy: number(3.0) };
                let other = Body { x: number(9.0), y: number(9.0), vx: number(3.0), vy: number(3.0) };
                let mut sums = [Vector2::zeros(); 2];
                pairs.push(0, &me, 1, &other, &mut sums);
                pairs.flush(&mut sums);
                let way = Vector2::new(other.x - me.x, other.y - me.y);
                let closing = Vector2::new(me.vx - other.vx, me.vy - other.vy);
                let wanted = pair::<Portable>(&way, &closing, &params);
                assert!((sums[0] - wanted).norm() < 2e-14 && (sums[0] + sums[1]).norm() < 1e-300, "{wanted}");
            }
        }
    }

    #[test]
    fn edges_of_the_law_are_decided_by_the_portable_functions() {
        let still = Body::default();
        let cases = [
            (still, still),
            (still, Body { vx: 1.0, ..still }),
            (still, Body { x: 3.0, vx: -1.0, ..still }),
            (still, Body { x: 3.0, vx: 1.0, ..still }),
            (Body { vx: 1.0, vy: 1.0, ..still }, Body { x: 2.0, y: 2.0, ..still }),
            (still, Body { x: 1.0, vx: 0.5, ..still }),
            (still, Body { x: 1e200, ..still }),
        ];
        for params in [Params::lightsfm_hunav(), Params::lightsfm_batch()] {
            for (me, other) in cases {
                let mut pairs = Pairs::new(&params);
                let mut sums = [Vector2::zeros(); 2];
                pairs.push(0, &me, 1, &other, &mut sums);
                pairs.flush(&mut sums);
                let way = Vector2::new(other.x - me.x, other.y - me.y);
                let closing = Vector2::new(me.vx - other.vx, me.vy - other.vy);
                for (sum, sign) in sums.iter().zip([1.0, -1.0]) {
                    let wanted = known(pair::<Portable>(&(way * sign), &(closing * sign), &params));
                    assert!((sum - wanted).norm() < 1e-14, "{me:?} {other:?}: {sum} {wanted}");
                }
            }
        }
    }
}
