//! What a planner is given before the run.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_maps::DistanceField;
use socrates_model::rule::RobotRule;
use socrates_model::{Door, Grid, HumanId, Point, RobotModel};

/// The robot's task in numbers.
#[derive(Debug, Clone)]
pub struct Mission {
    /// Body and limits.
    pub robot: RobotModel,
    /// The map.
    pub grid: Grid,
    /// Distance to walls, shared with the engine.
    pub field: Arc<DistanceField>,
    /// Doors of the location.
    pub doors: Vec<Door>,
    /// The intended way through every node and via point. Only `reference` keeps to it.
    pub route: Vec<Point>,
    /// Points a planner under test has to pass, start first, goal last.
    pub waypoints: Vec<Point>,
    /// The robot's script; only `reference` plays it (gestures are made by the engine).
    pub script: Vec<RobotRule>,
    /// The group that each human belongs to. Only planners whose parameters ask for it look here.
    pub groups: Vec<(HumanId, u32)>,
    /// The seed of the run, for planners that draw.
    pub seed: u64,
    /// Where each human is met, for the first time if several times.
    pub encounters: BTreeMap<HumanId, Point>,
}
