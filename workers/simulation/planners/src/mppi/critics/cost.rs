//! Cells of the costmap along a trajectory.
//!
//! Every second step is looked at (S of them). The cost c of the cell below the robot's center counts 0 below 1, `collision_cost` for
//! the whole trajectory at a collision, `critical_cost` from `near_collision_cost` on, and else c unless the goal is near. Term: the
//! sum / S, with the weight / 254. A collision is a lethal cell, an inscribed one where no outline is looked at, and an unknown one
//! where the map has none by design. The outline is looked at where c is at least the cost at the circumscribed radius; a lethal cell
//! under one of its edges is a collision. Where every trajectory collides the batch has failed.

use pulp::Simd;

use super::{Critic, Price};
use crate::costmap::{INSCRIBED, LETHAL, UNKNOWN};
use crate::mppi::ground::Ground;
use crate::mppi::lanes::{LANES, groups};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `CostCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct CostParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight of a trajectory all of whose cells cost 254. Default 3.81.
    pub cost_weight: f64,
    /// What a cell from the next one on counts, in costs of cells. Default 300.
    pub critical_cost: f64,
    /// Cells of at least this cost are critical, 1 to 255. Default 253.
    pub near_collision_cost: u8,
    /// What a trajectory that collides counts, in costs of cells. Default 1e6.
    pub collision_cost: f64,
    /// Where less of the plan is left only critical cells and collisions count, m. Default 0.5.
    pub near_goal_distance: f64,
    /// Every so many-th step is looked at, at least 1. Default 2.
    pub trajectory_point_step: usize,
    /// Whether the outline of the robot is looked at, where it has one. Default false.
    pub consider_footprint: bool,
}

impl Default for CostParams {
    fn default() -> Self {
        Self {
            enabled: true,
            cost_power: 1,
            cost_weight: 3.81,
            critical_cost: 300.0,
            near_collision_cost: INSCRIBED,
            collision_cost: 1e6,
            near_goal_distance: 0.5,
            trajectory_point_step: 2,
            consider_footprint: false,
        }
    }
}

#[derive(Debug)]
struct Cost {
    price: Price,
    critical_cost: f32,
    near_collision_cost: u8,
    collision_cost: f32,
    near_goal_m: f32,
    stride: usize,
    consider_footprint: bool,
    circumscribed_cost: u8,
    /// What each cost of a cell counts; infinite for a collision.
    counts: [f32; 256],
    totals: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.cost_critic;
    own.enabled.then(|| {
        Box::new(Cost {
            price: Price::new(own.cost_weight / f64::from(LETHAL), own.cost_power),
            critical_cost: own.critical_cost as f32,
            near_collision_cost: own.near_collision_cost,
            collision_cost: own.collision_cost as f32,
            near_goal_m: own.near_goal_distance as f32,
            stride: own.trajectory_point_step.max(1),
            consider_footprint: own.consider_footprint,
            circumscribed_cost: params.surroundings.circumscribed_cost(),
            counts: [0.0; 256],
            totals: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Cost {
    /// Whether a cell alone is a collision.
    fn collides(&self, cost: u8, outline: bool, track_unknown: bool) -> bool {
        match cost {
            LETHAL => true,
            INSCRIBED => !outline,
            UNKNOWN => !track_unknown,
            0..=252 => false,
        }
    }

    fn count(&self, cost: u8, near_goal: bool) -> f32 {
        if cost == 0 {
            0.0
        } else if cost >= self.near_collision_cost {
            self.critical_cost
        } else if near_goal {
            0.0
        } else {
            f32::from(cost)
        }
    }
}

impl Critic for Cost {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        let near_goal = scene.left_m < self.near_goal_m;
        let outline = self.consider_footprint && !scene.ground.footprint.is_empty();
        let mut counts = [0.0; 256];
        for (cost, count) in (0..=u8::MAX).zip(&mut counts) {
            let collides = self.collides(cost, outline, scene.ground.track_unknown);
            *count = if collides { f32::INFINITY } else { self.count(cost, near_goal) };
        }
        self.counts = counts;
        self.totals.fill(0.0);
        let looked = rollout.steps().div_ceil(self.stride);
        scene.arch.dispatch(Pass { critic: self, ground: &scene.ground, outline, rollout });
        let batch = self.totals.get_mut(..rollout.batch).unwrap_or_default();
        let mut all_collide = true;
        for total in batch {
            if total.is_infinite() {
                *total = self.collision_cost;
            } else {
                all_collide = false;
            }
        }
        verdict.failed |= all_collide;
        let price = self.price.scaled(1.0 / looked as f32);
        scene.arch.dispatch(Charge { price, costs: &mut verdict.costs, totals: &self.totals });
    }
}

struct Pass<'a> {
    critic: &'a mut Cost,
    ground: &'a Ground<'a>,
    outline: bool,
    rollout: &'a Rollout,
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { critic, ground, outline, rollout } = self;
        let Cost { counts, totals, circumscribed_cost, .. } = critic;
        let rows = rollout.x.iter().zip(rollout.y.iter()).zip(rollout.yaw.iter());
        for ((x, y), yaw) in rows.step_by(critic.stride) {
            let chunks = x.as_chunks::<LANES>().0.iter().zip(y.as_chunks::<LANES>().0).zip(yaw.as_chunks::<LANES>().0);
            for (totals, ((x, y), yaw)) in totals.as_chunks_mut::<LANES>().0.iter_mut().zip(chunks) {
                let mut cells = [0_u32; LANES];
                let written = S::as_mut_simd_u32s(&mut cells).0.iter_mut();
                for (cells, (x, y)) in written.zip(groups(simd, x).zip(groups(simd, y))) {
                    *cells = ground.cells(x, y);
                }
                if outline {
                    let poses = x.iter().zip(y).zip(yaw);
                    for ((total, cell), ((x, y), yaw)) in totals.iter_mut().zip(cells).zip(poses) {
                        let cost = ground.cost_of(cell);
                        *total += at(counts, cost);
                        let near = cost > 0 && cost >= *circumscribed_cost;
                        if near && total.is_finite() && ground.footprint_hits(*x, *y, *yaw) {
                            *total = f32::INFINITY;
                        }
                    }
                } else {
                    for (total, cell) in totals.iter_mut().zip(cells) {
                        *total += at(counts, ground.cost_of(cell));
                    }
                }
            }
        }
    }
}

/// What a cost counts.
#[inline(always)]
fn at(counts: &[f32; 256], cost: u8) -> f32 {
    counts.get(usize::from(cost)).copied().unwrap_or_default()
}

struct Charge<'a> {
    price: Price,
    costs: &'a mut [f32],
    totals: &'a [f32],
}

impl pulp::WithSimd for Charge<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.price.charge(simd, self.costs, self.totals);
    }
}
