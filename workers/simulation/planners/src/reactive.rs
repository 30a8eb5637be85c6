//! `reactive`: a small dynamic-window planner. It knows map, waypoints, lidar and the people it sees, and
//! neither the script nor the intended way between the waypoints.
//!
//! Fox, Burgard and Thrun 1997: of the velocities that can be reached within one call, the one with the best
//! sum of progress, clearance and speed along its arc; people are moved on at their present velocity.

use socrates_model::geometry::wrap_angle;
use socrates_model::{Command, Observation, Point, Polyline, RobotDriver, RobotModel, Vector};

use crate::detour;
use crate::ground::{Ground, closed_door_ahead, obstacles};
use crate::mission::Mission;
use crate::pursuit::{safe_share, steer};

/// Calls per second.
const RATE_HZ: f64 = 10.0;
/// How far ahead in time an arc is looked at, s.
const HORIZON_S: f64 = 3.0;
/// Steps of an arc.
const STEPS: u32 = 15;
/// Gap to bodies and walls below which an arc is not taken, m.
const LEAST_GAP_M: f64 = 0.08;
/// Gap from which on more is no better, m.
const ENOUGH_GAP_M: f64 = 0.5;

/// The planner.
#[derive(Debug)]
pub(crate) struct Reactive {
    robot: RobotModel,
    ground: Ground,
    route: Polyline,
    s: f64,
    /// Seconds without speed, and the way out that was planned for it with its own progress and age.
    still_s: f64,
    recovery: Option<(Polyline, f64, f64)>,
}

impl Reactive {
    pub(crate) fn new(mission: &Mission) -> Self {
        let ground = Ground::new(mission);
        let mut route = Polyline::default();
        for pair in mission.waypoints.windows(2) {
            let [from, to] = pair else { continue };
            match ground.way(from, to) {
                Some(way) => way.points().iter().for_each(|point| route.push(*point)),
                None => {
                    route.push(*from);
                    route.push(*to);
                }
            }
        }
        if route.points().is_empty() {
            mission.waypoints.iter().for_each(|point| route.push(*point));
        }
        Self { robot: mission.robot, ground, route, s: 0.0, still_s: 0.0, recovery: None }
    }

    /// A point on a way out of a standstill, while there is one: the window alone stays in front of who stands.
    fn recover(&mut self, seen: &Observation<'_>) -> Option<Point> {
        let at = seen.pose.point();
        self.still_s = if seen.v.abs() < 0.05 { self.still_s + 1.0 / RATE_HZ } else { 0.0 };
        if self.still_s > 1.5 && self.recovery.is_none() {
            self.still_s = 0.0;
            let people = obstacles(seen, &self.route.direction(self.s), 5.5);
            let goal = self.route.point(self.s + 3.5);
            self.recovery = detour::round(&self.ground, &people, &self.route, &at, &goal).map(|way| (way, 0.0, 0.0));
        }
        let (way, s, age) = self.recovery.as_mut()?;
        *s = way.project_within(&at, *s, *s + 1.0).0;
        *age += 1.0 / RATE_HZ;
        let target = way.point(*s + 0.8);
        if *age > 8.0 || *s > way.length_m() - 0.4 {
            self.recovery = None;
        }
        Some(target)
    }

