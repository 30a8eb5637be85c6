//! Costmaps: what it costs a robot to be in each cell of the floor.
//!
//! Values are those of Nav2: 0 free, 1 to 252 dearer, 253 the robot's center would touch, 254 an obstacle, 255 unknown.

mod grid;

pub use grid::{Costmap, FREE, INSCRIBED, LETHAL, MOST, UNKNOWN};
