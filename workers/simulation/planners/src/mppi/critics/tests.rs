//! Every critic against numbers worked out elsewhere: 1000 trajectories of 30 steps of 0.1 s, and what Nav2's own tests expect of them.

use socrates_model::{Point, Pose};

use super::*;
use crate::costmap::{Costmap, FREE, INSCRIBED, LETHAL, UNKNOWN};
use crate::mppi::ground::Ground;
use crate::mppi::lanes::Instructions;
use crate::mppi::params::MotionModel;
use crate::mppi::rows::Rows;
use crate::mppi::scene::Plan;

const BATCH: usize = 1000;
const STEPS: usize = 30;

/// A batch in front of critics.
struct Stage {
    params: MppiParams,
    rollout: Rollout,
    plan: Plan,
    costmap: Costmap,
    outline: Vec<Point>,
    yaw: f32,
    goal_yaw: f32,
    left_m: f32,
    furthest: Option<usize>,
    failed: bool,
}

impl Stage {
    /// Trajectories that stand at the origin of an empty floor, far from the goal.
    fn new() -> Self {
        Self::moving(MotionModel::DiffDrive)
    }

    fn moving(motion_model: MotionModel) -> Self {
        let params = MppiParams { batch_size: BATCH, motion_model, ..MppiParams::default() };
        let rollout = Rollout::zeros(BATCH, STEPS, 0.1, motion_model == MotionModel::Omni);
        Self {
            params,
            rollout,
            plan: Plan::default(),
            costmap: Costmap::new(100, 100, 0.1, Point::new(-5.0, -5.0), FREE),
            outline: Vec::new(),
            yaw: 0.0,
            goal_yaw: 0.0,
            left_m: 10.0,
            furthest: None,
            failed: false,
        }
    }

    /// Costs by the critic of this name.
    fn costs(&mut self, name: &str) -> Vec<f32> {
        let mut critic = named(name).expect("in the catalog").critic(&self.params).expect("enabled");
        let mut verdict = Verdict::new(self.rollout.length.len());
        if let Some(furthest) = self.furthest {
            verdict.set_furthest(furthest);
        }
        let robot = Pose::new(0.0, 0.0, f64::from(self.yaw));
        let scene = Scene {
            plan: &self.plan,
            ground: Ground::new(&self.costmap, &robot, &self.outline, self.params.surroundings.track_unknown_space),
            yaw: self.yaw,
            goal_yaw: self.goal_yaw,
            left_m: self.left_m,
            humble: self.params.humble,
            arch: Instructions::Detected.arch(),
        };
        critic.score(&scene, &self.rollout, &mut verdict);
        self.failed = verdict.failed;
        verdict.costs[..BATCH].to_vec()
    }

    /// Asserts that every trajectory costs so much.
    #[track_caller]
    fn each(&mut self, name: &str, wanted: f32) {
        let costs = self.costs(name);
        let wrong = costs.iter().find(|cost| (*cost - wanted).abs() > 2e-5 * wanted.abs().max(1.0));
        assert!(wrong.is_none(), "{name}: {wrong:?} instead of {wanted}");
    }

    /// A plan along x with these distances from the robot.
    fn plan_along_x(&mut self, xs: impl IntoIterator<Item = f32>) {
        self.plan.clear();
        xs.into_iter().for_each(|x| self.plan.push(x, 0.0, 0.0));
    }
}

fn fill(rows: &mut Rows, value: f32) {
    rows.iter_mut().for_each(|row| row.fill(value));
}

#[test]
fn constraint_charges_speeds_beyond_the_limits() {
    let mut stage = Stage::new();
    stage.each("ConstraintCritic", 0.0);
    fill(&mut stage.rollout.speeds.vx, 0.60);
    stage.each("ConstraintCritic", 1.2);
    fill(&mut stage.rollout.speeds.vx, -0.45);
    stage.each("ConstraintCritic", 1.2);
    stage.params.constraint_critic.cost_power = 2;
    stage.each("ConstraintCritic", 1.44);
}

#[test]
fn constraint_charges_turns_that_a_car_cannot_make() {
    let mut stage = Stage::moving(MotionModel::Ackermann { min_turning_r: 0.2 });
    fill(&mut stage.rollout.speeds.vx, 0.4);
    fill(&mut stage.rollout.speeds.wz, 1.5);
    stage.each("ConstraintCritic", 0.0);
    fill(&mut stage.rollout.speeds.wz, 2.5);
    stage.each("ConstraintCritic", 0.48);
    stage.params.constraint_critic.cost_power = 2;
    stage.each("ConstraintCritic", 0.2304);
}

