//! Which pairs are left out, and why that is safe.
//!
//! With d the distance of two people, I the vector of interaction, B = gamma |I| and theta the angle
//! from I to the other person, the two parts of the pair force have the sizes exp(-E_v) and exp(-E_a),
//! E = d/B + (m B theta)² with m = n' or n. A pair is dropped when a lower bound of both exponents
//! reaches a threshold T:
//!
//! ```text
//! E_low = d/B + 2 m² B² (1 - cos theta) - 2 pi m² epsilon B³ >= T,   m = min(n, n')
//! ```
//!
//! because theta² >= 2 (1 - cos theta), and because the bias turns theta by epsilon B at most, while
//! |theta| <= pi. The force of a dropped pair is then at most sqrt(2) k e^-T, k the social factor. It is
//! also at most sqrt(2) k e^(-d/B_max), B_max the range of two who meet head on as fast as the fastest.
//! With C_1 <= C_2 <= ... <= C_n = N - 1 the most others that anybody has within d_1 < d_2 < ... < d_n =
//! infinity, every error is at most
//!
//! ```text
//! sqrt(2) k e^-T S(T),   S(T) = sum of C_j (w_(j-1) - w_j),   w_0 = 1,  w_j = min(1, e^(T - d_j/B_max))
//! ```
//!
//! S grows with T. So T_0 = ln((N - 1) sqrt(2) k / error) keeps the bound, and so does each next
//! T = ln(S(T_before) sqrt(2) k / error), which is never larger.
//!
//! The test runs in f32 without a division, multiplied through with d³ B / gamma. Coordinates are taken
//! from the middle of the crowd, so rounding moves the direction of somebody who is at least
//! [`Prune::near_m`] away by 1e-4 at most; the threshold is raised by [`MARGIN`] to cover that, and
//! nearer pairs are always kept.

use super::density::Within;
use crate::params::Params;

/// Added to the threshold of the f32 test: covers its rounding.
const MARGIN: f64 = 0.1;
/// Closer pairs are always kept, m, in a crowd of up to half a kilometer.
const NEAR_M: f64 = 0.5;
/// The same as a share of the extent of larger crowds.
const NEAR_PER_EXTENT: f64 = 1e-3;

/// After so many rounds the threshold hardly falls any more.
const REFINEMENTS: usize = 3;

/// The threshold for one crowd.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prune {
    /// T; infinite when no pair may be dropped.
    threshold: f64,
    gamma_m: f64,
    lambda: f64,
    m2: f64,
    /// 2 m² gamma³ and 2 pi m² epsilon gamma⁴.
    angular: f64,
    bias: f64,
}

/// A circle around a point on the line of somebody's velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    /// How far ahead its center lies, m.
    pub(super) ahead_m: f64,
    /// Its radius, m; infinite when everybody counts.
    pub(super) radius_m: f64,
}

/// The f32 test for one crowd.
#[derive(Debug, Clone, Copy)]
pub(super) struct Test {
    lambda: f32,
    angular: f32,
    bias: f32,
    reach: f32,
    near2: f32,
}

/// Somebody as the f32 test sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Me {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) vx: f32,
    pub(super) vy: f32,
}

/// T for a sum over others, each of weight 1. No error allowed: infinite. No social force: 0.
fn threshold(params: &Params, error_mps2: f64, others: f64) -> f64 {
    libm::log(others * std::f64::consts::SQRT_2 * params.social / error_mps2).max(0.0)
}

impl Prune {
    /// The threshold that keeps the error on everybody below `error_mps2`, in a crowd of `n_people`.
    pub(super) fn new(params: &Params, n_people: usize, error_mps2: f64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a crowd never has 2^53 people")]
        let others = n_people.saturating_sub(1).max(1) as f64;
        let m = params.n.min(params.n_prime);
        let gamma3 = params.gamma_m * params.gamma_m * params.gamma_m;
        Self {
            threshold: threshold(params, error_mps2, others),
            gamma_m: params.gamma_m,
            lambda: params.lambda,
            m2: m * m,
            angular: 2.0 * m * m * gamma3,
            bias: std::f64::consts::TAU * m * m * params.epsilon * gamma3 * params.gamma_m,
        }
    }

