//! The simulation stage: from proposal, paths and behaviors to a recording.
//!
//! ```text
//! job ─► inputs ─► checks ─► Setup ─► engine ⇄ planner ─► frames ─► live viewers (never slow a run)
//!                                          └─► recording ─► MCAP + summary
//! ```
//!
//! Modules in reading order: the pure run ([`simulate()`], with the ways and the parts of people that drivers are told), robots and people
//! that are driven from outside ([`driving`]), what is said about it ([`summary`]), how fast it plays for viewers ([`pace`]), and the
//! worker's stage (`stage`, feature `mcap`).
//!
//! *Never here:* another stage, the orchestrator, the store, a metric, a verdict.

pub mod driving;
pub mod pace;
pub mod scene;
pub mod simulate;
#[cfg(feature = "mcap")]
pub mod stage;
pub mod summary;

mod people;
mod ways;

#[cfg(test)]
#[expect(clippy::print_stdout, reason = "what went wrong in which of many runs is told run by run")]
mod runs;

pub use simulate::{Driven, setup, simulate, simulate_into};
#[cfg(feature = "mcap")]
pub use stage::Simulation;
pub use summary::Summary;
