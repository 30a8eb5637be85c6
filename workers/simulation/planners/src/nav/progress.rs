//! Whether the robot gets on.

use socrates_model::{Point, Pose};

/// Parameters of the progress checker; defaults are Nav2's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProgressParams {
    /// The robot has to move so far, m; default 0.5.
    pub required_movement_radius: f64,
    /// In so long, s; default 10.
    pub movement_time_allowance: f64,
}

impl Default for ProgressParams {
    fn default() -> Self {
        Self { required_movement_radius: 0.5, movement_time_allowance: 10.0 }
    }
}

/// The progress checker.
#[derive(Debug, Default)]
pub struct ProgressChecker {
    params: ProgressParams,
    /// Where and when, s, it last got on.
    from: Option<(Point, f64)>,
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
        let at = pose.point();
        match self.from {
            Some((from, since_s)) if (at - from).norm() <= self.params.required_movement_radius => {
                now_s - since_s <= self.params.movement_time_allowance
            }
            Some(_) | None => {
                self.from = Some((at, now_s));
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
}
