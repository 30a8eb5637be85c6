//! Whether the robot gets on.

use socrates_model::Pose;
use socrates_model::geometry::wrap_angle;

/// Parameters of the progress checker; defaults are Nav2's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProgressParams {
    /// The robot has to move so far, m; default 0.5.
    pub required_movement_radius: f64,
    /// Or to turn so far, rad (`PoseProgressChecker`); default none: turning is no progress.
    pub required_movement_angle: Option<f64>,
    /// In so long, s; default 10.
    pub movement_time_allowance: f64,
}

impl Default for ProgressParams {
    fn default() -> Self {
        Self { required_movement_radius: 0.5, required_movement_angle: None, movement_time_allowance: 10.0 }
    }
}

/// The progress checker.
#[derive(Debug, Default)]
pub struct ProgressChecker {
    params: ProgressParams,
    /// Where and when, s, it last got on.
    from: Option<(Pose, f64)>,
}

impl ProgressChecker {
    /// A checker that has seen nothing.
    #[must_use]
    pub const fn new(params: &ProgressParams) -> Self {
        Self { params: *params, from: None }
    }

    /// Begins anew.
    pub const fn reset(&mut self) {
        self.from = None;
    }

    /// Whether the robot got on in the time it has.
    pub fn gets_on(&mut self, pose: &Pose, now_s: f64) -> bool {
        let params = &self.params;
        let stays = |from: &Pose| {
            let turned = wrap_angle(pose.yaw - from.yaw).abs();
            (pose.point() - from.point()).norm() <= params.required_movement_radius
                && params.required_movement_angle.is_none_or(|angle| turned <= angle)
        };
        match self.from {
            Some((from, since_s)) if stays(&from) => now_s - since_s <= self.params.movement_time_allowance,
            Some(_) | None => {
                self.from = Some((*pose, now_s));
                true
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_meter_in_ten_seconds_is_enough_and_less_is_not() {
        let mut checker = ProgressChecker::default();
        let at = |x: f64| Pose::new(x, 0.0, 0.0);
        assert!(checker.gets_on(&at(0.0), 0.0));
        assert!(checker.gets_on(&at(0.51), 9.9));
        assert!(checker.gets_on(&at(0.6), 19.8));
        assert!(!checker.gets_on(&at(0.7), 20.0));
        checker.reset();
        assert!(checker.gets_on(&at(0.7), 20.0));
    }

    #[test]
    fn turning_is_progress_where_that_is_asked() {
        let turns = ProgressParams { required_movement_angle: Some(0.5), ..ProgressParams::default() };
        for (params, gets_on) in [(turns, true), (ProgressParams::default(), false)] {
            let mut checker = ProgressChecker::new(&params);
            assert!(checker.gets_on(&Pose::new(0.0, 0.0, 3.0), 0.0));
            assert_eq!(checker.gets_on(&Pose::new(0.0, 0.0, -2.7), 11.0), gets_on);
        }
    }
}
