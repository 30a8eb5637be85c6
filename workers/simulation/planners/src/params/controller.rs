//! `controller_server`: checkers, path handler, and the controller.

use super::mppi;
use super::section::{Range, Section};
use crate::mppi::MppiParams;

/// `controller_server`.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerServer {
    /// Cycles per second, Hz, above 0. Default 20.
    pub controller_frequency: f64,
    /// How long the controller may have no command before the drive fails, s, at least 0; -1 for ever. Default 0.
    pub failure_tolerance: f64,
    /// Measured speeds below this count as 0, m/s, at least 0. Default 0.0001.
    pub min_x_velocity_threshold: f64,
    /// The same to the left, m/s. Default 0.0001.
    pub min_y_velocity_threshold: f64,
    /// The same in turning, rad/s. Default 0.0001.
    pub min_theta_velocity_threshold: f64,
    /// The first of `progress_checker_plugins`.
    pub progress_checker: ProgressChecker,
    /// The first of `goal_checker_plugins`.
    pub goal_checker: GoalChecker,
    /// The first of `path_handler_plugins`; Nav2 Humble has its keys in the controller's section.
    pub path_handler: PathHandler,
    /// The first of `controller_plugins`.
    pub controller: ControllerSpec,
}

impl Default for ControllerServer {
    fn default() -> Self {
        Self {
            controller_frequency: 20.0,
            failure_tolerance: 0.0,
            min_x_velocity_threshold: 0.0001,
            min_y_velocity_threshold: 0.0001,
            min_theta_velocity_threshold: 0.0001,
            progress_checker: ProgressChecker::default(),
            goal_checker: GoalChecker::default(),
            path_handler: PathHandler::default(),
            controller: ControllerSpec::Mppi(Box::default()),
        }
    }
}

/// A controller and its parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum ControllerSpec {
    /// `nav2_mppi_controller::MPPIController`.
    Mppi(Box<MppiParams>),
    /// `nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController`.
    Rpp(RppSpec),
}

/// `nav2_controller::SimpleProgressChecker` and `nav2_controller::PoseProgressChecker`.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgressChecker {
    /// The robot has to move so far, m, above 0. Default 0.5.
    pub required_movement_radius: f64,
    /// Or to turn so far, rad, above 0; none for the simple one. Default none.
    pub required_movement_angle: Option<f64>,
    /// Within this time, s, above 0. Default 10.
    pub movement_time_allowance: f64,
}

impl Default for ProgressChecker {
    fn default() -> Self {
        Self { required_movement_radius: 0.5, required_movement_angle: None, movement_time_allowance: 10.0 }
    }
}

/// `nav2_controller::SimpleGoalChecker` and `nav2_controller::StoppedGoalChecker`.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalChecker {
    /// Distance to the goal, m, above 0. Default 0.25.
    pub xy_goal_tolerance: f64,
    /// Angle to the goal's heading, rad, above 0; 2 pi and more for any. Default 0.25.
    pub yaw_goal_tolerance: f64,
    /// Whether a robot that was near enough stays so. Default true.
    pub stateful: bool,
    /// It is looked at only where at most so much of the plan is left, m, above 0. Default 1.
    pub path_length_tolerance: f64,
    /// Speeds at which the robot counts as stopped: m/s, rad/s; none for the simple one. Default none.
    pub stopped_velocity: Option<[f64; 2]>,
}

impl Default for GoalChecker {
    fn default() -> Self {
        Self {
            xy_goal_tolerance: 0.25,
            yaw_goal_tolerance: 0.25,
            stateful: true,
            path_length_tolerance: 1.0,
            stopped_velocity: None,
        }
    }
}

/// How much of the plan a controller is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct PathHandler {
    /// Length of the plan that is shown, m, above 0. Default 2; Nav2 Humble 1.5.
    pub prune_distance: f64,
    /// The robot is looked for so far along the plan, m, above 0; none for half of the local costmap. Default none.
    pub max_robot_pose_search_dist: Option<f64>,
    /// Whether the plan ends at the first change of direction. Default false.
    pub enforce_path_inversion: bool,
    /// Distance at which a change of direction is reached, m, above 0. Default 0.2.
    pub inversion_xy_tolerance: f64,
    /// Angle at which it is reached, rad, above 0. Default 0.4.
    pub inversion_yaw_tolerance: f64,
}

