//! Everybody on the floor, and what can be asked about them.

use socrates_crowd::orca::Orca;
use socrates_crowd::{Forces, Goal, Near, Person, forces_on};
use socrates_engine::Floor;
use socrates_model::geometry::wrap_angle;
use socrates_model::{EventKind, NodeId, Point, Vector};

use super::agent::Agent;
use super::obstacle::{Bounds, one_point};
use super::robot::Robot;
use crate::agents::Reaction;
use crate::profile::{RobotFelt, Rules};

/// Robot radius as HuNavSim has it, m: the radius of a goal that is the robot.
pub(crate) const ROBOT_RADIUS_M: f64 = 0.35;

/// Something to look at or go to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    /// The robot.
    Robot,
    /// An agent by its place in the list.
    Agent(usize),
    /// A place.
    Spot(Point),
}

/// What an agent does in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Deed {
    /// Walks to its first goal.
    Walk,
    /// Stands.
    Stand,
    /// Stands and turns to something.
    Look(Target),
    /// Goes up to something and stops before it.
    Approach { target: Target, stop_m: f64, speed_mps: f64 },
    /// Keeps up with something.
    Follow { target: Target, gap_m: f64, speed_mps: f64 },
    /// Keeps away from the robot.
    Flee { speed_mps: f64, factor: f64 },
    /// Lets the robot through.
    GiveWay,
    /// Stands in front of something.
    Block { target: Target, ahead_m: f64 },
    /// Walks to a place that is not on its list.
    GoTo(Point),
}

/// How somebody feels the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Felt {
    /// As a person.
    Person,
    /// As an obstacle point.
    Obstacle,
    /// Not at all.
    Nothing,
}

/// Everybody on the floor at a moment.
#[derive(Debug)]
pub(crate) struct Scene {
    pub(crate) rules: Rules,
    pub(crate) agents: Vec<Agent>,
    pub(crate) robot: Option<Robot>,
    pub(crate) floor: Floor,
    /// Where everybody who is present was when native motion began this tick, by place in the list.
    pub(crate) near: Near,
    pub(crate) orca: Orca,
    pub(crate) boxes: Vec<Bounds>,
    /// Global goals: number k is entry k - 1.
    pub(crate) goals: Vec<Point>,
    pub(crate) now_s: f64,
    pub(crate) dt: f64,
    /// What happened in this tick and is not written down yet.
    pub(crate) events: Vec<EventKind>,
}

impl Scene {
    /// Where a target is; `None` where there is no such thing on the floor.
    pub(crate) fn place(&self, target: Target) -> Option<Point> {
        match target {
            Target::Robot => self.robot.as_ref().map(Robot::at),
            Target::Agent(index) => self.agents.get(index).filter(|agent| agent.present).map(|agent| agent.at),
            Target::Spot(at) => Some(at),
        }
    }

    /// Heading of a target, rad.
    pub(crate) fn yaw(&self, target: Target) -> f64 {
        match target {
            Target::Robot => self.robot.as_ref().map_or(0.0, |robot| robot.pose.yaw),
            Target::Agent(index) => self.agents.get(index).map_or(0.0, |agent| agent.yaw),
            Target::Spot(_) => 0.0,
        }
    }

    /// Radius of a target, m.
    pub(crate) fn radius_m(&self, target: Target) -> f64 {
        match target {
            Target::Robot => self.robot.as_ref().map_or(ROBOT_RADIUS_M, |robot| robot.spec.radius_m),
            Target::Agent(index) => self.agents.get(index).map_or(0.0, |agent| agent.radius_m),
            Target::Spot(_) => 0.1,
        }
    }

    /// Velocity of a target, m/s.
    pub(crate) fn velocity(&self, target: Target) -> Vector {
        match target {
            Target::Robot => self.robot.as_ref().map_or_else(Vector::zeros, |robot| robot.velocity),
            Target::Agent(index) => self.agents.get(index).map_or_else(Vector::zeros, |agent| agent.velocity),
            Target::Spot(_) => Vector::zeros(),
        }
    }

    /// Distance from an agent to a target, center to center, m.
    pub(crate) fn distance_m(&self, me: usize, target: Target) -> Option<f64> {
        let at = self.agents.get(me)?.at;
        Some((self.place(target)? - at).norm())
    }

