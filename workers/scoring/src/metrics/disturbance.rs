//! What people near the robot change about their walk, without a run to compare with.

use socrates_model::geometry::wrap_angle;

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, count, or_why};
use crate::tracks::{MOVING_MPS, Sample};

/// A person farther from the robot's surface than this is not disturbed by it, m (DR-MPC).
const REACH_M: f64 = 1.5;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "disturbance",
    thresholds: &[("reach_m", REACH_M), ("moving_mps", MOVING_MPS)],
    measure: Measure::Online(Begin(|humans| Box::new(Disturbance::new(humans)))),
};

#[derive(Clone)]
struct Disturbance {
    speed: f64,
    turn: f64,
    /// Whether the human was there at all.
    came: Vec<bool>,
}

impl Disturbance {
    fn new(humans: usize) -> Self {
        Self { speed: 0.0, turn: 0.0, came: vec![false; humans] }
    }

    fn step(&mut self, weight: f64, before: &Sample, after: &Sample) {
        self.speed += weight * (before.speed() - after.speed()).max(0.0);
        if before.speed() > MOVING_MPS && after.speed() > MOVING_MPS {
            let course = |sample: &Sample| libm::atan2(sample.velocity.y, sample.velocity.x);
            self.turn += weight * wrap_angle(course(after) - course(before)).abs();
        }
    }
}

impl Running for Disturbance {
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>) {
        for (came, human) in self.came.iter_mut().zip(now.humans) {
            *came |= human.there;
        }
        let Some((robot, others)) = now.before.filter(|(robot, _)| robot.there) else { return };
        for ((before, after), radius_m) in others.iter().zip(now.humans).zip(setting.humans_radius_m) {
            if before.there && after.there {
                let surface = ((robot.at - before.at).norm() - setting.robot_radius_m - radius_m).max(0.0);
                if surface < REACH_M {
                    self.step(1.0 - surface / REACH_M, before, after);
                }
            }
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let people = self.came.iter().filter(|came| **came).count();
        let mean = |sum: f64| or_why((people > 0).then(|| sum / count(people)), "no human is there while the robot is");
        vec![mean(self.speed), mean(self.turn)]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn who_stops_and_turns_beside_the_robot_loses_its_speed_and_turns_once_weighted_by_nearness() {
        // Stops from 1 m/s at 0.75 m between surfaces: half of it counts. Another stays away and halves the mean.
        let stops = || {
            vec![
                Walk::robot(0., 0., 0., 0.),
                Walk::human_through(1, &[(0., -4., 1.28), (4., 0., 1.28), (10., 0., 1.28)]),
                Walk::human(2, 9., 0., 0., 0.),
            ]
        };
        // Just before it stands it is at 0.03 m less, seen over two steps.
        at_both_rates(&stops, 10.0, "disturbance_speed", 1.0 * 0.5 / 2.0, 0.005);
        at_both_rates(&stops, 10.0, "disturbance_turn", 0.0, 1e-9);
        // Turns by a right angle at the same place, without getting slower for longer than the corner.
        let turns = || {
            vec![
                Walk::robot(0., 0., 0., 0.),
                Walk::human_through(1, &[(0., -4., 1.28), (4., 0., 1.28), (10., 0., 7.28)]),
            ]
        };
        at_both_rates(&turns, 10.0, "disturbance_turn", std::f64::consts::FRAC_PI_2 * 0.5, 0.03);
    }

    #[test]
    fn far_away_is_no_disturbance_and_nobody_is_no_figure() {
        let far = recording(
            &[Walk::robot(0., 0., 0., 0.), Walk::human_through(1, &[(0., -4., 3.), (4., 0., 3.), (10., 0., 3.)])],
            10.0,
            0.1,
        );
        assert_eq!(value(&far, "disturbance_speed"), Some(0.0));
        let alone = recording(&[Walk::robot(0., 0., 0.5, 0.)], 4.0, 0.1);
        assert_eq!((value(&alone, "disturbance_speed"), value(&alone, "disturbance_turn")), (None, None));
    }
}
