//! The robot's body: a disc with the motion limits of its base, and how far it has come.

use socrates_maps::DistanceField;
use socrates_model::time::STEP_SECS;
use socrates_model::{AgentId, Command, Gesture, NodeId, Point, Polyline, Pose, RobotModel, Vector};

use crate::drive::GESTURE_S;
use crate::other_way::OtherWay;
use crate::view::MOVING_MPS;

/// Farther from its intended way than this the robot goes another way, m; nearer than this to any later part of it, m, it is back.
const OFF_WAY_M: f64 = 3.0;
const BACK_ON_WAY_M: f64 = 1.0;
/// Time over which the robot's own pace is averaged, s.
const PACE_S: f64 = 3.0;

/// The robot.
#[derive(Debug, Clone)]
pub(crate) struct Robot {
    pub(crate) model: RobotModel,
    pub(crate) pose: Pose,
    /// Forward, m/s.
    pub(crate) v: f64,
    /// To the left, m/s.
    pub(crate) vy: f64,
    pub(crate) omega: f64,
    pub(crate) velocity: Vector,
    /// Whether it ever moved.
    pub(crate) has_moved: bool,
    /// For how long it has stood since it last moved, s.
    pub(crate) stood_s: f64,
    pub(crate) command: Command,
    pub(crate) calls: u64,
    pub(crate) gesture: Option<Gesture>,
    pub(crate) gesture_until_s: f64,
    /// Intended way.
    pub(crate) route: Polyline,
    pub(crate) nodes: Vec<(NodeId, f64)>,
    pub(crate) next_node: usize,
    pub(crate) s: f64,
    /// How far on it is while it goes another way; made when it first does.
    pub(crate) other_way: Option<OtherWay>,
    /// Pace along the way while it moves, m/s.
    pub(crate) pace_mps: f64,
    pub(crate) arrived_s: Option<f64>,
    /// For how long it has rested at its goal, or stood near it while it is occupied, s.
    pub(crate) at_full_goal_s: f64,
    pub(crate) trail: Polyline,
}

impl Robot {
    /// As a point.
    pub(crate) fn at(&self) -> Point {
        self.pose.point()
    }

    /// As an agent.
    pub(crate) const fn agent() -> AgentId {
        AgentId::Robot
    }

    /// Direction it faces.
    pub(crate) fn heading(&self) -> Vector {
        Vector::new(libm::cos(self.pose.yaw), libm::sin(self.pose.yaw))
    }

    /// Direction it means to go: of its way while it is near it, else where it faces.
    pub(crate) fn intent(&self) -> Vector {
        let (s, aside) = self.route.project_within(&self.at(), self.s - 0.5, self.s + 2.0);
        let way = self.route.direction(s + 0.6);
        if aside < 2.0 && way.norm() > 0.5 && self.arrived_s.is_none() {
            way
        } else if self.model.is_omnidirectional() && self.velocity.norm() > MOVING_MPS {
            self.velocity.normalize()
        } else {
            self.heading()
        }
    }

    /// Whether it is still on its way past the length `s`.
    pub(crate) fn before(&self, s: f64) -> bool {
        self.s < s && self.arrived_s.is_none()
    }

    /// Seconds until it is at length `s` of its way; 0 when it is past.
    pub(crate) fn eta_s(&self, s: f64) -> f64 {
        (s - self.s).max(0.0) / self.pace_mps.max(0.1)
    }

    /// How fast it gets on, m/s: forward speed, of an omnidirectional base speed in whatever direction.
    pub(crate) fn speed_mps(&self) -> f64 {
        if self.model.is_omnidirectional() { self.velocity.norm() } else { self.v }
    }

