//! `straight_line`, `social_force`, `orca`: robots that move like the people of a crowd model, or see nobody.
//!
//! All three follow the shortest free way through their waypoints. What they wish is a velocity toward a point ahead on it; what
//! the base is told is that velocity, or the turn toward it where the base cannot go to the side.

use socrates_crowd::model::{Room, View};
use socrates_crowd::obstacle::Segment;
use socrates_crowd::orca::{Orca, OrcaSettings};
use socrates_crowd::{Goal, Params, Person, forces_on};
use socrates_model::geometry::wrap_angle;
use socrates_model::{Command, Observation, Point, Polyline, RobotDriver, RobotModel, Vector};

use crate::ground::{Ground, is_at_end, waits_at_door};
use crate::mission::Mission;
use crate::pursuit::pursue;

/// Calls per second.
const RATE_HZ: f64 = 20.0;
const DT_S: f64 = 1.0 / RATE_HZ;
/// Its place on its way is looked for so far back and on, m: a crowd may carry it along or hold it.
const AROUND_M: (f64, f64) = (0.5, 3.0);
/// Points ahead on its way that it may head for, farthest first, m: the farthest that nothing stands between counts.
const AHEAD_M: [f64; 5] = [2.0, 1.2, 0.7, 0.4, 0.2];
/// Walls are felt from so far, in so many sectors, as by people.
const WALL_REACH_M: f64 = 3.0;
const SECTORS: usize = 8;
/// A base that has to turn first is wider than it is, m: the velocity that avoidance chose is taken late.
const TURNS_M: f64 = 0.05;
/// Turning rate for each radian off the wished direction, 1/s.
const TURN_PER_S: f64 = 2.4;
/// Nearer to the end of its way than this it comes to rest, m.
const REST_M: f64 = 0.06;

/// How a robot goes by people.
#[derive(Debug)]
enum Manner {
    /// It sees nobody.
    Straight,
    /// It is pushed by social forces, with the constants of the HuNavSim family.
    Forces(Params),
    /// It takes the velocity nearest to its wish at which nobody is hit within 5 s (the settings of CrowdNav).
    Avoids(Orca),
}

/// The planner.
#[derive(Debug)]
pub(crate) struct Walker {
    manner: Manner,
    robot: RobotModel,
    ground: Ground,
    route: Polyline,
    /// Whether the way leads to the goal; where no way does it ends at the last waypoint that can be reached.
    complete: bool,
    s: f64,
    room: Room,
}

impl Walker {
    fn new(mission: &Mission, manner: Manner) -> Self {
        let ground = Ground::new(mission);
        let (route, complete) = ground.through(&mission.waypoints);
        Self { manner, robot: mission.robot, ground, route, complete, s: 0.0, room: Room::default() }
    }

    /// A robot that sees nobody.
    pub(crate) fn straight(mission: &Mission) -> Self {
        Self::new(mission, Manner::Straight)
    }

    /// A robot that social forces push.
    pub(crate) fn forces(mission: &Mission) -> Self {
        Self::new(mission, Manner::Forces(Params::default()))
    }

    /// A robot that avoids optimally, each taking half of the turn aside.
    pub(crate) fn avoids(mission: &Mission) -> Self {
        let settings =
            OrcaSettings { neighbor_range_m: 10.0, horizon_s: 5.0, wall_horizon_s: 1.0, ..OrcaSettings::default() };
        // Settings that cannot be meant leave a robot that sees nobody; a test holds that these can.
        Self::new(mission, Orca::new(settings).map_or(Manner::Straight, Manner::Avoids))
    }

    /// The point ahead on its way that it heads for.
    fn target(&self, at: &Point) -> Point {
        let margin_m = (self.ground.clearance_m(at) - self.robot.radius_m).min(0.0);
        let reached = |ahead: &f64| self.ground.straight(at, &self.route.point(self.s + ahead), margin_m);
        let ahead = AHEAD_M.into_iter().find(reached).unwrap_or(0.1);
        self.route.point(self.s + ahead)
    }

