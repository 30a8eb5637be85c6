//! How near the robot came to its goal.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, or_why};
use crate::running::Least;

/// The family.
pub(super) const FAMILY: Family =
    Family { name: "goal", thresholds: &[], measure: Measure::Online(Begin(|_| Box::new(Nearest::default()))) };

/// The smallest straight distance so far.
#[derive(Clone, Default)]
struct Nearest(Least);

impl Running for Nearest {
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>) {
        self.0
            .add(now.robot.filter(|robot| robot.there).zip(setting.goal).map(|(robot, goal)| (robot.at - goal).norm()));
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let empty = "the recording is empty";
        let whole = end.first.and_then(|first| end.setting.to_goal_m(&first.at)).filter(|way| *way > 1e-6);
        let left = end.last.and_then(|last| end.setting.to_goal_m(&last.at));
        let at_end = end.last.zip(end.setting.goal).map(|(last, goal)| (last.at - goal).norm());
        vec![
            or_why(
                whole.zip(left).map(|(whole, left)| left / whole),
                "start and goal are one place, or no way leads there",
            ),
            or_why(self.0.value(), empty),
            or_why(at_end, empty),
        ]
    }
}

#[cfg(test)]
mod tests {
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, floor, paths, recording};
    use crate::metrics::tests::value_of;

    #[test]
    fn half_way_is_half_of_the_way_left() {
        let place = floor(&[], &[("a", "CORRIDOR", 0., 0.), ("b", "CORRIDOR", 10., 0.)], &[("a", "b")]);
        let way = paths(&["a", "b"], &[]);
        let run = recording(&[Walk::robot(0., 0., 0.5, 0.)], 10.0, 0.1);
        let evidence = Evidence { location: Some(&place), paths: Some(&way), ..Evidence::of(&run) };
        assert!((value_of(&evidence, "goal_ratio").unwrap() - 0.5).abs() < 0.01);
        assert!((value_of(&evidence, "goal_distance_min").unwrap() - 5.0).abs() < 1e-6);
        assert_eq!(value_of(&evidence, "success"), Some(0.0));
    }
}
