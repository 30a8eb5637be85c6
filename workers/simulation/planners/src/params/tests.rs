//! Parameter files, good and bad.

use super::*;
use crate::controller::Controller as _;
use crate::costmap::{Costmap, FREE, LayerParams};
use crate::mppi::{MotionModel, Mppi, MppiParams};

fn mppi(loaded: &Loaded) -> &MppiParams {
    match &loaded.params.controller_server.controller {
        ControllerSpec::Mppi(mppi) => mppi,
        ControllerSpec::Rpp(rpp) => panic!("{rpp:?}"),
    }
}

fn values(text: &str) -> Vec<BadValue> {
    match read(text) {
        Err(ParamsFault::Values(values)) => values,
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_preset_is_read_without_a_warning_and_drives() {
    for preset in PRESETS {
        let loaded = read(preset.text).unwrap_or_else(|why| panic!("{}: {why}", preset.name));
        assert_eq!(loaded.warning, None, "{}", preset.name);
        let mut controller = Mppi::new(mppi(&loaded), 7).unwrap();
        let costmap = Costmap::new(100, 100, 0.05, socrates_model::Point::new(-2.5, -2.5), FREE);
        let plan: Vec<socrates_model::Pose> =
            (0..60_u8).map(|number| socrates_model::Pose::new(0.025 * f64::from(number), 0.0, 0.0)).collect();
        let cycle = crate::controller::Following {
            pose: plan[0],
            speed: crate::controller::Twist::default(),
            plan: &plan,
            goal: plan[59],
            costmap: &costmap,
            footprint: &[],
            speed_share: 1.0,
        };
        assert!(controller.command(&cycle).unwrap().vx > 0.0, "{}", preset.name);
    }
    assert!(preset("mppi").is_some() && preset("dwb").is_none());
}

#[test]
fn the_preset_of_the_case_study_has_its_values() {
    let loaded = read(preset("socrates_mppi").unwrap().text).unwrap();
    let found = mppi(&loaded);
    let wanted = [
        (found.vx_std, 0.75),
        (found.vy_std, 0.75),
        (found.wz_std, 0.4),
        (found.vx_max, 1.0),
        (found.vx_min, 0.0),
        (found.wz_max, 1.9),
        (found.temperature, 0.3),
        (found.gamma, 0.015),
        (found.path_follow_critic.cost_weight, 15.0),
        (found.path_align_critic.cost_weight, 14.0),
        (found.path_align_critic.max_path_occupancy_ratio, 0.05),
        (found.cost_critic.cost_weight, 3.81),
        (found.cost_critic.near_goal_distance, 1.0),
        (found.controller_frequency, 30.0),
        (found.surroundings.inscribed_radius, 0.22),
        (found.surroundings.inflation_radius, 0.5),
        (found.surroundings.cost_scaling_factor, 3.0),
        (loaded.params.controller_server.path_handler.prune_distance, 1.7),
        (loaded.params.controller_server.goal_checker.yaw_goal_tolerance, 628.0 / 100.0),
        (loaded.params.local_costmap.width, 15.0),
        (loaded.params.local_costmap.update_frequency, 30.0),
        (loaded.params.velocity_smoother.max_velocity[0], 0.5),
        (loaded.params.global_costmap.inflation().unwrap().inflation_radius, 0.25),
    ];
    for (number, (found, wanted)) in wanted.into_iter().enumerate() {
        assert!((found - wanted).abs() < 1e-12, "{number}: {found} {wanted}");
    }
    assert_eq!((found.batch_size, found.time_steps, found.humble), (2000, 56, true));
    assert!(!found.goal_angle_critic.enabled && found.cost_critic.consider_footprint);
    assert!(!Mppi::new(found, 1).unwrap().shifts(), "30 Hz and steps of 0.05 s");
    let names: Vec<&str> = found.critics.iter().map(|sheet| sheet.name).collect();
    assert_eq!(names, crate::mppi::BRINGUP_CRITICS);
}

#[test]
fn the_presets_about_people_have_layers_about_people() {
    let layers = |name: &str| read(preset(name).unwrap().text).unwrap().params;
    let social = |layer: &LayerParams| matches!(layer, LayerParams::UpoSocial(_));
    let plain = layers("socrates_mppi");
    assert!(!plain.local_costmap.layers.iter().chain(&plain.global_costmap.layers).any(social));
    let aware = layers("ha_mppi");
    assert!(aware.local_costmap.layers.iter().any(social) && aware.global_costmap.layers.iter().any(social));
    let can = layers("nav2can");
    let groups = |layer: &LayerParams| matches!(layer, LayerParams::Groups(groups) if groups.interaction_cost == 253);
    assert!(can.global_costmap.layers.iter().any(groups) && !can.local_costmap.layers.iter().any(groups));
    let last = |params: &CostmapServer| matches!(params.layers.last(), Some(LayerParams::Inflation(_)));
    assert!([&aware, &can].iter().all(|params| last(&params.local_costmap) && last(&params.global_costmap)));
}

#[test]
fn the_file_that_nav2_brings_up_is_read_as_it_is() {
    let Some(path) = socrates_tests::skip::shared("formats/nav2_params/nav2_params.yaml") else { return };
    let loaded = read(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(loaded.warning, None);
    let found = mppi(&loaded);
    let mut wanted = MppiParams::bringup();
    wanted.regenerate_noises = true;
    wanted.surroundings = found.surroundings.clone();
    assert_eq!(found, &wanted);
    let around = &found.surroundings;
    assert!((around.inflation_radius - 0.7).abs() < 1e-12 && (around.inscribed_radius - 0.22).abs() < 1e-12);
    let local = &loaded.params.local_costmap;
    assert!(local.rolling_window && (local.width - 3.0).abs() < 1e-12 && local.layers.len() == 2);
    let global = &loaded.params.global_costmap;
    assert!(global.track_unknown_space && global.layers.len() == 3);
    assert!((loaded.params.waypoint_follower.waypoint_pause_duration - 0.2).abs() < 1e-12);
    assert!((loaded.params.controller_server.failure_tolerance - 0.3).abs() < 1e-12);
}

#[test]
fn nothing_at_all_is_nav2s_defaults() {
    let loaded = read("").unwrap();
    assert_eq!(loaded.warning, None);
    assert_eq!(loaded.params.velocity_smoother, crate::nav::SmootherParams::default());
    assert_eq!(loaded.params.local_costmap.layers.len(), 3);
    assert_eq!(mppi(&loaded).critics, MppiParams::default().critics);
}

#[test]
fn unknown_keys_are_named_once_with_their_lines() {
    let text = "amcl:\n  ros__parameters:\n    alpha1: 0.2\n\
                controller_server:\n  ros__parameters:\n    controler_frequency: 10.0\n    FollowPath:\n      vx_maxx: 1.0\n\
                my_node:\n  ros__parameters: {}\n";
    let warning = read(text).unwrap().warning.unwrap();
    assert_eq!(
        warning,
        "these keys of the parameter file mean nothing here: \
         `controller_server.ros__parameters.FollowPath.vx_maxx` (line 8), \
         `controller_server.ros__parameters.controler_frequency` (line 6), `my_node` (line 9)"
    );
}

#[test]
fn keys_without_effect_are_named_where_they_ask_for_something_else() {
    let text = "controller_server:\n  ros__parameters:\n    controller_frequency: 20.0\n    FollowPath:\n      \
                enforce_path_inversion: true\n\
                velocity_smoother:\n  ros__parameters:\n    smoothing_frequency: 10.0\n    feedback: CLOSED_LOOP\n    \
                scale_velocities: true\n    deadband_velocity: [0.0, 0.0, 0.1]\n\
                local_costmap:\n  local_costmap:\n    ros__parameters:\n      footprint_padding: 0.05\n";
    let warning = read(text).unwrap().warning.unwrap();
    assert_eq!(
        warning,
        "these keys of the parameter file ask for what is not done here, and have no effect: \
         `controller_server.ros__parameters.FollowPath.enforce_path_inversion` (line 5), \
         `local_costmap.local_costmap.ros__parameters.footprint_padding` (line 15), \
         `velocity_smoother.ros__parameters.smoothing_frequency` (line 8), \
         `velocity_smoother.ros__parameters.scale_velocities` (line 10), \
         `velocity_smoother.ros__parameters.feedback` (line 9), \
         `velocity_smoother.ros__parameters.deadband_velocity` (line 11)"
    );
    let same = text.replace("true", "false").replace("10.0", "20.0").replace("CLOSED", "OPEN");
    let same = same.replace("0.1]", "0.0]").replace("0.05", "0.0");
    assert_eq!(read(&same).unwrap().warning, None);
    assert!(values(&text.replace("CLOSED_LOOP", "BOTH"))[0].allowed.contains("`OPEN_LOOP`"));
}

#[test]
fn values_that_cannot_be_meant_are_all_named_at_once() {
    let text = "controller_server:\n  ros__parameters:\n    FollowPath:\n      time_steps: 0\n      batch_size: 0\n      \
                vx_max: fast\n      critics: [\"CostCritic\", \"KindCritic\"]\n      motion_model: \"hover\"\n      \
                gamma: .nan\n      GoalCritic: 3\n\
                local_costmap:\n  local_costmap:\n    ros__parameters:\n      robot_radius: -0.2\n      \
                plugins: [\"a\"]\n      a: {plugin: \"x::Y\"}\n\
                velocity_smoother:\n  ros__parameters:\n    max_velocity: [0.5, 0.0]\n    feedback: \"NONE\"\n";
    let bad = values(text);
    let told: Vec<(&str, Option<usize>, &str)> =
        bad.iter().map(|bad| (bad.key.rsplit('.').next().unwrap(), bad.line, bad.value.as_str())).collect();
    assert_eq!(
        told,
        [
            ("batch_size", Some(5), "0"),
            ("time_steps", Some(4), "0"),
            ("gamma", Some(9), ".nan"),
            ("vx_max", Some(6), "fast"),
            ("motion_model", Some(8), "hover"),
            ("critics", Some(7), "KindCritic"),
            ("GoalCritic", Some(10), "3"),
            ("robot_radius", Some(14), "-0.2"),
            ("plugin", Some(16), "x::Y"),
            ("feedback", Some(20), "NONE"),
            ("max_velocity", Some(19), "a list of 2"),
        ]
    );
    assert_eq!(
        bad[0].to_string(),
        "line 5: `controller_server.ros__parameters.FollowPath.batch_size` is `0`; allowed: a whole number of at least 1"
    );
    assert!(bad[5].allowed.starts_with("`ConstraintCritic`, `CostCritic`"), "{}", bad[5].allowed);
}

#[test]
fn values_that_do_not_fit_each_other_are_named() {
    let slow = values("controller_server:\n  ros__parameters:\n    controller_frequency: 5.0\n");
    assert_eq!((slow[0].line, slow[0].allowed.as_str()), (Some(3), "at least 1 / model_dt"));
    let many = values("controller_server: {ros__parameters: {FollowPath: {batch_size: 9000000}}}");
    assert_eq!(many[0].key, "controller_server.ros__parameters.FollowPath.batch_size");
    let smoother = values("velocity_smoother: {ros__parameters: {max_decel: [1.0, 0.0, -1.0]}}");
    assert_eq!(smoother[0].allowed, "three numbers of at most 0");
}

#[test]
fn what_is_no_parameter_file_is_refused_without_a_panic() {
    assert!(matches!(read("a: [1,\nb: }"), Err(ParamsFault::Yaml { .. })));
    assert!(matches!(read("a: 1\na: 2\n"), Err(ParamsFault::Yaml { .. })));
    assert_eq!(read("- 1\n- 2\n"), Err(ParamsFault::Sections));
    assert_eq!(read(&" ".repeat(2 << 20)), Err(ParamsFault::Large { bytes: 2 << 20 }));
    assert!(matches!(read("controller_server: 3\n"), Err(ParamsFault::Values(_))));
    assert!(matches!(read("controller_server:\n  ros__parameters: [1]\n"), Err(ParamsFault::Values(_))));
}

#[test]
fn an_outline_is_read_as_a_list_or_as_nav2s_text() {
    for outline in [
        "\"[[0.3, 0.1], [-0.3, 0.1], [-0.3, -0.1], [0.3, -0.1]]\"",
        "[[0.3, 0.1], [-0.3, 0.1], [-0.3, -0.1], [0.3, -0.1]]",
    ] {
        let text = format!("local_costmap:\n  local_costmap:\n    ros__parameters:\n      footprint: {outline}\n");
        let loaded = read(&text).unwrap();
        assert_eq!(loaded.params.local_costmap.footprint.len(), 4);
        let around = &mppi(&loaded).surroundings;
        assert!((around.inscribed_radius - 0.1).abs() < 1e-12);
        assert!((around.circumscribed_radius - 0.1_f64.sqrt()).abs() < 1e-12);
    }
    let bad = values("local_costmap: {local_costmap: {ros__parameters: {footprint: \"[[0.3, 0.1], [1.0]]\"}}}");
    assert!(bad[0].allowed.starts_with("at least 3 points"));
}

#[test]
fn models_of_every_release_are_known() {
    let model = |lines: &str| {
        let text = format!("controller_server:\n  ros__parameters:\n    FollowPath:\n{lines}");
        mppi(&read(&text).unwrap()).motion_model
    };
    assert_eq!(model("      motion_model: \"DiffDrive\"\n"), MotionModel::DiffDrive);
    assert_eq!(model("      motion_model: Omni\n"), MotionModel::Omni);
    assert_eq!(model("      motion_model: Ackermann\n"), MotionModel::Ackermann { min_turning_r: 0.2 });
    let humble = "      motion_model: Ackermann\n      AckermannConstraints:\n        min_turning_r: 0.7\n";
    assert_eq!(model(humble), MotionModel::Ackermann { min_turning_r: 0.7 });
    let main = "      motion_model: car\n      car:\n        plugin: \"mppi::AckermannMotionModel\"\n        min_turning_r: 0.4\n";
    assert_eq!(model(main), MotionModel::Ackermann { min_turning_r: 0.4 });
}

#[test]
fn nav2_humble_shows_less_of_the_plan() {
    let shown_m = |lines: &str| {
        let text = format!("controller_server:\n  ros__parameters:\n    FollowPath:\n{lines}");
        read(&text).unwrap().params.controller_server.path_handler.prune_distance
    };
    assert!((shown_m("      nav2_release: main\n") - 2.0).abs() < 1e-12);
    assert!((shown_m("      nav2_release: humble\n") - 1.5).abs() < 1e-12);
    assert!((shown_m("      nav2_release: humble\n      prune_distance: 1.7\n") - 1.7).abs() < 1e-12);
}

#[test]
fn regulated_pure_pursuit_is_read_too() {
    let text = "controller_server:\n  ros__parameters:\n    FollowPath:\n      \
                plugin: \"nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController\"\n      \
                desired_linear_vel: 0.3\n      use_rotate_to_heading: false\n";
    let loaded = read(text).unwrap();
    let ControllerSpec::Rpp(rpp) = &loaded.params.controller_server.controller else { panic!("{loaded:?}") };
    assert!((rpp.desired_linear_vel - 0.3).abs() < 1e-12 && !rpp.use_rotate_to_heading);
    assert_eq!(loaded.warning, None);
    let other = values(&text.replace("RegulatedPurePursuit", "Other"));
    assert!(other[0].allowed.contains("MPPIController"));
}
