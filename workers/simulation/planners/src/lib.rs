//! Planners: what drives the robot under test.
//!
//! ```text
//! Mission ─► make(name) ─► RobotDriver: Observation (people in sight, lidar, doors) ─► Command (v, omega, gesture)
//! ```
//!
//! Modules in reading order: what a planner is given ([`mission`]), the list of planners ([`catalog`]), the
//! floor as planners see it (ground), ways round people (detour), past somebody slower (overtaking), following a way
//! (pursuit), where and when it waits (waiting, patience), then one file per planner and the robot's script that
//! `reference` plays. Beside them Nav2's parts: costs of the floor ([`costmap`]), the shortest way over them
//! ([`navfn`]), what follows it ([`controller`], [`rpp`], [`mppi`]), the whole ([`nav`]), and its parameter files
//! ([`params`], [`nav2`]).
//!
//! *Never here:* a behavior tree, the engine, a scenario file, the wall clock, a random number that no seed gives.

pub mod catalog;
pub mod controller;
pub mod costmap;
pub mod mission;
pub mod mppi;
pub mod nav;
pub mod nav2;
pub mod navfn;
pub mod params;
pub mod rpp;

mod detour;
mod ground;
mod overtaking;
mod patience;
mod pursuit;
mod reactive;
mod reference;
mod script;
mod waiting;
mod walker;

#[cfg(test)]
mod tests;

pub use catalog::{CATALOG, PlannerSheet, make, names};
pub use ground::free_way;
pub use mission::Mission;
