//! Crowd density around the robot.

use std::f64::consts::PI;

use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, or_why};
use crate::series::Series;

const NEEDS: &[Need] = &[Need::Robot, Need::Humans];
const SOURCE: &str = "CrowdBot evaluation tools, local density";

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[
        Sheet {
            id: "density_5m_mean",
            unit: "1/m^2",
            direction: Direction::Neutral,
            needs: NEEDS,
            source: SOURCE,
            about: "time mean of the people within 5 m of the robot over the area of that disc",
        },
        Sheet {
            id: "density_3m_mean",
            unit: "1/m^2",
            direction: Direction::Neutral,
            needs: NEEDS,
            source: SOURCE,
            about: "time mean of the people within 3 m of the robot over the area of that disc",
        },
        Sheet {
            id: "density_10m_mean",
            unit: "1/m^2",
            direction: Direction::Neutral,
            needs: NEEDS,
            source: SOURCE,
            about: "time mean of the people within 10 m of the robot over the area of that disc",
        },
        Sheet {
            id: "density_2_5m_max",
            unit: "1/m^2",
            direction: Direction::Neutral,
            needs: NEEDS,
            source: SOURCE,
            about: "most people within 2.5 m of the robot at once over the area of that disc",
        },
    ],
    measure,
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let centers: Vec<Series> =
        scene.pairs().map(|(robot, human)| robot.between(human, |r, h| (r.at - h.at).norm())).collect();
    let length = scene.length_s();
    let mean = |reach: f64| {
        let person_seconds: f64 = centers.iter().map(|distance| distance.time_below(reach)).sum();
        or_why((length > 0.0).then(|| person_seconds / length / (PI * (reach * reach))), "the recording has no length")
    };
    let most = scene
        .robot()
        .map_or(0, |robot| robot.samples.len())
        .min(centers.iter().map(|curve| curve.samples().len()).min().unwrap_or(0));
    let most = (0..most)
        .map(|index| centers.iter().filter(|curve| curve.samples().get(index).is_some_and(|(_, d)| *d < 2.5)).count())
        .max();
    let short = "the recording has no length";
    vec![mean(5.0), mean(3.0), mean(10.0), or_why(most.map(|most| crate::metrics::count(most) / (PI * 6.25)), short)]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn two_people_beside_a_standing_robot_are_two_per_disc() {
        let walks = [Walk::robot(0., 0., 0., 0.), Walk::human(1, 2., 0., 0., 0.), Walk::human(2, 0., 4., 0., 0.)];
        let run = recording(&walks, 5.0, 0.1);
        assert!((value(&run, "density_5m_mean").unwrap() - 2.0 / (25.0 * PI)).abs() < 1e-6);
        assert!((value(&run, "density_3m_mean").unwrap() - 1.0 / (9.0 * PI)).abs() < 1e-6);
        assert!((value(&run, "density_10m_mean").unwrap() - 2.0 / (100.0 * PI)).abs() < 1e-6);
        assert!((value(&run, "density_2_5m_max").unwrap() - 1.0 / (6.25 * PI)).abs() < 1e-6);
    }
}
