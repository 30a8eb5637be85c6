//! What one human's tree sees and does: the tick's start in, wishes out.

use std::cell::Cell;

use socrates_bt::World;
use socrates_model::time::STEP_SECS;
use socrates_model::{Action, AgentId, Gesture, HumanId, Point, SimTime, Trigger, Vector};

use crate::floor::Floor;
use crate::human::Human;

/// Half of the field of view, rad: 100° to either side.
pub(crate) const HALF_FIELD_OF_VIEW_RAD: f64 = 100.0 * std::f64::consts::PI / 180.0;
/// The robot blocks somebody whose direction of travel points at it within this angle, rad.
const BLOCKING_RAD: f64 = 0.5;
/// A robot faster than this moves, m/s.
pub(crate) const MOVING_MPS: f64 = 0.1;
/// Within this distance of its encounter node a human is at it, m.
const AT_ENCOUNTER_M: f64 = 1.0;

/// The robot as a human may notice it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RobotSeen {
    pub(crate) at: Point,
    pub(crate) speed_mps: f64,
    /// Whether it has moved in this run.
    pub(crate) has_moved: bool,
    /// For how long it has stood, s.
    pub(crate) stood_s: f64,
    pub(crate) gesture: Option<Gesture>,
}

/// What somebody shows the others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown {
    pub(crate) id: HumanId,
    pub(crate) gesture: Option<Gesture>,
    /// How many of their steps have ended, and whether they are done.
    pub(crate) steps_ended: u32,
    pub(crate) done: bool,
}

/// One human's view of the start of a tick.
pub(crate) struct View<'a> {
    pub(crate) floor: &'a Floor,
    pub(crate) now: SimTime,
    pub(crate) robot: Option<RobotSeen>,
    /// What all humans show, in the order of ids.
    pub(crate) shown: &'a [Shown],
    human: &'a Human,
    sight: Cell<Option<bool>>,
    /// What the tree asked for.
    pub(crate) act: Option<Action>,
    /// What it says from now on; the inner none takes an earlier gesture back.
    pub(crate) say: Option<Option<Gesture>>,
    /// To whom, where that is one.
    pub(crate) say_to: Option<AgentId>,
    /// The last step of its own that has ended, this tick included.
    pub(crate) steps_ended: u32,
}

impl<'a> View<'a> {
    pub(crate) fn of(
        human: &'a Human,
        floor: &'a Floor,
        now: SimTime,
        robot: Option<RobotSeen>,
        shown: &'a [Shown],
    ) -> Self {
        let sight = Cell::new(human.notice.robot_seen);
        Self {
            floor,
            now,
            robot,
            shown,
            human,
            sight,
            act: None,
            say: None,
            say_to: None,
            steps_ended: human.steps_ended,
        }
    }

    fn shown(&self, id: HumanId) -> Option<&Shown> {
        let place = self.shown.binary_search_by_key(&id, |shown| shown.id).ok()?;
        self.shown.get(place)
    }

    fn in_sight(&self, robot: &RobotSeen) -> bool {
        if let Some(known) = self.sight.get() {
            return known;
        }
        let seen = self.floor.sees(&self.human.at, &robot.at);
        self.sight.set(Some(seen));
        seen
    }

    /// Whether robot and human are in line of sight, where that was asked.
    pub(crate) const fn looked(&self) -> Option<bool> {
        self.sight.get()
    }

    /// Whether the robot is in the field of view and in line of sight at any distance up to `within_m`.
    pub(crate) fn sees_robot(&self, within_m: f64) -> Option<f64> {
        let robot = self.robot?;
        if self.sight.get() == Some(false) {
            return None;
        }
        let way = robot.at - self.human.at;
        let distance = way.norm();
        let seen = distance <= within_m && in_field_of_view(&self.human.heading(), &way) && self.in_sight(&robot);
        seen.then_some(distance)
    }
}