#[test]
fn constraint_charges_speeds_to_the_side() {
    let mut stage = Stage::moving(MotionModel::Omni);
    stage.params.vy_max = 0.3;
    fill(&mut stage.rollout.speeds.vy, -0.5);
    stage.each("ConstraintCritic", 2.4);
    fill(&mut stage.rollout.speeds.vx, 0.6);
    stage.each("ConstraintCritic", 3.6);
    stage.params.constraint_critic.cost_power = 2;
    stage.each("ConstraintCritic", 12.96);
}

#[test]
fn constraint_of_nav2_humble_charges_the_length_of_the_velocity() {
    let mut stage = Stage::new();
    (stage.params.humble, stage.params.vx_max, stage.params.vx_min, stage.params.vy_max) = (true, 1.0, 0.0, 1.0);
    fill(&mut stage.rollout.speeds.vx, 1.4);
    stage.each("ConstraintCritic", 0.0);
    fill(&mut stage.rollout.speeds.vx, 1.5);
    stage.each("ConstraintCritic", 4.0 * 3.0 * (1.5 - 2.0_f32.sqrt()));
    fill(&mut stage.rollout.speeds.vx, -1.1);
    stage.each("ConstraintCritic", 1.2);
}

#[test]
fn goal_angle_charges_the_mean_angle_near_the_goal() {
    let mut stage = Stage::new();
    // As Nav2 has it: 3.14.
    stage.goal_yaw = 314.0 / 100.0;
    stage.left_m = 0.3;
    stage.each("GoalAngleCritic", 9.42);
    stage.params.goal_angle_critic.symmetric_yaw_tolerance = true;
    stage.each("GoalAngleCritic", 3.0 * (std::f32::consts::PI - 314.0 / 100.0));
    for left_m in [0.8, 9.0] {
        stage.left_m = left_m;
        stage.each("GoalAngleCritic", 0.0);
    }
}

#[test]
fn goal_charges_the_mean_distance_near_the_goal() {
    let mut stage = Stage::new();
    stage.plan_along_x([0.0, 0.5]);
    stage.left_m = 0.5;
    stage.each("GoalCritic", 2.5);
    stage.left_m = 1.5;
    stage.each("GoalCritic", 0.0);
}

#[test]
fn path_angle_charges_looking_off_the_plan() {
    let mut stage = Stage::new();
    for _ in 0..10 {
        stage.plan.push(-1.0, 4.0, 0.0);
    }
    stage.each("PathAngleCritic", 3.9947);
    for mode in [PathAngleMode::EitherWay, PathAngleMode::PlanHeading] {
        stage.params.path_angle_critic.mode = mode;
        // 2.2 * (pi - atan2(4, -1)); Nav2's test has 2.9167 within 1e-3.
        stage.each("PathAngleCritic", 2.9168);
    }
    let mut stage = Stage::new();
    stage.plan_along_x([1.0; 10]);
    stage.each("PathAngleCritic", 0.0);
    stage.left_m = 0.4;
    stage.plan.clear();
    stage.plan.push(-1.0, 4.0, 0.0);
    stage.each("PathAngleCritic", 0.0);
}

#[test]
fn prefer_forward_charges_driving_backward() {
    let mut stage = Stage::new();
    fill(&mut stage.rollout.speeds.vx, 1.0);
    stage.each("PreferForwardCritic", 0.0);
    fill(&mut stage.rollout.speeds.vx, -1.0);
    stage.each("PreferForwardCritic", 15.0);
    stage.left_m = 0.4;
    stage.each("PreferForwardCritic", 0.0);
}

#[test]
fn twirling_charges_turning_away_from_the_goal() {
    let mut stage = Stage::new();
    fill(&mut stage.rollout.speeds.wz, -10.0);
    stage.each("TwirlingCritic", 100.0);
    stage.left_m = 0.2;
    stage.each("TwirlingCritic", 0.0);
}

#[test]
fn velocity_deadband_charges_speeds_that_are_not_carried_out() {
    let mut stage = Stage::moving(MotionModel::Omni);
    stage.params.velocity_deadband_critic.deadband_velocities = [0.08; 3];
    fill(&mut stage.rollout.speeds.vx, 0.01);
    fill(&mut stage.rollout.speeds.vy, 0.02);
    fill(&mut stage.rollout.speeds.wz, 0.021);
    stage.each("VelocityDeadbandCritic", 19.845);
    fill(&mut stage.rollout.speeds.vx, -0.8);
    fill(&mut stage.rollout.speeds.vy, 0.8);
    fill(&mut stage.rollout.speeds.wz, -0.8);
    stage.each("VelocityDeadbandCritic", 0.0);
}

#[test]
fn path_follow_charges_the_distance_to_a_point_ahead() {
    let mut stage = Stage::new();
    stage.plan_along_x([0.0, 0.0, 0.0, 0.0, 0.0, 0.15]);
    stage.each("PathFollowCritic", 0.75);
    stage.left_m = 1.3;
    stage.each("PathFollowCritic", 0.0);
}

