//! Speeds of everybody.

use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, or_why};
use crate::series::Series;
use crate::tracks::Track;

const ROBOT: &[Need] = &[Need::Robot];
const HUMANS: &[Need] = &[Need::Humans];

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[
        Sheet {
            id: "robot_speed_mean",
            unit: "m/s",
            direction: Direction::Neutral,
            needs: ROBOT,
            source: "Francis et al. 2023, table 1 (V)",
            about: "time mean of the robot's speed",
        },
        Sheet {
            id: "robot_speed_max",
            unit: "m/s",
            direction: Direction::Neutral,
            needs: ROBOT,
            source: "Francis et al. 2023, table 1 (V)",
            about: "largest speed of the robot",
        },
        Sheet {
            id: "robot_speed_min",
            unit: "m/s",
            direction: Direction::Neutral,
            needs: ROBOT,
            source: "Francis et al. 2023, table 1 (V)",
            about: "smallest speed of the robot",
        },
        Sheet {
            id: "human_speed_mean",
            unit: "m/s",
            direction: Direction::Neutral,
            needs: HUMANS,
            source: "HuNavSim, avg_pedestrian_velocity",
            about: "time mean of the humans' speeds, mean over humans",
        },
    ],
    measure,
};

fn curve(track: &Track) -> Series {
    track.curve(crate::tracks::Sample::speed)
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let robot = scene.robot().map(curve).unwrap_or_default();
    let means: Vec<f64> = scene.tracks.humans.iter().filter_map(|track| curve(track).mean()).collect();
    let short = "the recording has no length";
    vec![
        or_why(robot.mean(), short),
        or_why(robot.greatest().map(|(_, speed)| speed), short),
        or_why(robot.least().map(|(_, speed)| speed), short),
        or_why((!means.is_empty()).then(|| means.iter().sum::<f64>() / crate::metrics::count(means.len())), short),
    ]
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
