//! One cycle after the other: reset, fallback, shift, limits, models, and what is no cycle at all.

use super::*;
use crate::costmap::UNKNOWN;
use crate::mppi::critics::named;
use crate::mppi::{Instructions, MotionModel, SgfOrder};

fn near(found: Twist, wanted: Twist) {
    let off = [found.vx - wanted.vx, found.vy - wanted.vy, found.omega - wanted.omega];
    assert!(off.iter().all(|off| off.abs() < 1e-6), "{found:?} {wanted:?}");
}

#[test]
fn the_same_seed_gives_the_same_commands_on_every_set_of_instructions() {
    let hash = |instructions, motion_model| {
        let mut world = World::empty().with_disc(6.0, 5.1, 0.2);
        let params = MppiParams { motion_model, ..bringup(333) };
        let mut mppi = Mppi::new(&params, 42).unwrap().with_instructions(instructions);
        mppi.reset();
        (0..100).fold(0xCBF2_9CE4_8422_2325_u64, |hash, _| {
            let command = world.step(&mut mppi);
            [command.vx, command.vy, command.omega]
                .iter()
                .map(|value| u64::from((*value as f32).to_bits()))
                .fold(hash, |hash, bits| (hash ^ bits).wrapping_mul(0x0100_0000_01B3))
        })
    };
    for (model, recorded) in [
        (MotionModel::DiffDrive, 0x76E2_288C_F611_045C),
        (MotionModel::Omni, 0x7571_F621_3D37_2D77),
        (MotionModel::Ackermann { min_turning_r: 0.2 }, 0xE029_FDFE_949B_F3AE),
    ] {
        let baseline = hash(Instructions::Baseline, model);
        assert_eq!(baseline, recorded, "{model:?}: {baseline:#018X} differs from what other machines found");
        assert_eq!(baseline, hash(Instructions::Avx2, model), "{model:?} with AVX2");
        assert_eq!(baseline, hash(Instructions::Sixteen, model), "{model:?} with sixteen lanes");
        assert_eq!(baseline, hash(Instructions::Detected, model), "{model:?} with what there is");
    }
}

#[test]
fn seeds_differ_and_a_seed_repeats_itself() {
    let command = |seed| World::empty().command(&mut Mppi::new(&bringup(400), seed).unwrap()).unwrap();
    assert_eq!(command(1), command(1));
    assert_ne!(command(1), command(2));
}

#[test]
fn a_cycle_takes_no_memory() {
    let mut params = bringup(100);
    params
        .critics
        .extend(["ObstaclesCritic", "TwirlingCritic", "VelocityDeadbandCritic"].into_iter().filter_map(named));
    params.motion_model = MotionModel::Omni;
    params.regenerate_noises = true;
    let mut world = World::empty().with_disc(6.0, 5.1, 0.2);
    let mut mppi = Mppi::new(&params, 1).unwrap();
    world.step(&mut mppi);
    let before = mppi.memory();
    for _ in 0..100 {
        world.step(&mut mppi);
    }
    assert_eq!(before, mppi.memory());
    assert!(before.len() > 20);
}

#[test]
fn a_reset_stands_still_and_draws_new_noise() {
    let world = World::empty();
    let mut mppi = Mppi::new(&bringup(400), 5).unwrap();
    let first = world.command(&mut mppi).unwrap();
    mppi.reset();
    assert!(mppi.sequence.axes().into_iter().flatten().all(|value| value.abs() < 1e-9));
    let second = world.command(&mut mppi).unwrap();
    assert_ne!(first, second, "the noise is that of the next draw");
    let mut again = Mppi::new(&bringup(400), 5).unwrap();
    again.reset();
    assert_eq!(second, world.command(&mut again).unwrap());
}

#[test]
fn noise_is_drawn_again_only_where_that_is_asked_for() {
    let draws = |regenerate_noises| {
        let mut mppi = Mppi::new(&MppiParams { regenerate_noises, ..bringup(50) }, 5).unwrap();
        let mut world = World::empty();
        world.steps(&mut mppi, 5);
        mppi.draw
    };
    assert_eq!((draws(false), draws(true)), (1, 6));
}