#[test]
fn path_follow_goes_past_points_that_are_blocked() {
    let mut stage = Stage::new();
    stage.params.path_follow_critic.offset_from_furthest = 1;
    stage.plan_along_x([0.0, 0.15, 0.25, 0.35, 0.45]);
    stage.furthest = Some(0);
    stage.each("PathFollowCritic", 0.75);
    stage.costmap.set(51, 50, LETHAL);
    stage.costmap.set(52, 50, INSCRIBED);
    stage.each("PathFollowCritic", 1.75);
}

/// The plan of Nav2's test: 22 points up to 0.9 m, trajectories at 0.66 m.
fn aligned() -> Stage {
    let mut stage = Stage::new();
    stage.plan_along_x((0..22_u8).map(|number| 0.1 * f32::from(number.min(9))));
    fill(&mut stage.rollout.x, 0.66);
    stage.furthest = Some(21);
    stage
}

#[test]
fn path_align_charges_the_distance_to_the_plan() {
    let mut stage = aligned();
    let total: f32 = stage.costs("PathAlignCritic").iter().sum();
    assert!((total - 6600.0).abs() < 0.5, "{total}");
    stage.furthest = Some(19);
    stage.each("PathAlignCritic", 0.0);
    stage.furthest = Some(21);
    stage.left_m = 0.4;
    stage.each("PathAlignCritic", 0.0);
}

#[test]
fn path_align_leaves_a_blocked_plan_to_others() {
    let mut stage = aligned();
    stage.costmap.costs_mut().fill(LETHAL);
    stage.each("PathAlignCritic", 0.0);
    // Two blocked points never matter, and samples that belong to them do not count.
    let mut stage = aligned();
    stage.costmap.set(54, 50, LETHAL);
    stage.each("PathAlignCritic", 6.6);
    stage.costmap.set(50, 50, LETHAL);
    stage.each("PathAlignCritic", 0.0);
}

#[test]
fn path_align_goes_along_with_the_length_traveled() {
    let mut stage = Stage::new();
    stage.plan_along_x((0..60_u8).map(|number| 0.05 * f32::from(number)));
    for (step, row) in (0_u8..).zip(stage.rollout.x.iter_mut()) {
        row.fill(0.05 * f32::from(step));
    }
    fill(&mut stage.rollout.y, 0.2);
    stage.furthest = Some(40);
    // Beside the plan and as far along it: 0.2 m off all the time.
    stage.each("PathAlignCritic", 2.0);
    stage.params.path_align_critic.use_path_orientations = true;
    fill(&mut stage.rollout.yaw, 0.15);
    stage.each("PathAlignCritic", 2.5);
}

#[test]
fn the_furthest_point_is_no_farther_than_a_trajectory_is_long() {
    let mut stage = Stage::new();
    // There and back: the end of the plan is beside its beginning.
    for x in (0..20_u8).chain((0..20).rev()) {
        stage.plan.push(0.1 * f32::from(x), if stage.plan.len() < 20 { 0.0 } else { 0.3 }, 0.0);
    }
    fill(&mut stage.rollout.y, 0.2);
    fill(&mut stage.rollout.x, 0.5);
    let robot = Pose::new(0.0, 0.0, 0.0);
    let furthest = |stage: &Stage, humble| {
        let scene = Scene {
            plan: &stage.plan,
            ground: Ground::new(&stage.costmap, &robot, &[], false),
            yaw: 0.0,
            goal_yaw: 0.0,
            left_m: 10.0,
            humble,
            arch: Instructions::Detected.arch(),
        };
        Verdict::new(BATCH).furthest(&scene, &stage.rollout)
    };
    stage.rollout.length.fill(0.61);
    assert_eq!(furthest(&stage, false), 5);
    assert_eq!(furthest(&stage, true), 34);
    stage.rollout.length[17] = 9.0;
    assert_eq!(furthest(&stage, false), 34, "one trajectory is long enough");
}

#[test]
fn cost_charges_cells_by_their_cost() {
    let mut stage = Stage::new();
    stage.each("CostCritic", 0.0);
    stage.costmap.costs_mut().fill(100);
    stage.each("CostCritic", 3.81 * 100.0 / 254.0);
    stage.left_m = 0.4;
    stage.each("CostCritic", 0.0);
    stage.left_m = 10.0;
    stage.params.cost_critic.near_collision_cost = 90;
    stage.each("CostCritic", 3.81 * 300.0 / 254.0);
    assert!(!stage.failed);
}

