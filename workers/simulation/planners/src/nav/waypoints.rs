//! The waypoints, one after the other.

use socrates_model::{Point, Pose};

/// Parameters of the waypoint follower; defaults are the paper's and Nav2's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaypointParams {
    /// Pause at each waypoint, s; default 0.2.
    pub waypoint_pause_duration: f64,
    /// Whether a waypoint that cannot be reached ends the run; default false: the next one is gone for.
    pub stop_on_failure: bool,
}

impl Default for WaypointParams {
    fn default() -> Self {
        Self { waypoint_pause_duration: 0.2, stop_on_failure: false }
    }
}

/// The list of waypoints and how far it has come.
#[derive(Debug, Default)]
pub struct WaypointFollower {
    params: WaypointParams,
    goals: Vec<Pose>,
    next: usize,
    missed: Vec<usize>,
    pause_until_s: f64,
}

impl WaypointFollower {
    /// A follower of points; each is to be reached with the heading of the way to it.
    #[must_use]
    pub fn new(params: &WaypointParams, points: &[Point]) -> Self {
        let mut yaw = 0.0;
        let goals = points.iter().enumerate().map(|(place, point)| {
            let before = place.checked_sub(1).and_then(|before| points.get(before));
            if let Some(before) = before.filter(|before| *before != point) {
                yaw = libm::atan2(point.y - before.y, point.x - before.x);
            }
            Pose::new(point.x, point.y, yaw)
        });
        let goals = goals.collect();
        Self { params: *params, goals, next: 0, missed: Vec::new(), pause_until_s: f64::NEG_INFINITY }
    }

    /// The waypoint to go for; `None` at the end.
    #[must_use]
    pub fn goal(&self) -> Option<Pose> {
        self.goals.get(self.next).copied()
    }

    /// Place of the waypoint to go for in the list; the number of waypoints at the end.
    #[must_use]
    pub const fn index(&self) -> usize {
        self.next
    }

    /// Places of the waypoints that were given up.
    #[must_use]
    pub fn missed(&self) -> &[usize] {
        &self.missed
    }

    /// Whether it pauses at a waypoint.
    #[must_use]
    pub fn pauses(&self, now_s: f64) -> bool {
        now_s < self.pause_until_s
    }

    /// The waypoint was reached.
    pub fn reached(&mut self, now_s: f64) {
        self.next += 1;
        self.pause_until_s = now_s + self.params.waypoint_pause_duration;
    }

    /// The waypoint cannot be reached.
    pub fn failed(&mut self) {
        self.missed.push(self.next);
        self.next = if self.params.stop_on_failure { self.goals.len() } else { self.next + 1 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_waypoint_given_up_is_named_and_the_next_is_gone_for() {
        let points = [Point::new(0.0, 0.0), Point::new(0.0, 2.0), Point::new(2.0, 2.0)];
        let mut follower = WaypointFollower::new(&WaypointParams::default(), &points);
        follower.reached(3.0);
        assert!(follower.pauses(3.1) && !follower.pauses(3.21));
        assert!((follower.goal().unwrap().yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        follower.failed();
        assert_eq!((follower.index(), follower.missed()), (2, [1].as_slice()));
        let stops = WaypointParams { stop_on_failure: true, ..WaypointParams::default() };
        let mut follower = WaypointFollower::new(&stops, &points);
        follower.failed();
        assert!(follower.goal().is_none());
    }
}
