//! A robot without a planner: stands, drives through points and waits for whoever is in its way, or replays a recorded way.

use socrates_crowd::Person;
use socrates_crowd::tracks::Track;
use socrates_model::geometry::wrap_angle;
use socrates_model::{Gesture, Point, Pose, Vector};

/// Distance to a point at which it counts as reached, m.
const REACHED_M: f64 = 0.2;
/// Fastest turn, rad/s.
const TURN_RADPS: f64 = 1.5;
/// It turns on the spot where its way is farther to the side, rad.
const TURN_FIRST_RAD: f64 = 0.6;
/// Largest acceleration, m/s².
const A_MAX: f64 = 1.0;
/// It waits for whoever is nearer than this ahead, surface to surface, m.
const WAIT_M: f64 = 0.45;

/// A robot as described on the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotSpec {
    /// Number that must differ from those of the people. Default: any free one.
    pub id: Option<i64>,
    /// Where it starts.
    pub start: Pose,
    /// Points it drives through, in order; without any it stands.
    pub goals: Vec<Point>,
    /// Whether it starts over after the last point. Default false.
    pub cyclic: bool,
    /// Speed, m/s. Default 0.6.
    pub speed_mps: f64,
    /// Radius, m. Default 0.35, as HuNavSim has it.
    pub radius_m: f64,
    /// Gestures from their times on, s, in order of time.
    pub gestures: Vec<(f64, Gesture)>,
    /// A recorded way, which it takes tick by tick instead of driving; before it and after it the robot stands at its ends.
    pub track: Option<Track>,
}

impl RobotSpec {
    /// A robot that stands at a pose.
    #[must_use]
    pub const fn standing(start: Pose) -> Self {
        Self {
            id: None,
            start,
            goals: Vec::new(),
            cyclic: false,
            speed_mps: 0.6,
            radius_m: 0.35,
            gestures: Vec::new(),
            track: None,
        }
    }

    /// A robot that replays a recorded way, whoever is in it.
    #[must_use]
    pub fn replaying(track: Track) -> Self {
        let start = track.samples().first().map_or_else(Point::origin, |sample| sample.position);
        let facing = track.at(track.first_s(), &Person::standing(0, start)).map_or(0.0, |person| person.yaw);
        Self { track: Some(track), ..Self::standing(Pose::new(start.x, start.y, facing)) }
    }
}

/// The robot of a run.
#[derive(Debug, Clone)]
pub(crate) struct Robot {
    pub(crate) spec: RobotSpec,
    pub(crate) pose: Pose,
    pub(crate) velocity: Vector,
    pub(crate) omega: f64,
    pub(crate) gesture: Option<Gesture>,
    pub(crate) arrived: bool,
    speed_mps: f64,
    next: usize,
}

impl Robot {
    pub(crate) fn new(spec: &RobotSpec) -> Self {
        Self {
            spec: spec.clone(),
            pose: Pose { yaw: wrap_angle(spec.start.yaw), ..spec.start },
            velocity: Vector::zeros(),
            omega: 0.0,
            gesture: None,
            arrived: false,
            speed_mps: 0.0,
            next: 0,
        }
    }

    pub(crate) fn at(&self) -> Point {
        self.pose.point()
    }

    pub(crate) fn heading(&self) -> Vector {
        Vector::new(libm::cos(self.pose.yaw), libm::sin(self.pose.yaw))
    }

    /// The point it drives to.
    pub(crate) fn goal(&self) -> Option<Point> {
        self.spec.goals.get(self.next).copied()
    }