    /// One tick under the present command.
    pub(crate) fn step(&mut self) {
        let limit = self.model.a_max_mps2 * STEP_SECS;
        let wish = finite(self.command.v).clamp(self.model.v_min_mps, self.model.v_max_mps);
        if self.model.is_omnidirectional() {
            self.step_sideways(wish, limit);
        } else {
            // Braking may be twice as hard as starting: every base brakes harder than it starts.
            let brake = if wish.abs() < self.v.abs() { 2.0 * limit } else { limit };
            self.v += (wish - self.v).clamp(-brake, brake);
        }
        let turn = finite(self.command.omega).clamp(-self.model.omega_max_radps, self.model.omega_max_radps);
        let swing = self.model.alpha_max_radps2 * STEP_SECS;
        self.omega += (turn - self.omega).clamp(-swing, swing);
        self.pose.yaw = socrates_model::geometry::wrap_angle(self.pose.yaw + self.omega * STEP_SECS);
        let heading = self.heading();
        self.velocity = heading * self.v;
        if self.model.is_omnidirectional() {
            self.velocity += Vector::new(-heading.y, heading.x) * self.vy;
        }
        self.pose.x += self.velocity.x * STEP_SECS;
        self.pose.y += self.velocity.y * STEP_SECS;
    }

    /// Speeds of an omnidirectional base: the command is held to the largest speed in any direction, its change to the limit.
    fn step_sideways(&mut self, wish: f64, limit: f64) {
        let side = finite(self.command.vy).clamp(-self.model.vy_max_mps, self.model.vy_max_mps);
        let wish = Vector::new(wish, side);
        let fastest = self.model.v_max_mps.max(self.model.vy_max_mps);
        let wish = if wish.norm() > fastest { wish * (fastest / wish.norm()) } else { wish };
        let now = Vector::new(self.v, self.vy);
        let change = wish - now;
        let most = if wish.norm() < now.norm() { 2.0 * limit } else { limit };
        let next = if change.norm() > most { now + change * (most / change.norm()) } else { wish };
        (self.v, self.vy) = (next.x, next.y);
    }

    /// Takes over what contacts left of position and speed, and counts the progress.
    pub(crate) fn settle(&mut self, at: Point, velocity: Vector, field: &DistanceField) {
        self.pose.x = at.x;
        self.pose.y = at.y;
        if (velocity - self.velocity).norm() > 1e-9 {
            self.velocity = velocity;
            let heading = self.heading();
            self.v = velocity.dot(&heading);
            if self.model.is_omnidirectional() {
                self.vy = velocity.dot(&Vector::new(-heading.y, heading.x));
            }
        }
        let moves = self.velocity.norm() > MOVING_MPS;
        self.has_moved |= moves;
        self.stood_s = if self.has_moved && !moves { self.stood_s + STEP_SECS } else { 0.0 };
        let before = self.s;
        let (s, aside) = self.route.progress(&at, self.s, (0.3, 3.0));
        if aside < OFF_WAY_M {
            self.s = s.max(self.s - 0.02);
        } else {
            // Far off its way the nearest point says little. A planner that goes another way counts again where it comes back.
            let (s, aside) = self.route.project_within(&at, self.s, self.route.length_m());
            let (route, radius_m) = (&self.route, self.model.radius_m);
            let other = self.other_way.get_or_insert_with(|| OtherWay::new(route, field, radius_m));
            self.s = if aside < BACK_ON_WAY_M { s } else { other.level_s(&at, self.s).unwrap_or(self.s) };
        }
        if self.speed_mps() > 0.15 {
            let share = STEP_SECS / PACE_S;
            self.pace_mps += share * (((self.s - before) / STEP_SECS).clamp(0.3, self.model.v_max_mps) - self.pace_mps);
        }
        if self.trail.end().is_none_or(|end| (at - end).norm() > 0.1) {
            self.trail.push(at);
        }
    }

    /// Begins a gesture.
    pub(crate) fn say(&mut self, gesture: Gesture, now_s: f64) {
        self.gesture = Some(gesture);
        self.gesture_until_s = now_s + GESTURE_S;
    }
}

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}