#[test]
fn a_robot_in_an_obstacle_gets_an_error_after_one_retry() {
    let mut world = World::empty();
    world.costmap.costs_mut().fill(LETHAL);
    let mut mppi = Mppi::new(&bringup(50), 5).unwrap();
    assert_eq!(world.command(&mut mppi), Err(NoControl::Collision));
    assert_eq!(mppi.draw, 3, "noise is drawn at the start, for the retry and for the next cycle");
    world.costmap.costs_mut().fill(UNKNOWN);
    assert_eq!(world.command(&mut mppi), Err(NoControl::Collision), "unknown is no floor");
    world.costmap.costs_mut().fill(FREE);
    assert!(world.command(&mut mppi).is_ok(), "the next cycle begins anew");
    let params = MppiParams { retry_attempt_limit: 4, ..bringup(50) };
    let mut patient = Mppi::new(&params, 5).unwrap();
    world.costmap.costs_mut().fill(LETHAL);
    assert_eq!(world.command(&mut patient), Err(NoControl::Collision));
    assert_eq!(patient.draw, 6);
}

#[test]
fn the_validator_stops_a_trajectory_into_an_obstacle_that_no_critic_sees() {
    let drives_into_it = |humble| {
        let critics = ["PathFollowCritic", "PathAlignCritic"].into_iter().filter_map(named).collect();
        let mut mppi = Mppi::new(&MppiParams { critics, humble, ..bringup(200) }, 5).unwrap();
        // A wall 0.3 m ahead.
        let mut world = World::empty();
        (0..200).for_each(|row| (86..100).for_each(|column| world.costmap.set(column, row, LETHAL)));
        let inside = (0..200).any(|_| {
            // As Nav2's controller server: no command is a stop.
            let command = world.command(&mut mppi).unwrap_or_default();
            world.carry_out(command);
            world.costmap.cost_at(&world.pose.point()) == LETHAL
        });
        (inside, mppi.draw > 1)
    };
    assert_eq!(drives_into_it(false), (false, true));
    assert_eq!(drives_into_it(true), (true, false), "Nav2 Humble has no validator");
}

#[test]
fn a_plan_without_poses_is_an_error() {
    let world = World { plan: vec![Pose::new(8.0, 5.0, 0.0)], ..World::empty() };
    let mut mppi = Mppi::new(&bringup(50), 5).unwrap();
    let goal = Pose::new(8.0, 5.0, 0.0);
    let cycle = Following {
        pose: world.pose,
        speed: world.speed,
        plan: &[],
        goal,
        costmap: &world.costmap,
        footprint: &[],
        speed_share: 1.0,
    };
    assert_eq!(mppi.command(&cycle), Err(NoControl::NoPlan));
    assert!(mppi.command(&Following { plan: &[goal], ..cycle }).is_ok(), "one pose is a plan");
}

#[test]
fn what_is_no_number_is_an_error_and_leaves_nothing_behind() {
    let mut mppi = Mppi::new(&bringup(50), 5).unwrap();
    let lost = World { pose: Pose::new(f64::NAN, 5.0, 0.0), ..World::empty() };
    assert_eq!(lost.command(&mut mppi), Err(NoControl::Collision));
    let dizzy = World { pose: Pose::new(4.0, 5.0, f64::INFINITY), ..World::empty() };
    assert_eq!(dizzy.command(&mut mppi), Err(NoControl::Collision));
    let command = World::empty().command(&mut mppi).unwrap();
    assert!(command.vx.is_finite() && command.omega.is_finite());
}

#[test]
fn the_sequence_moves_on_where_the_periods_agree() {
    let mut mppi = Mppi::new(&bringup(400), 5).unwrap();
    assert!(mppi.shifts());
    let mut world = World::empty();
    for _ in 0..20 {
        let sent = world.step(&mut mppi);
        let [vx, vy, omega] = mppi.sequence.command(0).map(f64::from);
        near(sent, Twist { vx, vy, omega });
    }
    // At 30 Hz a step of 0.05 s is no cycle: the sequence stays, and its first command is sent.
    let mut fast = Mppi::new(&MppiParams { controller_frequency: 30.0, ..bringup(400) }, 5).unwrap();
    assert!(!fast.shifts());
    let mut world = World { period_s: 1.0 / 30.0, ..World::empty() };
    for _ in 0..20 {
        let sent = world.step(&mut fast);
        let [vx, vy, omega] = fast.sequence.command(0).map(f64::from);
        near(sent, Twist { vx, vy, omega });
    }
    assert!(world.pose.x > 4.05, "{:?}", world.pose);
}

