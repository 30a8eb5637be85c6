//! On which side they pass, and how they wind round each other.

use std::f64::consts::TAU;

use socrates_model::geometry::wrap_angle;

use crate::metrics::{Family, Measure, Measured, Scene, or_why};

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "passing",
    thresholds: &[],
    measure: Measure::Whole { measure, why: "the human meant is the one who comes nearest in the end" },
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let mut nearest: Option<(f64, f64)> = None;
    let mut total = 0.0;
    for ((_, human), distance) in scene.pairs().zip(&scene.distances) {
        let mut turns = 0.0;
        let mut before: Option<f64> = None;
        for (r, h) in scene.even.iter().filter_map(|r| Some((r, human.at(r.t)?))) {
            let line = h.at - r.at;
            if line.norm() <= 1e-6 {
                continue;
            }
            let angle = libm::atan2(line.y, line.x);
            turns += before.map_or(0.0, |before| wrap_angle(angle - before)) / TAU;
            before = Some(angle);
        }
        total += f64::abs(turns);
        if let Some((_, least)) = distance.least()
            && nearest.is_none_or(|(old, _)| least < old)
        {
            nearest = Some((least, turns));
        }
    }
    vec![or_why(nearest.map(|(_, turns)| turns), "there is no human in the recording"), Ok(total)]
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn two_who_pass_wind_half_round_and_the_sign_is_the_side() {
        let pass = |y: f64| recording(&[Walk::robot(-50., 0., 1., 0.), Walk::human(1, 50., y, -1., 0.)], 100.0, 0.1);
        // The human passes on the robot's left: both keep right, and the line turns counter-clockwise.
        assert!((value(&pass(0.8), "passing_side").unwrap() - 0.5).abs() < 0.01);
        assert!((value(&pass(-0.8), "passing_side").unwrap() + 0.5).abs() < 0.01);
        assert!((value(&pass(-0.8), "topological_complexity").unwrap() - 0.5).abs() < 0.01);
    }
}
