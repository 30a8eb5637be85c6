//! Normal noise, the same for a seed on every machine.
//!
//! Every sample at every step has its own number: a hash of seed, draw, step and sample gives two uniform numbers, and Box and Muller's
//! transform makes two normal ones of them. So a sample's noise depends neither on the size of the batch nor on what was drawn before.

use pulp::Simd;

use super::elementary::{ln, sin_cos};
use super::lanes::{LANES, groups, groups_mut};
use super::rows::Rows;

/// Increment and multipliers of SplitMix64 (Steele, Lea, Flood 2014).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
const MIX: [u64; 2] = [0xBF58_476D_1CE4_E5B9, 0x94D0_49BB_1331_11EB];
/// A uniform number has so many bits: those of an f32.
const BITS: u32 = 24;
/// What keeps the hashes of the sideways axis apart from those of the other two.
const SIDEWAYS: u64 = 1 << 63;

/// SplitMix64's finalizer.
#[inline(always)]
const fn mixed(state: u64) -> u64 {
    let state = (state ^ (state >> 30)).wrapping_mul(MIX[0]);
    let state = (state ^ (state >> 27)).wrapping_mul(MIX[1]);
    state ^ (state >> 31)
}

/// A number of each axis for every sample at every step.
#[derive(Debug, Clone)]
pub(crate) struct Axes {
    /// Forward, m/s.
    pub(crate) vx: Rows,
    /// To the left, m/s; no rows unless the base is omnidirectional.
    pub(crate) vy: Rows,
    /// Turning, rad/s.
    pub(crate) wz: Rows,
}

impl Axes {
    /// Zeros.
    pub(crate) fn zeros(batch: usize, steps: usize, holonomic: bool) -> Self {
        let rows = || Rows::zeros(batch, steps);
        Self { vx: rows(), vy: if holonomic { rows() } else { Rows::none() }, wz: rows() }
    }
}

/// Draws new noise.
pub(crate) struct Draw<'a> {
    /// Seed and number of the draw.
    pub(crate) key: (u64, u64),
    /// Standard deviations forward, to the left and turning.
    pub(crate) std: [f32; 3],
    /// What is written.
    pub(crate) noise: &'a mut Axes,
}

impl pulp::WithSimd for Draw<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let key = mixed(self.key.0.wrapping_add(mixed(self.key.1.wrapping_add(GOLDEN))));
        let [vx, vy, wz] = self.std;
        for (step, (forward, turning)) in (0_u64..).zip(self.noise.vx.iter_mut().zip(self.noise.wz.iter_mut())) {
            pairs(simd, key, step, (forward, vx), (turning, wz));
        }
        let mut unused = [0.0; LANES];
        for (step, sideways) in (0_u64..).zip(self.noise.vy.iter_mut()) {
            for (chunk, sideways) in (0_u64..).zip(sideways.as_chunks_mut::<LANES>().0) {
                // Whole chunks, so that the second numbers need no row of their own.
                let at = key ^ SIDEWAYS;
                chunk_of_pairs(simd, at, step, chunk, (sideways, vy), (&mut unused, 0.0));
            }
        }
    }
}

/// Two numbers for every sample of a step.
#[inline(always)]
fn pairs<S: Simd>(simd: S, key: u64, step: u64, first: (&mut [f32], f32), second: (&mut [f32], f32)) {
    let rows = first.0.as_chunks_mut::<LANES>().0.iter_mut().zip(second.0.as_chunks_mut::<LANES>().0);
    for (chunk, (one, other)) in (0_u64..).zip(rows) {
        chunk_of_pairs(simd, key, step, chunk, (one, first.1), (other, second.1));
    }
}

