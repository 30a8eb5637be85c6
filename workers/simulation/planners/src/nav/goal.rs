//! Whether the goal is reached.

use std::f64::consts::TAU;

use socrates_model::Pose;
use socrates_model::geometry::wrap_angle;

use crate::controller::Twist;

/// Parameters of the goal checker (Nav2's `SimpleGoalChecker` and `StoppedGoalChecker`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoalParams {
    /// So near is there, m; default 0.25.
    pub xy_goal_tolerance: f64,
    /// A heading so near to the goal's is right, rad; default a whole turn, as in the paper's setup: any heading (Nav2 0.25).
    pub yaw_goal_tolerance: f64,
    /// Whether a robot that was there stays there while it turns; default true.
    pub stateful: bool,
    /// A robot is not there while more than this is left of its path, m; default 1.
    pub path_length_tolerance: f64,
    /// Speeds at most at which the robot counts as stopped, m/s and rad/s; default none: it need not stop.
    pub stopped_velocity: Option<[f64; 2]>,
}

impl Default for GoalParams {
    fn default() -> Self {
        Self {
            xy_goal_tolerance: 0.25,
            yaw_goal_tolerance: TAU,
            stateful: true,
            path_length_tolerance: 1.0,
            stopped_velocity: None,
        }
    }
}

/// The goal checker.
#[derive(Debug, Default)]
pub struct GoalChecker {
    params: GoalParams,
    there: bool,
}

impl GoalChecker {
    /// A checker for a new goal.
    #[must_use]
    pub const fn new(params: &GoalParams) -> Self {
        Self { params: *params, there: false }
    }

    /// A new goal.
    pub const fn reset(&mut self) {
        self.there = false;
    }

    /// Whether the goal is reached, with so much of the path left, m.
    pub fn reached(&mut self, pose: &Pose, speed: &Twist, goal: &Pose, left_m: f64) -> bool {
        if !(self.there && self.params.stateful) {
            let near = (goal.point() - pose.point()).norm() <= self.params.xy_goal_tolerance;
            self.there = near && left_m <= self.params.path_length_tolerance;
        }
        let stopped = self
            .params
            .stopped_velocity
            .is_none_or(|[moving, turning]| libm::hypot(speed.vx, speed.vy) <= moving && speed.omega.abs() <= turning);
        self.there && stopped && wrap_angle(goal.yaw - pose.yaw).abs() <= self.params.yaw_goal_tolerance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STANDS: Twist = Twist { vx: 0.0, vy: 0.0, omega: 0.0 };

    #[test]
    fn a_robot_once_there_may_turn_where_it_is() {
        let params = GoalParams { yaw_goal_tolerance: 0.25, ..GoalParams::default() };
        let goal = Pose::new(1.0, 0.0, 0.0);
        let mut checker = GoalChecker::new(&params);
        assert!(!checker.reached(&Pose::new(0.8, 0.0, 1.0), &STANDS, &goal, 0.2));
        assert!(
            checker.reached(&Pose::new(0.7, 0.0, 0.2), &STANDS, &goal, 0.3),
            "pushed out of the tolerance it is still there"
        );
        checker.reset();
        assert!(!checker.reached(&Pose::new(0.7, 0.0, 0.2), &STANDS, &goal, 0.3));
        let mut forgetful = GoalChecker::new(&GoalParams { stateful: false, ..params });
        assert!(!forgetful.reached(&Pose::new(0.8, 0.0, 1.0), &STANDS, &goal, 0.2));
        assert!(!forgetful.reached(&Pose::new(0.7, 0.0, 0.2), &STANDS, &goal, 0.3));
    }

    #[test]
    fn a_goal_passed_on_the_way_round_is_not_reached_yet() {
        let goal = Pose::new(1.0, 0.0, 0.0);
        assert!(!GoalChecker::default().reached(&goal, &STANDS, &goal, 4.0));
        assert!(GoalChecker::default().reached(&Pose::new(1.1, 0.1, 3.0), &STANDS, &goal, 0.5));
    }

    #[test]
    fn a_robot_that_has_to_stop_is_there_when_it_has() {
        let params = GoalParams { stopped_velocity: Some([0.1, 0.2]), ..GoalParams::default() };
        let goal = Pose::new(1.0, 0.0, 0.0);
        let mut checker = GoalChecker::new(&params);
        assert!(!checker.reached(&goal, &Twist { vx: 0.3, ..STANDS }, &goal, 0.0));
        assert!(!checker.reached(&goal, &Twist { omega: -0.3, ..STANDS }, &goal, 0.0));
        assert!(checker.reached(&goal, &Twist { vx: 0.1, vy: 0.0, omega: 0.2 }, &goal, 0.0));
    }
}
