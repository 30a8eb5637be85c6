//! The paths stage: from a proposal and the map to node sequences and encounters.
//!
//! ```text
//! request, reading, location, proposal ──► question ──► author ──► paths + exchange
//! ```
//!
//! Thin on purpose: what the authoring stages share is in `socrates-desk`.
//!
//! *Never here:* another stage, the orchestrator, a second ask, a wait, an environment variable.

mod stage;

pub use stage::PathsStage;
