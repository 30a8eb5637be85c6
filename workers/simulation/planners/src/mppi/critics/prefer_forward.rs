//! Driving backward. Active from the threshold on; term: sum over time of dt * max(-vx, 0).

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `PreferForwardCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct PreferForwardParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per m. Default 5.
    pub cost_weight: f64,
    /// It judges where at least so much of the plan is left, m. Default 0.5.
    pub threshold_to_consider: f64,
}

impl Default for PreferForwardParams {
    fn default() -> Self {
        Self { enabled: true, cost_power: 1, cost_weight: 5.0, threshold_to_consider: 0.5 }
    }
}

#[derive(Debug)]
struct PreferForward {
    price: Price,
    threshold_m: f32,
    sums: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.prefer_forward_critic;
    own.enabled.then(|| {
        Box::new(PreferForward {
            price: Price::new(own.cost_weight, own.cost_power),
            threshold_m: own.threshold_to_consider as f32,
            sums: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Critic for PreferForward {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        if scene.left_m < self.threshold_m {
            return;
        }
        self.sums.fill(0.0);
        scene.arch.dispatch(Pass { critic: self, rollout, costs: &mut verdict.costs });
    }
}

struct Pass<'a> {
    critic: &'a mut PreferForward,
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let sums = &mut self.critic.sums;
        let zero = Lanes::splat(simd, 0.0);
        for vx in self.rollout.speeds.vx.iter() {
            for (sum, vx) in groups_mut::<S>(sums).zip(groups(simd, vx)) {
                *sum = (Lanes::new(simd, *sum) + (-vx).max(zero)).raw;
            }
        }
        self.critic.price.scaled(self.rollout.dt).charge(simd, self.costs, sums);
    }
}
