//! Failure to progress.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, count};
use crate::tracks::{Sample, between};

/// Length of a window, s, and the least progress in it, m: a robot that gains less is counted as stuck.
const WINDOW_SECS: f64 = 5.0;
const LEAST_M: f64 = 0.1;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "progress",
    thresholds: &[("window_secs", WINDOW_SECS), ("least_m", LEAST_M)],
    measure: Measure::Online(Begin(|_| Box::new(Windows::default()))),
};

/// Windows so far.
#[derive(Clone, Copy, Default)]
struct Windows {
    /// The last state, and the shortest way at the end of the last window.
    last: Option<Sample>,
    left_m: Option<f64>,
    /// End of the window that runs, s.
    ends_s: f64,
    failures: usize,
}

impl Windows {
    /// The window ends with the robot in a state.
    fn ends(&mut self, setting: &Setting<'_>, state: Option<Sample>) {
        let now = state.and_then(|sample| setting.to_goal_m(&sample.at));
        if self.left_m.zip(now).is_some_and(|(before, now)| before - now < LEAST_M) {
            self.failures += 1;
        }
        self.left_m = now;
        self.ends_s += WINDOW_SECS;
    }
}

impl Running for Windows {
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>) {
        let Some(robot) = now.robot else { return };
        if self.last.is_none() {
            self.left_m = setting.to_goal_m(&robot.at);
            self.ends_s = robot.t + WINDOW_SECS;
        }
        while self.ends_s <= robot.t {
            let state = between(self.last.as_ref(), robot, self.ends_s);
            self.ends(setting, state);
        }
        self.last = Some(*robot);
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        // Rounding may put the end of a window a hair behind the last sample.
        let mut whole = *self;
        if let Some(last) = self.last.filter(|last| self.ends_s <= last.t + 1e-9) {
            whole.ends(end.setting, Some(last).filter(|last| last.there));
        }
        vec![Ok(count(whole.failures))]
    }
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
