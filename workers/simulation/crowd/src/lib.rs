//! People who walk: social forces, mutual avoidance and recorded tracks, as a library of its own.
//!
//! ```text
//!               people + walls
//!        ┌────────────┼────────────────┬────────────────┬──────────────┐
//!     forces       strict            fast             orca          tracks
//!   portable,   the reference    large crowds,     velocities     as recorded
//!   one by one  library, bit     an error bound    that avoid
//!        │       for bit              │             collisions        │
//!        │          │                 │                └── mix ───────┤
//!        └──────────┴─────────────────┴──► people, one step later ◄───┘
//! ```
//!
//! The law of the social forces is that of Moussaïd et al. 2009 and 2010 (social and group forces) and
//! Helbing and Molnár 1995 (desired and obstacle forces), with the constants of the HuNavSim family. It
//! is there in three ways:
//!
//! - [`forces()`] and [`integrate()`]: plain functions. Transcendental functions come from `libm`, sums
//!   run in list order, nothing is fused: the same input gives the same bytes on every machine.
//! - [`strict`]: the reference library bit for bit, with the functions of the platform.
//! - [`fast`]: large crowds; pairs that provably do not matter are left out, the rest is worked out many
//!   at a time, and the bytes are the same on every processor.
//!
//! Every step is synchronous: everybody moves from the same (old) state.
//!
//! ```
//! use socrates_crowd::cross::{DT_S, cross};
//! use socrates_crowd::fast::{Crowd, Settings};
//!
//! let floor = cross(100);
//! let mut crowd = Crowd::new(&floor.walkers, &floor.walls, &Settings::default())?;
//! crowd.step(DT_S)?;
//! assert_eq!(crowd.people().len(), 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! *Never here:* a map, a robot, a scenario word, rigid-body contacts, a clock, a random number that
//! nobody asked for, a file or socket (readers take text, writers take what they write to).

pub mod cross;
pub mod fast;
pub mod forces;
mod group;
pub mod integrate;
mod math;
pub mod mix;
pub mod model;
pub mod near;
pub mod obstacle;
pub mod orca;
pub mod params;
pub mod person;
pub mod strict;
pub mod tracks;
mod vector;
pub mod walker;

pub use forces::{Forces, forces, forces_on};
pub use integrate::integrate;
pub use mix::{Member, Mix};
pub use model::{CrowdModel, View};
pub use near::{Found, Near};
pub use obstacle::{Segment, points_in_range};
pub use params::{BadParams, CenterOrder, Params};
pub use person::{Goal, Person};
pub use vector::wrap;
pub use walker::{Drive, Route, Walker};