    /// Value of driving at (v, omega) for the horizon; `None` where it hits something.
    fn value(&self, seen: &Observation<'_>, cloud: &[Point], v: f64, omega: f64, target: &Point) -> Option<f64> {
        let mut pose = (seen.pose.point(), seen.pose.yaw);
        let dt = HORIZON_S / f64::from(STEPS);
        let mut least = ENOUGH_GAP_M;
        let mut late = 0.0_f64;
        for step in 1..=STEPS {
            pose.1 += omega * dt;
            pose.0 += Vector::new(libm::cos(pose.1), libm::sin(pose.1)) * (v * dt);
            let t = dt * f64::from(step);
            let people =
                seen.people.iter().map(|person| (person.at + person.velocity * t - pose.0).norm() - person.radius_m);
            let scan = cloud.iter().map(|hit| (hit - pose.0).norm());
            let gap = people.chain(scan).fold(self.ground.clearance_m(&pose.0), f64::min) - self.robot.radius_m;
            least = least.min(gap);
            // Beyond the way to stop, an arc may still be left.
            if gap < LEAST_GAP_M {
                if t <= v / self.robot.a_max_mps2 + 0.8 {
                    return None;
                }
                late = late.max(1.0 - t / HORIZON_S);
            }
        }
        let way = target - pose.0;
        let turn = wrap_angle(libm::atan2(way.y, way.x) - pose.1).abs();
        let progress = (target - seen.pose.point()).norm() - way.norm();
        Some(1.2 * progress + 0.8 * least.max(0.0) + 0.3 * v - 0.25 * turn - 3.0 * late)
    }
}

impl RobotDriver for Reactive {
    fn rate_hz(&self) -> f64 {
        RATE_HZ
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let at = seen.pose.point();
        self.ground.look(seen);
        let (s, aside) = self.route.project_within(&at, self.s, self.s + 2.5);
        if aside < 3.0 {
            self.s = s.max(self.s);
        }
        let end = self.route.end().unwrap_or(at);
        let left = (end - at).norm();
        if left < 0.15 {
            return Command { waiting: true, ..Command::default() };
        }
        if closed_door_ahead(seen, &self.route, self.s, 1.2).is_some_and(|left| left < self.robot.radius_m + 0.7) {
            return Command { waiting: true, ..Command::default() };
        }
        if left < 1.0 && self.ground.straight(&at, &end, 0.0) {
            // The last meter is driven straight: the window looks farther than that.
            let last = Polyline::new(&[at, end]);
            let share = safe_share(seen, &last, 0.0, &self.robot, 0.1);
            return steer(seen, &last, 0.0, share * self.robot.v_max_mps, &self.robot);
        }
        let target = self.recover(seen).unwrap_or_else(|| self.route.point(self.s + 1.4));
        let scan = (seen.lidar)();
        let cloud: Vec<Point> = scan
            .iter()
            .enumerate()
            .step_by(6)
            .filter(|(_, range)| **range < 2.5)
            .map(|(beam, range)| {
                #[expect(clippy::cast_precision_loss, reason = "360 beams")]
                let angle = seen.pose.yaw + (beam as f64).to_radians();
                at + Vector::new(libm::cos(angle), libm::sin(angle)) * *range
            })
            // People are judged where they will be, not where the beams met them.
            .filter(|hit| seen.people.iter().all(|person| (person.at - hit).norm() > person.radius_m + 0.1))
            .collect();
        let reach = 2.0 * self.robot.a_max_mps2 / RATE_HZ;
        let most = self.robot.v_max_mps.min(0.2 + left);
        let mut best: Option<(f64, f64, f64)> = None;
        for fast in 0..=5_u32 {
            let v = (seen.v - reach + 2.0 * reach * f64::from(fast) / 5.0).clamp(0.0, most);
            for turn in 0..=14_u32 {
                let omega = self.robot.omega_max_radps * (f64::from(turn) / 7.0 - 1.0);
                if let Some(value) = self.value(seen, &cloud, v, omega, &target)
                    && best.is_none_or(|(top, _, _)| value > top + 1e-9)
                {
                    best = Some((value, v, omega));
                }
            }
        }
        match best {
            Some((_, v, omega)) => Command { v, omega, gesture: None, waiting: false },
            // Nothing is free: stand and turn towards the way.
            None => {
                let way = target - at;
                let turn = wrap_angle(libm::atan2(way.y, way.x) - seen.pose.yaw);
                Command { v: 0.0, omega: turn.clamp(-0.6, 0.6), gesture: None, waiting: false }
            }
        }
    }
}
