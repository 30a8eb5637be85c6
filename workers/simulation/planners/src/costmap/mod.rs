//! Costmaps: what it costs a robot to be in each cell of the floor.
//!
//! Values are those of Nav2: 0 free, 1 to 252 dearer, 253 the robot's center would touch, 254 an obstacle, 255 unknown.
//!
//! ```text
//! map, scan, people ─► layers in their order ─► LayeredCostmap ─► Costmap
//! ```
//!
//! Modules in reading order: the grid, the layers one over the other (layered), what is always there (walls), what the lidar
//! sees (obstacle, raytrace), the room beside obstacles (inflation), people (people, lobe, proxemic, upo, nav2can), groups.

mod grid;
mod groups;
mod inflation;
mod layered;
mod lobe;
mod nav2can;
mod obstacle;
mod people;
mod proxemic;
mod raytrace;
mod upo;
mod walls;

#[cfg(test)]
pub(crate) mod fixture;
#[cfg(test)]
mod social_tests;
#[cfg(test)]
mod tests;

pub use grid::{Bounds, Costmap, FREE, INSCRIBED, LETHAL, MOST, UNKNOWN};
pub use groups::{Ellipse, FFormationParams, GroupLayer, GroupSource, GroupsParams};
pub use inflation::{InflationLayer, InflationParams};
pub use layered::{CostmapParams, Layer, LayerParams, LayeredCostmap, Merge, Scan, Sensed};
pub use nav2can::{Nav2CanLayer, Nav2CanParams};
pub use obstacle::{ObstacleLayer, ObstacleParams};
pub use people::{OraclePeople, OraclePeopleParams};
pub use proxemic::{ProxemicLayer, ProxemicParams};
pub use upo::{UpoSocialLayer, UpoSocialParams};
pub use walls::{StaticLayer, StaticParams};
