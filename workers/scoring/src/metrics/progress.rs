//! Failure to progress.

use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, count};

/// Length of a window, s, and the least progress in it, m (`spec/evaluation` §2.1).
const WINDOW_SECS: f64 = 5.0;
const LEAST_M: f64 = 0.1;

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[Sheet {
        id: "failure_to_progress",
        unit: "count",
        direction: Direction::Down,
        needs: &[Need::Robot, Need::Goal],
        source: "Francis et al. 2023, table 1 (FP)",
        about: "windows of 5 s in which the shortest way to the goal became less than 0.1 m shorter",
    }],
    measure,
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let Some(robot) = scene.robot() else { return Vec::new() };
    let (Some(first), Some(last)) = (robot.samples.first(), robot.samples.last()) else { return Vec::new() };
    let mut failures = 0_usize;
    let mut start = first.t;
    let mut left = scene.to_goal_m(&first.at);
    while start + WINDOW_SECS <= last.t + 1e-9 {
        start += WINDOW_SECS;
        let Some(now) = robot.at(start.min(last.t)).and_then(|sample| scene.to_goal_m(&sample.at)) else {
            left = None;
            continue;
        };
        if left.is_some_and(|before| before - now < LEAST_M) {
            failures += 1;
        }
        left = Some(now);
    }
    vec![Ok(count(failures))]
}

#[cfg(test)]
mod tests {
    use socrates_model::EventKind;

    use crate::fixture::{Walk, event, recording};
    use crate::metrics::tests::value;

    #[test]
    fn ten_seconds_of_standing_are_two_windows_without_progress() {
        let walk =
            Walk::through(socrates_model::AgentId::Robot, &[(0., 0., 0.), (5., 5., 0.), (15., 5., 0.), (20., 10., 0.)]);
        let mut run = recording(&[walk], 20.0, 0.1);
        event(&mut run, 20.0, EventKind::RobotArrived);
        assert_eq!(value(&run, "failure_to_progress"), Some(2.0));
    }
}
