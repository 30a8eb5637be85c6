//! Critics: what makes a trajectory expensive. One file each, listed in [`CATALOG`].
//!
//! The cost of a critic is (weight * term) ^ power; the files say the terms.

mod constraint;
mod cost;
mod goal;
mod goal_angle;
mod obstacles;
mod path_align;
mod path_angle;
mod path_follow;
mod prefer_forward;
mod twirling;
mod velocity_deadband;

#[cfg(test)]
mod tests;

use pulp::Simd;

pub use constraint::ConstraintParams;
pub use cost::CostParams;
pub use goal::GoalParams;
pub use goal_angle::GoalAngleParams;
pub use obstacles::ObstaclesParams;
pub use path_align::PathAlignParams;
pub use path_angle::{PathAngleMode, PathAngleParams};
pub use path_follow::PathFollowParams;
pub use prefer_forward::PreferForwardParams;
pub use twirling::TwirlingParams;
pub use velocity_deadband::VelocityDeadbandParams;

use super::lanes::{Lanes, groups, groups_mut};
use super::params::MppiParams;
use super::rollout::Rollout;
use super::scene::{Scene, Verdict};

/// Judges a batch of trajectories.
pub(crate) trait Critic: std::fmt::Debug + Send {
    /// Adds its costs.
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict);
}

/// Makes a critic; nothing where the parameters switch it off.
type Maker = fn(&MppiParams) -> Option<Box<dyn Critic>>;

/// What is known of a critic without making it.
#[derive(Debug, Clone, Copy)]
pub struct CriticSheet {
    /// Nav2's name of it.
    pub name: &'static str,
    /// One sentence for people.
    pub about: &'static str,
    make: Maker,
}

impl PartialEq for CriticSheet {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Every critic.
pub const CATALOG: &[CriticSheet] = &[
    CriticSheet {
        name: "ConstraintCritic",
        about: "speeds beyond the limits, and turns tighter than a car can",
        make: constraint::make,
    },
    CriticSheet { name: "CostCritic", about: "cells of the costmap, and collisions", make: cost::make },
    CriticSheet {
        name: "ObstaclesCritic",
        about: "distance to obstacles as the inflation tells it, and collisions",
        make: obstacles::make,
    },
    CriticSheet { name: "GoalCritic", about: "distance to the goal, near to it", make: goal::make },
    CriticSheet { name: "GoalAngleCritic", about: "heading off that of the goal, near to it", make: goal_angle::make },
    CriticSheet { name: "PathAlignCritic", about: "distance to the plan all along", make: path_align::make },
    CriticSheet {
        name: "PathFollowCritic",
        about: "distance of the end to a point ahead on the plan",
        make: path_follow::make,
    },
    CriticSheet {
        name: "PathAngleCritic",
        about: "heading at the end off the way to a point ahead on the plan",
        make: path_angle::make,
    },
    CriticSheet { name: "PreferForwardCritic", about: "driving backward", make: prefer_forward::make },
    CriticSheet { name: "TwirlingCritic", about: "turning far from the goal", make: twirling::make },
    CriticSheet {
        name: "VelocityDeadbandCritic",
        about: "speeds that the base does not carry out because they are too small",
        make: velocity_deadband::make,
    },
];

/// The critic of this name.
#[must_use]
pub fn named(name: &str) -> Option<&'static CriticSheet> {
    CATALOG.iter().find(|sheet| sheet.name == name)
}

impl CriticSheet {
    /// The critic, unless the parameters switch it off.
    pub(crate) fn critic(&self, params: &MppiParams) -> Option<Box<dyn Critic>> {
        (self.make)(params)
    }
}

/// How a term becomes a cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Price {
    weight: f32,
    power: u32,
}

impl Price {
    pub(crate) fn new(weight: f64, power: u32) -> Self {
        Self { weight: weight as f32, power }
    }

    /// The same for a term of which this share counts.
    pub(crate) fn scaled(self, share: f32) -> Self {
        Self { weight: self.weight * share, ..self }
    }

    /// The cost of a term.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(self, term: Lanes<S>) -> Lanes<S> {
        (term * term.like(self.weight)).power(self.power)
    }

    /// Adds the costs of all terms.
    #[inline(always)]
    pub(crate) fn charge<S: Simd>(self, simd: S, costs: &mut [f32], terms: &[f32]) {
        for (cost, term) in groups_mut::<S>(costs).zip(groups(simd, terms)) {
            *cost = (Lanes::new(simd, *cost) + self.of(term)).raw;
        }
    }
}
