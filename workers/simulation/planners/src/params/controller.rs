//! `controller_server`: checkers, path handler, and the controller.

use super::mppi;
use super::section::{Range, Section};
use crate::mppi::MppiParams;
use crate::nav::{GoalParams, PathParams, ProgressParams};
use crate::rpp::RppParams;

/// `controller_server`.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerServer {
    /// Cycles per second, Hz, above 0. Default 20.
    pub controller_frequency: f64,
    /// How long the controller may have no command before the drive fails, s, at least 0; -1 for ever. Default 0.
    pub failure_tolerance: f64,
    /// Measured speeds below these count as 0: forward, to the left, m/s, turning, rad/s, at least 0. Default 0.0001 each.
    pub least_speeds: [f64; 3],
    /// The first of `progress_checker_plugins`.
    pub progress_checker: ProgressParams,
    /// The first of `goal_checker_plugins`. Default as in Nav2: a heading within 0.25 rad.
    pub goal_checker: GoalParams,
    /// The first of `path_handler_plugins`; Nav2 Humble has its keys in the controller's section. Default 2 m of the plan; Nav2 Humble
    /// 1.5.
    pub path_handler: PathParams,
    /// The first of `controller_plugins`.
    pub controller: ControllerSpec,
}

impl Default for ControllerServer {
    fn default() -> Self {
        Self {
            controller_frequency: 20.0,
            failure_tolerance: 0.0,
            least_speeds: [0.0001; 3],
            progress_checker: ProgressParams::default(),
            goal_checker: GoalParams { yaw_goal_tolerance: 0.25, ..GoalParams::default() },
            path_handler: PathParams { prune_distance: 2.0, ..PathParams::default() },
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
    Rpp(Box<RppParams>),
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
    let [x, y, theta] = &mut found.least_speeds;
    from.number("min_x_velocity_threshold", x, Range::AtLeast0);
    from.number("min_y_velocity_threshold", y, Range::AtLeast0);
    from.number("min_theta_velocity_threshold", theta, Range::AtLeast0);
    let progress = first(from, &["progress_checker_plugins", "progress_checker_plugin"], "progress_checker");
    found.progress_checker = from.section(&progress, progress_checker);
    let goal = first(from, &["goal_checker_plugins", "goal_checker_plugin"], "goal_checker");
    found.goal_checker = from.section(&goal, |section| goal_checker(section, found.goal_checker));
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
            RPP => ControllerSpec::Rpp(Box::new(rpp(section))),
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

fn progress_checker(from: &mut Section<'_>) -> ProgressParams {
    let mut found = ProgressParams::default();
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

fn goal_checker(from: &mut Section<'_>, mut found: GoalParams) -> GoalParams {
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

fn path_handler(from: &mut Section<'_>, into: &mut PathParams) {
    from.number("prune_distance", &mut into.prune_distance, Range::Above0);
    if from.has("max_robot_pose_search_dist") {
        let mut distance = 0.0;
        from.number("max_robot_pose_search_dist", &mut distance, Range::Above0);
        into.max_robot_pose_search_dist = (distance > 0.0).then_some(distance);
    }
    // Every plan here leads forward.
    from.idle_flag("enforce_path_inversion", false);
    from.skip(&["inversion_xy_tolerance", "inversion_yaw_tolerance"]);
}

/// Regulated Pure Pursuit, but for what it takes from other servers.
fn rpp(from: &mut Section<'_>) -> RppParams {
    from.skip(&["transform_tolerance", "max_robot_pose_search_dist", "interpolate_curvature_after_goal"]);
    let mut found = RppParams { use_velocity_scaled_lookahead_dist: false, ..RppParams::default() };
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
