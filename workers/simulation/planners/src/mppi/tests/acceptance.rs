//! A scene whose outcome was recorded from Nav2's own optimizer.

use super::*;
use crate::mppi::MotionModel;

/// What a run came to.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    /// The first speed, m/s.
    first_mps: f64,
    /// Speed after 16 cycles, m/s.
    early_mps: f64,
    /// Slowest between x = 4.9 m and x = 5.3 m, m/s.
    slowest_mps: f64,
    /// Lowest y, m, and where.
    lowest_m: f64,
    lowest_at_m: f64,
    /// Fastest beyond x = 5.85 m, m/s.
    late_mps: f64,
    /// Least distance between the robot's center and the obstacle's edge, m.
    clearance_m: f64,
    end: Pose,
}

/// 240 cycles at 20 Hz past a disc beside the plan.
fn run(params: &MppiParams, seed: u64, outline: &[Point]) -> Outcome {
    let mut world = World::empty().with_disc(6.0, 5.1, 0.2);
    world.outline = outline.to_vec();
    let mut mppi = Mppi::new(params, seed).unwrap();
    let mut outcome = Outcome {
        first_mps: 0.0,
        early_mps: 0.0,
        slowest_mps: f64::INFINITY,
        lowest_m: f64::INFINITY,
        lowest_at_m: 0.0,
        late_mps: 0.0,
        clearance_m: f64::INFINITY,
        end: world.pose,
    };
    for cycle in 0..240 {
        let command = world.step(&mut mppi);
        let pose = world.pose;
        match cycle {
            0 => outcome.first_mps = command.vx,
            16 => outcome.early_mps = command.vx,
            _ => (),
        }
        if (4.9..5.3).contains(&pose.x) {
            outcome.slowest_mps = outcome.slowest_mps.min(command.vx);
        }
        if pose.x > 5.85 {
            outcome.late_mps = outcome.late_mps.max(command.vx);
        }
        if pose.y < outcome.lowest_m {
            (outcome.lowest_m, outcome.lowest_at_m) = (pose.y, pose.x);
        }
        outcome.clearance_m = outcome.clearance_m.min(libm::hypot(pose.x - 6.0, pose.y - 5.1) - 0.2);
        outcome.end = pose;
    }
    outcome
}

#[test]
fn print_outcomes() {
    for seed in 0..20 {
        println!("diff 2000 {:?}", run(&bringup(2000), seed, &[]));
    }
    for seed in 0..8 {
        println!("diff 400 {:?}", run(&bringup(400), seed, &[]));
    }
    for seed in 0..6 {
        let omni = MppiParams { motion_model: MotionModel::Omni, ..bringup(2000) };
        println!("omni 2000 {:?}", run(&omni, seed, &[]));
    }
    for seed in 0..3 {
        let square = [(0.22, 0.22), (-0.22, 0.22), (-0.22, -0.22), (0.22, -0.22)].map(|(x, y)| Point::new(x, y));
        let mut params = bringup(2000);
        params.cost_critic.consider_footprint = true;
        params.surroundings.circumscribed_radius = 0.3111;
        println!("square 2000 {:?}", run(&params, seed, &square));
    }
}