    /// The same for a crowd of which more is known: how many others anybody has within some distances
    /// (growing; the last bound must hold for all), and the largest range of a pair.
    pub(super) fn with_density(self, params: &Params, error_mps2: f64, within: &[Within], most_range_m: f64) -> Self {
        let mut threshold_now = self.threshold;
        for _ in 0..REFINEMENTS {
            let (mut sum, mut weight) = (0.0, 1.0);
            for (place, bound) in within.iter().enumerate() {
                let beyond = libm::exp((threshold_now - bound.distance_m / most_range_m).min(0.0));
                let next = if place + 1 == within.len() { 0.0 } else { beyond };
                sum += bound.others * (weight - next);
                weight = next;
            }
            threshold_now = threshold(params, error_mps2, sum).min(threshold_now);
        }
        Self { threshold: threshold_now, ..self }
    }

    /// T.
    pub(super) fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The circle that holds everybody who may be kept by somebody of this speed, in a crowd where nobody
    /// is faster than `fastest_mps`.
    ///
    /// With P the part of I along the way to the other and S² the square of the rest,
    /// 2 (1 - cos theta) |I|² >= S², so that E_low < T asks for
    ///
    /// ```text
    /// d < reach(P) = max over S² of gamma sqrt(P² + S²) (T - m² gamma² S²)
    /// ```
    ///
    /// where P <= 1 + lambda (speed cos phi + fastest), phi the angle from the own velocity. A supremum of
    /// convex functions is convex, so d lies below the straight line in cos phi from behind (K) to ahead
    /// (F), d < a + b cos phi, a = (F + K) / 2, b = (F - K) / 2; and that curve lies in the circle of
    /// radius sqrt(a² + b²) around the point b ahead. Where I points away from the other (P < 0) the
    /// reach is less than at P = 0.
    pub(super) fn circle(&self, speed_mps: f64, fastest_mps: f64) -> Circle {
        let closing = self.lambda * (speed_mps + fastest_mps);
        let strongest = 1.0 + closing;
        let range = self.gamma_m * strongest;
        // The bias takes this much from the exponents at most.
        let threshold = self.threshold
            + MARGIN
            + self.bias / (self.gamma_m * self.gamma_m * self.gamma_m * self.gamma_m) * range * range * range;
        let everywhere = Circle { ahead_m: 0.0, radius_m: threshold * range };
        let sharpness = self.m2 * self.gamma_m * self.gamma_m;
        let reach = |along: f64| {
            let best = (threshold / sharpness - 2.0 * along * along) / 3.0;
            let aside2 = best.clamp(0.0, closing * closing);
            self.gamma_m * (along * along + aside2).sqrt() * (threshold - sharpness * aside2)
        };
        let (front, back) = (reach(strongest), reach(1.0 + self.lambda * (fastest_mps - speed_mps)));
        let (mean, ahead_m) = ((front + back) / 2.0, (front - back) / 2.0);
        let egg = Circle { ahead_m, radius_m: (mean * mean + ahead_m * ahead_m).sqrt() };
        // Not so for an infinite threshold or without angular sharpness.
        if egg.radius_m < everywhere.radius_m { egg } else { everywhere }
    }

    /// The f32 test for a crowd of this extent.
    #[expect(clippy::cast_possible_truncation, reason = "the test is made in f32 on purpose")]
    pub(super) fn test(&self, extent_m: f64) -> Test {
        let near_m = NEAR_M.max(extent_m * NEAR_PER_EXTENT);
        Test {
            lambda: self.lambda as f32,
            angular: self.angular as f32,
            bias: self.bias as f32,
            reach: ((self.threshold + MARGIN) * self.gamma_m) as f32,
            near2: (near_m * near_m) as f32,
        }
    }
}

/// How many people one call of [`Test::keeps`] looks at.
pub(super) const WIDTH: usize = 16;

