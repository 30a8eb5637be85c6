//! People who walk: the social force model of pedestrians, as pure functions.
//!
//! ```text
//! people + obstacle points ──► forces ──► integrate ──► people, one step later
//!                    (desired, obstacle, social, group)
//! ```
//!
//! Every force is computed from the same (old) state and in a written order of operations, so the
//! same input gives the same bytes on every machine: transcendental functions come from `libm`,
//! sums run in list order, nothing is fused. Model: Moussaïd et al. 2009 and 2010 (social and group
//! forces), Helbing and Molnár 1995 (desired and obstacle forces), with the constants of the
//! HuNavSim family.
//!
//! *Never here:* a wall map, a robot, a scenario word, rigid-body contacts, a clock, a random number.

pub mod cross;
pub mod fast;
pub mod forces;
mod group;
pub mod integrate;
mod math;
pub mod mix;
pub mod model;
pub mod obstacle;
pub mod orca;
pub mod params;
pub mod person;
pub mod strict;
pub mod trace;
pub mod tracks;
mod vector;
pub mod walker;

pub use forces::{Forces, forces, forces_on};
pub use integrate::integrate;
pub use obstacle::{Segment, points_in_range};
pub use params::{BadParams, CenterOrder, Params};
pub use person::{Goal, Person};
pub use walker::{Drive, Route, Walker};
