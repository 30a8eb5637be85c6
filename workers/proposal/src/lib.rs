//! The proposal stage: from a request and its reading to a scenario in detail.
//!
//! ```text
//! request, reading, location ──► question ──► author ──► proposal + exchange
//! ```
//!
//! Thin on purpose: it carries papers from the job to the author's desk and the answer back. A refused answer is
//! reported with every reason and kept as the artifact `refused`, so that the next ask can show it to the author.
//!
//! *Never here:* another stage, the orchestrator, a second ask, a wait, an environment variable.

mod report;
mod stage;

pub use stage::ProposalStage;
