//! The proposal stage: from a request and its reading to a scenario in detail.
//!
//! ```text
//! request, reading, location ──► question ──► author ──► proposal + exchange
//! ```
//!
//! Thin on purpose: what the authoring stages share is in `socrates-desk`.
//!
//! *Never here:* another stage, the orchestrator, a second ask, a wait, an environment variable.

mod stage;

pub use stage::ProposalStage;
