//! The shape of the robot's path and of its speed.

use socrates_model::geometry::wrap_angle;

use crate::metrics::path::Spaced;
use crate::metrics::scene::EVEN_SECS;
use crate::metrics::smoothness::{size, smoothed};
use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};

/// A swing of the speed of at least this is an oscillation, m/s.
const SWING_MPS: f64 = 0.1;
/// Least movement in a second of an agent that moves, m (SEAN 2.0).
const MOVED_M: f64 = 0.05;
/// A second on the even grid.
const MOVED_STEPS: usize = 10;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "shape",
    thresholds: &[("swing_mps", SWING_MPS), ("moved_m", MOVED_M)],
    measure: Measure::Whole { measure, why: "read with the smoothness of the whole speed profile" },
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let (mut normalized, mut rough, mut triples) = (0.0, 0.0, 0_usize);
    let mut spaced = Spaced::default();
    for sample in &scene.even {
        spaced.step(sample.at, |p, q, r| {
            let (a, b, c) = ((q - p).norm(), (r - q).norm(), (r - p).norm());
            if a * b * c > 1e-9 {
                let double_area = (q - p).perp(&(r - p)).abs();
                normalized += 2.0 * double_area / (a * b * c) * (a + b);
                rough += double_area / (c * c);
                triples += 1;
            }
        });
    }
    let short = "the path is shorter than 1 m";
    let mean = |sum: f64| or_why((triples > 0).then(|| sum / count(triples)), short);
    let heading: f64 =
        scene.even.iter().zip(scene.even.iter().skip(1)).map(|(a, b)| wrap_angle(b.yaw - a.yaw).abs()).sum();
    let length = scene.path_length_m();
    let smooth = smoothed(scene);
    let speeds: Vec<f64> = smooth.iter().map(size).collect();
    let effort: f64 = smooth.iter().zip(smooth.iter().skip(1)).map(|(a, b)| (b - a).norm()).sum();
    let windows = scene.even.iter().zip(scene.even.iter().skip(MOVED_STEPS));
    let still = windows.filter(|(a, b)| (b.at - a.at).norm() < MOVED_M).count();
    vec![
        mean(normalized),
        mean(rough),
        or_why((length > 0.1).then(|| heading / length), "the robot does not move"),
        Ok(count(swings(&speeds))),
        Ok(effort),
        Ok(count(still) * EVEN_SECS),
    ]
}

/// Turning points between swings of at least [`SWING_MPS`].
fn swings(speeds: &[f64]) -> usize {
    let Some(first) = speeds.first() else { return 0 };
    let (mut low, mut high) = (*first, *first);
    let mut rising: Option<bool> = None;
    let mut found = 0;
    for speed in speeds {
        (low, high) = (low.min(*speed), high.max(*speed));
        let turned = match rising {
            None if speed - low >= SWING_MPS => Some(true),
            None if high - speed >= SWING_MPS => Some(false),
            Some(true) if high - speed >= SWING_MPS => Some(false),
            Some(false) if speed - low >= SWING_MPS => Some(true),
            None | Some(_) => continue,
        };
        found += usize::from(rising.is_some());
        rising = turned;
        (low, high) = (*speed, *speed);
    }
    found
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use socrates_model::AgentId;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn a_circle_has_closed_forms() {
        // Radius 2 m, points half a meter of way apart: an angle of 0.25 between neighbors.
        let circle = || vec![Walk::circle(2.0, 20.0)];
        let (side, long) = (4.0 * 0.125_f64.sin(), 4.0 * 0.25_f64.sin());
        at_both_rates(&circle, 19.9, "curvature_normalized", side, 0.01 * side);
        let area = side * side * 0.25_f64.sin() / 2.0;
        at_both_rates(&circle, 19.9, "roughness", 2.0 * area / (long * long), 0.002);
        at_both_rates(&circle, 19.9, "angle_over_length", 0.5, 0.01);
    }

    #[test]
    fn a_sine_in_speed_turns_twice_a_period_and_has_the_effort_of_its_amplitude() {
        for step in [0.1, 0.01] {
            let mut run = recording(&[Walk::through(AgentId::Robot, &[(0., 0., 0.)])], 4.0 * PI, step);
            for state in &mut run.frames {
                let t = state.tick as f64 * step;
                (state.vx, state.x) = (1.0 + 0.5 * t.sin(), t + 0.5 * (1.0 - t.cos()));
            }
            assert_eq!(value(&run, "speed_oscillations"), Some(4.0));
            // Three half tenths of a second at both ends are lost to smoothing, at 0.5 m/s^2.
            assert!((value(&run, "acceleration_effort").unwrap() - (4.0 - 0.15)).abs() < 0.06);
        }
    }

    #[test]
    fn a_stop_of_three_seconds_is_felt_a_second_late() {
        // At 0.4 m/s 0.05 m are 0.125 s: still from 0.875 s after the stop to 0.125 s after the start.
        let walks = || vec![Walk::through(AgentId::Robot, &[(0., 0., 0.), (5., 2., 0.), (8., 2., 0.), (13., 4., 0.)])];
        at_both_rates(&walks, 13.0, "stopped_time", 2.25, 0.11);
    }
}
