//! What follows a plan: Nav2's controllers, one behind the other's trait.

use socrates_model::{Point, Pose};

use crate::costmap::Costmap;

/// A velocity in the robot's own frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Forward, m/s.
    pub vx: f64,
    /// To the left, m/s; 0 unless the base is omnidirectional.
    pub vy: f64,
    /// Turning rate, counter-clockwise, rad/s.
    pub omega: f64,
}

/// One cycle of a controller.
#[derive(Debug, Clone, Copy)]
pub struct Following<'a> {
    /// Where the robot is.
    pub pose: Pose,
    /// How it moves.
    pub speed: Twist,
    /// The plan from the robot on, as far as the path handler lets it be seen; at least one pose.
    pub plan: &'a [Pose],
    /// End of the whole plan.
    pub goal: Pose,
    /// Costs round the robot.
    pub costmap: &'a Costmap,
    /// Outline of the robot in its own frame, m; empty for a disc, whose cost is read at its center alone.
    pub footprint: &'a [Point],
    /// Largest speed allowed now as a share of the controller's own, 0 to 1.
    pub speed_share: f64,
}

/// Why a controller has no command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoControl {
    /// Every command that it thought of leads into an obstacle.
    #[error("every command leads into an obstacle")]
    Collision,
    /// The plan is empty.
    #[error("the plan is empty")]
    NoPlan,
}

/// Follows a plan, one command per cycle of a fixed length.
pub trait Controller: std::fmt::Debug {
    /// The next command.
    ///
    /// # Errors
    /// [`NoControl`]; Nav2 calls it `NoValidControl` (106).
    fn command(&mut self, cycle: &Following<'_>) -> Result<Twist, NoControl>;

    /// Forgets what it did: a new goal.
    fn reset(&mut self);
}
