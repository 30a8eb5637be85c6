//! Whether the robot did its task.

use crate::fidelity::GOAL_M;
use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured};

/// The family.
pub(super) const FAMILY: Family =
    Family { name: "success", thresholds: &[("goal_m", GOAL_M)], measure: Measure::Online(Begin(|_| Box::new(Task))) };

/// Everything that is asked is known at the end.
#[derive(Clone)]
struct Task;

impl Running for Task {
    fn push(&mut self, _setting: &Setting<'_>, _now: &Now<'_>) {}

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let flag = |yes: bool| Ok(if yes { 1.0 } else { 0.0 });
        vec![
            flag(end.succeeded()),
            flag(end.arrived_s.is_some()),
            end.trip_s().ok_or_else(|| "the robot never arrives".to_owned()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::EventKind;

    use crate::fixture::{Walk, event, recording};
    use crate::metrics::tests::value;

    #[test]
    fn a_robot_that_arrives_through_a_person_has_no_success() {
        let mut run = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 3., 0.2, 0., 0.)], 8.0, 0.1);
        event(&mut run, 6.0, EventKind::RobotArrived);
        assert_eq!(value(&run, "success"), Some(0.0));
        assert_eq!(value(&run, "arrived"), Some(1.0));
        assert_eq!(value(&run, "time_to_goal"), Some(6.0));
    }
}