/// Two numbers for every sample of a chunk.
#[inline(always)]
fn chunk_of_pairs<S: Simd>(
    simd: S,
    key: u64,
    step: u64,
    chunk: u64,
    (first, first_std): (&mut [f32; LANES], f32),
    (second, second_std): (&mut [f32; LANES], f32),
) {
    let counter = (step << 32) | (chunk * LANES as u64);
    let (mut radius, mut angle) = ([0.0; LANES], [0.0; LANES]);
    for ((radius, angle), sample) in radius.iter_mut().zip(&mut angle).zip(counter..) {
        let bits = mixed(key.wrapping_add(sample.wrapping_mul(GOLDEN)));
        // Both fit into f32 without rounding.
        *radius = (bits >> (64 - BITS)) as f32;
        *angle = (bits & ((1 << BITS) - 1)) as f32;
    }
    let unit = 1.0 / (1_u32 << BITS) as f32;
    let written = groups_mut::<S>(first).zip(groups_mut::<S>(second));
    for ((first, second), (radius, angle)) in written.zip(groups(simd, &radius).zip(groups(simd, &angle))) {
        // Half a unit above 0, of which there is no logarithm.
        let uniform = (radius + radius.like(0.5)) * radius.like(unit);
        let length = (ln(uniform) * radius.like(-2.0)).max(radius.like(0.0)).sqrt();
        let (sine, cosine) = sin_cos(angle * angle.like(unit * std::f32::consts::TAU));
        *first = (length * cosine * length.like(first_std)).raw;
        *second = (length * sine * length.like(second_std)).raw;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mppi::lanes::Instructions;

    fn drawn(batch: usize, key: (u64, u64), instructions: Instructions) -> Axes {
        let mut noise = Axes::zeros(batch, 56, true);
        instructions.arch().dispatch(Draw { key, std: [0.2, 0.3, 0.4], noise: &mut noise });
        noise
    }

    fn all(rows: &Rows, batch: usize) -> Vec<f64> {
        rows.iter().flat_map(|row| row[..batch].iter().map(|value| f64::from(*value))).collect()
    }

    #[test]
    fn noise_has_the_mean_and_the_deviation_that_were_asked_for() {
        let noise = drawn(2000, (7, 0), Instructions::Detected);
        for (rows, std) in [(&noise.vx, 0.2), (&noise.vy, 0.3), (&noise.wz, 0.4)] {
            let values = all(rows, 2000);
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / n;
            let tails = values.iter().filter(|value| value.abs() > 2.0 * std).count() as f64 / n;
            // Four standard errors of a mean, a deviation and a share over 112 000 numbers.
            assert!(mean.abs() < 4.0 * std / n.sqrt(), "{mean}");
            assert!((variance.sqrt() / std - 1.0).abs() < 4.0 / (2.0 * n).sqrt(), "{}", variance.sqrt());
            assert!((tails - 0.0455).abs() < 4.0 * (0.0455 * 0.9545 / n).sqrt(), "{tails}");
        }
    }

    #[test]
    fn axes_and_neighbors_are_not_correlated() {
        let noise = drawn(2000, (7, 0), Instructions::Detected);
        let (vx, vy, wz) = (all(&noise.vx, 2000), all(&noise.vy, 2000), all(&noise.wz, 2000));
        let correlation = |a: &[f64], b: &[f64]| {
            let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
            product / norm(a) / norm(b)
        };
        let limit = 4.0 / (vx.len() as f64).sqrt();
        for found in [
            correlation(&vx, &wz),
            correlation(&vx, &vy),
            correlation(&vy, &wz),
            correlation(&vx[1..], &vx),
            correlation(&vx[2000..], &vx),
        ] {
            assert!(found.abs() < limit, "{found}");
        }
    }

    #[test]
    fn noise_depends_on_seed_and_draw_and_on_nothing_else() {
        let of = |batch, key, instructions| all(&drawn(batch, key, instructions).vx, 400);
        let noise = of(400, (7, 3), Instructions::Baseline);
        assert_eq!(noise, of(400, (7, 3), Instructions::Detected));
        assert_eq!(noise, of(400, (7, 3), Instructions::Avx2));
        assert_eq!(noise, of(2000, (7, 3), Instructions::Detected), "a larger batch has the smaller one in it");
        assert_ne!(noise, of(400, (7, 4), Instructions::Detected));
        assert_ne!(noise, of(400, (8, 3), Instructions::Detected));
    }
}
