//! Scoring: metrics, fidelity verdict and story of one recording.
//!
//! ```text
//! recording ─► tracks ─┬─► metrics   (how well did the robot do?)          ─┐
//!                      ├─► fidelity  (did the scenario happen as asked?)   ─┼─► report
//!                      └─► narrative (what happened, with times)           ─┘
//! ```
//!
//! The core is one pure function, [`score()`]; the stage around it (feature `mcap`) decodes inputs and hands back the
//! report. What is missing (a map, a proposal, velocities) makes single figures not applicable with
//! a note; it never becomes 0.
//!
//! *Never here:* a wall clock, a random number, a model that decides, a judgment of the setting by
//! what the robot made of it.

mod circle;
mod doubts;
mod evidence;
mod hull;
mod running;
mod series;
mod skips;
mod tracks;

pub mod compare;
pub mod fidelity;
pub mod metrics;
pub mod temporal;

mod narrative;
mod pool;
mod repair;
mod score;
#[cfg(feature = "mcap")]
mod stage;

#[cfg(test)]
mod asked;
#[cfg(test)]
mod cases;
#[cfg(test)]
mod crowds;
#[cfg(test)]
mod driven;
#[cfg(test)]
mod fixture;
#[cfg(test)]
mod idle;
#[cfg(test)]
mod lasting;
#[cfg(test)]
mod meetings;
#[cfg(test)]
mod room;
#[cfg(test)]
mod scenarios;
#[cfg(test)]
mod script;

pub use doubts::doubts;
pub use evidence::Evidence;
pub use pool::{Cell, Pool, PoolFault, PooledRun, Ranking, pool};
pub use score::{score, verdict_of};
pub use series::{Series, Span};
#[cfg(feature = "mcap")]
pub use stage::ScoringStage;
pub use tracks::{MOVING_MPS, Sample, Track, TrackFault, Tracks};