#[test]
fn a_speed_limit_is_a_limit() {
    let mut mppi = Mppi::new(&bringup(400), 5).unwrap();
    let mut world = World { speed_share: 0.4, ..World::empty() };
    let fastest = (0..80).map(|_| world.step(&mut mppi).vx).fold(0.0, f64::max);
    assert!((fastest - 0.2).abs() < 1e-6, "{fastest}");
    // After a faster drive it brakes as fast as it can.
    world.speed_share = 1.0;
    world.steps(&mut mppi, 40);
    let (fast, share) = (world.speed.vx, 0.5);
    assert!(fast > 0.35, "{fast}");
    world.speed_share = share;
    world.steps(&mut mppi, 3);
    assert!(world.speed.vx <= 0.25 + 1e-6, "{}", world.speed.vx);
}

#[test]
fn commands_keep_the_limits_of_speed_and_acceleration() {
    for motion_model in [MotionModel::DiffDrive, MotionModel::Omni, MotionModel::Ackermann { min_turning_r: 0.3 }] {
        let params = MppiParams { motion_model, ..bringup(200) };
        let mut mppi = Mppi::new(&params, 9).unwrap();
        let mut world = World::empty().with_disc(6.0, 5.1, 0.2);
        for _ in 0..150 {
            let (before, now) = (world.speed, world.step(&mut mppi));
            let within = |value: f64, limit: f64| value.abs() <= limit + 1e-5;
            assert!(within(now.vx - before.vx, 0.15) && within(now.omega - before.omega, 0.175), "{before:?} {now:?}");
            assert!(now.vx <= 0.5 && now.vx >= -0.35 - 1e-6 && within(now.omega, 1.9) && within(now.vy, 0.5));
            match motion_model {
                MotionModel::DiffDrive => assert!(now.vy.abs() < 1e-9),
                MotionModel::Omni => (),
                MotionModel::Ackermann { min_turning_r } => {
                    assert!(now.omega.abs() * min_turning_r <= now.vx.abs() + 1e-5, "{now:?}");
                }
            }
            for (axis, limit) in mppi.sequence.axes().into_iter().zip([0.5, 0.5, 1.9]) {
                assert!(axis.iter().all(|value| value.abs() <= limit + 1e-5), "{axis:?}");
            }
        }
        assert!(world.pose.x > 5.0, "{motion_model:?}: {:?}", world.pose);
    }
}

#[test]
fn the_speed_that_is_reckoned_with_is_the_last_command_as_far_as_the_base_followed() {
    // Measured speeds lag behind; a closed loop goes on from what was sent, an open one from nothing else.
    let mut closed = Mppi::new(&bringup(400), 5).unwrap();
    let mut open = Mppi::new(&MppiParams { open_loop: true, ..bringup(400) }, 5).unwrap();
    let world = World::empty();
    let sent: Vec<[f64; 2]> =
        (0..10).map(|_| [world.command(&mut closed).unwrap().vx, world.command(&mut open).unwrap().vx]).collect();
    // The robot never moves: within a closed loop no command gets more than two steps ahead of standing.
    assert!(sent.iter().all(|[closed, _]| *closed <= 0.3 + 1e-6), "{sent:?}");
    assert!(sent[9][1] > sent[9][0] + 0.01, "{sent:?}");
}

