//! From costs to the next control sequence.
//!
//! Every trajectory b first pays for leaving the last sequence u: gamma / std² * sum over t of u_t * (c_bt - u_t) per axis. Its weight is
//! then w_b = exp(-(cost_b - least cost) / temperature) / sum, and u_t becomes the mean of the controls c_bt so weighted.

use pulp::Simd;

use super::elementary::exp;
use super::lanes::{Lanes, Sum, groups, groups_mut};
use super::noise::Axes;
use super::rows::Rows;
use super::sequence::Sequence;

/// Averages the controls of a batch.
pub(crate) struct Average<'a> {
    /// Trajectories that count.
    pub(crate) batch: usize,
    /// Their controls.
    pub(crate) controls: &'a Axes,
    /// Their costs; what leaving the sequence costs is added.
    pub(crate) costs: &'a mut [f32],
    /// Written: their weights, which sum to 1.
    pub(crate) weights: &'a mut [f32],
    /// The last sequence; becomes the next.
    pub(crate) sequence: &'a mut Sequence,
    /// Gamma / std² of each axis; 0 where it does not count.
    pub(crate) stay: [f32; 3],
    /// Costs per factor e of weight.
    pub(crate) temperature: f32,
}

impl pulp::WithSimd for Average<'_> {
    /// Whether costs were numbers.
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { batch, controls, costs, weights, sequence, stay, temperature } = self;
        let rows = [&controls.vx, &controls.vy, &controls.wz];
        for ((rows, sequence), stay) in rows.into_iter().zip(sequence.axes()).zip(stay) {
            charge(simd, costs, rows, sequence, stay);
        }
        if let Some(beyond) = costs.get_mut(batch..) {
            beyond.fill(f32::INFINITY);
        }
        let least = least(simd, costs);
        let per_cost = Lanes::splat(simd, 1.0 / temperature);
        for (weight, cost) in groups_mut::<S>(weights).zip(groups(simd, costs)) {
            *weight = exp((cost.like(least) - cost) * per_cost).raw;
        }
        let sum = Sum::of(simd, weights);
        if !(sum.is_finite() && sum > 0.0) {
            return false;
        }
        let share = Lanes::splat(simd, 1.0 / sum);
        for weight in groups_mut::<S>(weights) {
            *weight = (Lanes::new(simd, *weight) * share).raw;
        }
        for (rows, sequence) in rows.into_iter().zip(sequence.axes_mut()) {
            for (value, row) in sequence.iter_mut().zip(rows.iter()) {
                *value = Sum::of_products(simd, weights, row);
            }
        }
        true
    }
}

/// Adds what leaving the sequence costs on one axis.
#[inline(always)]
fn charge<S: Simd>(simd: S, costs: &mut [f32], rows: &Rows, sequence: &[f32], stay: f32) {
    for (row, u) in rows.iter().zip(sequence) {
        let price = stay * u;
        // Standing costs nothing to leave.
        if price.abs() > 0.0 {
            let (price, u) = (Lanes::splat(simd, price), Lanes::splat(simd, *u));
            for (cost, control) in groups_mut::<S>(costs).zip(groups(simd, row)) {
                *cost = (Lanes::new(simd, *cost) + price * (control - u)).raw;
            }
        }
    }
}

/// The least of all costs.
#[inline(always)]
fn least<S: Simd>(simd: S, costs: &[f32]) -> f32 {
    let start = Lanes::splat(simd, f32::INFINITY);
    let mut least = start;
    for cost in groups(simd, costs) {
        least = cost.min(least);
    }
    least.each(f32::INFINITY).into_iter().fold(f32::INFINITY, f32::min)
}
