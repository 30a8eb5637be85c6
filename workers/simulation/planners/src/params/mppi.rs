//! The section of MPPI.

use super::section::{Range, Section};
use crate::mppi::{CATALOG, MotionModel, MppiParams, PathAngleMode, SgfOrder, named};

/// Smallest turning radius of a car that says none, m: Nav2's default.
const MIN_TURNING_R: f64 = 0.2;
/// Highest power of a cost.
const MOST_POWER: u32 = 16;

/// Which motion model a name means; a plugin's name or a short one of any release.
fn motion_model(name: &str, min_turning_r: f64) -> Option<MotionModel> {
    match name {
        "diff_drive" | "DiffDrive" | "mppi::DiffDriveMotionModel" => Some(MotionModel::DiffDrive),
        "omni" | "Omni" | "mppi::OmniMotionModel" => Some(MotionModel::Omni),
        "ackermann" | "Ackermann" | "mppi::AckermannMotionModel" => Some(MotionModel::Ackermann { min_turning_r }),
        _ => None,
    }
}

/// Reads the section. `controller_frequency` is the server's.
pub(super) fn read(from: &mut Section<'_>, controller_frequency: f64) -> MppiParams {
    let mut found = MppiParams { controller_frequency, ..MppiParams::default() };
    from.skip(&[
        "visualize",
        "debug",
        "publish_optimal_trajectory",
        "publish_critics_stats",
        "TrajectoryVisualizer",
        "transform_tolerance",
        "visualizer",
        "trajectory_step",
        "time_step",
    ]);
    // Ours: which release of Nav2 is meant.
    from.choice("nav2_release", &mut found.humble, &[("humble", true), ("main", false)]);
    sampling(from, &mut found);
    motion(from, &mut found);
    from.section("TrajectoryValidator", |section| {
        section.skip(&["plugin"]);
        let into = &mut found.trajectory_validator;
        section.number("collision_lookahead_time", &mut into.collision_lookahead_time, Range::Above0);
        section.flag("consider_footprint", &mut into.consider_footprint);
    });
    if let Some(names) = from.texts("critics") {
        found.critics.clear();
        for name in names {
            match named(&name) {
                Some(sheet) => found.critics.push(sheet),
                None => {
                    let known: Vec<String> = CATALOG.iter().map(|sheet| format!("`{}`", sheet.name)).collect();
                    from.refuse("critics", name, known.join(", "));
                }
            }
        }
    }
    near_the_goal(from, &mut found);
    along_the_plan(from, &mut found);
    of_motion(from, &mut found);
    of_obstacles(from, &mut found);
    found
}

fn sampling(from: &mut Section<'_>, found: &mut MppiParams) {
    from.whole("batch_size", &mut found.batch_size, 1);
    from.whole("time_steps", &mut found.time_steps, 2);
    from.number("model_dt", &mut found.model_dt, Range::Above0);
    from.whole("iteration_count", &mut found.iteration_count, 1);
    from.whole("retry_attempt_limit", &mut found.retry_attempt_limit, 0);
    from.number("vx_std", &mut found.vx_std, Range::Above0);
    from.number("vy_std", &mut found.vy_std, Range::Above0);
    from.number("wz_std", &mut found.wz_std, Range::AtLeast0);
    from.number("temperature", &mut found.temperature, Range::Above0);
    from.number("gamma", &mut found.gamma, Range::AtLeast0);
    from.flag("regenerate_noises", &mut found.regenerate_noises);
    from.flag("open_loop", &mut found.open_loop);
    from.flag("clamp_raw_controls", &mut found.clamp_raw_controls);
    from.choice("sgf_order", &mut found.sgf_order, &[("1", SgfOrder::One), ("2", SgfOrder::Two)]);
    from.number("reset_period", &mut found.reset_period, Range::AtLeast0);
}

fn motion(from: &mut Section<'_>, found: &mut MppiParams) {
    from.number("vx_max", &mut found.vx_max, Range::Above0);
    from.number("vx_min", &mut found.vx_min, Range::AtMost0);
    from.number("vy_max", &mut found.vy_max, Range::AtLeast0);
    from.number("wz_max", &mut found.wz_max, Range::Above0);
    from.number("ax_max", &mut found.ax_max, Range::Above0);
    from.number("ax_min", &mut found.ax_min, Range::Below0);
    from.number("ay_max", &mut found.ay_max, Range::Above0);
    from.number("ay_min", &mut found.ay_min, Range::Below0);
    from.number("az_max", &mut found.az_max, Range::Above0);
    from.number("model_delay_vx", &mut found.model_delay_vx, Range::AtLeast0);
    from.number("model_delay_vy", &mut found.model_delay_vy, Range::AtLeast0);
    from.number("model_delay_wz", &mut found.model_delay_wz, Range::AtLeast0);
    let mut radius = MIN_TURNING_R;
    from.section("AckermannConstraints", |section| section.number("min_turning_r", &mut radius, Range::Above0));
    if let Some(name) = from.text("motion_model") {
        // Since Nav2 1.5 the model is a plugin with a section of its own.
        let plugin = from.section(&name, |section| {
            section.number("min_turning_r", &mut radius, Range::Above0);
            section.text("plugin")
        });
        match motion_model(plugin.as_deref().unwrap_or(&name), radius) {
            Some(model) => found.motion_model = model,
            None => from.refuse("motion_model", name, "`diff_drive`, `omni`, `ackermann`"),
        }
    }
}