#[test]
fn cost_charges_a_collision_once_and_fails_when_all_collide() {
    // One step in 15 that are looked at is in the obstacle.
    let mut stage = Stage::new();
    stage.rollout.x.row_mut(10)[..BATCH / 2].fill(1.05);
    for (cost, collides) in [(LETHAL, true), (INSCRIBED, true), (UNKNOWN, true), (252, false)] {
        stage.costmap.set(60, 50, cost);
        let costs = stage.costs("CostCritic");
        let wanted = if collides { 1e6 } else { f32::from(cost) } * 3.81 / 254.0 / 15.0;
        assert!((costs[0] / wanted - 1.0).abs() < 1e-4, "{cost}: {} {wanted}", costs[0]);
        assert!(costs[BATCH - 1].abs() < 1e-9 && !stage.failed);
    }
    stage.params.surroundings.track_unknown_space = true;
    stage.costmap.set(60, 50, UNKNOWN);
    assert!((stage.costs("CostCritic")[0] - 3.81 * 300.0 / 254.0 / 15.0).abs() < 1e-4, "unknown is tracked");
    stage.costmap.costs_mut().fill(LETHAL);
    stage.costs("CostCritic");
    assert!(stage.failed);
}

#[test]
fn cost_looks_at_the_outline_where_it_may_touch() {
    let mut stage = Stage::new();
    stage.outline = [(0.3, 0.1), (-0.3, 0.1), (-0.3, -0.1), (0.3, -0.1)].map(|(x, y)| Point::new(x, y)).to_vec();
    stage.params.cost_critic.consider_footprint = true;
    (stage.params.surroundings.inscribed_radius, stage.params.surroundings.circumscribed_radius) = (0.1, 0.3162);
    // trunc(252 * exp(-3 * 0.2162)) = 131.
    stage.costmap.set(50, 50, 131);
    stage.costmap.set(52, 50, LETHAL);
    stage.rollout.x.iter_mut().for_each(|row| row.fill(0.02));
    stage.costs("CostCritic");
    assert!(stage.failed, "an edge is on the lethal cell");
    stage.costmap.set(50, 50, 130);
    stage.each("CostCritic", 3.81 * 130.0 / 254.0);
    assert!(!stage.failed, "too far away to be looked at");
    stage.costmap.set(50, 50, INSCRIBED);
    stage.costmap.set(52, 50, FREE);
    stage.each("CostCritic", 3.81 * 300.0 / 254.0);
}

#[test]
fn obstacles_charges_being_close_and_being_closer_than_others() {
    let mut stage = Stage::new();
    let around = &mut stage.params.surroundings;
    (around.cost_scaling_factor, around.inscribed_radius, around.inflation_radius) = (3.0, 0.2, 0.7);
    // Half of the batch stands where the distance to the obstacle is 0.05 m from the edge, half on free floor.
    let cost = (253.0 * libm::exp(-3.0 * 0.05)) as u8;
    stage.rollout.x.iter_mut().for_each(|row| row[..BATCH / 2].fill(1.05));
    stage.costmap.set(60, 50, cost);
    let distance = (libm::log(253.0) - libm::log(f64::from(cost))) / 3.0;
    let wanted = 20.0 * 30.0 * (0.1 - distance) + 1.5 * (0.7 - distance);
    let costs = stage.costs("ObstaclesCritic");
    assert!((f64::from(costs[0]) - wanted).abs() < 1e-3, "{} {wanted}", costs[0]);
    assert!(costs[BATCH - 1].abs() < 1e-9);
    stage.left_m = 0.4;
    assert!((f64::from(stage.costs("ObstaclesCritic")[0]) - 20.0 * 30.0 * (0.1 - distance)).abs() < 1e-3);
    stage.costmap.set(60, 50, LETHAL);
    assert!((stage.costs("ObstaclesCritic")[0] / 2e6 - 1.0).abs() < 1e-4);
    assert!(!stage.failed);
    stage.costmap.costs_mut().fill(LETHAL);
    stage.costs("ObstaclesCritic");
    assert!(stage.failed);
}

#[test]
fn every_critic_has_a_name_of_nav2_and_can_be_switched_off() {
    let mut params = MppiParams { critics: CATALOG.iter().collect(), ..MppiParams::default() };
    assert!(CATALOG.iter().all(|sheet| sheet.name.ends_with("Critic") && sheet.critic(&params).is_some()));
    for enabled in [
        &mut params.constraint_critic.enabled,
        &mut params.cost_critic.enabled,
        &mut params.obstacles_critic.enabled,
        &mut params.goal_critic.enabled,
        &mut params.goal_angle_critic.enabled,
        &mut params.path_align_critic.enabled,
        &mut params.path_follow_critic.enabled,
        &mut params.path_angle_critic.enabled,
        &mut params.prefer_forward_critic.enabled,
        &mut params.twirling_critic.enabled,
        &mut params.velocity_deadband_critic.enabled,
    ] {
        *enabled = false;
    }
    assert!(CATALOG.iter().all(|sheet| sheet.critic(&params).is_none()));
}
