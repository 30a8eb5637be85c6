//! Deceleration needed to avoid a crash, and speed near people.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, or_why};
use crate::running::{MeanWhileBelow, Pen};
use crate::tracks::Sample;
use socrates_model::Vector;

/// Nearer than this is near people, m (the outer limit of Hall's personal zone).
const NEAR_M: f64 = 1.2;
/// Surfaces nearer than this have met: the deceleration would be without bound, m.
const TOUCH_M: f64 = 0.01;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "drac",
    thresholds: &[("near_m", NEAR_M), ("touch_m", TOUCH_M)],
    measure: Measure::Online(Begin(|humans| Box::new(Crash::new(humans)))),
};

/// Velocity of the human against the robot.
fn relative(r: &Sample, h: &Sample) -> Vector {
    h.velocity - r.velocity
}

/// Closing speed squared over twice the gap.
fn drac(line: &Vector, motion: &Vector, gap: f64) -> f64 {
    let closing = (-line.dot(motion) / line.norm()).max(0.0);
    closing * closing / (2.0 * gap)
}

#[derive(Clone)]
struct Crash {
    top: Option<f64>,
    /// Gap, robot and human when both were last there, by human.
    before: Vec<Option<(f64, Sample, Sample)>>,
    pen: Pen,
    speed: MeanWhileBelow,
}

impl Crash {
    fn new(humans: usize) -> Self {
        Self { top: None, before: vec![None; humans], pen: Pen::default(), speed: MeanWhileBelow::level(NEAR_M) }
    }
}

impl Running for Crash {
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>) {
        let Some(r) = now.robot else { return };
        self.speed.add(self.pen.to(now.t, Some(r.speed())), now.nearest_piece);
        for ((before, h), radius_m) in self.before.iter_mut().zip(now.humans).zip(setting.humans_radius_m) {
            if !(r.there && h.there) {
                continue;
            }
            let gap = (h.at - r.at).norm() - (setting.robot_radius_m + radius_m);
            // Where the two meet or part between samples, the limit lies there and not at a sample.
            let found = match before {
                Some((last, p, q)) if (*last < TOUCH_M) != (gap < TOUCH_M) => {
                    let share = (TOUCH_M - *last) / (gap - *last);
                    let (line, motion) =
                        ((q.at - p.at).lerp(&(h.at - r.at), share), relative(p, q).lerp(&relative(r, h), share));
                    Some(drac(&line, &motion, TOUCH_M))
                }
                _ => (gap >= TOUCH_M).then(|| drac(&(h.at - r.at), &relative(r, h), gap)),
            };
            if let Some(found) = found {
                self.top = Some(self.top.map_or(found, |old: f64| old.max(found)));
            }
            *before = Some((gap, *r, *h));
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        vec![or_why(self.top, "the two are always in contact"), or_why(self.speed.mean(), "nobody comes within 1.2 m")]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn the_deceleration_is_that_of_stopping_in_the_gap() {
        // After 2 s: centers 2.53 m apart, gap 2 m, closing at 1 m/s: 1 / 4 m/s².
        let run = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 4.53, 0., 0., 0.)], 2.0, 0.1);
        assert!((value(&run, "drac_max").unwrap() - 0.25).abs() < 1e-6);
        assert_eq!(value(&run, "speed_near_people"), None);
        // Into contact at 1 m/s: the limit of 0.01 m decides, at any rate.
        for step in [0.1, 0.01, 0.03] {
            let run = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 4.53, 0., 0., 0.)], 4.5, step);
            assert!((value(&run, "drac_max").unwrap() - 50.0).abs() < 1e-6);
        }
    }
}
