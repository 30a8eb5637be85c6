//! Being drawn along the plan. Active where at least the threshold is left of a plan of at least two points; term: distance of the
//! last point of the trajectory to a point of the plan so many points behind the farthest one that any trajectory gets to, moved
//! on to the first that is free.

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::scene::{Scene, Verdict};

/// Parameters of `PathFollowCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct PathFollowParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per m. Default 5.
    pub cost_weight: f64,
    /// It judges where at least so much of the plan is left, m. Default 1.4.
    pub threshold_to_consider: f64,
    /// Points of the plan between the farthest one reached and the one that draws. Default 6.
    pub offset_from_furthest: usize,
}

impl Default for PathFollowParams {
    fn default() -> Self {
        Self { enabled: true, cost_power: 1, cost_weight: 5.0, threshold_to_consider: 1.4, offset_from_furthest: 6 }
    }
}

#[derive(Debug)]
struct PathFollow {
    price: Price,
    threshold_m: f32,
    offset: usize,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.path_follow_critic;
    own.enabled.then(|| {
        Box::new(PathFollow {
            price: Price::new(own.cost_weight, own.cost_power),
            threshold_m: own.threshold_to_consider as f32,
            offset: own.offset_from_furthest,
        }) as Box<dyn Critic>
    })
}

impl Critic for PathFollow {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        if scene.left_m < self.threshold_m || scene.plan.len() < 2 {
            return;
        }
        let last = scene.plan.len() - 1;
        let first = (verdict.furthest(scene, rollout).saturating_add(self.offset)).min(last);
        let free = verdict.valid(scene).iter().enumerate().skip(first).find(|(_, valid)| **valid);
        let Some(to) = scene.plan.point(free.map_or(last, |(index, _)| index)) else { return };
        scene.arch.dispatch(Pass { price: self.price, to, rollout, costs: &mut verdict.costs });
    }
}

struct Pass<'a> {
    price: Price,
    to: (f32, f32),
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let ends = groups(simd, self.rollout.x.last()).zip(groups(simd, self.rollout.y.last()));
        for (cost, (x, y)) in groups_mut::<S>(self.costs).zip(ends) {
            let (dx, dy) = (x - x.like(self.to.0), y - y.like(self.to.1));
            *cost = (Lanes::new(simd, *cost) + self.price.of((dx * dx + dy * dy).sqrt())).raw;
        }
    }
}
