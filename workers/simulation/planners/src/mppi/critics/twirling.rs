//! Turning far from the goal. Active where more of the plan is left than the goal tolerance; term: mean of |wz| over time.

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `TwirlingCritic`, which no list of critics has by default.
#[derive(Debug, Clone, PartialEq)]
pub struct TwirlingParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, s/rad. Default 10.
    pub cost_weight: f64,
}

impl Default for TwirlingParams {
    fn default() -> Self {
        Self { enabled: true, cost_power: 1, cost_weight: 10.0 }
    }
}

#[derive(Debug)]
struct Twirling {
    price: Price,
    tolerance_m: f32,
    sums: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.twirling_critic;
    own.enabled.then(|| {
        Box::new(Twirling {
            price: Price::new(own.cost_weight, own.cost_power),
            tolerance_m: params.surroundings.xy_goal_tolerance as f32,
            sums: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Critic for Twirling {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        if scene.left_m < self.tolerance_m {
            return;
        }
        self.sums.fill(0.0);
        scene.arch.dispatch(Pass { critic: self, rollout, costs: &mut verdict.costs });
    }
}

struct Pass<'a> {
    critic: &'a mut Twirling,
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let sums = &mut self.critic.sums;
        for wz in self.rollout.speeds.wz.iter() {
            for (sum, wz) in groups_mut::<S>(sums).zip(groups(simd, wz)) {
                *sum = (Lanes::new(simd, *sum) + wz.abs()).raw;
            }
        }
        self.critic.price.scaled(1.0 / self.rollout.steps() as f32).charge(simd, self.costs, sums);
    }
}