/// What every critic has.
fn common(from: &mut Section<'_>, enabled: &mut bool, power: &mut u32) {
    from.flag("enabled", enabled);
    from.small("cost_power", power, "a whole number from 1 to 16", 1, MOST_POWER);
}

fn near_the_goal(from: &mut Section<'_>, found: &mut MppiParams) {
    from.section("GoalCritic", |section| {
        let into = &mut found.goal_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.number("threshold_to_consider", &mut into.threshold_to_consider, Range::AtLeast0);
    });
    from.section("GoalAngleCritic", |section| {
        let into = &mut found.goal_angle_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.number("threshold_to_consider", &mut into.threshold_to_consider, Range::AtLeast0);
        section.flag("symmetric_yaw_tolerance", &mut into.symmetric_yaw_tolerance);
    });
}

fn along_the_plan(from: &mut Section<'_>, found: &mut MppiParams) {
    from.section("PathAlignCritic", |section| {
        let into = &mut found.path_align_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.number("threshold_to_consider", &mut into.threshold_to_consider, Range::AtLeast0);
        section.whole("offset_from_furthest", &mut into.offset_from_furthest, 0);
        section.whole("trajectory_point_step", &mut into.trajectory_point_step, 1);
        section.number("max_path_occupancy_ratio", &mut into.max_path_occupancy_ratio, Range::AtLeast0);
        section.flag("use_path_orientations", &mut into.use_path_orientations);
    });
    from.section("PathFollowCritic", |section| {
        let into = &mut found.path_follow_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.number("threshold_to_consider", &mut into.threshold_to_consider, Range::AtLeast0);
        section.whole("offset_from_furthest", &mut into.offset_from_furthest, 0);
    });
    from.section("PathAngleCritic", |section| {
        let into = &mut found.path_angle_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.number("threshold_to_consider", &mut into.threshold_to_consider, Range::AtLeast0);
        section.whole("offset_from_furthest", &mut into.offset_from_furthest, 0);
        section.number("max_angle_to_furthest", &mut into.max_angle_to_furthest, Range::AtLeast0);
        // What Nav2 had before the modes.
        let forward = [("true", PathAngleMode::Forward), ("false", PathAngleMode::EitherWay)];
        section.choice("forward_preference", &mut into.mode, &forward);
        let modes = [("0", PathAngleMode::Forward), ("1", PathAngleMode::EitherWay), ("2", PathAngleMode::PlanHeading)];
        section.choice("mode", &mut into.mode, &modes);
    });
}

fn of_motion(from: &mut Section<'_>, found: &mut MppiParams) {
    from.section("ConstraintCritic", |section| {
        let into = &mut found.constraint_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
    });
    from.section("PreferForwardCritic", |section| {
        let into = &mut found.prefer_forward_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.number("threshold_to_consider", &mut into.threshold_to_consider, Range::AtLeast0);
    });
    from.section("TwirlingCritic", |section| {
        let into = &mut found.twirling_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        // As Nav2's files name them.
        section.small("twirling_cost_power", &mut into.cost_power, "a whole number from 1 to 16", 1, MOST_POWER);
        section.number("twirling_cost_weight", &mut into.cost_weight, Range::AtLeast0);
    });
    from.section("VelocityDeadbandCritic", |section| {
        let into = &mut found.velocity_deadband_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.axes("deadband_velocities", &mut into.deadband_velocities);
    });
}

fn of_obstacles(from: &mut Section<'_>, found: &mut MppiParams) {
    from.section("CostCritic", |section| {
        section.skip(&["inflation_layer_name"]);
        let into = &mut found.cost_critic;
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("cost_weight", &mut into.cost_weight, Range::AtLeast0);
        section.number("critical_cost", &mut into.critical_cost, Range::AtLeast0);
        section.cost("near_collision_cost", &mut into.near_collision_cost);
        section.number("collision_cost", &mut into.collision_cost, Range::AtLeast0);
        section.number("near_goal_distance", &mut into.near_goal_distance, Range::AtLeast0);
        section.whole("trajectory_point_step", &mut into.trajectory_point_step, 1);
        section.flag("consider_footprint", &mut into.consider_footprint);
    });
    let humble = found.humble;
    from.section("ObstaclesCritic", |section| {
        // The inflation is that of the costmap.
        section.skip(&["inflation_layer_name", "inflation_radius", "cost_scaling_factor"]);
        let into = &mut found.obstacles_critic;
        if humble {
            into.collision_cost = 1e4;
        }
        common(section, &mut into.enabled, &mut into.cost_power);
        section.number("critical_weight", &mut into.critical_weight, Range::AtLeast0);
        section.number("repulsion_weight", &mut into.repulsion_weight, Range::AtLeast0);
        section.number("collision_cost", &mut into.collision_cost, Range::AtLeast0);
        section.number("collision_margin_distance", &mut into.collision_margin_distance, Range::AtLeast0);
        section.number("near_goal_distance", &mut into.near_goal_distance, Range::AtLeast0);
        section.flag("consider_footprint", &mut into.consider_footprint);
    });
}