    /// The velocity that the crowd model gives the robot, m/s in the map.
    fn velocity(&mut self, seen: &Observation<'_>, target: &Point, last: bool) -> Option<Vector> {
        let at = seen.pose.point();
        let ahead = Vector::new(libm::cos(seen.pose.yaw), libm::sin(seen.pose.yaw));
        let side = if self.robot.is_omnidirectional() { 0.0 } else { TURNS_M };
        let me = Person {
            id: 0,
            position: at,
            velocity: ahead * seen.v + Vector::new(-ahead.y, ahead.x) * seen.vy,
            yaw: seen.pose.yaw,
            radius_m: self.robot.radius_m + side,
            speed_mps: self.robot.v_max_mps,
            // Only the end of the way is a place to come to rest at.
            goal: Some(Goal { at: *target, radius_m: if last { REST_M } else { 0.0 } }),
            group: None,
        };
        let mut people = vec![me.clone()];
        people.extend(seen.people.iter().map(|person| Person {
            id: person.id.number(),
            position: person.at,
            velocity: person.velocity,
            yaw: person.yaw,
            radius_m: person.radius_m,
            speed_mps: person.velocity.norm(),
            goal: None,
            group: None,
        }));
        let walls = self.ground.wall_points(&at, WALL_REACH_M, SECTORS);
        match &self.manner {
            Manner::Straight => None,
            Manner::Forces(params) => {
                let force = forces_on(0, &people, &walls, params).total();
                Some(me.velocity + force * DT_S)
            }
            Manner::Avoids(orca) => {
                let walls: Vec<Segment> = walls.iter().map(|point| Segment { from: *point, to: *point }).collect();
                let view = View {
                    me: &me,
                    place: Some(0),
                    people: &people,
                    walls: &walls,
                    now_s: 0.0,
                    dt_s: DT_S,
                    index: None,
                };
                Some(orca.velocity(&view, &mut self.room))
            }
        }
    }

    /// What the base is told for a velocity.
    fn told(&self, seen: &Observation<'_>, wish: Vector) -> Command {
        let most = self.robot.v_max_mps;
        let wish = if wish.norm() > most { wish * (most / wish.norm()) } else { wish };
        let (sin, cos) = (libm::sin(seen.pose.yaw), libm::cos(seen.pose.yaw));
        let (forward, side) = (wish.x * cos + wish.y * sin, wish.y * cos - wish.x * sin);
        let turn = if wish.norm() > 0.02 { wrap_angle(libm::atan2(side, forward)) } else { 0.0 };
        let omega = (TURN_PER_S * turn).clamp(-self.robot.omega_max_radps, self.robot.omega_max_radps);
        if self.robot.is_omnidirectional() {
            return Command { v: forward, vy: side, omega, ..Command::default() };
        }
        // Facing away it turns on the spot.
        Command { v: forward.max(0.0), omega, ..Command::default() }
    }
}

impl RobotDriver for Walker {
    fn rate_hz(&self) -> f64 {
        RATE_HZ
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let at = seen.pose.point();
        self.ground.look(seen);
        self.s = self.route.progress(&at, self.s, AROUND_M).0;
        let stand = Command::default();
        let Some(end) = self.route.end() else { return stand };
        if is_at_end(&self.route, &at, self.s) {
            return Command { waiting: self.complete, ..stand };
        }
        if waits_at_door(seen, &self.route, self.s, self.robot.radius_m) {
            return Command { waiting: true, ..stand };
        }
        let target = self.target(&at);
        let last = (target - end).norm() < 1e-6;
        match self.velocity(seen, &target, last) {
            Some(wish) => self.told(seen, wish),
            None => pursue(seen, &self.ground, (&self.route, self.s), self.robot.v_max_mps, &self.robot),
        }
    }
}
