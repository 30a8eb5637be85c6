//! The other servers: planner, velocity smoother, behaviors, waypoints.

use super::section::{Range, Section};
use crate::navfn::NavFnParams;

/// `planner_server`.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannerServer {
    /// Plans per second that are expected, Hz, above 0. Default 20.
    pub expected_planner_frequency: f64,
    /// The planner.
    pub planner: NavFnParams,
}

impl Default for PlannerServer {
    fn default() -> Self {
        Self { expected_planner_frequency: 20.0, planner: NavFnParams::default() }
    }
}

/// `velocity_smoother`. Axes: forward and to the left, m/s, turning, rad/s.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocitySmoother {
    /// Commands per second, Hz, above 0. Default 20.
    pub smoothing_frequency: f64,
    /// Whether all axes are slowed down alike. Default false.
    pub scale_velocities: bool,
    /// Whether the last command is taken for the speed now, `feedback: OPEN_LOOP`. Default true; `CLOSED_LOOP` is false.
    pub open_loop: bool,
    /// Largest speeds. Default 0.5, 0, 2.5.
    pub max_velocity: [f64; 3],
    /// Least speeds. Default -0.5, 0, -2.5.
    pub min_velocity: [f64; 3],
    /// Largest accelerations, /s. Default 2.5, 0, 3.2.
    pub max_accel: [f64; 3],
    /// Largest decelerations, /s. Default -2.5, 0, -3.2.
    pub max_decel: [f64; 3],
    /// Smaller speeds become 0. Default 0, 0, 0.
    pub deadband_velocity: [f64; 3],
    /// Time without a command after which the robot stops, s, above 0. Default 1.
    pub velocity_timeout: f64,
}

impl Default for VelocitySmoother {
    fn default() -> Self {
        Self {
            smoothing_frequency: 20.0,
            scale_velocities: false,
            open_loop: true,
            max_velocity: [0.5, 0.0, 2.5],
            min_velocity: [-0.5, 0.0, -2.5],
            max_accel: [2.5, 0.0, 3.2],
            max_decel: [-2.5, 0.0, -3.2],
            deadband_velocity: [0.0; 3],
            velocity_timeout: 1.0,
        }
    }
}

/// `behavior_server`: what the robot does when it is stuck.
#[derive(Debug, Clone, PartialEq)]
pub struct BehaviorServer {
    /// Cycles per second, Hz, above 0. Default 10.
    pub cycle_frequency: f64,
    /// How far ahead collisions are looked for, s, at least 0. Default 2.
    pub simulate_ahead_time: f64,
    /// Largest turning rate of a spin, rad/s, above 0. Default 1.
    pub max_rotational_vel: f64,
    /// Least turning rate of a spin, rad/s, at least 0. Default 0.4.
    pub min_rotational_vel: f64,
    /// Angular acceleration of a spin, rad/s², above 0. Default 3.2.
    pub rotational_acc_lim: f64,
}

impl Default for BehaviorServer {
    fn default() -> Self {
        Self {
            cycle_frequency: 10.0,
            simulate_ahead_time: 2.0,
            max_rotational_vel: 1.0,
            min_rotational_vel: 0.4,
            rotational_acc_lim: 3.2,
        }
    }
}

/// `waypoint_follower`.
#[derive(Debug, Clone, PartialEq)]
pub struct WaypointFollower {
    /// Whether a waypoint that cannot be reached ends the drive. Default true; Nav2's files say false.
    pub stop_on_failure: bool,
    /// Pause at each waypoint, ms. Default 0.
    pub waypoint_pause_duration: usize,
}

impl Default for WaypointFollower {
    fn default() -> Self {
        Self { stop_on_failure: true, waypoint_pause_duration: 0 }
    }
}

/// Keys that every node has and that mean nothing here.
pub(super) const OF_NODES: [&str; 4] =
    ["introspection_mode", "use_sim_time", "bond_heartbeat_period", "service_introspection_mode"];

/// Reads the parameters of a node.
pub(super) fn node<'a, T>(root: &mut Section<'a>, name: &str, read: impl FnOnce(&mut Section<'a>) -> T) -> T {
    root.section(name, |node| {
        node.section("ros__parameters", |parameters| {
            parameters.skip(&OF_NODES);
            read(parameters)
        })
    })
}

