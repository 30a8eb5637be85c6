//! The social force of many on one, in lanes: for runs with many people.
//!
//! The same law as `socrates_crowd::forces_on`, pair by pair, with an exponential and an arc tangent of our own, so
//! that the compiler can work on several pairs at once. Within 1e-9 m/s² of it per pair (tested). Each pair is
//! reckoned by itself without fused operations and the sum runs in list order: the same bytes on every x86-64.

use std::ops::Range;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LOG2_E, PI, TAU};

use socrates_crowd::Params;
use socrates_model::Vector;

/// tan(pi / 8): the arc tangent is reduced to below it.
const EIGHTH: f64 = 0.414_213_562_373_095_03;
/// The natural logarithm of 2 in two parts, so that whole multiples of the first are exact.
const LN_2: (f64, f64) = (6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10);
/// Added and taken away again it rounds to a whole number; in between its last bits hold that number.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// Pairs that are worked on at once at most.
const WIDTH: usize = 8;
/// At this distance a force is exactly nothing, m.
const NOWHERE_M: f64 = 1e6;
/// Below this exponent a force is nothing.
const LEAST: f64 = -700.0;

/// Pairs of people with others, field by field: those of one person one after the other.
#[derive(Debug, Default)]
pub(crate) struct Lanes {
    x: Vec<f64>,
    y: Vec<f64>,
    vx: Vec<f64>,
    vy: Vec<f64>,
    along: Vec<f64>,
    aside: Vec<f64>,
}

impl Lanes {
    pub(crate) fn clear(&mut self) {
        for row in [&mut self.x, &mut self.y, &mut self.vx, &mut self.vy] {
            row.clear();
        }
    }

    /// More pairs: where somebody else is from the person, and how much faster the person is. Gives their range.
    pub(crate) fn extend(&mut self, pairs: impl Iterator<Item = (Vector, Vector)>) -> Range<usize> {
        let start = self.x.len();
        pairs.for_each(|(way, faster)| self.push(&way, &faster));
        start..self.x.len()
    }

    /// Somebody else: where it is from the person, and how much faster the person is.
    fn push(&mut self, way: &Vector, faster: &Vector) {
        self.x.push(way.x);
        self.y.push(way.y);
        self.vx.push(faster.x);
        self.vy.push(faster.y);
    }

    /// Reckons the social forces of all pairs.
    pub(crate) fn reckon(&mut self, params: &Params) {
        // Nobody is left over to be reckoned alone: the lanes are filled up with somebody too far off to be felt.
        while !self.x.len().is_multiple_of(WIDTH) {
            self.push(&Vector::new(NOWHERE_M, 0.0), &Vector::zeros());
        }
        self.along.clear();
        self.along.resize(self.x.len(), 0.0);
        self.aside.clear();
        self.aside.resize(self.x.len(), 0.0);
        let Self { x, y, vx, vy, along, aside } = self;
        pulp::Arch::new().dispatch(Pairs { x, y, vx, vy, along, aside, params });
    }

    /// Sum of the social forces of some pairs, m/s², once they are reckoned; a part that is no number counts as 0.
    pub(crate) fn sum(&self, pairs: &Range<usize>) -> Vector {
        let parts = self
            .along
            .get(pairs.clone())
            .into_iter()
            .flatten()
            .zip(self.aside.get(pairs.clone()).into_iter().flatten());
        let sum = parts.fold((0.0, 0.0), |(x, y), (fx, fy)| (x + fx, y + fy));
        Vector::new(sum.0, sum.1)
    }
}

/// All pairs at once. A closure would be compiled for the least of processors: the width is chosen where
/// [`pulp::WithSimd`] is taken in whole.
struct Pairs<'a> {
    x: &'a [f64],
    y: &'a [f64],
    vx: &'a [f64],
    vy: &'a [f64],
    along: &'a mut [f64],
    aside: &'a mut [f64],
    params: &'a Params,
}

impl pulp::WithSimd for Pairs<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _width: S) {
        let ins = self.x.iter().zip(self.y).zip(self.vx.iter().zip(self.vy));
        for (((x, y), (vx, vy)), (fx, fy)) in ins.zip(self.along.iter_mut().zip(self.aside)) {
            (*fx, *fy) = pair(*x, *y, *vx, *vy, self.params);
        }
    }
}