#[test]
fn every_model_finds_its_way_past_a_costly_spot() {
    // As Nav2's smoke test: 400 trajectories of 15 steps, one spot that costs 250, a map of 4 m by 4 m, a plan of 50 points.
    let sets: [&[&str]; 2] = [
        &["GoalCritic", "GoalAngleCritic", "CostCritic", "PathAngleCritic", "PathFollowCritic", "PreferForwardCritic"],
        &[
            "GoalCritic",
            "GoalAngleCritic",
            "ObstaclesCritic",
            "PathAngleCritic",
            "PathFollowCritic",
            "PreferForwardCritic",
        ],
    ];
    for set in sets {
        for motion_model in [MotionModel::DiffDrive, MotionModel::Omni, MotionModel::Ackermann { min_turning_r: 0.2 }] {
            let params = MppiParams {
                batch_size: 400,
                time_steps: 15,
                motion_model,
                critics: set.iter().copied().filter_map(named).collect(),
                ..MppiParams::default()
            };
            let mut world = World {
                costmap: Costmap::new(40, 40, 0.1, Point::origin(), FREE),
                plan: (0..50_u8).map(|number| Pose::new(1.0 + 0.04 * f64::from(number), 2.0, 0.0)).collect(),
                pose: Pose::new(1.0, 2.0, 0.0),
                ..World::empty()
            };
            (18..22).for_each(|row| (18..22).for_each(|column| world.costmap.set(column, row, 250)));
            let mut mppi = Mppi::new(&params, 3).unwrap();
            let command = world.step(&mut mppi);
            assert!(command.vx.is_finite() && command.omega.is_finite(), "{command:?}");
            assert!((0..20).all(|_| world.command(&mut mppi).is_ok()), "{motion_model:?} {set:?}");
        }
    }
}

#[test]
fn nav2_humble_forgets_after_a_pause() {
    let mut world = World::empty();
    let mut main = Mppi::new(&bringup(100), 5).unwrap();
    let mut humble = Mppi::new(&MppiParams { humble: true, ..bringup(100) }, 5).unwrap();
    for mppi in [&mut main, &mut humble] {
        world.step(mppi);
        mppi.paused(0.9);
        assert_eq!(mppi.draw, 1);
        mppi.paused(1.1);
    }
    assert_eq!((main.draw, humble.draw), (1, 2));
}

#[test]
fn nav2_humble_drives_as_well() {
    let params = MppiParams { humble: true, sgf_order: SgfOrder::Two, ..bringup(400) };
    let mut mppi = Mppi::new(&params, 5).unwrap();
    let mut world = World::empty();
    world.steps(&mut mppi, 120);
    assert!(world.pose.x > 6.0 && (world.pose.y - 5.0).abs() < 0.1, "{:?}", world.pose);
}

#[test]
fn a_delayed_base_is_told_earlier() {
    // Behind a delay of 0.2 s the controller still follows the plan.
    let params = MppiParams { model_delay_vx: 0.2, model_delay_wz: 0.2, ..bringup(400) };
    let mut mppi = Mppi::new(&params, 5).unwrap();
    let mut world = World::empty();
    let mut under_way = std::collections::VecDeque::from([Twist::default(); 4]);
    for _ in 0..120 {
        let command = world.command(&mut mppi).unwrap();
        under_way.push_back(command);
        let obeyed = under_way.pop_front().unwrap();
        world.carry_out(obeyed);
    }
    assert!(world.pose.x > 5.5 && (world.pose.y - 5.0).abs() < 0.15, "{:?}", world.pose);
}

#[test]
fn parameters_out_of_range_are_all_named_at_once() {
    let params = MppiParams {
        batch_size: 0,
        time_steps: 0,
        vx_std: -1.0,
        vx_max: f64::NAN,
        model_delay_wz: f64::INFINITY,
        motion_model: MotionModel::Ackermann { min_turning_r: 0.0 },
        ..MppiParams::default()
    };
    let bad = Mppi::new(&params, 1).map(|_| ()).unwrap_err();
    let keys: Vec<&str> = bad.0.iter().map(|bad| bad.key).collect();
    let wanted =
        ["batch_size", "time_steps", "vx_std", "vx_max", "model_delay_wz", "AckermannConstraints.min_turning_r"];
    assert_eq!(keys, wanted);
    assert!(bad.to_string().starts_with("`batch_size` is `0`; allowed: 1 to 1000000; "), "{bad}");
    let slow = MppiParams { controller_frequency: 10.0, ..MppiParams::default() };
    assert_eq!(slow.check().unwrap_err().0[0].allowed, "at least 1 / model_dt");
}
