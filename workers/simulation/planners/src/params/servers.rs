//! The other servers: planner, velocity smoother, behaviors, waypoints.

use super::section::{Range, Section};
use crate::nav::{RecoveryParams, SmootherParams, WaypointParams};
use crate::navfn::NavFnParams;

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

pub(super) fn planner_server(from: &mut Section<'_>) -> NavFnParams {
    let mut found = NavFnParams::default();
    // Nav2 complains of a planner that is slower than expected, and does nothing else.
    from.skip(&["allow_partial_planning", "costmap_update_timeout", "expected_planner_frequency"]);
    let names = from.texts("planner_plugins");
    let name = names.and_then(|names| names.into_iter().next()).unwrap_or_else(|| "GridBased".to_owned());
    from.section(&name, |navfn| {
        let allowed = ["nav2_navfn_planner::NavfnPlanner", "nav2_navfn_planner/NavfnPlanner"];
        if let Some(plugin) = navfn.text("plugin").filter(|plugin| !allowed.contains(&plugin.as_str())) {
            navfn.refuse("plugin", plugin, "`nav2_navfn_planner::NavfnPlanner`");
        }
        let into = &mut found;
        navfn.number("tolerance", &mut into.tolerance, Range::AtLeast0);
        navfn.flag("use_astar", &mut into.use_astar);
        navfn.flag("allow_unknown", &mut into.allow_unknown);
        navfn.flag("use_final_approach_orientation", &mut into.use_final_approach_orientation);
        navfn.whole("max_cycles_factor", &mut into.max_cycles_factor, 1);
    });
    found
}

/// `controller_frequency` is the rate at which this simulation smooths commands, Hz.
pub(super) fn velocity_smoother(from: &mut Section<'_>, controller_frequency: f64) -> SmootherParams {
    let mut found = SmootherParams::default();
    from.skip(&["odom_topic", "odom_duration", "use_realtime_priority", "enable_stamped_cmd_vel"]);
    from.idle_number("smoothing_frequency", controller_frequency, Range::Above0);
    from.idle_flag("scale_velocities", false);
    from.idle_choice("feedback", "OPEN_LOOP", &["OPEN_LOOP", "CLOSED_LOOP"]);
    from.axes("max_velocity", &mut found.max_velocity);
    from.axes("min_velocity", &mut found.min_velocity);
    from.axes("max_accel", &mut found.max_accel);
    from.axes("max_decel", &mut found.max_decel);
    from.idle_axes("deadband_velocity", [0.0; 3]);
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

pub(super) fn behavior_server(from: &mut Section<'_>) -> RecoveryParams {
    let mut found = RecoveryParams::default();
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
        // Recoveries go by the steps of the controller, which are shorter.
        "cycle_frequency",
    ]);
    // Which behaviors there are is the navigator's to say.
    for behavior in from.texts("behavior_plugins").unwrap_or_default() {
        from.skip(&[&behavior]);
    }
    from.number("simulate_ahead_time", &mut found.simulate_ahead_time, Range::AtLeast0);
    from.number("max_rotational_vel", &mut found.max_rotational_vel, Range::Above0);
    from.number("min_rotational_vel", &mut found.min_rotational_vel, Range::AtLeast0);
    from.number("rotational_acc_lim", &mut found.rotational_acc_lim, Range::Above0);
    found
}

pub(super) fn waypoint_follower(from: &mut Section<'_>) -> WaypointParams {
    // Nav2's own values where the file says nothing; its files say false, and 200 ms.
    let mut found = WaypointParams { stop_on_failure: true, waypoint_pause_duration: 0.0 };
    from.skip(&["loop_rate", "global_frame_id"]);
    from.flag("stop_on_failure", &mut found.stop_on_failure);
    if let Some(executor) = from.text("waypoint_task_executor_plugin") {
        from.section(&executor, |task| {
            task.skip(&["plugin"]);
            let (mut enabled, mut pause_ms) = (true, 0);
            task.flag("enabled", &mut enabled);
            task.small("waypoint_pause_duration", &mut pause_ms, "a whole number of milliseconds", 0, u32::MAX);
            if enabled {
                found.waypoint_pause_duration = f64::from(pause_ms) / 1000.0;
            }
        });
    }
    found
}
