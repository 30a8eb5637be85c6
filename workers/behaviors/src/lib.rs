//! The behaviors stage: from a proposal to one behavior tree per human.
//!
//! ```text
//! request, reading, location, proposal ──► question ──► author ──► behaviors + exchange
//! ```
//!
//! Thin on purpose: what the authoring stages share is in `socrates-desk`.
//!
//! *Never here:* another stage, the orchestrator, a second ask, a wait, an environment variable.

mod stage;

pub use stage::BehaviorsStage;
