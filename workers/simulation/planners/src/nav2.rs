//! Nav2 as a parameter file describes it: its stack with its controller, for a mission.

use crate::controller::Controller;
use crate::costmap::{CostmapParams, GroupSource, LayerParams};
use crate::mission::Mission;
use crate::mppi::{BadParams, Mppi};
use crate::nav::{
    GoalParams, PathParams, ProgressParams, RecoveryParams, SmootherParams, Stack, StackParams, WaypointParams,
};
use crate::params::{ControllerSpec, CostmapServer, Nav2Params, RppSpec};
use crate::rpp::{RegulatedPurePursuit, RppParams};

/// The stack of a parameter file. The robot is planned at least as wide as its body is; its own limits hold besides those of the
/// file.
///
/// # Errors
/// [`BadParams`] for values of MPPI that do not go together.
pub fn stack(params: &Nav2Params, mission: &Mission) -> Result<Stack, BadParams> {
    let server = &params.controller_server;
    let robot_radius = params.local_costmap.robot_radius.max(mission.robot.radius_m);
    let controller: Box<dyn Controller> = match &server.controller {
        ControllerSpec::Mppi(mppi) => Box::new(Mppi::new(mppi, mission.seed)?),
        ControllerSpec::Rpp(rpp) => Box::new(RegulatedPurePursuit::new(&pursuit(rpp, params, robot_radius))),
    };
    Ok(Stack::new(stack_params(params, mission, robot_radius), mission, controller))
}

fn stack_params(params: &Nav2Params, mission: &Mission, robot_radius: f64) -> StackParams {
    let server = &params.controller_server;
    let (goal, progress, path) = (&server.goal_checker, &server.progress_checker, &server.path_handler);
    let (smoother, behaviors) = (&params.velocity_smoother, &params.behavior_server);
    let corner = |[x, y]: &[f64; 2]| socrates_model::Point::new(*x, *y);
    StackParams {
        controller_frequency: server.controller_frequency,
        // Nav2's -1: for ever.
        failure_tolerance: if server.failure_tolerance < 0.0 { f64::INFINITY } else { server.failure_tolerance },
        robot_radius,
        footprint: params.local_costmap.footprint.iter().map(corner).collect(),
        global_costmap: costmap(&params.global_costmap, mission),
        local_costmap: costmap(&params.local_costmap, mission),
        navfn: params.planner_server.planner,
        path: PathParams {
            prune_distance: path.prune_distance,
            max_robot_pose_search_dist: path.max_robot_pose_search_dist,
        },
        goal: GoalParams {
            xy_goal_tolerance: goal.xy_goal_tolerance,
            yaw_goal_tolerance: goal.yaw_goal_tolerance,
            stateful: goal.stateful,
            path_length_tolerance: goal.path_length_tolerance,
        },
        progress: ProgressParams {
            required_movement_radius: progress.required_movement_radius,
            movement_time_allowance: progress.movement_time_allowance,
        },
        waypoints: WaypointParams {
            waypoint_pause_duration: milliseconds(params.waypoint_follower.waypoint_pause_duration),
            stop_on_failure: params.waypoint_follower.stop_on_failure,
        },
        smoother: SmootherParams {
            max_velocity: smoother.max_velocity,
            min_velocity: smoother.min_velocity,
            max_accel: smoother.max_accel,
            max_decel: smoother.max_decel,
            velocity_timeout: smoother.velocity_timeout,
        },
        recovery: RecoveryParams {
            min_rotational_vel: behaviors.min_rotational_vel,
            max_rotational_vel: behaviors.max_rotational_vel,
            rotational_acc_lim: behaviors.rotational_acc_lim,
            simulate_ahead_time: behaviors.simulate_ahead_time,
            ..RecoveryParams::default()
        },
        ..StackParams::default()
    }
}

/// Whole milliseconds in seconds.
fn milliseconds(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX)) / 1000.0
}

/// A costmap; who belongs together is told by the mission where the file asks the simulation.
fn costmap(server: &CostmapServer, mission: &Mission) -> CostmapParams {
    let mut layers = server.layers.clone();
    for layer in &mut layers {
        if let LayerParams::Groups(groups) = layer
            && let GroupSource::Given(members) = &mut groups.source
        {
            members.clone_from(&mission.groups);
        }
    }
    CostmapParams {
        width_m: server.width,
        height_m: server.height,
        resolution_m: server.resolution,
        update_frequency_hz: server.update_frequency,
        rolling_window: server.rolling_window,
        track_unknown_space: server.track_unknown_space,
        layers,
    }
}

/// Regulated Pure Pursuit of a parameter file.
fn pursuit(rpp: &RppSpec, params: &Nav2Params, robot_radius: f64) -> RppParams {
    RppParams {
        period_s: 1.0 / params.controller_server.controller_frequency,
        desired_linear_vel: rpp.desired_linear_vel,
        lookahead_dist: rpp.lookahead_dist,
        min_lookahead_dist: rpp.min_lookahead_dist,
        max_lookahead_dist: rpp.max_lookahead_dist,
        lookahead_time: rpp.lookahead_time,
        use_velocity_scaled_lookahead_dist: rpp.use_velocity_scaled_lookahead_dist,
        regulated_linear_scaling_min_radius: rpp.regulated_linear_scaling_min_radius,
        regulated_linear_scaling_min_speed: rpp.regulated_linear_scaling_min_speed,
        cost_scaling_dist: rpp.cost_scaling_dist,
        cost_scaling_gain: rpp.cost_scaling_gain,
        inflation_cost_scaling_factor: rpp.inflation_cost_scaling_factor,
        robot_radius,
        approach_velocity_scaling_dist: rpp.approach_velocity_scaling_dist,
        min_approach_linear_velocity: rpp.min_approach_linear_velocity,
        rotate_to_heading_min_angle: rpp.rotate_to_heading_min_angle,
        rotate_to_heading_angular_vel: rpp.rotate_to_heading_angular_vel,
        xy_goal_tolerance: params.controller_server.goal_checker.xy_goal_tolerance,
        max_allowed_time_to_collision_up_to_carrot: rpp.max_allowed_time_to_collision_up_to_carrot,
        max_linear_accel: rpp.max_linear_accel,
        max_angular_accel: rpp.max_angular_accel,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::{PRESETS, read};
    use crate::tests::mission;

    #[test]
    fn a_controller_without_a_command_is_borne_for_ever_where_the_file_says_so() {
        let text = "controller_server: { ros__parameters: { failure_tolerance: -1.0 } }";
        let params = read(text).unwrap().params;
        assert!(stack_params(&params, &mission(vec![]), 0.25).failure_tolerance.is_infinite());
    }

    #[test]
    fn every_preset_makes_a_stack_with_its_own_layers_and_rate() {
        let mission = Mission { groups: vec![(socrates_model::HumanId::new(1), 1)], ..mission(vec![]) };
        for preset in PRESETS {
            let params = read(preset.text).unwrap().params;
            let made = stack_params(&params, &mission, 0.25);
            let hz = params.controller_server.controller_frequency;
            assert!((made.controller_frequency - hz).abs() < 1e-9, "{}", preset.name);
            assert_eq!(made.local_costmap.layers.len(), params.local_costmap.layers.len(), "{}", preset.name);
            assert!(stack(&params, &mission).is_ok(), "{}", preset.name);
            let given = made.global_costmap.layers.iter().any(|layer| {
                matches!(layer, LayerParams::Groups(groups) if groups.source == GroupSource::Given(mission.groups.clone()))
            });
            assert_eq!(given, preset.text.contains("groups: oracle"), "{}", preset.name);
        }
    }
}
