//! Parameter files of Nav2: a user pastes their own.
//!
//! ```text
//! YAML ─► read ─► Nav2Params (the structs that the stack takes, Nav2's names) and one warning: keys without meaning or effect here
//! ```
//!
//! Keys keep their names and places: `controller_server.ros__parameters.FollowPath.vx_max`. Servers that this simulation has nothing
//! of (maps, localization, docking) are passed over. A key that is unknown is named in the warning with its line, and so is one that is
//! known but asks for something else than what is done. A value of a wrong kind or out of its range is an error; all errors come at
//! once.
//!
//! Ours are few keys: `nav2_release` (`main` or `humble`) in MPPI's section, and the layers `socrates::OraclePeople`,
//! `nav2can::SocialLayer` and `nav2can::InteractionLayer`.
//!
//! *Never here:* a file, a controller that runs.

mod controller;
mod costmap;
mod mppi;
mod presets;
mod section;
mod servers;

#[cfg(test)]
mod tests;

use std::cell::RefCell;

use yaml_serde::Value;

pub use controller::{ControllerServer, ControllerSpec};
pub use costmap::CostmapServer;
pub use presets::{PRESETS, Preset, preset};
pub use section::BadValue;

use crate::mppi::Surroundings;
use crate::nav::{RecoveryParams, SmootherParams, WaypointParams};
use crate::navfn::NavFnParams;
use section::{Notes, Section};

/// Largest file, bytes: Nav2's own has 19 kB.
const MAX_BYTES: usize = 1 << 20;

/// Nodes of Nav2 that this simulation has nothing of.
const PASSED_OVER: [&str; 24] = [
    "amcl",
    "bt_navigator",
    "bt_navigator_navigate_through_poses_rclcpp_node",
    "bt_navigator_navigate_to_pose_rclcpp_node",
    "collision_monitor",
    "costmap_filter_info_server",
    "docking_server",
    "filter_mask_server",
    "keepout_costmap_filter_info_server",
    "keepout_filter_mask_server",
    "lifecycle_manager",
    "lifecycle_manager_localization",
    "lifecycle_manager_navigation",
    "loopback_simulator",
    "map_saver",
    "map_server",
    "robot_state_publisher",
    "route_server",
    "slam_toolbox",
    "smoother_server",
    "speed_costmap_filter_info_server",
    "speed_filter_mask_server",
    "following_server",
    "vector_object_server",
];

/// What a parameter file says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Nav2Params {
    /// Checkers, path handler, controller.
    pub controller_server: ControllerServer,
    /// The planner.
    pub planner_server: NavFnParams,
    /// Costs round the robot, which controllers see.
    pub local_costmap: CostmapServer,
    /// Costs of the whole map, which planners see.
    pub global_costmap: CostmapServer,
    /// What commands pass through.
    pub velocity_smoother: SmootherParams,
    /// What the robot does when it is stuck.
    pub behavior_server: RecoveryParams,
    /// Drives from waypoint to waypoint.
    pub waypoint_follower: WaypointParams,
}

/// A parameter file that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// What it says.
    pub params: Nav2Params,
    /// The keys that mean nothing here and those that have no effect, a sentence each; none where there are none.
    pub warning: Option<String>,
}

/// Why a parameter file cannot be taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ParamsFault {
    /// It is too large.
    #[error("the parameter file has {bytes} bytes; allowed: at most {MAX_BYTES}")]
    Large {
        /// Its size.
        bytes: usize,
    },
    /// It is no YAML.
    #[error("the parameter file is no YAML: {why}")]
    Yaml {
        /// What the parser says, with line and column.
        why: String,
    },
    /// It holds something else than sections.
    #[error("the parameter file holds no sections; it starts with the name of a node such as `controller_server:`")]
    Sections,
    /// Values that cannot be meant.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Values(Vec<BadValue>),
}

/// Reads a parameter file.
///
/// # Errors
/// [`ParamsFault`], with every value that cannot be meant.
pub fn read(text: &str) -> Result<Loaded, ParamsFault> {
    if text.len() > MAX_BYTES {
        return Err(ParamsFault::Large { bytes: text.len() });
    }
    let value: Value = yaml_serde::from_str(text).map_err(|why| ParamsFault::Yaml { why: why.to_string() })?;
    let map = match &value {
        Value::Mapping(map) => Some(map),
        // An empty file: everything as it is by default.
        Value::Null => None,
        Value::Bool(_) | Value::Number(_) | Value::String(_) | Value::Sequence(_) | Value::Tagged(_) => {
            return Err(ParamsFault::Sections);
        }
    };
    let notes = RefCell::new(Notes::new(text));
    let mut root = Section::root(map, &notes);
    root.skip(&PASSED_OVER);
    let controller_server = servers::node(&mut root, "controller_server", controller::controller_server);
    let rate_hz = controller_server.controller_frequency;
    let mut params = Nav2Params {
        controller_server,
        planner_server: servers::node(&mut root, "planner_server", servers::planner_server),
        local_costmap: costmap::read(&mut root, "local_costmap"),
        global_costmap: costmap::read(&mut root, "global_costmap"),
        velocity_smoother: servers::node(&mut root, "velocity_smoother", |node| {
            servers::velocity_smoother(node, rate_hz)
        }),
        behavior_server: servers::node(&mut root, "behavior_server", servers::behavior_server),
        waypoint_follower: servers::node(&mut root, "waypoint_follower", servers::waypoint_follower),
    };
    root.end();
    relate(&mut params, &root);
    let Notes { bad, unknown, idle, .. } = notes.take();
    if !bad.is_empty() {
        return Err(ParamsFault::Values(bad));
    }
    let told = [
        ("these keys of the parameter file mean nothing here", unknown),
        ("these keys of the parameter file ask for what is not done here, and have no effect", idle),
    ];
    let sentences = told.into_iter().filter(|(_, keys)| !keys.is_empty());
    let warning: Vec<String> = sentences.map(|(what, keys)| format!("{what}: {}", keys.join(", "))).collect();
    Ok(Loaded { params, warning: (!warning.is_empty()).then(|| warning.join("; ")) })
}

/// Gives the controller what it takes from other servers, and checks what concerns several values.
fn relate(params: &mut Nav2Params, root: &Section<'_>) {
    let (inscribed_radius, circumscribed_radius) = params.local_costmap.radii();
    let inflation = params.local_costmap.inflation().cloned().unwrap_or_default();
    let server = &mut params.controller_server;
    let mppi = match &mut server.controller {
        ControllerSpec::Mppi(mppi) => mppi,
        ControllerSpec::Rpp(rpp) => {
            rpp.period_s = 1.0 / server.controller_frequency;
            rpp.robot_radius = params.local_costmap.robot_radius;
            rpp.xy_goal_tolerance = server.goal_checker.xy_goal_tolerance;
            return;
        }
    };
    mppi.surroundings = Surroundings {
        track_unknown_space: params.local_costmap.track_unknown_space,
        inscribed_radius,
        circumscribed_radius,
        cost_scaling_factor: inflation.cost_scaling_factor,
        inflation_radius: inflation.inflation_radius,
        xy_goal_tolerance: server.goal_checker.xy_goal_tolerance,
    };
    let Err(found) = mppi.check() else { return };
    for bad in found.0 {
        let server = "controller_server.ros__parameters";
        let section = if bad.of_server { "" } else { ".FollowPath" };
        root.refuse_below(&format!("{server}{section}.{}", bad.key), &bad.value, bad.allowed);
    }
}
