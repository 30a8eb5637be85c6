//! What a tree sees and what it can do.

use socrates_model::{Action, AgentId, Gesture, HumanId, SimTime, Trigger};

use crate::leaf::LeafCall;
use crate::status::Status;

/// One human's view at the start of a tick. What is done in a tick is seen in the next one.
pub trait World {
    /// Distance to the robot, center to center, m; `None` where there is no robot.
    fn robot_distance_m(&self) -> Option<f64>;
    /// Whether the robot is in the field of view, in line of sight and within `within_m`.
    fn robot_visible(&self, within_m: f64) -> bool;
    /// Whether the robot stands in this human's way within `within_m`.
    fn robot_blocking(&self, within_m: f64) -> bool;
    /// Whether the robot moves, in any direction.
    fn robot_moving(&self) -> bool;
    /// Whether the robot has come to a stand: one that has not set off yet has not stopped. A world that knows of the
    /// present only need not say more than [`World::robot_moving`].
    fn robot_stopped(&self) -> bool {
        self.robot_distance_m().is_some() && !self.robot_moving()
    }
    /// The gesture the robot makes.
    fn robot_gesture(&self) -> Option<Gesture>;
    /// Whether the robot has passed this human ([`Trigger::RobotPassed`]); a world
    /// without such a memory says no.
    fn robot_passed(&self) -> bool {
        false
    }
    /// Whether the robot passes this human, of which a tree remembers how near it has been, m.
    fn robot_passes(&self, nearest_m: f64) -> bool {
        self.robot_distance_m().is_some_and(|distance_m| Trigger::is_passed(distance_m, nearest_m))
    }
    /// For how long the robot has stood, s; 0 while it moves and before it has set off.
    fn robot_stood_s(&self) -> f64 {
        0.0
    }
    /// How many steps of somebody's sequence have ended. Its own steps are seen in the tick in which they end.
    fn steps_ended(&self, _id: HumanId) -> u32 {
        0
    }
    /// Whether somebody is done ([`Trigger::Done`]).
    fn is_done(&self, _id: HumanId) -> bool {
        false
    }
    /// A step of this human's sequence has ended.
    fn end_step(&mut self, _step: u32) {}
    /// The gesture another human makes.
    fn human_gesture(&self, id: HumanId) -> Option<Gesture>;
    /// Whether this human is at the present goal of its path.
    fn goal_reached(&self) -> bool;
    /// Whether this human is at the last goal of its path. A world that takes the next goal by itself
    /// need not say more than [`World::goal_reached`].
    fn path_done(&self) -> bool {
        self.goal_reached()
    }
    /// Whether this human is at the end of a way that its present act has taken.
    fn has_arrived(&self) -> bool {
        self.path_done()
    }
    /// Takes the next goal of the path; at the last one nothing changes.
    fn next_goal(&mut self);
    /// Whether this human is at the node where it meets the robot; of several, the first.
    fn at_encounter(&self) -> bool;
    /// Time since the start of the run.
    fn now(&self) -> SimTime;
    /// Length of a tick, s.
    fn step_s(&self) -> f64;
    /// Does something for the length of this tick. `leaf` counts the leaves of
    /// [`Tree::leaf_names`](crate::Tree::leaf_names) from 1.
    fn act(&mut self, action: &Action, leaf: u16);
    /// Makes a gesture that lasts until the next one; none takes an earlier one back.
    fn gesture(&mut self, gesture: Option<Gesture>);

    /// Makes a gesture to somebody, which lasts until the next one. In a world that does not tell listeners apart everybody
    /// notices it.
    fn gesture_to(&mut self, gesture: Gesture, _to: AgentId) {
        self.gesture(Some(gesture));
    }

    /// Ticks a leaf of the catalog in this world's own meaning; `None` leaves it to the native one. In trees read
    /// with [`Meaning::World`](crate::Meaning::World) it is asked for every condition and action, timers included,
    /// but not for control flow, decorators and the leaves of BehaviorTree.CPP itself; in others never. A leaf
    /// without a native meaning that gets `None` fails, and
    /// [`TreeState::unanswered`](crate::TreeState::unanswered) names it.
    fn leaf(&mut self, _call: &mut LeafCall<'_>) -> Option<Status> {
        None
    }
    /// A leaf of the catalog that was running is stopped.
    fn leaf_halted(&mut self, _call: &mut LeafCall<'_>) {}

    /// Ticks a leaf that is not in the catalog (see [`Options::foreign`](crate::Options)).
    fn foreign(&mut self, _leaf: u16) -> Status {
        Status::Failure
    }
    /// A foreign leaf that was running is stopped.
    fn foreign_halted(&mut self, _leaf: u16) {}
}
