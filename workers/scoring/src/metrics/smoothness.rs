//! Acceleration, jerk and energy of the robot.

use crate::metrics::scene::EVEN_SECS;
use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, count, or_why};
use socrates_model::Vector;

const NEEDS: &[Need] = &[Need::Robot];

/// The family. Velocities are those of the even 0.1 s grid, smoothed by the weights 1 2 1 (half power
/// near 2.5 Hz): else jerk is sampling noise.
pub(super) const FAMILY: Family = Family {
    sheets: &[
        Sheet {
            id: "acceleration_mean",
            unit: "m/s^2",
            direction: Direction::Down,
            needs: NEEDS,
            source: "Francis et al. 2023, table 1 (A)",
            about: "mean acceleration of the smoothed velocity",
        },
        Sheet {
            id: "acceleration_max",
            unit: "m/s^2",
            direction: Direction::Down,
            needs: NEEDS,
            source: "Francis et al. 2023, table 1 (A)",
            about: "largest acceleration of the smoothed velocity",
        },
        Sheet {
            id: "jerk_mean",
            unit: "m/s^3",
            direction: Direction::Down,
            needs: NEEDS,
            source: "Francis et al. 2023, table 1 (J), from a second difference of velocity",
            about: "mean jerk of the smoothed velocity",
        },
        Sheet {
            id: "jerk_rms",
            unit: "m/s^3",
            direction: Direction::Down,
            needs: NEEDS,
            source: "Hogan and Sternad 2009",
            about: "root mean square jerk of the smoothed velocity",
        },
        Sheet {
            id: "log_dimensionless_jerk",
            unit: "log",
            direction: Direction::Up,
            needs: NEEDS,
            source: "Balasubramanian et al. 2012 (LDLJ)",
            about: "-ln(T^3 / v_max^2 * integral of squared jerk); nearer to 0 is smoother; not applicable without jerk",
        },
        Sheet {
            id: "motion_energy",
            unit: "m^2/s",
            direction: Direction::Down,
            needs: NEEDS,
            source: "SocNavBench, robot_motion_energy",
            about: "integral of squared speed over the trip",
        },
    ],
    measure,
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let raw: Vec<Vector> = scene.even.iter().map(|sample| sample.velocity).collect();
    let smooth: Vec<Vector> = raw
        .windows(3)
        .filter_map(|triple| if let [a, b, c] = triple { Some((a + b * 2.0 + c) / 4.0) } else { None })
        .collect();
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
        or_why(mean(&jerk), short),
        or_why(mean(&jerk).map(|_| (squared / EVEN_SECS / count(jerk.len())).sqrt()), short),
        or_why(ldlj, "the robot moves without any jerk"),
        Ok(energy * EVEN_SECS),
    ]
}

fn size(vector: &Vector) -> f64 {
    vector.norm()
}

#[cfg(test)]
mod tests {
    use socrates_model::{AgentId, AgentState};

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

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