impl Default for PathHandler {
    fn default() -> Self {
        Self {
            prune_distance: 2.0,
            max_robot_pose_search_dist: None,
            enforce_path_inversion: false,
            inversion_xy_tolerance: 0.2,
            inversion_yaw_tolerance: 0.4,
        }
    }
}

/// Parameters of regulated pure pursuit.
#[derive(Debug, Clone, PartialEq)]
pub struct RppSpec {
    /// Speed, m/s, above 0. Default 0.5.
    pub desired_linear_vel: f64,
    /// Distance of the point that is steered at, m, above 0. Default 0.6.
    pub lookahead_dist: f64,
    /// Least such distance, m, above 0. Default 0.3.
    pub min_lookahead_dist: f64,
    /// Largest such distance, m, above 0. Default 0.9.
    pub max_lookahead_dist: f64,
    /// Distance as a time at the present speed, s, above 0. Default 1.5.
    pub lookahead_time: f64,
    /// Whether the distance depends on the speed. Default false.
    pub use_velocity_scaled_lookahead_dist: bool,
    /// Whether the robot turns on the spot where it looks far off. Default true.
    pub use_rotate_to_heading: bool,
    /// Angle beyond which it does, rad, above 0. Default 0.785.
    pub rotate_to_heading_min_angle: f64,
    /// How fast it turns then, rad/s, above 0. Default 1.8.
    pub rotate_to_heading_angular_vel: f64,
    /// Largest acceleration, m/s², above 0. Default 2.5.
    pub max_linear_accel: f64,
    /// Largest angular acceleration, rad/s², above 0. Default 3.2.
    pub max_angular_accel: f64,
    /// Least speed near the goal, m/s, above 0. Default 0.05.
    pub min_approach_linear_velocity: f64,
    /// Distance to the goal from which on it slows down, m, above 0. Default 0.6.
    pub approach_velocity_scaling_dist: f64,
    /// Whether it stops before obstacles. Default true.
    pub use_collision_detection: bool,
    /// Within this time, s, above 0. Default 1.
    pub max_allowed_time_to_collision_up_to_carrot: f64,
    /// Whether it slows down in curves. Default true.
    pub use_regulated_linear_velocity_scaling: bool,
    /// Of a smaller radius than this, m, above 0. Default 0.9.
    pub regulated_linear_scaling_min_radius: f64,
    /// Down to this speed, m/s, above 0. Default 0.25.
    pub regulated_linear_scaling_min_speed: f64,
    /// Whether it slows down beside obstacles. Default true.
    pub use_cost_regulated_linear_velocity_scaling: bool,
    /// Nearer than this, m, above 0. Default 0.6.
    pub cost_scaling_dist: f64,
    /// Share of the distance that the speed keeps, above 0. Default 1.
    pub cost_scaling_gain: f64,
    /// Loss of cost with distance in the local costmap, 1/m, above 0. Default 3.
    pub inflation_cost_scaling_factor: f64,
}

impl Default for RppSpec {
    fn default() -> Self {
        Self {
            desired_linear_vel: 0.5,
            lookahead_dist: 0.6,
            min_lookahead_dist: 0.3,
            max_lookahead_dist: 0.9,
            lookahead_time: 1.5,
            use_velocity_scaled_lookahead_dist: false,
            use_rotate_to_heading: true,
            rotate_to_heading_min_angle: 0.785,
            rotate_to_heading_angular_vel: 1.8,
            max_linear_accel: 2.5,
            max_angular_accel: 3.2,
            min_approach_linear_velocity: 0.05,
            approach_velocity_scaling_dist: 0.6,
            use_collision_detection: true,
            max_allowed_time_to_collision_up_to_carrot: 1.0,
            use_regulated_linear_velocity_scaling: true,
            regulated_linear_scaling_min_radius: 0.9,
            regulated_linear_scaling_min_speed: 0.25,
            use_cost_regulated_linear_velocity_scaling: true,
            cost_scaling_dist: 0.6,
            cost_scaling_gain: 1.0,
            inflation_cost_scaling_factor: 3.0,
        }
    }
}

