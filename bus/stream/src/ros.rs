//! Bags of ROS 2 as tracks: what a robot recorded in Gazebo, HuNavSim or the real world, without any ROS here.
//!
//! ```text
//! file.mcap ─► MCAP ─► CDR by its own definition ─► places, transforms ─► one frame, one clock ─► table of tracks
//!              bag     schema, cdr, decode          sight                frames, clock           tracks
//! ```
//!
//! | topic, by its type | what is taken |
//! |---|---|
//! | `nav_msgs/msg/Odometry` | where the robot was |
//! | `tf2_msgs/msg/TFMessage` | where frames stand; where the robot was, if nothing else says so |
//! | `hunav_msgs/msg/Agent` | where the robot was, its radius, its goal if it has one |
//! | `hunav_msgs/msg/Agents` | people with their headings, radii and groups |
//! | `people_msgs/msg/People` | people |
//! | `geometry_msgs/msg/PoseArray`, `PoseStamped` | people, where the topic is called so; the goal, in `goal_pose` |
//! | `rosgraph_msgs/msg/Clock` | the simulator's time, for messages that have none |
//!
//! Messages are read by the names of their fields, from the definition that the bag carries. Everybody is placed in `map` by the
//! bag's transforms; what no transform connects is refused. [`BagPen`] writes the file of a bag whose messages others have made.

mod bag;
mod cdr;
mod clock;
mod decode;
mod fault;
mod frames;
mod metadata;
mod pen;
mod pick;
mod rigid;
mod schema;
mod sight;
mod tracks;

pub use bag::Bag;
pub use fault::{BagFault, CONVERT};
pub use metadata::files;
pub use pen::BagPen;
pub use pick::Choice;
pub use tracks::Tracks;

#[cfg(test)]
mod tests;
