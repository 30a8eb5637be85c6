//! Acceleration, jerk and energy of the robot.

use crate::metrics::scene::EVEN_SECS;
use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::tracks::Sample;
use socrates_model::Vector;

/// The family. Velocities are those of the even 0.1 s grid, smoothed by the weights 1 2 1 (half power
/// near 2.5 Hz): else jerk is sampling noise.
pub(super) const FAMILY: Family = Family {
    name: "smoothness",
    thresholds: &[("even_secs", EVEN_SECS)],
    measure: Measure::Whole { measure, why: "the spectrum is that of the whole speed profile" },
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let raw: Vec<Vector> = scene.even.iter().map(|sample| sample.velocity).collect();
    let smooth = smoothed(scene);
    let acceleration: Vec<Vector> =
        smooth.iter().zip(smooth.iter().skip(1)).map(|(a, b)| (b - a) / EVEN_SECS).collect();
    let jerk: Vec<f64> =
        acceleration.iter().zip(acceleration.iter().skip(1)).map(|(a, b)| ((b - a) / EVEN_SECS).norm()).collect();
    let sizes: Vec<f64> = acceleration.iter().map(size).collect();
    let mean = |values: &[f64]| (!values.is_empty()).then(|| values.iter().sum::<f64>() / count(values.len()));
    let short = "the recording is shorter than 0.5 s";
    let squared: f64 = jerk.iter().map(|jerk| jerk * jerk).sum::<f64>() * EVEN_SECS;
    let top_speed = smooth.iter().map(size).fold(0.0, f64::max);
    let length = scene.length_s();
    let ldlj = (squared > 1e-9 && top_speed > 1e-6)
        .then(|| -libm::log(length * length * length / (top_speed * top_speed) * squared));
    let energy: f64 =
        raw.iter().zip(raw.iter().skip(1)).map(|(a, b)| (a.norm_squared() + b.norm_squared()) / 2.0).sum();
    vec![
        or_why(mean(&sizes), short),
        or_why(sizes.iter().copied().max_by(f64::total_cmp), short),
        or_why(sizes.iter().copied().min_by(f64::total_cmp), short),
        or_why(jerk.iter().copied().min_by(f64::total_cmp), short),
        or_why(jerk.iter().copied().max_by(f64::total_cmp), short),
        or_why(sparc(&smooth), "the robot does not move for a second"),
        or_why(mean(&jerk), short),
        or_why(mean(&jerk).map(|_| (squared / EVEN_SECS / count(jerk.len())).sqrt()), short),
        or_why(ldlj, "the robot moves without any jerk"),
        Ok(energy * EVEN_SECS),
    ]
}

/// Velocities of the even grid, smoothed. Those at the ends are taken on, with the acceleration there: differences over
/// half the time would be jerks.
pub(super) fn smoothed(scene: &Scene<'_>) -> Vec<Vector> {
    let mut velocities: Vec<Vector> = scene.even.iter().map(|sample| sample.velocity).collect();
    let steady = |from: &Sample, to: &Sample, inner: &Sample| (to.at - from.at) / EVEN_SECS * 2.0 - inner.velocity;
    if let ([a, b, _, ..], Some(first)) = (scene.even.as_slice(), velocities.first_mut()) {
        *first = steady(a, b, b);
    }
    if let ([.., _, a, b], Some(last)) = (scene.even.as_slice(), velocities.last_mut()) {
        *last = steady(a, b, a);
    }
    let triples = velocities.windows(3);
    triples.filter_map(|triple| if let [a, b, c] = triple { Some((a + b * 2.0 + c) / 4.0) } else { None }).collect()
}

/// Spectral arc length of the speed profile.
///
/// Spectrum of the mean-free padding to 20 s or twice the length at steps of 0.05 Hz, up to 2.5 Hz (the half-power
/// point of the smoothing), cut behind the last amplitude above 5 % of that at 0 Hz.
fn sparc(smooth: &[Vector]) -> Option<f64> {
    const STEP_HZ: f64 = 0.05;
    const TOP_HZ: f64 = 2.5;
    const FLOOR: f64 = 0.05;
    if smooth.len() < 10 {
        return None;
    }
    let speeds: Vec<f64> = smooth.iter().map(size).collect();
    let at_rest: f64 = speeds.iter().sum();
    if at_rest <= 1e-9 {
        return None;
    }
    let steps = libm::round(TOP_HZ / STEP_HZ) as u32;
    let amplitude = |k: u32| {
        // Recurrence of the rotation: one sine and cosine per frequency.
        let turn = std::f64::consts::TAU * STEP_HZ * f64::from(k) * EVEN_SECS;
        let (c, s) = (libm::cos(turn), libm::sin(turn));
        let (mut x, mut y, mut re, mut im) = (1.0, 0.0, 0.0, 0.0);
        for speed in &speeds {
            re += speed * x;
            im += speed * y;
            (x, y) = (x * c - y * s, x * s + y * c);
        }
        libm::sqrt(re * re + im * im) / at_rest
    };
    let spectrum: Vec<f64> = (0..=steps).map(amplitude).collect();
    let kept = spectrum.iter().rposition(|value| *value >= FLOOR)?.max(1);
    let width = 1.0 / count(kept);
    let kept = spectrum.get(..=kept)?;
    Some(-kept.iter().zip(kept.iter().skip(1)).map(|(a, b)| libm::sqrt(width * width + (b - a) * (b - a))).sum::<f64>())
}

pub(super) fn size(vector: &Vector) -> f64 {
    vector.norm()
}

#[cfg(test)]
mod tests {
    use socrates_model::{AgentId, AgentState};

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn one_smooth_stroke_has_a_shorter_spectrum_than_a_stop_and_go() {
        for step in [0.1, 0.01] {
            let of = |speed: &dyn Fn(f64) -> f64| {
                let mut run = recording(&[Walk::through(AgentId::Robot, &[(0., 0., 0.)])], 10.0, step);
                let mut x = 0.0;
                for state in &mut run.frames {
                    let t = state.tick as f64 * step;
                    (state.vx, state.x) = (speed(t), x);
                    x += speed(t + 0.5 * step) * step;
                }
                value(&run, "sparc").unwrap()
            };
            let smooth = of(&|t| (t * std::f64::consts::PI / 10.0).sin().powi(2));
            let rough = of(&|t| (t * std::f64::consts::PI * 0.4).sin().powi(2));
            assert!(smooth < -1.0 && smooth > -2.0 && rough < smooth - 0.3, "{smooth} {rough} at {step}");
        }
    }

    #[test]
    fn a_sine_in_speed_has_the_jerk_of_its_amplitude() {
        // v = 1 + 0.5 sin(t): a = 0.5 cos t, j = -0.5 sin t; over whole periods mean |a| = mean |j| = 1 / pi.
        for step in [0.1, 0.01] {
            let mut run =
                recording(&[Walk::through(AgentId::Robot, &[(0., 0., 0.)])], 4.0 * std::f64::consts::PI, step);
            for state in &mut run.frames {
                let t = state.tick as f64 * step;
                let AgentState { x, vx, .. } = state;
                *vx = 1.0 + 0.5 * t.sin();
                *x = t + 0.5 * (1.0 - t.cos());
            }
            let wanted = 1.0 / std::f64::consts::PI;
            assert!((value(&run, "acceleration_mean").unwrap() - wanted).abs() < 0.01);
            assert!((value(&run, "jerk_mean").unwrap() - wanted).abs() < 0.01);
            assert!((value(&run, "jerk_rms").unwrap() - 0.125_f64.sqrt()).abs() < 0.01);
        }
    }
}
