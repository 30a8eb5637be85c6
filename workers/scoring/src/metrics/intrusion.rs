//! Personal intrusion in person-seconds.

use crate::metrics::zones::HALL_M;
use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet};
use crate::series::Series;
use crate::tracks::Sample;

const NEEDS: &[Need] = &[Need::Robot, Need::Humans];

const fn uniform(id: &'static str, about: &'static str) -> Sheet {
    Sheet {
        id,
        unit: "person*s",
        direction: Direction::Down,
        needs: NEEDS,
        source: "Okal and Arras 2016, uniform, in seconds instead of samples",
        about,
    }
}

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[
        uniform("intrusion_intimate", "sum over humans of the time with the robot's surface nearer than 0.45 m"),
        uniform("intrusion_personal", "sum over humans of the time with the robot's surface nearer than 1.2 m"),
        uniform("intrusion_social", "sum over humans of the time with the robot's surface nearer than 3.6 m"),
        Sheet {
            id: "intrusion_anisotropic",
            unit: "person*s",
            direction: Direction::Down,
            needs: NEEDS,
            source: "Okal and Arras 2016, anisotropic, b = 1, lambda = 0.4, r = 0.9, a = 1.2 m",
            about: "sum over humans of the time with d < a e^((r - d) / b) (lambda + (1 - lambda)(1 + cos phi) / 2), d the centre distance and phi the angle off the person's heading: a robot in front intrudes from farther away",
        },
    ],
    measure,
};

/// Nobody is intruded upon from farther than this whatever the angle, m: 1.2 e^(0.9 - 1.5) is less.
const REACH_M: f64 = 1.5;

fn reaches(r: &Sample, h: &Sample) -> bool {
    (r.at - h.at).norm_squared() < REACH_M * REACH_M
}

/// How far outside the anisotropic region the robot is.
fn margin(r: &Sample, h: &Sample) -> f64 {
    let d = (r.at - h.at).norm();
    let front = (1.0 + libm::cos(h.bearing(&r.at))) / 2.0;
    d - 1.2 * libm::exp(0.9 - d) * (0.4 + 0.6 * front)
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let uniform = |limit: f64| -> f64 { scene.distances.iter().map(|distance| distance.time_below(limit)).sum() };
    let anisotropic: f64 = scene
        .pairs()
        .map(|(robot, human)| {
            // Only pieces with an end inside count, so angles matter only there and at the neighbours.
            let near: Vec<bool> = robot.samples.iter().zip(&human.samples).map(|(r, h)| reaches(r, h)).collect();
            let beside = |k: usize| {
                let around = near.get(k.saturating_sub(1)..(k + 2).min(near.len())).unwrap_or_default();
                around.contains(&true)
            };
            let margin: Series = robot
                .samples
                .iter()
                .zip(&human.samples)
                .enumerate()
                .map(|(k, (r, h))| (r.t, h.there.then(|| if beside(k) { margin(r, h) } else { REACH_M })))
                .collect();
            margin.time_below(0.0)
        })
        .sum();
    let [intimate, personal, social] = HALL_M.map(uniform);
    vec![Ok(intimate), Ok(personal), Ok(social), Ok(anisotropic)]
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn two_people_at_one_metre_count_twice_and_the_front_reaches_farther() {
        let stand = |yaw: f64, n: u32| Walk::human(n, 1.4, if n == 1 { 0.0 } else { 1.2 }, 0., 0.).facing(yaw);
        let pi = std::f64::consts::PI;
        let two = recording(&[Walk::robot(0., 0., 0., 0.), stand(0., 1), stand(0., 2)], 10.0, 0.1);
        assert!((value(&two, "intrusion_social").unwrap() - 20.0).abs() < 1e-6);
        let at = |yaw: f64| {
            let walk = Walk::human(1, 1.0, 0., 0., 0.).facing(yaw);
            value(&recording(&[Walk::robot(0., 0., 0., 0.), walk], 10.0, 0.1), "intrusion_anisotropic").unwrap()
        };
        assert!((at(pi) - 10.0).abs() < 1e-6 && at(0.0).abs() < 1e-6);
    }
}
