//! The engine: one simulated run of a scenario, pure and fixed-step.
//!
//! ```text
//! Setup ─► start (floor, trees, places) ─► every 0.01 s:
//!     doors ─► trees (World) ─► planner ─► rendezvous ─► motion ─► forces ─► contacts ─► recorder
//! ```
//!
//! Modules in reading order: what goes in ([`setup`]), the still world ([`floor`], cells, [`doors`], [`lidar`]), the agents
//! (human, view, robot, script), how they move (near, motion, block, make_room, walk, [`gait`], lanes, [`models`], driven,
//! advance, [`contacts`]), how they meet
//! (rendezvous), where they start (placing, start), what is written down ([`recorder`], ending), and the loop
//! ([`run`], drive).
//!
//! *Never here:* a file, a socket, the wall clock, a thread, a random number outside the seed, another
//! library's math types in the interface.

pub mod contacts;
pub mod doors;
pub mod floor;
pub mod gait;
pub mod lidar;
pub mod models;
pub mod recorder;
pub mod run;
pub mod setup;

mod advance;
mod block;
mod cells;
mod drive;
mod driven;
mod ending;
mod ends;
mod gathering;
mod gaze;
mod give_way;
mod human;
mod make_room;
mod meetings;
mod motion;
mod near;
mod other_way;
mod placing;
mod rendezvous;
mod robot;
mod script;
mod start;
mod turning;
mod view;
mod walk;
mod walls;

#[cfg(test)]
mod aisle_runs;
#[cfg(test)]
mod door_runs;
#[cfg(test)]
mod driven_runs;
#[cfg(test)]
mod end_runs;
#[cfg(test)]
mod fixture;
#[cfg(test)]
mod group_runs;
#[cfg(test)]
mod meeting_runs;
#[cfg(test)]
mod model_runs;
#[cfg(test)]
mod step_runs;
#[cfg(test)]
mod tests;

pub use contacts::{Body, Touch, resolve};
pub use doors::event_names;
pub use drive::Drivers;
pub use driven::body_of;
pub use floor::Floor;
pub use lidar::{BEAMS, BadScan, Disc, scan, scan_shapes};
pub use models::HumanModel;
pub use recorder::Recorder;
pub use run::Engine;
pub use setup::{MAX_AUTO_S, PERSON_RADIUS_M, Setup};
pub use start::intended_way;
pub use view::in_field_of_view;