/// Length of the plan that Nav2 Humble shows a controller, m.
const HUMBLE_PRUNE_M: f64 = 1.5;
const MPPI: &str = "nav2_mppi_controller::MPPIController";
const RPP: &str = "nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController";

/// Reads the server. What MPPI takes from other servers is filled in later.
pub(super) fn controller_server(from: &mut Section<'_>) -> ControllerServer {
    let mut found = ControllerServer::default();
    from.skip(&[
        "costmap_update_timeout",
        "use_realtime_priority",
        "speed_limit_topic",
        "odom_topic",
        "odom_duration",
        "publish_zero_velocity",
        "enable_stamped_cmd_vel",
    ]);
    from.number("controller_frequency", &mut found.controller_frequency, Range::Above0);
    from.number("failure_tolerance", &mut found.failure_tolerance, Range::Finite);
    from.number("min_x_velocity_threshold", &mut found.min_x_velocity_threshold, Range::AtLeast0);
    from.number("min_y_velocity_threshold", &mut found.min_y_velocity_threshold, Range::AtLeast0);
    from.number("min_theta_velocity_threshold", &mut found.min_theta_velocity_threshold, Range::AtLeast0);
    let progress = first(from, &["progress_checker_plugins", "progress_checker_plugin"], "progress_checker");
    found.progress_checker = from.section(&progress, progress_checker);
    let goal = first(from, &["goal_checker_plugins", "goal_checker_plugin"], "goal_checker");
    found.goal_checker = from.section(&goal, goal_checker);
    let mut pruned = false;
    let handler = first(from, &["path_handler_plugins"], "PathHandler");
    from.section(&handler, |section| {
        section.skip(&[
            "plugin",
            "enforce_path_rotation",
            "minimum_rotation_angle",
            "reject_unit_path",
            "transform_tolerance",
        ]);
        pruned |= section.has("prune_distance");
        path_handler(section, &mut found.path_handler);
    });
    let controller = first(from, &["controller_plugins"], "FollowPath");
    found.controller = from.section(&controller, |section| {
        // Nav2 Humble keeps them here.
        pruned |= section.has("prune_distance");
        path_handler(section, &mut found.path_handler);
        let plugin = section.text("plugin").unwrap_or_else(|| MPPI.to_owned());
        match plugin.as_str() {
            RPP => ControllerSpec::Rpp(rpp(section)),
            MPPI => ControllerSpec::Mppi(Box::new(mppi::read(section, found.controller_frequency))),
            _ => {
                section.refuse("plugin", plugin, format!("`{MPPI}`, `{RPP}`"));
                ControllerSpec::Mppi(Box::default())
            }
        }
    });
    if !pruned && matches!(&found.controller, ControllerSpec::Mppi(mppi) if mppi.humble) {
        found.path_handler.prune_distance = HUMBLE_PRUNE_M;
    }
    found
}

/// The first plugin that a list names.
fn first(from: &mut Section<'_>, lists: &[&str], default: &str) -> String {
    let mut name = None;
    for list in lists {
        let found = if list.ends_with('s') {
            from.texts(list).and_then(|names| names.into_iter().next())
        } else {
            from.text(list)
        };
        name = name.or(found);
    }
    name.unwrap_or_else(|| default.to_owned())
}

fn progress_checker(from: &mut Section<'_>) -> ProgressChecker {
    let mut found = ProgressChecker::default();
    let plugins = [("nav2_controller::SimpleProgressChecker", false), ("nav2_controller::PoseProgressChecker", true)];
    let mut turns = false;
    from.choice("plugin", &mut turns, &plugins);
    from.number("required_movement_radius", &mut found.required_movement_radius, Range::Above0);
    let mut angle = 0.5;
    from.number("required_movement_angle", &mut angle, Range::Above0);
    found.required_movement_angle = turns.then_some(angle);
    from.number("movement_time_allowance", &mut found.movement_time_allowance, Range::Above0);
    found
}

