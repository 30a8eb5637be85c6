//! Times at which somebody is headed straight for somebody else: headings in place of gazes.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured};
use crate::running::{Below, Pen};
use crate::tracks::Sample;

/// Half of the cone within which somebody is looked at, rad (5°, Arena).
const CONE_RAD: f64 = 5.0 / 180.0 * std::f64::consts::PI;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "gaze",
    thresholds: &[("cone_rad", CONE_RAD)],
    measure: Measure::Online(Begin(|_| Box::new(Gaze::new()))),
};

#[derive(Clone)]
struct Gaze {
    watched: (Pen, Below),
    watching: (Pen, Below),
}

impl Gaze {
    fn new() -> Self {
        let none = (Pen::default(), Below::level(CONE_RAD));
        Self { watched: none, watching: none }
    }
}

impl Running for Gaze {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        let robot = now.robot.filter(|robot| robot.there);
        let least = |angle: &dyn Fn(&Sample, &Sample) -> f64| {
            let there = now.humans.iter().filter(|human| human.there);
            robot.and_then(|robot| there.map(|human| angle(robot, human)).reduce(f64::min))
        };
        let watched = least(&|robot, human| human.bearing(&robot.at).abs());
        let watching = least(&|robot, human| robot.bearing(&human.at).abs());
        for ((pen, below), angle) in [(&mut self.watched, watched), (&mut self.watching, watching)] {
            below.add(pen.to(now.t, angle));
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        vec![Ok(self.watched.1.seconds()), Ok(self.watching.1.seconds())]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn somebody_who_faces_the_way_sees_the_robot_cross_a_cone_of_ten_degrees() {
        // At 4 m before the person the robot crosses ahead at 0.5 m/s: twice 4 m tan 5° of way.
        let walks =
            || vec![Walk::robot(-3., 4., 0.5, 0.), Walk::human(1, 0., 0., 0., 0.).facing(std::f64::consts::FRAC_PI_2)];
        let chord = 2.0 * 4.0 * (5.0_f64 / 180.0 * std::f64::consts::PI).tan() / 0.5;
        at_both_rates(&walks, 12.0, "time_watched", chord, 0.01);
        at_both_rates(&walks, 12.0, "time_watching", 0.0, 1e-9);
        // Straight for somebody who looks away: watching all the time, never watched.
        let behind = || vec![Walk::robot(-3., 0., 0.2, 0.), Walk::human(1, 0., 0., 0., 0.)];
        at_both_rates(&behind, 10.0, "time_watching", 10.0, 1e-6);
        at_both_rates(&behind, 10.0, "time_watched", 0.0, 1e-9);
        assert_eq!(value(&recording(&[Walk::robot(0., 0., 0.5, 0.)], 4.0, 0.1), "time_watched"), None);
    }
}
