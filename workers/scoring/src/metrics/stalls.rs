//! Standing still on the way.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Direction, Family, Measure, Measured, Need, Sheet, count};
use crate::running::{Pen, Stretches};
use crate::series::Span;
use crate::tracks::Sample;

/// Slower than this is standing, m/s; spinning slower than this is not turning, rad/s (HuNavSim).
const STILL_MPS: f64 = 0.01;
const STILL_RADPS: f64 = 0.02;
/// A stall of at least this length is a freeze, s.
const FREEZE_SECS: f64 = 2.0;

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[
        Sheet {
            id: "stalled_time",
            unit: "s",
            direction: Direction::Down,
            needs: &[Need::Robot],
            source: "HuNavSim, time_not_moving, with the sign of the spin ignored",
            about: "time on the trip with a speed below 0.01 m/s and a spin below 0.02 rad/s",
        },
        Sheet {
            id: "freezing_events",
            unit: "count",
            direction: Direction::Down,
            needs: &[Need::Robot],
            source: "Trautman and Krause 2010, as stalls of at least 2 s before the goal",
            about: "stalls of at least 2 s before the robot is at its goal",
        },
    ],
    thresholds: &[("still_mps", STILL_MPS), ("still_radps", STILL_RADPS), ("freeze_secs", FREEZE_SECS)],
    measure: Measure::Online(Begin(|_| Box::new(Stalls::new()))),
};

#[derive(Clone)]
struct Stalls {
    before: Option<Sample>,
    pen: Pen,
    still: Stretches,
}

impl Stalls {
    fn new() -> Self {
        Self { before: None, pen: Pen::default(), still: Stretches::below(1.0, 0.0, 0.0) }
    }

    fn step(&mut self, b: &Sample) {
        if let Some(a) = self.before.replace(*b) {
            let turn = socrates_model::geometry::wrap_angle(b.yaw - a.yaw).abs() / (b.t - a.t).max(1e-9);
            let speed = (b.at - a.at).norm() / (b.t - a.t).max(1e-9);
            // Both limits as one figure: below 1 is still.
            let still = (speed / STILL_MPS).max(turn / STILL_RADPS).min(2.0);
            self.still.add(self.pen.to((a.t + b.t) / 2.0, Some(still)));
        }
    }
}

impl Running for Stalls {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        for sample in now.even {
            self.step(sample);
        }
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let mut whole = self.clone();
        end.tail.iter().for_each(|sample| whole.step(sample));
        let stalls = whole.still.spans();
        let total = stalls.iter().map(Span::length_s).sum();
        let freezes = stalls.iter().filter(|stall| stall.length_s() >= FREEZE_SECS - 0.2).count();
        vec![Ok(total), Ok(count(freezes))]
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::AgentId;

    use crate::fixture::Walk;
    use crate::metrics::tests::at_both_rates;

    #[test]
    fn a_stop_of_three_seconds_is_one_freeze_of_that_length() {
        let walks = || vec![Walk::through(AgentId::Robot, &[(0., 0., 0.), (4., 2., 0.), (7., 2., 0.), (12., 5., 0.)])];
        at_both_rates(&walks, 12.0, "stalled_time", 3.0, 0.15);
        at_both_rates(&walks, 12.0, "freezing_events", 1.0, 0.0);
    }
}
