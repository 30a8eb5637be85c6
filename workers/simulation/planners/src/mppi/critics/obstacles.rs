//! Distance to obstacles, read from the inflation of the costmap; an alternative to `CostCritic`.
//!
//! At every step of a trajectory whose cell costs c of at least 1, the distance is d = (s * r_in - ln c + ln 253) / s, s being the
//! inflation's scaling factor and r_in the inscribed radius, less r_in where the cost is that of the center alone. Below the margin it
//! adds margin - d to `raw`, and unless the goal is near it adds the inflation radius - d to `rep`. At a collision `raw` becomes
//! `collision_cost` and the trajectory ends. Term, of weight 1: critical_weight * raw + repulsion_weight * (rep - least rep) / T.

use super::{Critic, Price};
use crate::costmap::{INSCRIBED, LETHAL, UNKNOWN};
use crate::mppi::lanes::Lanes;
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `ObstaclesCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstaclesParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight of being close, per m. Default 20.
    pub critical_weight: f64,
    /// Weight of being nearer than others, per m. Default 1.5.
    pub repulsion_weight: f64,
    /// What a trajectory that collides counts, m. Default 1e5, in Nav2 Humble 1e4.
    pub collision_cost: f64,
    /// Closer than this is close, m. Default 0.1.
    pub collision_margin_distance: f64,
    /// Where less of the plan is left only being close counts, m. Default 0.5.
    pub near_goal_distance: f64,
    /// Whether the outline of the robot is looked at, where it has one. Default false.
    pub consider_footprint: bool,
}

impl Default for ObstaclesParams {
    fn default() -> Self {
        Self {
            enabled: true,
            cost_power: 1,
            critical_weight: 20.0,
            repulsion_weight: 1.5,
            collision_cost: 1e5,
            collision_margin_distance: 0.1,
            near_goal_distance: 0.5,
            consider_footprint: false,
        }
    }
}

#[derive(Debug)]
struct Obstacles {
    params: ObstaclesParams,
    inflation_m: f32,
    circumscribed_cost: u8,
    /// Distance that a cost tells, m: with the outline looked at, and for the center alone.
    distances: [[f32; 256]; 2],
    raw: Vec<f32>,
    repulsion: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.obstacles_critic;
    own.enabled.then(|| {
        let around = &params.surroundings;
        let mut distances = [[0.0; 256]; 2];
        for (table, less) in distances.iter_mut().zip([0.0, around.inscribed_radius]) {
            for (cost, distance) in (0..=u8::MAX).zip(table) {
                let (scale, cost) = (around.cost_scaling_factor, f64::from(cost.max(1)));
                let logs = libm::log(f64::from(INSCRIBED)) - libm::log(cost);
                *distance = ((scale * around.inscribed_radius + logs) / scale - less) as f32;
            }
        }
        Box::new(Obstacles {
            params: own.clone(),
            inflation_m: around.inflation_radius as f32,
            circumscribed_cost: around.circumscribed_cost(),
            distances,
            raw: vec![0.0; padded(params.batch_size)],
            repulsion: vec![0.0; padded(params.batch_size)],
        }) as Box<dyn Critic>
    })
}

impl Critic for Obstacles {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        let near_goal = scene.left_m < self.params.near_goal_distance as f32;
        let outline = self.params.consider_footprint && !scene.ground.footprint.is_empty();
        self.raw.fill(0.0);
        self.repulsion.fill(0.0);
        let rows = rollout.x.iter().zip(rollout.y.iter()).zip(rollout.yaw.iter());
        for ((x, y), yaw) in rows {
            let poses = x.iter().zip(y).zip(yaw).take(rollout.batch);
            let sums = self.raw.iter_mut().zip(&mut self.repulsion);
            for ((raw, repulsion), ((x, y), yaw)) in sums.zip(poses) {
                // Infinite: this trajectory has ended in a collision.
                if raw.is_infinite() {
                    continue;
                }
                let cost = scene.ground.cost(*x, *y);
                let looks = outline && cost > 0 && cost >= self.circumscribed_cost;
                let collides = match cost {
                    0 => continue,
                    LETHAL => true,
                    INSCRIBED if !outline => true,
                    UNKNOWN => !scene.ground.track_unknown,
                    1..=253 => looks && scene.ground.footprint_hits(*x, *y, *yaw),
                };
                if collides {
                    *raw = f32::INFINITY;
                    continue;
                }
                let [with_outline, center] = &self.distances;
                let table = if looks { with_outline } else { center };
                let distance = table.get(usize::from(cost)).copied().unwrap_or_default();
                *raw += (self.params.collision_margin_distance as f32 - distance).max(0.0);
                if !near_goal {
                    *repulsion += self.inflation_m - distance;
                }
            }
        }
        self.charge(rollout, verdict);
    }
}

impl Obstacles {
    fn charge(&self, rollout: &Rollout, verdict: &mut Verdict) {
        let own = &self.params;
        let (raws, repulsions) = (self.raw.iter().take(rollout.batch), self.repulsion.iter().take(rollout.batch));
        verdict.failed |= raws.clone().all(|raw| raw.is_infinite());
        let least = repulsions.clone().copied().fold(f32::INFINITY, f32::min);
        let per_step = own.repulsion_weight as f32 / rollout.steps() as f32;
        let price = Price::new(1.0, own.cost_power);
        for (cost, (raw, repulsion)) in verdict.costs.iter_mut().zip(raws.zip(repulsions)) {
            let raw = if raw.is_infinite() { own.collision_cost as f32 } else { *raw };
            let term = own.critical_weight as f32 * raw + per_step * (repulsion - least);
            *cost += price.of(Lanes::splat(pulp::Scalar::new(), term)).raw;
        }
    }
}
