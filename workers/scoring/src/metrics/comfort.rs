//! Comfort of people as two published models have it, and the end of a run that took too long.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, Scene, count, or_why};
use crate::running::Mean;
use crate::tracks::Sample;

/// Mass of the robot in the energy of a contact, kg: of a delivery robot, where none is stated.
const MASS_KG: f64 = 50.0;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "comfort",
    thresholds: &[("mass_kg", MASS_KG)],
    measure: Measure::Online(Begin(|_| Box::new(Comfort::default()))),
};

/// What people do after the robot has arrived counts too.
pub(super) const TOGETHER: Family = Family {
    name: "comfort_together",
    thresholds: &[],
    measure: Measure::Whole { measure: together, why: "people walk on after the robot has arrived" },
};

/// The person's Gaussian at a point: 1 at the person.
fn gaussian(person: &Sample, robot: &Sample) -> f64 {
    let line = robot.at - person.at;
    let front = (2.0 * person.speed()).max(0.5);
    // Farther than in any direction the Gaussian reaches; a little more, so that rounding decides nothing.
    if line.norm_squared() > 62.0 * front * front {
        return 0.0;
    }
    let facing = person.course();
    let (ahead, aside) = (facing.dot(&line), facing.perp(&line));
    let along = if ahead >= 0.0 { front } else { front / 2.0 };
    let across = front * 2.0 / 3.0;
    let size = (ahead * ahead) / (2.0 * along * along) + (aside * aside) / (2.0 * across * across);
    // From here on it is less than 1e-13 and not worth an exponential.
    if size > 30.0 { 0.0 } else { libm::exp(-size) }
}

#[derive(Clone, Default)]
struct Comfort {
    discomfort: Mean,
    energy: f64,
}

impl Running for Comfort {
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>) {
        let Some(robot) = now.robot else { return };
        let there = now.humans.iter().filter(|human| human.there);
        let felt = robot.there.then(|| there.map(|human| gaussian(human, robot)).fold(0.0, f64::max));
        self.discomfort.add(now.t, felt);
        for (human, radius_m) in now.humans.iter().zip(setting.humans_radius_m) {
            let touch = setting.robot_radius_m + radius_m;
            if robot.there && human.there && (robot.at - human.at).norm() < touch {
                self.energy = self.energy.max(MASS_KG * (robot.velocity - human.velocity).norm_squared() / 2.0);
            }
        }
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        vec![
            Ok(self.discomfort.integral()),
            Ok(self.energy),
            Ok(count(end.contacts + end.walls.spans().len())),
            Err("recordings hold one robot".to_owned()),
            Ok(if end.arrived_s.is_some() { 0.0 } else { 1.0 }),
        ]
    }
}

/// The end of everybody's walk.
fn together(scene: &Scene<'_>) -> Vec<Measured> {
    let begin = scene.robot().and_then(|robot| robot.samples.first()).map_or(0.0, |sample| sample.t);
    let over = scene.arrived_s.map(|arrived| {
        let last = |samples: &[Sample]| {
            let mut there = samples.iter().rev().filter(|sample| sample.there);
            there.find(|sample| sample.speed() > crate::tracks::MOVING_MPS).map_or(0.0, |s| s.t)
        };
        scene.whole.humans.iter().map(|human| last(&human.samples)).fold(arrived, f64::max) - begin
    });
    vec![or_why(over, "the robot never arrives")]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn kirby_of_a_standing_person_has_its_closed_form() {
        // Beside a person who looks along x, the robot passes at y = 1 along x: across = 1/3, along 1/2 and 1/4.
        let walks = || vec![Walk::robot(-5., 1., 0.5, 0.), Walk::human(1, 0., 0., 0., 0.)];
        let across = (-1.0 / (2.0 / 9.0_f64)).exp();
        let wanted = across * (PI / 2.0).sqrt() * (0.5 + 0.25) / 0.5;
        at_both_rates(&walks, 20.0, "kirby_discomfort", wanted, 0.02 * wanted);
    }

    #[test]
    fn energy_is_that_of_the_relative_motion_and_0_without_contact() {
        let meet = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 2., 0., -1., 0.)], 1.0, 0.05);
        assert_eq!(value(&meet, "contact_energy_max"), Some(100.0));
        let past = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 2., 2., -1., 0.)], 1.0, 0.05);
        assert_eq!(value(&past, "contact_energy_max"), Some(0.0));
    }
}
