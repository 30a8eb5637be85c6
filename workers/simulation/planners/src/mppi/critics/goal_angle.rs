//! Heading off that of the goal, near to it. Active up to the threshold; term: mean over time of the shortest angle between the heading
//! and that of the goal.

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::elementary::wrapped;
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `GoalAngleCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalAngleParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per rad. Default 3.
    pub cost_weight: f64,
    /// It judges where at most so much of the plan is left, m. Default 0.5.
    pub threshold_to_consider: f64,
    /// Whether the opposite heading is as good. Default false.
    pub symmetric_yaw_tolerance: bool,
}

impl Default for GoalAngleParams {
    fn default() -> Self {
        Self {
            enabled: true,
            cost_power: 1,
            cost_weight: 3.0,
            threshold_to_consider: 0.5,
            symmetric_yaw_tolerance: false,
        }
    }
}

#[derive(Debug)]
struct GoalAngle {
    price: Price,
    threshold_m: f32,
    symmetric: bool,
    sums: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.goal_angle_critic;
    own.enabled.then(|| {
        Box::new(GoalAngle {
            price: Price::new(own.cost_weight, own.cost_power),
            threshold_m: own.threshold_to_consider as f32,
            symmetric: own.symmetric_yaw_tolerance,
            sums: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Critic for GoalAngle {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        if scene.left_m > self.threshold_m {
            return;
        }
        self.sums.fill(0.0);
        scene.arch.dispatch(Pass { critic: self, goal_yaw: scene.goal_yaw, rollout, costs: &mut verdict.costs });
    }
}

struct Pass<'a> {
    critic: &'a mut GoalAngle,
    goal_yaw: f32,
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let sums = &mut self.critic.sums;
        let goal = Lanes::splat(simd, self.goal_yaw);
        let half = goal.like(std::f32::consts::PI);
        for yaw in self.rollout.yaw.iter() {
            for (sum, yaw) in groups_mut::<S>(sums).zip(groups(simd, yaw)) {
                let mut angle = wrapped(goal - yaw).abs();
                if self.critic.symmetric {
                    angle = angle.min(half - angle);
                }
                *sum = (Lanes::new(simd, *sum) + angle).raw;
            }
        }
        self.critic.price.scaled(1.0 / self.rollout.steps() as f32).charge(simd, self.costs, sums);
    }
}