    /// Whether `target` is within a distance and an angle of the heading of `observer`; where the profile says so, in
    /// line of sight.
    pub(crate) fn sees(&self, observer: usize, target: Target, within_m: f64, half_view_rad: f64) -> Option<f64> {
        let agent = self.agents.get(observer)?;
        let to = self.place(target)?;
        let distance = (to - agent.at).norm();
        let seen = distance <= within_m
            && bearing(&agent.at, agent.yaw, &to).abs() <= half_view_rad
            && (!self.rules.sight || self.floor.sees(&agent.at, &to));
        seen.then_some(distance)
    }

    /// Whether the robot counts as visible.
    pub(crate) fn sees_robot(&self, me: usize, within_m: f64) -> Option<f64> {
        // Whoever runs from it knows where it is, although it turned its back.
        let aware =
            self.rules.native && self.agents.get(me).is_some_and(|agent| agent.errand.aware_until_s > self.now_s);
        let half_view_rad = if aware { std::f64::consts::PI } else { self.rules.half_view_rad };
        self.sees(me, Target::Robot, within_m, half_view_rad)
    }

    /// Whether the robot moves, as the profile takes it.
    pub(crate) fn robot_moved(&self) -> bool {
        let velocity = self.velocity(Target::Robot);
        if self.rules.moved_is_signed {
            // Two signed components below the threshold: a robot that drives towards -x and -y stands.
            !(velocity.x < 0.1 && velocity.y < 0.1)
        } else {
            velocity.norm() > 0.1
        }
    }

    /// The agent of an id.
    pub(crate) fn index_of(&self, id: i64) -> Option<usize> {
        self.agents.iter().position(|agent| agent.id == id)
    }

    /// How an agent feels the robot now.
    pub(crate) fn felt(&self, agent: &Agent) -> Felt {
        let by_reaction = match agent.reaction {
            Reaction::Regular => Felt::Person,
            Reaction::Impassive => Felt::Obstacle,
            Reaction::Surprised
            | Reaction::Scared
            | Reaction::Curious
            | Reaction::Threatening
            | Reaction::Custom(_) => Felt::Nothing,
        };
        match self.rules.robot_felt {
            RobotFelt::ByAll => Felt::Person,
            RobotFelt::ByReaction => by_reaction,
            RobotFelt::UnlessReacting if agent.state == 1 => by_reaction,
            RobotFelt::UnlessReacting => Felt::Person,
        }
    }

    /// Forces on an agent with this goal and speed, from where everybody is now.
    pub(crate) fn forces(&self, me: usize, goal: Option<Goal>, speed_mps: f64, felt: Felt) -> Forces {
        let mut people: Vec<Person> = Vec::with_capacity(self.agents.len() + 1);
        let mut index = 0;
        for (place, agent) in self.agents.iter().enumerate().filter(|(_, agent)| agent.present) {
            if place == me {
                index = people.len();
                people.push(Person { goal, speed_mps, ..agent.person() });
            } else {
                people.push(agent.person());
            }
        }
        let Some(agent) = self.agents.get(me) else { return Forces::default() };
        let mut points: Vec<Point> = one_point(self, me).into_iter().collect();
        match (felt, self.robot.as_ref()) {
            (Felt::Person, Some(robot)) => people.push(Person {
                velocity: robot.velocity,
                yaw: robot.pose.yaw,
                radius_m: robot.spec.radius_m,
                ..Person::standing(0, robot.at())
            }),
            (Felt::Obstacle, Some(robot)) => points.push(robot.at()),
            (Felt::Nothing, _) | (_, None) => {}
        }
        forces_on(index, &people, &points, &agent.forces)
    }

    /// The goal of an agent as the forces take it.
    pub(crate) fn goal(&self, me: usize) -> Option<Goal> {
        let agent = self.agents.get(me)?;
        agent.goals.front().map(|goal| Goal { at: goal.at, radius_m: agent.goal_radius_m })
    }

    /// Takes the first goal off the list of an agent and tells it.
    pub(crate) fn take_goal(&mut self, me: usize, keep_last: bool) {
        let Some(agent) = self.agents.get_mut(me) else { return };
        let who = agent.agent();
        agent.errand.way = None;
        if let Some(node) = agent.next_goal(keep_last).and_then(|name| NodeId::new(name).ok()) {
            self.events.push(EventKind::Node { agent: who, node });
        }
    }
}

/// Angle from a heading to a point, rad, in (-pi, pi].
pub(crate) fn bearing(from: &Point, yaw: f64, to: &Point) -> f64 {
    let way = to - from;
    if way.norm() > 0.0 { wrap_angle(libm::atan2(way.y, way.x) - yaw) } else { 0.0 }
}