    /// One step on; `people` are centers and radii. Says whether it has arrived just now.
    pub(crate) fn step(&mut self, now_s: f64, dt: f64, people: &[(Point, f64)]) -> bool {
        self.gesture = self
            .spec
            .gestures
            .iter()
            .take_while(|(from_s, _)| *from_s <= now_s + 1e-9)
            .last()
            .map(|(_, gesture)| *gesture);
        let here = Person { yaw: self.pose.yaw, velocity: self.velocity, ..Person::standing(0, self.at()) };
        let replayed = self.spec.track.as_ref().map(|track| (track.at(now_s + dt, &here), now_s + dt > track.last_s()));
        if let Some((person, is_over)) = replayed {
            return self.replay(person, is_over);
        }
        let Some(goal) = self.goal() else {
            self.halt();
            return false;
        };
        let way = goal - self.at();
        let distance = way.norm();
        if distance <= REACHED_M {
            self.next += 1;
            if self.next >= self.spec.goals.len() && self.spec.cyclic {
                self.next = 0;
            }
            let arrived = self.goal().is_none() && !self.arrived;
            self.arrived |= arrived;
            return arrived;
        }
        let turn = wrap_angle(libm::atan2(way.y, way.x) - self.pose.yaw);
        self.omega = (turn / dt).clamp(-TURN_RADPS, TURN_RADPS);
        let heading = self.heading();
        let blocked = people.iter().any(|(at, radius_m)| {
            let to = at - self.at();
            let gap = to.norm() - radius_m - self.spec.radius_m;
            gap < WAIT_M && to.dot(&heading) > 0.6 * to.norm()
        });
        let wish = if blocked || turn.abs() > TURN_FIRST_RAD {
            0.0
        } else {
            self.spec.speed_mps.min(libm::sqrt(2.0 * A_MAX * distance))
        };
        // It brakes as hard as it must, and speeds up gently.
        self.speed_mps = wish.min(self.speed_mps + A_MAX * dt);
        self.pose.yaw = wrap_angle(self.pose.yaw + self.omega * dt);
        self.velocity = self.heading() * self.speed_mps;
        self.pose.x += self.velocity.x * dt;
        self.pose.y += self.velocity.y * dt;
        false
    }

    /// Takes the place that the recorded way has for it. Says whether the way has ended just now.
    fn replay(&mut self, person: Option<Person>, is_over: bool) -> bool {
        let Some(person) = person else {
            self.halt();
            let ends = is_over && !self.arrived;
            self.arrived |= ends;
            return ends;
        };
        self.pose = Pose::new(person.position.x, person.position.y, wrap_angle(person.yaw));
        self.velocity = person.velocity;
        false
    }

    fn halt(&mut self) {
        self.velocity = Vector::zeros();
        self.omega = 0.0;
        self.speed_mps = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_drives_through_its_points_and_arrives_once() {
        let mut spec = RobotSpec::standing(Pose::new(0.0, 0.0, 0.0));
        spec.goals = vec![Point::new(2.0, 0.0), Point::new(2.0, 2.0)];
        spec.gestures = vec![(1.0, Gesture::Wait)];
        let mut robot = Robot::new(&spec);
        let arrivals = (0..2000).filter(|tick| robot.step(f64::from(*tick) * 0.01, 0.01, &[])).count();
        assert_eq!(arrivals, 1);
        assert!((robot.at() - Point::new(2.0, 2.0)).norm() < 0.25);
        assert_eq!(robot.gesture, Some(Gesture::Wait));
    }

    #[test]
    fn it_replays_a_recorded_way_through_whoever_is_in_it_and_stands_at_its_end() {
        let tracks = socrates_crowd::tracks::Tracks::read("t,id,x,y\n0,0,1,2\n2,0,3,2\n4,0,3,4\n").unwrap();
        let mut robot = Robot::new(&RobotSpec::replaying(tracks.get(0).unwrap().clone()));
        assert_eq!((robot.pose.x, robot.pose.y), (1.0, 2.0));
        let arrivals = (0..600).filter(|tick| {
            let arrived = robot.step(f64::from(*tick) * 0.01, 0.01, &[(Point::new(3.0, 2.0), 0.3)]);
            if *tick == 99 {
                assert!((robot.at() - Point::new(2.0, 2.0)).norm() < 1e-6, "{}", robot.at());
            }
            arrived
        });
        assert_eq!(arrivals.count(), 1);
        assert!((robot.at() - Point::new(3.0, 4.0)).norm() < 0.03 && robot.velocity.norm() == 0.0, "{}", robot.at());
    }

    #[test]
    fn it_waits_for_somebody_in_its_way() {
        let mut spec = RobotSpec::standing(Pose::new(0.0, 0.0, 0.0));
        spec.goals = vec![Point::new(9.0, 0.0)];
        let mut robot = Robot::new(&spec);
        for tick in 0..2000 {
            robot.step(f64::from(tick) * 0.01, 0.01, &[(Point::new(4.0, 0.1), 0.3)]);
        }
        assert!((2.5..3.35).contains(&robot.pose.x), "{}", robot.pose.x);
    }
}
