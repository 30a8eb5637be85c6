//! Standing still on the way.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::scene::EVEN_SECS;
use crate::metrics::{Begin, Family, Measure, Measured, count};
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
    name: "stalls",
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
        // A robot that was away in between did not stand.
        if let Some(a) = self.before.replace(*b).filter(|a| b.t - a.t < 1.5 * EVEN_SECS) {
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
        if let Some(robot) = now.robot.filter(|robot| robot.there) {
            self.step(robot);
        }
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let stalls = self.still.spans();
        let total = stalls.iter().map(Span::length_s).sum();
        let end_s = end.last.map_or(f64::INFINITY, |last| last.t);
        let over = |stall: &&Span| end.setting.goal.is_none() && stall.to_s >= end_s - EVEN_SECS;
        let long = |stall: &&Span| stall.length_s() >= FREEZE_SECS - 0.2;
        let freezes = stalls.iter().filter(long).filter(|stall| !over(stall)).count();
        vec![Ok(total), Ok(count(freezes))]
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::{AgentId, Point};

    use crate::evidence::Evidence;
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value, value_of};

    #[test]
    fn a_stop_of_three_seconds_is_one_freeze_of_that_length() {
        let walks = || vec![Walk::through(AgentId::Robot, &[(0., 0., 0.), (4., 2., 0.), (7., 2., 0.), (12., 5., 0.)])];
        at_both_rates(&walks, 12.0, "stalled_time", 3.0, 0.15);
        at_both_rates(&walks, 12.0, "freezing_events", 1.0, 0.0);
    }

    #[test]
    fn standing_at_the_end_is_a_freeze_only_short_of_a_goal_that_is_known() {
        let walk = Walk::through(AgentId::Robot, &[(0., 0., 0.), (4., 2., 0.), (12., 2., 0.)]);
        let run = recording(&[walk], 12.0, 0.1);
        assert_eq!(value(&run, "freezing_events"), Some(0.0));
        let toward = |x: f64| Evidence { goal: Some(Point::new(x, 0.0)), ..Evidence::of(&run) };
        assert_eq!(value_of(&toward(5.0), "freezing_events"), Some(1.0));
        assert_eq!(value_of(&toward(2.0), "freezing_events"), Some(0.0));
        assert_eq!(value_of(&toward(2.0), "success"), Some(1.0));
    }
}
