//! Giving way: the robot to people and people to the robot.

use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::tracks::Track;

/// Slowing by this share of the speed before is yielding.
const SLOWED_SHARE: f64 = 0.2;
/// Only meetings nearer than this are judged, m between surfaces.
const MEETING_M: f64 = 2.0;
/// Only slowing in the last seconds before the closest approach counts, s.
const BEFORE_SECS: f64 = 5.0;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "yielding",
    thresholds: &[("slowed_share", SLOWED_SHARE), ("meeting_m", MEETING_M), ("before_secs", BEFORE_SECS)],
    measure: Measure::Whole { measure, why: "who slowed first is known after the closest approach" },
};

/// First time before a meeting at which somebody is 20 % slower than its fastest so far in the window.
fn slows(track: &Track, from: f64, to: f64) -> Option<f64> {
    let mut top = 0.0_f64;
    for sample in track.present().filter(|sample| sample.t >= from && sample.t <= to) {
        top = top.max(sample.speed());
        if top > 0.3 && sample.speed() <= (1.0 - SLOWED_SHARE) * top {
            return Some(sample.t);
        }
    }
    None
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let (mut robots, mut all) = (0_usize, 0_usize);
    let (mut distances, mut leads) = (0.0, 0.0);
    for ((robot, human), distance) in scene.pairs().zip(&scene.distances) {
        let Some((closest, least)) = distance.least() else { continue };
        if least > MEETING_M {
            continue;
        }
        let from = closest - BEFORE_SECS;
        let (mine, theirs) = (slows(robot, from, closest), slows(human, from, closest));
        let Some(first) = mine.into_iter().chain(theirs).min_by(f64::total_cmp) else { continue };
        all += 1;
        if mine.is_some_and(|mine| mine <= first) {
            robots += 1;
        }
        let at = distance.samples().iter().find(|(t, _)| *t >= first - 1e-9).map_or(least, |(_, value)| *value);
        distances += at;
        leads += closest - first;
    }
    let why = "nobody slows down before a meeting";
    let mean = |sum: f64| or_why((all > 0).then(|| sum / count(all)), why);
    vec![mean(count(robots)), mean(distances), mean(leads)]
}

#[cfg(test)]
mod tests {
    use socrates_model::AgentId;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn the_robot_that_stops_first_yields() {
        let robot = Walk::through(AgentId::Robot, &[(0., -6., 0.), (5., -1.5, 0.), (9., -1.5, 0.), (15., 4., 0.)]);
        let run = recording(&[robot, Walk::human(1, 0., -7., 0., 1.)], 10.0, 0.1);
        assert_eq!(value(&run, "robot_yields"), Some(1.0));
        assert!(value(&run, "yield_lead").unwrap() > 0.5);
        let even = recording(&[Walk::robot(-6., 0., 1., 0.), Walk::human(1, 0., -7., 0., 1.)], 10.0, 0.1);
        assert_eq!(value(&even, "robot_yields"), None);
    }
}
