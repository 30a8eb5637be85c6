//! From the grid of a ROS map to a scene graph: places, ways, doors and rooms that nobody drew.
//!
//! ```text
//! grid ─► floor (dust and small things left out, exact distances) ─► skeleton ─► throats: wall ends that face each other
//!                                                                       │             │
//!                                                                       ▼             ▼
//!           files of a location ◄─ nodes with types ◄─ sketch ◄─ network of ways ◄─ regions: rooms, corridors, halls
//! ```
//!
//! [`annotate`] is pure: the same grid and options give the same annotation on every machine. What it does not understand it says as
//! [`Remark`]s with places. [`score`](mod@score) compares two locations of one map.
//!
//! *Never here:* files, a clock, chance, a language model, a change of the map: its image stays as it is, dust included, so that
//! edges and nodes lie where the simulation lets people walk.

mod annotate;
mod attach;
mod cells;
mod files;
mod floor;
mod kind;
mod middle;
mod naming;
mod network;
mod open;
mod region;
mod remark;
mod repair;
pub mod score;
mod sketch;
mod thin;
mod things;
mod throat;
mod way;

pub use annotate::{Annotation, Counts, Options, annotate};
pub use files::files;
pub use remark::{Remark, RemarkKind};
