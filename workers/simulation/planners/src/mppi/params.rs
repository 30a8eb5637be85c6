//! Parameters of the controller, by Nav2's names.

use super::critics::{
    ConstraintParams, CostParams, CriticSheet, GoalAngleParams, GoalParams, ObstaclesParams, PathAlignParams,
    PathAngleParams, PathFollowParams, PreferForwardParams, TwirlingParams, VelocityDeadbandParams, named,
};
use crate::costmap::INSCRIBED;

/// How the base moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum MotionModel {
    /// Two driven sides: forward and turning.
    #[default]
    DiffDrive,
    /// Every direction.
    Omni,
    /// A car.
    Ackermann {
        /// Smallest turning radius, m, above 0; Nav2's default is 0.2.
        min_turning_r: f64,
    },
}

/// Order of the polynomial that smooths commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SgfOrder {
    /// A mean of nine.
    One,
    /// A parabola through nine.
    #[default]
    Two,
}

/// What looks at the chosen trajectory before its command is sent; Nav2 Humble has none.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryValidatorParams {
    /// The trajectory has to be free for so long, s, above 0. Default 2.
    pub collision_lookahead_time: f64,
    /// Whether the outline of the robot is looked at, where it has one. Default false.
    pub consider_footprint: bool,
}

impl Default for TrajectoryValidatorParams {
    fn default() -> Self {
        Self { collision_lookahead_time: 2.0, consider_footprint: false }
    }
}

/// What Nav2's controller asks other servers for.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings {
    /// Whether unknown cells are in the map, `track_unknown_space`. Default false: then they are collisions.
    pub track_unknown_space: bool,
    /// Distance from the robot's center to its nearest edge, m. Default 0.22.
    pub inscribed_radius: f64,
    /// Distance from the robot's center to its farthest corner, m. Default 0.22.
    pub circumscribed_radius: f64,
    /// Inflation of the costmap: loss with distance, 1/m. Default 3.
    pub cost_scaling_factor: f64,
    /// Inflation of the costmap: where it ends, m. Default 0.7.
    pub inflation_radius: f64,
    /// Tolerance of the goal checker, m. Default 0.25.
    pub xy_goal_tolerance: f64,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self {
            track_unknown_space: false,
            inscribed_radius: 0.22,
            circumscribed_radius: 0.22,
            cost_scaling_factor: 3.0,
            inflation_radius: 0.7,
            xy_goal_tolerance: 0.25,
        }
    }
}

impl Surroundings {
    /// Cost of a cell so far from an obstacle that no corner of the robot reaches it: trunc(252 * exp(-s * (d - r_in))); 0 beyond the
    /// inflation.
    pub(crate) fn circumscribed_cost(&self) -> u8 {
        let distance = self.circumscribed_radius;
        if distance > self.inflation_radius {
            return 0;
        }
        let beyond = (distance - self.inscribed_radius).max(0.0);
        (f64::from(INSCRIBED - 1) * libm::exp(-self.cost_scaling_factor * beyond)) as u8
    }
}

/// Parameters of [`super::Mppi`]. The default is that of Nav2's main branch.
#[derive(Debug, Clone, PartialEq)]
pub struct MppiParams {
    /// Whether the controller behaves as that of Nav2 Humble: speeds follow commands at once, commands are smoothed once at the
    /// end, what is left of the plan is taken straight, the farthest point may be farther along the plan than a trajectory is long,
    /// there are no acceleration limits and no validator, and a pause resets it. Default false.
    pub humble: bool,
    /// Cycles per second, Hz, of the controller server: at least 1 / `model_dt`. Default 20. Only at exactly 1 / `model_dt` the
    /// sequence moves on by a step each cycle.
    pub controller_frequency: f64,
    /// Trajectories, 1 to 1 000 000. Default 1000.
    pub batch_size: usize,
    /// Steps of each, 2 to 10 000. Default 56.
    pub time_steps: usize,
    /// Time of a step, s, above 0. Default 0.05.
    pub model_dt: f64,
    /// Times that a cycle samples and improves, at least 1. Default 1.
    pub iteration_count: usize,
    /// Times that a failed cycle begins anew. Default 1.
    pub retry_attempt_limit: usize,
    /// Standard deviation of the noise forward, m/s, above 0. Default 0.2.
    pub vx_std: f64,
    /// Standard deviation of the noise to the left, m/s, above 0. Default 0.2.
    pub vy_std: f64,
    /// Standard deviation of the noise of turning, rad/s, at least 0. Default 0.4.
    pub wz_std: f64,
    /// Largest speed forward, m/s, above 0. Default 0.5.
    pub vx_max: f64,
    /// Largest speed backward, m/s, at most 0. Default -0.35.
    pub vx_min: f64,
    /// Largest speed to either side, m/s, at least 0. Default 0.5.
    pub vy_max: f64,
    /// Largest turning rate, rad/s, above 0. Default 1.9.
    pub wz_max: f64,
    /// Largest acceleration, m/s², above 0. Default 3.
    pub ax_max: f64,
    /// Strongest braking, m/s², below 0. Default -3.
    pub ax_min: f64,
    /// Largest acceleration to a side, m/s², above 0. Default 3.
    pub ay_max: f64,
    /// Strongest braking to a side, m/s², below 0. Default -3.
    pub ay_min: f64,
    /// Largest angular acceleration, rad/s², above 0. Default 3.5.
    pub az_max: f64,
    /// Time until the base obeys forward, s, at least 0. Default 0.
    pub model_delay_vx: f64,
    /// Time until the base obeys to the left, s, at least 0. Default 0.
    pub model_delay_vy: f64,
    /// Time until the base obeys in turning, s, at least 0. Default 0.
    pub model_delay_wz: f64,
    /// Costs per factor e of weight, above 0. Default 0.3. Smaller: the best trajectories alone count.
    pub temperature: f64,
    /// Weight of leaving the last sequence, at least 0. Default 0.015.
    pub gamma: f64,
    /// Whether every cycle draws its own noise. Default false: it is drawn at a reset.
    pub regenerate_noises: bool,
    /// Whether the last command is taken for the speed now. Default false.
    pub open_loop: bool,
    /// Whether sampled commands become what the base can do before they are averaged. Default false.
    pub clamp_raw_controls: bool,
    /// Order of the smoothing. Default 2.
    pub sgf_order: SgfOrder,
    /// Pause after which Nav2 Humble begins anew, s. Default 1.
    pub reset_period: f64,
    /// How the base moves. Default `diff_drive`.
    pub motion_model: MotionModel,
    /// `TrajectoryValidator`.
    pub trajectory_validator: TrajectoryValidatorParams,
    /// The critics in the order in which they judge. Default: the eight that Nav2 brings up.
    pub critics: Vec<&'static CriticSheet>,
    /// `ConstraintCritic`.
    pub constraint_critic: ConstraintParams,
    /// `CostCritic`.
    pub cost_critic: CostParams,
    /// `ObstaclesCritic`.
    pub obstacles_critic: ObstaclesParams,
    /// `GoalCritic`.
    pub goal_critic: GoalParams,
    /// `GoalAngleCritic`.
    pub goal_angle_critic: GoalAngleParams,
    /// `PathAlignCritic`.
    pub path_align_critic: PathAlignParams,
    /// `PathFollowCritic`.
    pub path_follow_critic: PathFollowParams,
    /// `PathAngleCritic`.
    pub path_angle_critic: PathAngleParams,
    /// `PreferForwardCritic`.
    pub prefer_forward_critic: PreferForwardParams,
    /// `TwirlingCritic`.
    pub twirling_critic: TwirlingParams,
    /// `VelocityDeadbandCritic`.
    pub velocity_deadband_critic: VelocityDeadbandParams,
    /// What other servers say.
    pub surroundings: Surroundings,
}

