//! What can go wrong on the way, with Nav2's numbers.

use std::collections::BTreeMap;

use crate::controller::NoControl;
use crate::navfn::PlanError;

/// An error of navigation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
pub enum NavError {
    /// 203 to 208: no plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// 103: nothing is left of the plan ahead of the robot.
    #[error("the plan is empty")]
    InvalidPath,
    /// 105: the robot did not get on for too long.
    #[error("the robot did not get on")]
    FailedToMakeProgress,
    /// 106: the controller had no command for longer than is borne.
    #[error("the controller has no command")]
    NoValidControl,
    /// 9002: a waypoint was given up after its recoveries.
    #[error("a waypoint was given up")]
    GivenUp,
}

impl NavError {
    /// Nav2's number for it.
    #[must_use]
    pub const fn code(self) -> u16 {
        match self {
            Self::Plan(error) => error.code(),
            Self::InvalidPath => 103,
            Self::FailedToMakeProgress => 105,
            Self::NoValidControl => 106,
            Self::GivenUp => 9002,
        }
    }
}

impl From<NoControl> for NavError {
    fn from(reason: NoControl) -> Self {
        match reason {
            NoControl::Collision => Self::NoValidControl,
            NoControl::NoPlan => Self::InvalidPath,
        }
    }
}

/// The errors of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ErrorLog {
    last: Option<NavError>,
    counts: BTreeMap<NavError, u32>,
}

impl ErrorLog {
    /// Adds one.
    pub fn add(&mut self, error: NavError) {
        self.last = Some(error);
        *self.counts.entry(error).or_default() += 1;
    }

    /// The last one.
    #[must_use]
    pub const fn last(&self) -> Option<NavError> {
        self.last
    }

    /// How often each happened.
    #[must_use]
    pub const fn counts(&self) -> &BTreeMap<NavError, u32> {
        &self.counts
    }
}