fn goal_checker(from: &mut Section<'_>) -> GoalChecker {
    let mut found = GoalChecker::default();
    let plugins = [("nav2_controller::SimpleGoalChecker", false), ("nav2_controller::StoppedGoalChecker", true)];
    let mut stops = false;
    from.choice("plugin", &mut stops, &plugins);
    from.skip(&["symmetric_yaw_tolerance"]);
    from.number("xy_goal_tolerance", &mut found.xy_goal_tolerance, Range::Above0);
    from.number("yaw_goal_tolerance", &mut found.yaw_goal_tolerance, Range::Above0);
    from.flag("stateful", &mut found.stateful);
    from.number("path_length_tolerance", &mut found.path_length_tolerance, Range::Above0);
    let mut stopped = [0.25; 2];
    let [speed, turning] = &mut stopped;
    from.number("trans_stopped_velocity", speed, Range::AtLeast0);
    from.number("rot_stopped_velocity", turning, Range::AtLeast0);
    found.stopped_velocity = stops.then_some(stopped);
    found
}

fn path_handler(from: &mut Section<'_>, into: &mut PathHandler) {
    from.number("prune_distance", &mut into.prune_distance, Range::Above0);
    if from.has("max_robot_pose_search_dist") {
        let mut distance = 0.0;
        from.number("max_robot_pose_search_dist", &mut distance, Range::Above0);
        into.max_robot_pose_search_dist = (distance > 0.0).then_some(distance);
    }
    from.flag("enforce_path_inversion", &mut into.enforce_path_inversion);
    from.number("inversion_xy_tolerance", &mut into.inversion_xy_tolerance, Range::Above0);
    from.number("inversion_yaw_tolerance", &mut into.inversion_yaw_tolerance, Range::Above0);
}

fn rpp(from: &mut Section<'_>) -> RppSpec {
    from.skip(&["transform_tolerance", "max_robot_pose_search_dist", "interpolate_curvature_after_goal"]);
    let mut found = RppSpec::default();
    for (key, into) in [
        ("desired_linear_vel", &mut found.desired_linear_vel),
        ("lookahead_dist", &mut found.lookahead_dist),
        ("min_lookahead_dist", &mut found.min_lookahead_dist),
        ("max_lookahead_dist", &mut found.max_lookahead_dist),
        ("lookahead_time", &mut found.lookahead_time),
        ("rotate_to_heading_min_angle", &mut found.rotate_to_heading_min_angle),
        ("rotate_to_heading_angular_vel", &mut found.rotate_to_heading_angular_vel),
        ("max_angular_accel", &mut found.max_angular_accel),
        ("min_approach_linear_velocity", &mut found.min_approach_linear_velocity),
        ("approach_velocity_scaling_dist", &mut found.approach_velocity_scaling_dist),
        ("max_allowed_time_to_collision_up_to_carrot", &mut found.max_allowed_time_to_collision_up_to_carrot),
        ("regulated_linear_scaling_min_radius", &mut found.regulated_linear_scaling_min_radius),
        ("regulated_linear_scaling_min_speed", &mut found.regulated_linear_scaling_min_speed),
        ("cost_scaling_dist", &mut found.cost_scaling_dist),
        ("cost_scaling_gain", &mut found.cost_scaling_gain),
        ("inflation_cost_scaling_factor", &mut found.inflation_cost_scaling_factor),
        ("max_linear_accel", &mut found.max_linear_accel),
    ] {
        from.number(key, into, Range::Above0);
    }
    for (key, into) in [
        ("use_velocity_scaled_lookahead_dist", &mut found.use_velocity_scaled_lookahead_dist),
        ("use_rotate_to_heading", &mut found.use_rotate_to_heading),
        ("use_collision_detection", &mut found.use_collision_detection),
        ("use_regulated_linear_velocity_scaling", &mut found.use_regulated_linear_velocity_scaling),
        ("use_cost_regulated_linear_velocity_scaling", &mut found.use_cost_regulated_linear_velocity_scaling),
    ] {
        from.flag(key, into);
    }
    found
}