/// The force of one other person.
#[inline(always)]
fn pair(x: f64, y: f64, vx: f64, vy: f64, params: &Params) -> (f64, f64) {
    let distance = (x * x + y * y).sqrt();
    // On one spot there is no direction; the angle is taken from the x axis then, as the crowd library takes it.
    let apart = distance > 0.0;
    let (ex, ey) = (if apart { x / distance } else { 0.0 }, if apart { y / distance } else { 0.0 });
    let (ix, iy) = (vx * params.lambda + ex, vy * params.lambda + ey);
    let strength = (ix * ix + iy * iy).sqrt();
    let (ax, ay) = (ix / strength, iy / strength);
    let range = params.gamma_m * strength;
    // From the interaction to the other person.
    let from_x = if apart { ex } else { 1.0 };
    let turned = atan2(ax * ey - ay * from_x, ax * from_x + ay * ey) + params.epsilon * range;
    let theta = if turned > PI { turned - TAU } else { turned };
    let far = -distance / range;
    let (slow_width, turn_width) = (params.n_prime * range * theta, params.n * range * theta);
    let slow = -exp(far - slow_width * slow_width);
    let side = if theta > 0.0 { 1.0 } else { 0.0 } - if theta < 0.0 { 1.0 } else { 0.0 };
    let turn = -side * exp(far - turn_width * turn_width);
    let (fx, fy) = ((ax * slow - ay * turn) * params.social, (ay * slow + ax * turn) * params.social);
    (if fx.is_nan() { 0.0 } else { fx }, if fy.is_nan() { 0.0 } else { fy })
}

/// e to a power of at most 0.
#[inline(always)]
fn exp(power: f64) -> f64 {
    let least = if power > LEAST { power } else { LEAST };
    let rounded = least * LOG2_E + ROUNDER;
    let whole = rounded - ROUNDER;
    let rest = least - whole * LN_2.0 - whole * LN_2.1;
    // Taylor's series to the 13th power: below 1e-16 for a rest of at most ln 2 / 2.
    let mut sum = 1.0 / 6_227_020_800.0;
    for factor in [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        sum = sum * rest + factor;
    }
    // The last bits of `rounded` are the whole number of halvings; they become the exponent of a power of two.
    let scale = f64::from_bits(rounded.to_bits().wrapping_add(1023) << 52);
    let found = sum * scale;
    if power > LEAST { found } else { power * 0.0 }
}

/// Angle of a vector, rad.
#[inline(always)]
fn atan2(y: f64, x: f64) -> f64 {
    let (across, along) = (y.abs(), x.abs());
    let (small, large) = if across > along { (along, across) } else { (across, along) };
    let share = small / large;
    let steep = share > EIGHTH;
    let reduced = if steep { (share - 1.0) / (share + 1.0) } else { share };
    let square = reduced * reduced;
    // The series of the arc tangent to the 31st power: below 1e-13 for tan(pi / 8).
    let mut sum = -1.0 / 31.0;
    for factor in [
        1.0 / 29.0,
        -1.0 / 27.0,
        1.0 / 25.0,
        -1.0 / 23.0,
        1.0 / 21.0,
        -1.0 / 19.0,
        1.0 / 17.0,
        -1.0 / 15.0,
        1.0 / 13.0,
        -1.0 / 11.0,
        1.0 / 9.0,
        -1.0 / 7.0,
        1.0 / 5.0,
        -1.0 / 3.0,
        1.0,
    ] {
        sum = sum * square + factor;
    }
    let octant = reduced * sum + if steep { FRAC_PI_4 } else { 0.0 };
    let quadrant = if across > along { FRAC_PI_2 - octant } else { octant };
    let half = if x < 0.0 { PI - quadrant } else { quadrant };
    if y < 0.0 { -half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_crowd::{Person, forces_on};
    use socrates_model::Point;

    #[test]
    fn exponential_and_angle_are_right() {
        for step in 0..40_000_u32 {
            let power = -f64::from(step) * 0.0177;
            let (found, want) = (exp(power), libm::exp(power));
            assert!((found - want).abs() <= 1e-14 * want + 1e-300, "{power}: {found} {want}");
            let angle = -PI + f64::from(step) * TAU / 40_000.0;
            let (y, x) = (libm::sin(angle) * 3.0, libm::cos(angle) * 3.0);
            assert!((atan2(y, x) - libm::atan2(y, x)).abs() < 1e-12, "{angle}");
        }
        assert!(exp(-1e300).abs() < 1e-300 && exp(f64::NAN).is_nan() && atan2(0.0, 0.0).is_nan());
    }

    #[test]
    fn lanes_give_the_forces_of_the_crowd_library() {
        let mut seed = 9_u64;
        let mut random = |low: f64, high: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * ((seed >> 11) as f64 / 9_007_199_254_740_992.0)
        };
        let params = Params::default();
        let mut lanes = Lanes::default();
        let mut worst: f64 = 0.0;
        for _ in 0..2000 {
            let mut people: Vec<Person> = (0..20)
                .map(|id| Person {
                    velocity: Vector::new(random(-1.8, 1.8), random(-1.8, 1.8)),
                    ..Person::standing(id, Point::new(random(-4.0, 4.0), random(-4.0, 4.0)))
                })
                .collect();
            // On one spot, and on one spot at one speed.
            people[1].position = people[0].position;
            people[2].position = people[0].position;
            people[2].velocity = people[0].velocity;
            let want = forces_on(0, &people, &[], &params).social;
            lanes.clear();
            for other in &people[1..] {
                lanes.push(&(other.position - people[0].position), &(people[0].velocity - other.velocity));
            }
            lanes.reckon(&params);
            worst = worst.max((lanes.sum(&(0..19)) - want).norm());
        }
        assert!(worst < 1e-9, "{worst}");
    }
}
