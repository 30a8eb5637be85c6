//! Parameters that cannot be meant.

use super::params::{MotionModel, MppiParams};

/// A parameter out of its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{key}` is `{value}`; allowed: {allowed}")]
pub struct BadParam {
    /// Nav2's name of it, sections apart by points.
    pub key: &'static str,
    /// Whether it is a key of the controller server, not of MPPI's own section.
    pub of_server: bool,
    /// Its value.
    pub value: String,
    /// What may stand there.
    pub allowed: &'static str,
}

/// Every parameter out of its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
pub struct BadParams(pub Vec<BadParam>);

/// Most trajectories, and most steps: beyond that a cycle takes seconds and gigabytes.
const MOST_SAMPLES: usize = 1_000_000;
const MOST_STEPS: usize = 10_000;
/// Most samples times steps.
const MOST_CELLS: usize = 50_000_000;
/// Longest delay, steps.
const MOST_DELAY: f64 = 1000.0;

/// Collects what is out of its range.
#[derive(Default)]
struct Found(Vec<BadParam>);

impl Found {
    fn check(&mut self, key: &'static str, value: impl ToString, allowed: &'static str, good: bool) {
        if !good {
            self.0.push(BadParam { key, of_server: false, value: value.to_string(), allowed });
        }
    }

    fn above_0(&mut self, key: &'static str, value: f64) {
        self.check(key, value, "a finite number above 0", value.is_finite() && value > 0.0);
    }

    fn at_least_0(&mut self, key: &'static str, value: f64) {
        self.check(key, value, "a finite number of at least 0", value.is_finite() && value >= 0.0);
    }

    fn below_0(&mut self, key: &'static str, value: f64) {
        self.check(key, value, "a finite number below 0", value.is_finite() && value < 0.0);
    }

    fn finite(&mut self, key: &'static str, value: f64) {
        self.check(key, value, "a finite number", value.is_finite());
    }

    fn at_least_1(&mut self, key: &'static str, value: usize) {
        self.check(key, value, "a whole number of at least 1", value >= 1);
    }
}

impl MppiParams {
    /// Says what is out of its range.
    ///
    /// # Errors
    /// [`BadParams`] with all of it.
    pub fn check(&self) -> Result<(), BadParams> {
        let mut found = Found::default();
        self.check_sampling(&mut found);
        self.check_motion(&mut found);
        self.check_critics(&mut found);
        if found.0.is_empty() { Ok(()) } else { Err(BadParams(found.0)) }
    }

    fn check_sampling(&self, found: &mut Found) {
        let (batch, steps) = (self.batch_size, self.time_steps);
        found.check("batch_size", batch, "1 to 1000000", (1..=MOST_SAMPLES).contains(&batch));
        found.check("time_steps", steps, "2 to 10000", (2..=MOST_STEPS).contains(&steps));
        let cells = batch.saturating_mul(steps);
        if batch <= MOST_SAMPLES && steps <= MOST_STEPS {
            found.check("batch_size", batch, "at most 50000000 / time_steps", cells <= MOST_CELLS);
        }
        found.at_least_1("iteration_count", self.iteration_count);
        found.above_0("model_dt", self.model_dt);
        self.check_frequency(found);
        found.above_0("vx_std", self.vx_std);
        found.above_0("vy_std", self.vy_std);
        found.at_least_0("wz_std", self.wz_std);
        found.above_0("temperature", self.temperature);
        found.at_least_0("gamma", self.gamma);
        found.at_least_0("reset_period", self.reset_period);
    }

    fn check_frequency(&self, found: &mut Found) {
        let before = found.0.len();
        let frequency = self.controller_frequency;
        found.above_0("controller_frequency", frequency);
        if self.model_dt > 0.0 && frequency > 0.0 {
            let slow = self.period_s() > self.model_dt + 1e-6;
            found.check("controller_frequency", frequency, "at least 1 / model_dt", !slow);
        }
        found.0.iter_mut().skip(before).for_each(|bad| bad.of_server = true);
    }

    fn check_motion(&self, found: &mut Found) {
        found.above_0("vx_max", self.vx_max);
        let back = self.vx_min;
        found.check("vx_min", back, "a finite number of at most 0", back.is_finite() && back <= 0.0);
        found.at_least_0("vy_max", self.vy_max);
        found.above_0("wz_max", self.wz_max);
        found.above_0("ax_max", self.ax_max);
        found.below_0("ax_min", self.ax_min);
        found.above_0("ay_max", self.ay_max);
        found.below_0("ay_min", self.ay_min);
        found.above_0("az_max", self.az_max);
        let delays = [
            ("model_delay_vx", self.model_delay_vx),
            ("model_delay_vy", self.model_delay_vy),
            ("model_delay_wz", self.model_delay_wz),
        ];
        for (key, delay) in delays {
            let most = MOST_DELAY * self.model_dt.abs();
            found.check(key, delay, "0 to 1000 times model_dt", (0.0..=most).contains(&delay));
        }
        if let MotionModel::Ackermann { min_turning_r } = self.motion_model {
            found.above_0("AckermannConstraints.min_turning_r", min_turning_r);
        }
        found.above_0(
            "TrajectoryValidator.collision_lookahead_time",
            self.trajectory_validator.collision_lookahead_time,
        );
        let around = &self.surroundings;
        found.at_least_0("inscribed_radius", around.inscribed_radius);
        found.at_least_0("circumscribed_radius", around.circumscribed_radius);
        found.above_0("cost_scaling_factor", around.cost_scaling_factor);
        found.at_least_0("inflation_radius", around.inflation_radius);
        found.at_least_0("xy_goal_tolerance", around.xy_goal_tolerance);
    }