pub(super) fn planner_server(from: &mut Section<'_>) -> PlannerServer {
    let mut found = PlannerServer::default();
    from.skip(&["allow_partial_planning", "costmap_update_timeout"]);
    from.number("expected_planner_frequency", &mut found.expected_planner_frequency, Range::Above0);
    let names = from.texts("planner_plugins");
    let name = names.and_then(|names| names.into_iter().next()).unwrap_or_else(|| "GridBased".to_owned());
    from.section(&name, |navfn| {
        let allowed = ["nav2_navfn_planner::NavfnPlanner", "nav2_navfn_planner/NavfnPlanner"];
        if let Some(plugin) = navfn.text("plugin").filter(|plugin| !allowed.contains(&plugin.as_str())) {
            navfn.refuse("plugin", plugin, "`nav2_navfn_planner::NavfnPlanner`");
        }
        let into = &mut found.planner;
        navfn.number("tolerance", &mut into.tolerance, Range::AtLeast0);
        navfn.flag("use_astar", &mut into.use_astar);
        navfn.flag("allow_unknown", &mut into.allow_unknown);
        navfn.flag("use_final_approach_orientation", &mut into.use_final_approach_orientation);
        navfn.whole("max_cycles_factor", &mut into.max_cycles_factor, 1);
    });
    found
}

pub(super) fn velocity_smoother(from: &mut Section<'_>) -> VelocitySmoother {
    let mut found = VelocitySmoother::default();
    from.skip(&["odom_topic", "odom_duration", "use_realtime_priority", "enable_stamped_cmd_vel"]);
    from.number("smoothing_frequency", &mut found.smoothing_frequency, Range::Above0);
    from.flag("scale_velocities", &mut found.scale_velocities);
    from.choice("feedback", &mut found.open_loop, &[("OPEN_LOOP", true), ("CLOSED_LOOP", false)]);
    from.axes("max_velocity", &mut found.max_velocity);
    from.axes("min_velocity", &mut found.min_velocity);
    from.axes("max_accel", &mut found.max_accel);
    from.axes("max_decel", &mut found.max_decel);
    from.axes("deadband_velocity", &mut found.deadband_velocity);
    from.number("velocity_timeout", &mut found.velocity_timeout, Range::Above0);
    for (key, values, allowed, good) in [
        ("max_velocity", found.max_velocity, "three numbers of at least 0", true),
        ("max_accel", found.max_accel, "three numbers of at least 0", true),
        ("min_velocity", found.min_velocity, "three numbers of at most 0", false),
        ("max_decel", found.max_decel, "three numbers of at most 0", false),
    ] {
        if values.iter().any(|value| if good { *value < 0.0 } else { *value > 0.0 }) {
            from.refuse(key, format!("{values:?}"), allowed);
        }
    }
    found
}

pub(super) fn behavior_server(from: &mut Section<'_>) -> BehaviorServer {
    let mut found = BehaviorServer::default();
    from.skip(&[
        "local_costmap_topic",
        "global_costmap_topic",
        "costmap_topic",
        "local_footprint_topic",
        "global_footprint_topic",
        "footprint_topic",
        "local_frame",
        "global_frame",
        "robot_base_frame",
        "transform_tolerance",
    ]);
    // Which behaviors there are is the navigator's to say.
    for behavior in from.texts("behavior_plugins").unwrap_or_default() {
        from.skip(&[&behavior]);
    }
    from.number("cycle_frequency", &mut found.cycle_frequency, Range::Above0);
    from.number("simulate_ahead_time", &mut found.simulate_ahead_time, Range::AtLeast0);
    from.number("max_rotational_vel", &mut found.max_rotational_vel, Range::Above0);
    from.number("min_rotational_vel", &mut found.min_rotational_vel, Range::AtLeast0);
    from.number("rotational_acc_lim", &mut found.rotational_acc_lim, Range::Above0);
    found
}

pub(super) fn waypoint_follower(from: &mut Section<'_>) -> WaypointFollower {
    let mut found = WaypointFollower::default();
    from.skip(&["loop_rate", "global_frame_id"]);
    from.flag("stop_on_failure", &mut found.stop_on_failure);
    if let Some(executor) = from.text("waypoint_task_executor_plugin") {
        from.section(&executor, |task| {
            task.skip(&["plugin"]);
            let mut enabled = true;
            task.flag("enabled", &mut enabled);
            task.whole("waypoint_pause_duration", &mut found.waypoint_pause_duration, 0);
            if !enabled {
                found.waypoint_pause_duration = 0;
            }
        });
    }
    found
}
