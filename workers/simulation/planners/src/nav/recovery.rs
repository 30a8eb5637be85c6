//! What is done when stuck.

use socrates_model::geometry::wrap_angle;
use socrates_model::{Point, Pose, Vector};

use super::collision::touches;
use crate::controller::Twist;
use crate::costmap::Costmap;

/// Parameters of the recoveries; defaults are Nav2's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecoveryParams {
    /// So many recoveries a waypoint may take; default 6.
    pub number_of_retries: u32,
    /// Angle of a spin, rad; default 1.57.
    pub spin_dist: f64,
    /// Slowest spin, rad/s; default 0.4.
    pub min_rotational_vel: f64,
    /// Fastest spin, rad/s; default 1.
    pub max_rotational_vel: f64,
    /// Braking of a spin, rad/s²; default 3.2.
    pub rotational_acc_lim: f64,
    /// Length of a wait, s; default 5.
    pub wait_duration: f64,
    /// How far it backs up, m; default 0.3.
    pub backup_dist: f64,
    /// How fast it backs up, m/s; default 0.05, as in Humble (0.15 later).
    pub backup_speed: f64,
    /// Collisions are looked for so far ahead, s; default 2.
    pub simulate_ahead_time: f64,
    /// A spin or backing up that takes longer has failed, s; default 10.
    pub time_allowance: f64,
}

impl Default for RecoveryParams {
    fn default() -> Self {
        Self {
            number_of_retries: 6,
            spin_dist: 1.57,
            min_rotational_vel: 0.4,
            max_rotational_vel: 1.0,
            rotational_acc_lim: 3.2,
            wait_duration: 5.0,
            backup_dist: 0.3,
            backup_speed: 0.05,
            simulate_ahead_time: 2.0,
            time_allowance: 10.0,
        }
    }
}

/// One way to get free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Recovery {
    /// Both costmaps forget what they saw.
    ClearCostmaps,
    /// A quarter turn on the spot.
    Spin,
    /// A wait.
    Wait,
    /// A little way back.
    BackUp,
}

impl Recovery {
    /// They take turns in this order.
    pub const ROUND: [Self; 4] = [Self::ClearCostmaps, Self::Spin, Self::Wait, Self::BackUp];
}

/// How a recovery goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Going {
    /// It wants this.
    On(Twist),
    /// It is through.
    Done,
    /// It would hit something, or takes too long.
    Failed,
}

/// A recovery under way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Running {
    pub(super) kind: Recovery,
    since_s: f64,
    from: Pose,
    last_yaw: f64,
    turned: f64,
}

impl Running {
    pub(super) const fn new(kind: Recovery, pose: &Pose, now_s: f64) -> Self {
        Self { kind, since_s: now_s, from: *pose, last_yaw: pose.yaw, turned: 0.0 }
    }

    /// The next command.
    pub(super) fn step(
        &mut self,
        params: &RecoveryParams,
        pose: &Pose,
        now_s: f64,
        (map, footprint): (&Costmap, &[Point]),
    ) -> Going {
        let late = now_s - self.since_s > params.time_allowance;
        match self.kind {
            Recovery::ClearCostmaps => Going::Done,
            Recovery::Wait if now_s - self.since_s >= params.wait_duration => Going::Done,
            Recovery::Wait => Going::On(Twist::default()),
            Recovery::Spin => {
                self.turned += wrap_angle(pose.yaw - self.last_yaw).abs();
                self.last_yaw = pose.yaw;
                let left = params.spin_dist.abs() - self.turned;
                if left <= 0.0 {
                    return Going::Done;
                }
                let speed = libm::sqrt(2.0 * params.rotational_acc_lim * left);
                let speed = speed.max(params.min_rotational_vel).min(params.max_rotational_vel);
                let reach = left.min(speed * params.simulate_ahead_time);
                let omega = if params.spin_dist < 0.0 { -speed } else { speed };
                let turned = |by: f64| Pose { yaw: pose.yaw + by * omega.signum(), ..*pose };
                if late || steps(reach, SPIN_STEP_RAD).any(|by| touches(map, &turned(by), footprint)) {
                    return Going::Failed;
                }
                Going::On(Twist { omega, ..Twist::default() })
            }
            Recovery::BackUp => {
                let left = params.backup_dist - (pose.point() - self.from.point()).norm();
                if left <= 0.0 {
                    return Going::Done;
                }
                let reach = left.min(params.backup_speed * params.simulate_ahead_time);
                let back = -Vector::new(libm::cos(pose.yaw), libm::sin(pose.yaw));
                let moved = |by: f64| Pose::new(pose.x + back.x * by, pose.y + back.y * by, pose.yaw);
                let step_m = map.resolution_m() / 2.0;
                if late || steps(reach, step_m).any(|by| touches(map, &moved(by), footprint)) {
                    return Going::Failed;
                }
                Going::On(Twist { vx: -params.backup_speed, ..Twist::default() })
            }
        }
    }
}

/// A spin is looked through in steps of so much, rad.
const SPIN_STEP_RAD: f64 = 0.05;

/// Lengths from one step to `reach`.
fn steps(reach: f64, step: f64) -> impl Iterator<Item = f64> {
    (1_u32..).map(move |count| f64::from(count) * step).take_while(move |far| *far <= reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::{FREE, INSCRIBED};

    /// Runs a recovery of a robot that does as it is told.
    fn run(kind: Recovery, map: &Costmap) -> (Pose, f64, Going) {
        let mut pose = Pose::new(0.0, 0.0, 0.0);
        let mut running = Running::new(kind, &pose, 0.0);
        for call in 0_u32.. {
            let now_s = 0.05 * f64::from(call);
            match running.step(&RecoveryParams::default(), &pose, now_s, (map, &[])) {
                Going::On(twist) => {
                    pose.yaw += twist.omega * 0.05;
                    pose.x += twist.vx * 0.05;
                }
                end @ (Going::Done | Going::Failed) => return (pose, now_s, end),
            }
        }
        unreachable!("a recovery ends")
    }

    #[test]
    fn each_recovery_does_what_its_name_says() {
        let free = Costmap::new(100, 100, 0.05, Point::new(-2.5, -2.5), FREE);
        let (pose, took_s, end) = run(Recovery::Spin, &free);
        assert!(end == Going::Done && (1.57..1.63).contains(&pose.yaw) && (1.5..2.5).contains(&took_s), "{pose:?}");
        let (pose, took_s, end) = run(Recovery::BackUp, &free);
        assert!(end == Going::Done && (-0.303..=-0.3).contains(&pose.x) && (5.9..6.2).contains(&took_s), "{pose:?}");
        let (_, took_s, end) = run(Recovery::Wait, &free);
        assert!(end == Going::Done && (took_s - 5.0).abs() < 1e-9);
        assert_eq!(run(Recovery::ClearCostmaps, &free).2, Going::Done);
    }

    #[test]
    fn backing_up_fails_before_an_obstacle_behind() {
        let mut map = Costmap::new(100, 100, 0.05, Point::new(-2.5, -2.5), FREE);
        (0..100).for_each(|row| map.set(45, row, INSCRIBED));
        let (pose, _, end) = run(Recovery::BackUp, &map);
        assert!(end == Going::Failed && (-0.2..=-0.05).contains(&pose.x), "{pose:?}");
    }
}