/// Whether a way lies in the field of view of somebody who faces there: 100° to either side.
#[must_use]
pub fn in_field_of_view(heading: &Vector, way: &Vector) -> bool {
    // Ahead is always in it; only what is abeam or behind needs the angle.
    heading.dot(way) > 0.0 || angle_between(heading, way) <= HALF_FIELD_OF_VIEW_RAD
}

/// Angle between two directions, rad, 0 to pi; 0 where one of them is zero.
pub(crate) fn angle_between(a: &Vector, b: &Vector) -> f64 {
    libm::atan2(a.perp(b).abs(), a.dot(b))
}

impl World for View<'_> {
    fn robot_distance_m(&self) -> Option<f64> {
        self.robot.map(|robot| (robot.at - self.human.at).norm())
    }

    fn robot_visible(&self, within_m: f64) -> bool {
        self.sees_robot(within_m).is_some()
    }

    fn robot_blocking(&self, within_m: f64) -> bool {
        self.robot.is_some_and(|robot| {
            let way = robot.at - self.human.at;
            way.norm() <= within_m && angle_between(&self.human.travel(), &way) <= BLOCKING_RAD && self.in_sight(&robot)
        })
    }

    fn robot_moving(&self) -> bool {
        self.robot.is_some_and(|robot| robot.speed_mps > MOVING_MPS)
    }

    fn robot_passed(&self) -> bool {
        self.robot_distance_m().is_some_and(|distance_m| Trigger::is_passed(distance_m, self.human.nearest_robot_m))
    }

    fn robot_stopped(&self) -> bool {
        self.robot.is_some_and(|robot| robot.has_moved && robot.speed_mps <= MOVING_MPS)
    }

    fn robot_gesture(&self) -> Option<Gesture> {
        self.robot.and_then(|robot| robot.gesture)
    }

    fn human_gesture(&self, id: HumanId) -> Option<Gesture> {
        // A person who waits for a sign sees it, whomever it is made to.
        self.shown(id).and_then(|shown| shown.gesture)
    }

    fn robot_stood_s(&self) -> f64 {
        self.robot.map_or(0.0, |robot| robot.stood_s)
    }

    fn steps_ended(&self, id: HumanId) -> u32 {
        if id == self.human.id { self.steps_ended } else { self.shown(id).map_or(0, |shown| shown.steps_ended) }
    }

    fn is_done(&self, id: HumanId) -> bool {
        self.shown(id).is_some_and(|shown| shown.done)
    }

    fn end_step(&mut self, step: u32) {
        self.steps_ended = self.steps_ended.max(step);
    }

    fn goal_reached(&self) -> bool {
        self.human.at_goal()
    }

    fn has_arrived(&self) -> bool {
        // A step that begins in this very tick has not set off yet.
        let begins = self.steps_ended > self.human.steps_ended;
        let leads = matches!(self.human.action, Action::TurnBack | Action::GoTo(_));
        leads && !begins && self.human.at_goal()
    }

    fn next_goal(&mut self) {
        // The way is walked node by node by itself; there is no goal to take by hand.
    }

    fn at_encounter(&self) -> bool {
        let meeting = self.human.meeting();
        meeting.is_some_and(|meeting| (self.human.at - meeting.at).norm() <= AT_ENCOUNTER_M)
    }

    fn now(&self) -> SimTime {
        self.now
    }

    fn step_s(&self) -> f64 {
        STEP_SECS
    }

    fn act(&mut self, action: &Action, _leaf: u16) {
        // One motion at a time: the first of a tick counts.
        if self.act.is_none() {
            self.act = Some(action.clone());
        }
    }

    fn gesture(&mut self, gesture: Option<Gesture>) {
        (self.say, self.say_to) = (Some(gesture), None);
    }

    fn gesture_to(&mut self, gesture: Gesture, to: AgentId) {
        (self.say, self.say_to) = (Some(Some(gesture)), Some(to));
    }
}
