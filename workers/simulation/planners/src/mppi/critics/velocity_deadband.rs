//! Speeds that are too small to be carried out. Term: sum over time of dt * (max(|d_vx| - |vx|, 0) + max(|d_wz| - |wz|, 0)); an
//! omnidirectional base adds the same for vy.

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `VelocityDeadbandCritic`, which no list of critics has by default.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityDeadbandParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per m. Default 35.
    pub cost_weight: f64,
    /// Smallest speeds that are carried out: forward and to the left, m/s, turning, rad/s. Default 0, 0, 0.
    pub deadband_velocities: [f64; 3],
}

impl Default for VelocityDeadbandParams {
    fn default() -> Self {
        Self { enabled: true, cost_power: 1, cost_weight: 35.0, deadband_velocities: [0.0; 3] }
    }
}

#[derive(Debug)]
struct VelocityDeadband {
    price: Price,
    least: [f32; 3],
    sums: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.velocity_deadband_critic;
    own.enabled.then(|| {
        Box::new(VelocityDeadband {
            price: Price::new(own.cost_weight, own.cost_power),
            least: own.deadband_velocities.map(|speed| speed.abs() as f32),
            sums: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Critic for VelocityDeadband {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        self.sums.fill(0.0);
        scene.arch.dispatch(Pass { critic: self, rollout, costs: &mut verdict.costs });
    }
}

struct Pass<'a> {
    critic: &'a mut VelocityDeadband,
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
        for (rows, least) in [&speeds.vx, &speeds.vy, &speeds.wz].into_iter().zip(critic.least) {
            for row in rows.iter() {
                for (sum, speed) in groups_mut::<S>(&mut critic.sums).zip(groups(simd, row)) {
                    *sum = (Lanes::new(simd, *sum) + (zero.like(least) - speed.abs()).max(zero)).raw;
                }
            }
        }
        critic.price.scaled(self.rollout.dt).charge(simd, self.costs, &critic.sums);
    }
}