impl Test {
    /// For each of [`WIDTH`] people, 1 if the pair with `me` must be kept and 0 if it may be dropped.
    #[inline(always)]
    #[expect(clippy::indexing_slicing, reason = "every array has WIDTH items; an indexed loop becomes vector code")]
    pub(super) fn keeps(
        &self,
        me: &Me,
        x: &[f32; WIDTH],
        y: &[f32; WIDTH],
        vx: &[f32; WIDTH],
        vy: &[f32; WIDTH],
    ) -> [u8; WIDTH] {
        let mut keeps = [0; WIDTH];
        for k in 0..WIDTH {
            let (dx, dy) = (x[k] - me.x, y[k] - me.y);
            let (dvx, dvy) = (me.vx - vx[k], me.vy - vy[k]);
            let r2 = dx * dx + dy * dy;
            let r = r2.sqrt();
            let scale = self.lambda * r;
            // J = d I.
            let (jx, jy) = (scale * dvx + dx, scale * dvy + dy);
            let j2 = jx * jx + jy * jy;
            let product = j2.sqrt() * r;
            let along = jx * dx + jy * dy;
            let low = r2 * r2 * r + j2 * (self.angular * (product - along) - self.bias * (j2 * r));
            let limit = self.reach * (product * r2);
            // Written so that what is not a number is kept.
            keeps[k] = 1 - u8::from((low >= limit) & (r2 >= self.near2));
        }
        keeps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;
    use crate::forces::pair;
    use crate::math::Portable;
    use nalgebra::Vector2;

    #[test]
    fn what_is_known_of_a_crowd_lowers_the_threshold_and_keeps_the_bound() {
        // People on a line, half a meter apart, so that sums over the others are plain.
        let (params, error, range) = (Params::lightsfm_hunav(), 1e-3, 2.0);
        let n = 5000_u32;
        let bound = |m: f64| Within { distance_m: m, others: (4.0 * m).min(f64::from(n - 1)) };
        let within = [5.0, 10.0, 20.0, 30.0, 40.0, 1e9].map(bound);
        let plain = Prune::new(&params, n as usize, error);
        let known = plain.with_density(&params, error, &within, range);
        assert!(known.threshold < plain.threshold - 2.0, "{} {}", known.threshold, plain.threshold);
        let most: f64 = (1..n / 2)
            .map(|place| f64::from(place) * 0.5)
            .map(|distance| 2.0 * libm::exp(-known.threshold.max(distance / range)))
            .sum();
        assert!(most * std::f64::consts::SQRT_2 * params.social <= error, "{most}");
        let exact = Prune::new(&params, n as usize, 0.0).with_density(&params, 0.0, &within, range);
        assert!(exact.threshold.is_infinite());
    }

    #[test]
    fn nobody_beyond_the_circle_is_felt_more_than_promised() {
        for (profile, params) in [Params::lightsfm_hunav(), Params::lightsfm_batch()].into_iter().enumerate() {
            for error in [1e-9, 1e-6, 1e-3, 1e-1] {
                let mut random = SplitMix64::new(profile as u64);
                let prune = Prune::new(&params, 1000, error);
                let (allowed, fastest) = (error / 999.0, 1.5);
                let mut beyond = 0;
                for _ in 0..100_000 {
                    let mut polar = |size: f64| {
                        let (length, angle) = (size * random.next_f64(), std::f64::consts::TAU * random.next_f64());
                        Vector2::new(length * libm::cos(angle), length * libm::sin(angle))
                    };
                    let (mine, other, way) = (polar(fastest), polar(fastest), polar(60.0));
                    let circle = prune.circle(mine.norm(), fastest);
                    if (way - mine / mine.norm() * circle.ahead_m).norm() > circle.radius_m {
                        beyond += 1;
                        let force = pair::<Portable>(&way, &(mine - other), &params).norm();
                        assert!(force <= allowed, "{way} {force} {allowed}");
                    }
                }
                assert!(beyond > 1000, "{beyond}");
            }
        }
    }

    #[test]
    #[expect(clippy::cast_possible_truncation, reason = "the test is made in f32 on purpose")]
    fn no_pair_with_a_larger_force_than_promised_is_dropped() {
        for (profile, params) in [Params::lightsfm_hunav(), Params::lightsfm_batch()].into_iter().enumerate() {
            for (error, extent) in [(1e-9, 200.0), (1e-6, 63.0), (1e-3, 200.0), (1e-1, 8.0), (1e-3, 5000.0)] {
                let mut random = SplitMix64::new(profile as u64);
                let prune = Prune::new(&params, 1000, error);
                let test = prune.test(extent);
                let allowed = error / 999.0;
                let mut dropped = 0;
                for _ in 0..200_000 {
                    let mut number = |size: f64| (random.next_f64() - 0.5) * size;
                    let (x, y) = (number(extent), number(extent));
                    let (way_x, way_y) = (number(60.0), number(60.0));
                    let (vx, vy, wx, wy) = (number(3.0), number(3.0), number(3.0), number(3.0));
                    let me = Me { x: x as f32, y: y as f32, vx: vx as f32, vy: vy as f32 };
                    let row = |number: f64| [number as f32; WIDTH];
                    let keeps = test.keeps(&me, &row(x + way_x), &row(y + way_y), &row(wx), &row(wy));
                    if keeps[3] == 0 {
                        dropped += 1;
                        let way = Vector2::new(way_x, way_y);
                        let force = pair::<Portable>(&way, &Vector2::new(vx - wx, vy - wy), &params).norm();
                        assert!(force <= allowed, "{way} {force} {allowed}");
                    }
                }
                assert!(dropped > 1000, "{dropped}");
            }
        }
    }
}
