//! Looking along the plan. Active where at least the threshold is left of the plan and the robot looks farther off the way to a point
//! of the plan than allowed; that point is so many points behind the farthest one that any trajectory gets to. Term: angle between
//! the last heading of the trajectory and the way from its last point to that point.

use pulp::Simd;
use socrates_model::Point;
use socrates_model::geometry::wrap_angle;

use super::{Critic, Price};
use crate::mppi::elementary::{atan2, wrapped};
use crate::mppi::lanes::{Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::scene::{Scene, Verdict, off_heading};

/// Which way round a robot may look along the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PathAngleMode {
    /// Forward (0).
    #[default]
    Forward,
    /// Forward or backward, whichever is nearer (1).
    EitherWay,
    /// As the headings of the plan say (2).
    PlanHeading,
}

/// Parameters of `PathAngleCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct PathAngleParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per rad. Default 2.2.
    pub cost_weight: f64,
    /// It judges where at least so much of the plan is left, m. Default 0.5.
    pub threshold_to_consider: f64,
    /// Points of the plan between the farthest one reached and the one to be looked at. Default 4.
    pub offset_from_furthest: usize,
    /// It judges where the robot looks farther off that point, rad. Default pi / 4.
    pub max_angle_to_furthest: f64,
    /// Which way round. Default forward.
    pub mode: PathAngleMode,
}

impl Default for PathAngleParams {
    fn default() -> Self {
        Self {
            enabled: true,
            cost_power: 1,
            cost_weight: 2.2,
            threshold_to_consider: 0.5,
            offset_from_furthest: 4,
            max_angle_to_furthest: std::f64::consts::FRAC_PI_4,
            mode: PathAngleMode::Forward,
        }
    }
}

#[derive(Debug)]
struct PathAngle {
    price: Price,
    threshold_m: f32,
    offset: usize,
    max_angle: f64,
    mode: PathAngleMode,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.path_angle_critic;
    own.enabled.then(|| {
        Box::new(PathAngle {
            price: Price::new(own.cost_weight, own.cost_power),
            threshold_m: own.threshold_to_consider as f32,
            offset: own.offset_from_furthest,
            max_angle: own.max_angle_to_furthest,
            mode: own.mode,
        }) as Box<dyn Critic>
    })
}

impl Critic for PathAngle {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        if scene.left_m < self.threshold_m {
            return;
        }
        let last = scene.plan.len().saturating_sub(1);
        let index = verdict.furthest(scene, rollout).saturating_add(self.offset).min(last);
        let (Some(to), Some(plan_yaw)) = (scene.plan.point(index), scene.plan.yaw.get(index).copied()) else { return };
        if self.off(&Point::new(f64::from(to.0), f64::from(to.1)), f64::from(scene.yaw), f64::from(plan_yaw))
            <= self.max_angle
        {
            return;
        }
        let (price, mode) = (self.price, self.mode);
        scene.arch.dispatch(Pass { price, mode, to, plan_yaw, rollout, costs: &mut verdict.costs });
    }
}

impl PathAngle {
    /// How far the robot looks off the way to a point, rad.
    fn off(&self, to: &Point, yaw: f64, plan_yaw: f64) -> f64 {
        use std::f64::consts::{FRAC_PI_2, PI};
        let angle = off_heading(yaw, to);
        match self.mode {
            PathAngleMode::Forward => angle,
            PathAngleMode::EitherWay => angle.min(PI - angle),
            PathAngleMode::PlanHeading => {
                let against = wrap_angle(libm::atan2(to.y, to.x) - plan_yaw).abs() > FRAC_PI_2;
                if against { PI - angle } else { angle }
            }
        }
    }
}

struct Pass<'a> {
    price: Price,
    mode: PathAngleMode,
    to: (f32, f32),
    plan_yaw: f32,
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Rollout { x, y, yaw, .. } = self.rollout;
        let ends = groups(simd, x.last()).zip(groups(simd, y.last())).zip(groups(simd, yaw.last()));
        for (cost, ((x, y), yaw)) in groups_mut::<S>(self.costs).zip(ends) {
            let (dx, dy) = (x.like(self.to.0) - x, y.like(self.to.1) - y);
            let zero = x.like(0.0);
            // At the point itself there is no way to it: the x axis, as with the functions of C.
            let there = dx.abs().max(dy.abs()).at_most(zero);
            let bearing = there.select(zero, atan2(dy, there.select(x.like(1.0), dx)));
            let angle = wrapped(bearing - yaw).abs();
            let backward = x.like(std::f32::consts::PI) - angle;
            let angle = match self.mode {
                PathAngleMode::Forward => angle,
                PathAngleMode::EitherWay => angle.min(backward),
                PathAngleMode::PlanHeading => {
                    let quarter = x.like(std::f32::consts::FRAC_PI_2);
                    let along = wrapped(bearing - x.like(self.plan_yaw)).abs().at_most(quarter);
                    along.select(angle, backward)
                }
            };
            *cost = (Lanes::new(simd, *cost) + self.price.of(angle)).raw;
        }
    }
}
