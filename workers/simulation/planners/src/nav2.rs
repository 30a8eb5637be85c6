//! Nav2 as a parameter file describes it: its stack with its controller, for a mission.

use crate::controller::Controller;
use crate::costmap::{CostmapParams, GroupSource, LayerParams};
use crate::mission::Mission;
use crate::mppi::{BadParams, Mppi};
use crate::nav::{Stack, StackParams};
use crate::params::{ControllerSpec, CostmapServer, Nav2Params};
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
        ControllerSpec::Rpp(rpp) => Box::new(RegulatedPurePursuit::new(&RppParams { robot_radius, ..**rpp })),
    };
    Ok(Stack::new(stack_params(params, mission, robot_radius), mission, controller))
}

fn stack_params(params: &Nav2Params, mission: &Mission, robot_radius: f64) -> StackParams {
    let server = &params.controller_server;
    let corner = |[x, y]: &[f64; 2]| socrates_model::Point::new(*x, *y);
    StackParams {
        controller_frequency: server.controller_frequency,
        // Nav2's -1: for ever.
        failure_tolerance: if server.failure_tolerance < 0.0 { f64::INFINITY } else { server.failure_tolerance },
        robot_radius,
        footprint: params.local_costmap.footprint.iter().map(corner).collect(),
        global_costmap: costmap(&params.global_costmap, mission),
        local_costmap: costmap(&params.local_costmap, mission),
        least_speeds: server.least_speeds,
        navfn: params.planner_server,
        path: server.path_handler,
        goal: server.goal_checker,
        progress: server.progress_checker,
        waypoints: params.waypoint_follower,
        smoother: params.velocity_smoother,
        recovery: params.behavior_server,
        ..StackParams::default()
    }
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
