//! Distance to the goal, near to it. Active up to the threshold; term: mean distance to the last point of the plan over time.

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `GoalCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per m. Default 5.
    pub cost_weight: f64,
    /// It judges where at most so much of the plan is left, m. Default 1.4.
    pub threshold_to_consider: f64,
}

impl Default for GoalParams {
    fn default() -> Self {
        Self { enabled: true, cost_power: 1, cost_weight: 5.0, threshold_to_consider: 1.4 }
    }
}

#[derive(Debug)]
struct Goal {
    price: Price,
    threshold_m: f32,
    sums: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.goal_critic;
    own.enabled.then(|| {
        Box::new(Goal {
            price: Price::new(own.cost_weight, own.cost_power),
            threshold_m: own.threshold_to_consider as f32,
            sums: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Critic for Goal {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        if scene.left_m > self.threshold_m {
            return;
        }
        self.sums.fill(0.0);
        scene.arch.dispatch(Pass { critic: self, goal: scene.plan.end(), rollout, costs: &mut verdict.costs });
    }
}

struct Pass<'a> {
    critic: &'a mut Goal,
    goal: (f32, f32),
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let sums = &mut self.critic.sums;
        for (x, y) in self.rollout.x.iter().zip(self.rollout.y.iter()) {
            for (sum, (x, y)) in groups_mut::<S>(sums).zip(groups(simd, x).zip(groups(simd, y))) {
                let (dx, dy) = (x - x.like(self.goal.0), y - y.like(self.goal.1));
                *sum = (Lanes::new(simd, *sum) + (dx * dx + dy * dy).sqrt()).raw;
            }
        }
        self.critic.price.scaled(1.0 / self.rollout.steps() as f32).charge(simd, self.costs, sums);
    }
}
