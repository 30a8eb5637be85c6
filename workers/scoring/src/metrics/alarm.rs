//! Two costs of planners among people, as the largest of a run: how soon the two would touch, and how narrowly they miss.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured};
use crate::tracks::Sample;

/// Largest value of both, 1/s: that of a time to collision of 0.1 s, and of a contact (SocNav3 has 10 for a contact).
const MOST_PER_S: f64 = 10.0;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "alarm",
    thresholds: &[("most_per_s", MOST_PER_S)],
    measure: Measure::Online(Begin(|_| Box::new(Alarm::default()))),
};

#[derive(Clone, Default)]
struct Alarm {
    fear: f64,
    panic: f64,
}

/// How narrowly two miss each other at constant velocity, 1/s; 0 for two who do not come nearer or would touch.
fn panic(robot: &Sample, human: &Sample, radii_m: f64) -> f64 {
    let (line, velocity) = (human.at - robot.at, robot.velocity - human.velocity);
    let (apart, speed) = (line.norm(), velocity.norm());
    if apart <= radii_m || speed < 1e-9 || line.dot(&velocity) <= 0.0 {
        return 0.0;
    }
    let miss = line.perp(&velocity).abs() / speed;
    if miss <= radii_m { 0.0 } else { (speed / apart * miss / (miss - radii_m)).min(MOST_PER_S) }
}

impl Running for Alarm {
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>) {
        let soonest = now.ttc_s.iter().copied().flatten().reduce(f64::min);
        if let Some(soonest) = soonest {
            self.fear = self.fear.max(if soonest * MOST_PER_S <= 1.0 { MOST_PER_S } else { 1.0 / soonest });
        }
        let Some(robot) = now.robot.filter(|robot| robot.there) else { return };
        for (human, radius_m) in now.humans.iter().zip(setting.humans_radius_m).filter(|(human, _)| human.there) {
            self.panic = self.panic.max(panic(robot, human, setting.robot_radius_m + radius_m));
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        vec![Ok(self.fear), Ok(self.panic)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn fear_is_one_over_the_shortest_time_to_collision() {
        // Head on at 0.5 m/s from 3.53 m: 3 m between surfaces; after 4 s 1 m is left, 2 s.
        let walks = || vec![Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 3.53, 0., 0., 0.)];
        at_both_rates(&walks, 4.0, "fear_max", 0.5, 1e-6);
        at_both_rates(&walks, 7.0, "fear_max", 10.0, 1e-9);
        let away = recording(&[Walk::robot(0., 0., -0.5, 0.), Walk::human(1, 3.53, 0., 0., 0.)], 4.0, 0.1);
        assert_eq!((value(&away, "fear_max"), value(&away, "panic_max")), (Some(0.0), Some(0.0)));
        let alone = recording(&[Walk::robot(0., 0., 0.5, 0.)], 4.0, 0.1);
        assert_eq!((value(&alone, "fear_max"), value(&alone, "panic_max")), (None, None));
    }

    #[test]
    fn panic_of_a_pass_is_that_of_the_nearest_moment_before_it() {
        // Past a standing person at 1.06 m, twice the radii: V / C times 2, and C is least beside it.
        let walks = || vec![Walk::robot(-4., 1.06, 0.8, 0.), Walk::human(1, 0., 0., 0., 0.)];
        at_both_rates(&walks, 10.0, "panic_max", 0.8 / 1.06 * 2.0, 0.01);
        // 0.1 m of room of 0.63 m: capped.
        let narrow = || vec![Walk::robot(-4., 0.54, 0.8, 0.), Walk::human(1, 0., 0., 0., 0.)];
        at_both_rates(&narrow, 10.0, "panic_max", MOST_PER_S, 1e-9);
    }
}