/// The critics that Nav2 brings up, in its order.
pub const BRINGUP_CRITICS: [&str; 8] = [
    "ConstraintCritic",
    "CostCritic",
    "GoalCritic",
    "GoalAngleCritic",
    "PathAlignCritic",
    "PathFollowCritic",
    "PathAngleCritic",
    "PreferForwardCritic",
];

impl Default for MppiParams {
    fn default() -> Self {
        Self {
            humble: false,
            controller_frequency: 20.0,
            batch_size: 1000,
            time_steps: 56,
            model_dt: 0.05,
            iteration_count: 1,
            retry_attempt_limit: 1,
            vx_std: 0.2,
            vy_std: 0.2,
            wz_std: 0.4,
            vx_max: 0.5,
            vx_min: -0.35,
            vy_max: 0.5,
            wz_max: 1.9,
            ax_max: 3.0,
            ax_min: -3.0,
            ay_max: 3.0,
            ay_min: -3.0,
            az_max: 3.5,
            model_delay_vx: 0.0,
            model_delay_vy: 0.0,
            model_delay_wz: 0.0,
            temperature: 0.3,
            gamma: 0.015,
            regenerate_noises: false,
            open_loop: false,
            clamp_raw_controls: false,
            sgf_order: SgfOrder::Two,
            reset_period: 1.0,
            motion_model: MotionModel::DiffDrive,
            trajectory_validator: TrajectoryValidatorParams::default(),
            critics: BRINGUP_CRITICS.into_iter().filter_map(named).collect(),
            constraint_critic: ConstraintParams::default(),
            cost_critic: CostParams::default(),
            obstacles_critic: ObstaclesParams::default(),
            goal_critic: GoalParams::default(),
            goal_angle_critic: GoalAngleParams::default(),
            path_align_critic: PathAlignParams::default(),
            path_follow_critic: PathFollowParams::default(),
            path_angle_critic: PathAngleParams::default(),
            prefer_forward_critic: PreferForwardParams::default(),
            twirling_critic: TwirlingParams::default(),
            velocity_deadband_critic: VelocityDeadbandParams::default(),
            surroundings: Surroundings::default(),
        }
    }
}

impl MppiParams {
    /// The default with the values with which Nav2 brings up its robot: 2000 trajectories, the goal near within 1 m, and other weights
    /// of `PathAlignCritic`, `PathFollowCritic` and `PathAngleCritic`.
    #[must_use]
    pub fn bringup() -> Self {
        let base = Self::default();
        Self {
            batch_size: 2000,
            cost_critic: CostParams { near_goal_distance: 1.0, ..base.cost_critic },
            path_align_critic: PathAlignParams {
                cost_weight: 14.0,
                max_path_occupancy_ratio: 0.05,
                ..base.path_align_critic
            },
            path_follow_critic: PathFollowParams { offset_from_furthest: 5, ..base.path_follow_critic },
            path_angle_critic: PathAngleParams {
                cost_weight: 2.0,
                max_angle_to_furthest: 1.0,
                ..base.path_angle_critic
            },
            ..base
        }
    }

    /// Whether the base moves sideways.
    pub(crate) const fn holonomic(&self) -> bool {
        matches!(self.motion_model, MotionModel::Omni)
    }

    /// Time of a cycle, s.
    pub(crate) fn period_s(&self) -> f64 {
        1.0 / self.controller_frequency
    }
}
