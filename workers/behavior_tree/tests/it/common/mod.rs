//! A world whose facts a test sets by hand.

use std::collections::BTreeMap;

use socrates_bt::{Tree, TreeState, World};
use socrates_model::{Action, Gesture, HumanId, SimTime};

/// What there is to see, and what was done in the last tick.
#[derive(Default)]
pub(crate) struct Room {
    pub(crate) distance_m: Option<f64>,
    pub(crate) visible: bool,
    pub(crate) blocking: bool,
    pub(crate) moving: bool,
    pub(crate) robot_says: Option<Gesture>,
    pub(crate) humans_say: BTreeMap<HumanId, Gesture>,
    pub(crate) stood_s: f64,
    pub(crate) ended: BTreeMap<HumanId, u32>,
    pub(crate) done: Vec<HumanId>,
    pub(crate) at_goal: bool,
    pub(crate) at_encounter: bool,
    pub(crate) tick: u64,
    pub(crate) acts: Vec<Action>,
    pub(crate) leaves: Vec<u16>,
    pub(crate) gesture: Option<Gesture>,
    pub(crate) goals_taken: u32,
}

impl Room {
    /// Ticks once and gives the motions of that tick.
    pub(crate) fn tick(&mut self, tree: &Tree, state: &mut TreeState) -> Vec<Action> {
        self.acts.clear();
        self.leaves.clear();
        tree.tick(state, self);
        self.tick += 1;
        self.acts.clone()
    }
}

impl World for Room {
    fn robot_distance_m(&self) -> Option<f64> {
        self.distance_m
    }
    fn robot_visible(&self, within_m: f64) -> bool {
        self.visible && self.distance_m.is_some_and(|m| m <= within_m)
    }
    fn robot_blocking(&self, within_m: f64) -> bool {
        self.blocking && self.distance_m.is_some_and(|m| m <= within_m)
    }
    fn robot_moving(&self) -> bool {
        self.moving
    }
    fn robot_gesture(&self) -> Option<Gesture> {
        self.robot_says
    }
    fn human_gesture(&self, id: HumanId) -> Option<Gesture> {
        self.humans_say.get(&id).copied()
    }
    fn robot_stood_s(&self) -> f64 {
        self.stood_s
    }
    fn steps_ended(&self, id: HumanId) -> u32 {
        self.ended.get(&id).copied().unwrap_or(0)
    }
    fn is_done(&self, id: HumanId) -> bool {
        self.done.contains(&id)
    }
    fn end_step(&mut self, step: u32) {
        self.ended.insert(HumanId::new(1), step);
    }
    fn goal_reached(&self) -> bool {
        self.at_goal
    }
    fn next_goal(&mut self) {
        self.goals_taken += 1;
    }
    fn at_encounter(&self) -> bool {
        self.at_encounter
    }
    fn now(&self) -> SimTime {
        SimTime::at_tick(self.tick)
    }
    fn step_s(&self) -> f64 {
        0.01
    }
    fn act(&mut self, action: &Action, leaf: u16) {
        self.acts.push(action.clone());
        self.leaves.push(leaf);
    }
    fn gesture(&mut self, gesture: Option<Gesture>) {
        self.gesture = gesture;
    }
}
