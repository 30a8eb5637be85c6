//! Speeds beyond the limits.
//!
//! Term: sum over time of dt * (max(vx - vx_max, 0) + max(vx_min - vx, 0)); an omnidirectional base adds max(|vy| - vy_max, 0), a car
//! max(r_min - |vx| / max(|wz|, 1e-6), 0). Nav2 Humble takes for every base the length of the velocity with the sign of vx against
//! hypot(vx_max, vy_max) and -hypot(vx_min, vy_max) instead.

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::{MotionModel, MppiParams};
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Slowest turning that a radius is taken of, rad/s.
const LEAST_RADPS: f32 = 1e-6;

/// Parameters of `ConstraintCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per m. Default 4.
    pub cost_weight: f64,
}

impl Default for ConstraintParams {
    fn default() -> Self {
        Self { enabled: true, cost_power: 1, cost_weight: 4.0 }
    }
}

#[derive(Debug)]
struct Constraint {
    price: Price,
    vx: [f32; 2],
    vy_max: f32,
    /// Smallest turning radius of a car, m.
    radius: Option<f32>,
    /// Largest speeds backward and forward that Nav2 Humble takes.
    length: [f32; 2],
    sums: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.constraint_critic;
    own.enabled.then(|| {
        let [least, most] = [params.vx_min, params.vx_max];
        Box::new(Constraint {
            price: Price::new(own.cost_weight, own.cost_power),
            vx: [least as f32, most as f32],
            vy_max: params.vy_max as f32,
            radius: match params.motion_model {
                MotionModel::Ackermann { min_turning_r } => Some(min_turning_r as f32),
                MotionModel::DiffDrive | MotionModel::Omni => None,
            },
            length: [-libm::hypot(least, params.vy_max) as f32, libm::hypot(most, params.vy_max) as f32],
            sums: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Critic for Constraint {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        self.sums.fill(0.0);
        scene.arch.dispatch(Pass { critic: self, humble: scene.humble, rollout, costs: &mut verdict.costs });
    }
}

struct Pass<'a> {
    critic: &'a mut Constraint,
    humble: bool,
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let critic = self.critic;
        let speeds = &self.rollout.speeds;
        let zero = Lanes::splat(simd, 0.0);
        for (step, vx) in speeds.vx.iter().enumerate() {
            let vy = speeds.vy.row(step);
            if self.humble {
                let [least, most] = critic.length.map(|limit| zero.like(limit));
                let mut sideways = groups(simd, vy);
                for (sum, vx) in groups_mut::<S>(&mut critic.sums).zip(groups(simd, vx)) {
                    let vy = sideways.next().unwrap_or(zero);
                    let length = (vx * vx + vy * vy).sqrt();
                    let length = vx.below(zero).select(-length, length);
                    *sum = (Lanes::new(simd, *sum) + beyond(length, least, most)).raw;
                }
                continue;
            }
            let [least, most] = critic.vx.map(|limit| zero.like(limit));
            for (sum, vx) in groups_mut::<S>(&mut critic.sums).zip(groups(simd, vx)) {
                *sum = (Lanes::new(simd, *sum) + beyond(vx, least, most)).raw;
            }
            for (sum, vy) in groups_mut::<S>(&mut critic.sums).zip(groups(simd, vy)) {
                *sum = (Lanes::new(simd, *sum) + (vy.abs() - zero.like(critic.vy_max)).max(zero)).raw;
            }
            if let Some(radius) = critic.radius {
                let rows = groups(simd, vx).zip(groups(simd, speeds.wz.row(step)));
                for (sum, (vx, wz)) in groups_mut::<S>(&mut critic.sums).zip(rows) {
                    let turned = vx.abs() / wz.abs().max(zero.like(LEAST_RADPS));
                    *sum = (Lanes::new(simd, *sum) + (zero.like(radius) - turned).max(zero)).raw;
                }
            }
        }
        critic.price.scaled(self.rollout.dt).charge(simd, self.costs, &critic.sums);
    }
}

/// How far a speed is beyond two limits.
#[inline(always)]
fn beyond<S: Simd>(speed: Lanes<S>, least: Lanes<S>, most: Lanes<S>) -> Lanes<S> {
    let zero = speed.like(0.0);
    (speed - most).max(zero) + (least - speed).max(zero)
}
