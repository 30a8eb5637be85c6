//! Speeds of everybody.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, count, or_why};
use crate::running::{Least, Mean};
use crate::tracks::Sample;

/// The family.
pub(super) const FAMILY: Family =
    Family { name: "speeds", thresholds: &[], measure: Measure::Online(Begin(|humans| Box::new(Speeds::new(humans)))) };

#[derive(Clone)]
struct Speeds {
    mean: Mean,
    least: Least,
    /// The largest is the smallest of what is missing.
    greatest: Least,
    humans: Vec<Mean>,
}

impl Speeds {
    fn new(humans: usize) -> Self {
        Self {
            mean: Mean::default(),
            least: Least::default(),
            greatest: Least::default(),
            humans: vec![Mean::default(); humans],
        }
    }
}

/// The speed of somebody who is there.
fn speed(sample: &Sample) -> Option<f64> {
    sample.there.then(|| sample.speed())
}

impl Running for Speeds {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        if let Some(robot) = now.robot {
            let speed = speed(robot);
            self.mean.add(now.t, speed);
            self.least.add(speed);
            self.greatest.add(speed.map(|speed| -speed));
        }
        for (mean, human) in self.humans.iter_mut().zip(now.humans) {
            mean.add(now.t, speed(human));
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let means: Vec<f64> = self.humans.iter().filter_map(Mean::mean).collect();
        let short = "the recording has no length";
        vec![
            or_why(self.mean.mean(), short),
            or_why(self.greatest.value().map(|speed| -speed), short),
            or_why(self.least.value(), short),
            or_why((!means.is_empty()).then(|| means.iter().sum::<f64>() / count(means.len())), short),
        ]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Walk;
    use crate::metrics::tests::at_both_rates;

    #[test]
    fn even_walks_have_their_speed_as_mean() {
        let walks =
            || vec![Walk::robot(0., 0., 0.6, 0.), Walk::human(1, 9., 3., -1., 0.), Walk::human(2, 9., 5., 0., 0.)];
        at_both_rates(&walks, 8.0, "robot_speed_mean", 0.6, 1e-9);
        at_both_rates(&walks, 8.0, "human_speed_mean", 0.5, 1e-9);
    }
}