    fn check_critics(&self, found: &mut Found) {
        let powers = [
            ("ConstraintCritic.cost_power", self.constraint_critic.cost_power),
            ("CostCritic.cost_power", self.cost_critic.cost_power),
            ("ObstaclesCritic.cost_power", self.obstacles_critic.cost_power),
            ("GoalCritic.cost_power", self.goal_critic.cost_power),
            ("GoalAngleCritic.cost_power", self.goal_angle_critic.cost_power),
            ("PathAlignCritic.cost_power", self.path_align_critic.cost_power),
            ("PathFollowCritic.cost_power", self.path_follow_critic.cost_power),
            ("PathAngleCritic.cost_power", self.path_angle_critic.cost_power),
            ("PreferForwardCritic.cost_power", self.prefer_forward_critic.cost_power),
            ("TwirlingCritic.cost_power", self.twirling_critic.cost_power),
            ("VelocityDeadbandCritic.cost_power", self.velocity_deadband_critic.cost_power),
        ];
        for (key, power) in powers {
            found.check(key, power, "1 to 16", (1..=16).contains(&power));
        }
        let numbers = [
            ("ConstraintCritic.cost_weight", self.constraint_critic.cost_weight),
            ("CostCritic.cost_weight", self.cost_critic.cost_weight),
            ("CostCritic.critical_cost", self.cost_critic.critical_cost),
            ("CostCritic.collision_cost", self.cost_critic.collision_cost),
            ("CostCritic.near_goal_distance", self.cost_critic.near_goal_distance),
            ("ObstaclesCritic.critical_weight", self.obstacles_critic.critical_weight),
            ("ObstaclesCritic.repulsion_weight", self.obstacles_critic.repulsion_weight),
            ("ObstaclesCritic.collision_cost", self.obstacles_critic.collision_cost),
            ("ObstaclesCritic.collision_margin_distance", self.obstacles_critic.collision_margin_distance),
            ("ObstaclesCritic.near_goal_distance", self.obstacles_critic.near_goal_distance),
            ("GoalCritic.cost_weight", self.goal_critic.cost_weight),
            ("GoalCritic.threshold_to_consider", self.goal_critic.threshold_to_consider),
            ("GoalAngleCritic.cost_weight", self.goal_angle_critic.cost_weight),
            ("GoalAngleCritic.threshold_to_consider", self.goal_angle_critic.threshold_to_consider),
            ("PathAlignCritic.cost_weight", self.path_align_critic.cost_weight),
            ("PathAlignCritic.threshold_to_consider", self.path_align_critic.threshold_to_consider),
            ("PathAlignCritic.max_path_occupancy_ratio", self.path_align_critic.max_path_occupancy_ratio),
            ("PathFollowCritic.cost_weight", self.path_follow_critic.cost_weight),
            ("PathFollowCritic.threshold_to_consider", self.path_follow_critic.threshold_to_consider),
            ("PathAngleCritic.cost_weight", self.path_angle_critic.cost_weight),
            ("PathAngleCritic.threshold_to_consider", self.path_angle_critic.threshold_to_consider),
            ("PathAngleCritic.max_angle_to_furthest", self.path_angle_critic.max_angle_to_furthest),
            ("PreferForwardCritic.cost_weight", self.prefer_forward_critic.cost_weight),
            ("PreferForwardCritic.threshold_to_consider", self.prefer_forward_critic.threshold_to_consider),
            ("TwirlingCritic.cost_weight", self.twirling_critic.cost_weight),
            ("VelocityDeadbandCritic.cost_weight", self.velocity_deadband_critic.cost_weight),
        ];
        for (key, number) in numbers {
            found.at_least_0(key, number);
        }
        for speed in self.velocity_deadband_critic.deadband_velocities {
            found.finite("VelocityDeadbandCritic.deadband_velocities", speed);
        }
        found.at_least_1("CostCritic.trajectory_point_step", self.cost_critic.trajectory_point_step);
        found.at_least_1("PathAlignCritic.trajectory_point_step", self.path_align_critic.trajectory_point_step);
    }
}
