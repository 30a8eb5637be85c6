//! How fast the robot answers a gesture.

use socrates_model::Gesture;

use crate::metrics::{Family, Measure, Measured, Scene, or_why};
use crate::tracks::MOVING_MPS;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "response",
    thresholds: &[("moving_mps", MOVING_MPS)],
    measure: Measure::Whole { measure, why: "the answer comes after the gesture" },
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let delay = |gesture: Gesture, goes: bool| -> Measured {
        let Some(robot) = scene.robot() else { return Err("there is no robot in the recording".to_owned()) };
        let mut longest: Option<f64> = None;
        for human in &scene.tracks.humans {
            let mut saying = false;
            for sample in &human.samples {
                let says = sample.gesture == Some(gesture);
                if says && !saying {
                    let done = robot.samples.iter().find(|r| r.t >= sample.t && (r.speed() > MOVING_MPS) == goes);
                    let Some(done) = done else { return Err(format!("the robot never answers {gesture}")) };
                    longest = Some(longest.map_or(done.t - sample.t, |old: f64| old.max(done.t - sample.t)));
                }
                saying = says;
            }
        }
        or_why(longest, &format!("nobody says {gesture}"))
    };
    vec![delay(Gesture::Wait, false), delay(Gesture::Proceed, true)]
}

#[cfg(test)]
mod tests {
    use socrates_model::{AgentId, Gesture};

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn the_delay_is_from_the_gesture_to_the_stop() {
        let robot = Walk::through(AgentId::Robot, &[(0., 0., 0.), (5., 4., 0.), (9., 4., 0.), (12., 6., 0.)]);
        let human = Walk::human(1, 8., 0., 0., 0.).says(3.5, 6.0, Gesture::Wait);
        let run = recording(&[robot, human], 12.0, 0.1);
        assert!((value(&run, "wait_response").unwrap() - 1.5).abs() < 0.11);
        assert_eq!(value(&run, "proceed_response"), None);
    }
}
