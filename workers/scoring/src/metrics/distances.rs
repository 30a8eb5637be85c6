//! Distances to people and walls.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, or_why};
use crate::running::{Least, Mean};

/// The family.
pub(super) const FAMILY: Family =
    Family { name: "distances", thresholds: &[], measure: Measure::Online(Begin(|_| Box::new(Distances::default()))) };

#[derive(Clone, Default)]
struct Distances {
    least: Least,
    mean: Mean,
    clearing: Least,
    clearing_mean: Mean,
}

impl Running for Distances {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        self.least.add(now.least);
        self.mean.add(now.t, now.nearest.map(|distance| distance.max(0.0)));
        self.clearing.add(now.clearance);
        self.clearing_mean.add(now.t, now.clearance);
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let all = [self.least.value(), self.mean.mean(), self.clearing.value(), self.clearing_mean.mean()];
        all.map(|value| or_why(value, "the recording has no length")).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, floor, recording};
    use crate::metrics::tests::{at_both_rates, value_of};

    #[test]
    fn passing_a_standing_person_at_one_meter_leaves_the_offset_less_both_radii() {
        let walks = || vec![Walk::robot(-4., 0., 0.8, 0.), Walk::human(1, 0., 1., 0., 0.)];
        at_both_rates(&walks, 10.0, "human_distance_min", 1.0 - 0.53, 0.001);
    }

    #[test]
    fn the_clearing_distance_is_that_of_the_wall_beside_the_way() {
        let place = floor(&[(-20., 1.0, 20., 1.5)], &[], &[]);
        let run = recording(&[Walk::robot(-4., 0., 0.8, 0.)], 10.0, 0.1);
        let evidence = Evidence { location: Some(&place), ..Evidence::of(&run) };
        let found = value_of(&evidence, "clearing_distance_min").unwrap();
        assert!((found - 0.75).abs() < 0.11, "{found}");
    }
}
