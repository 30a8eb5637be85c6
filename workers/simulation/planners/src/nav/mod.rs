//! Nav2's navigation without ROS: from costmaps, a planner and a controller to a [`RobotDriver`](socrates_model::RobotDriver).
//!
//! ```text
//! waypoints ─► global costmap ─► NavFn ─► path ─► part ahead ─► controller ─► smoother ─► Command
//!                   (recovery: clear, spin, wait, back up ◄── no plan, no command, no progress)
//! ```
//!
//! Modules in reading order: the parameters of all of it (params), what can go wrong (error), the path as far as it is seen
//! (path), the checkers (goal, progress), the list of waypoints (waypoints), limits of speed (smoother), collisions
//! (collision), what is done when stuck (recovery), and the whole (stack).

mod collision;
mod error;
mod goal;
mod params;
mod path;
mod progress;
mod recovery;
mod smoother;
mod stack;
mod waypoints;

#[cfg(test)]
mod tests;

pub use collision::touches;
pub use error::{ErrorLog, NavError};
pub use goal::{GoalChecker, GoalParams};
pub use params::StackParams;
pub use path::{PathHandler, PathParams};
pub use progress::{ProgressChecker, ProgressParams};
pub use recovery::{Recovery, RecoveryParams};
pub use smoother::{SmootherParams, VelocitySmoother};
pub use stack::Stack;
pub use waypoints::{WaypointFollower, WaypointParams};
