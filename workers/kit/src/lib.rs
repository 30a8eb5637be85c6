//! What every worker shares: the [`Stage`] trait and the loop that serves it.
//!
//! ```text
//! acquire ─► Job (inputs fetched) ─► Stage::run ─► outputs stored ─► report spooled ─► report sent until recorded
//!    ▲ hint, poll        │ beat every 2 s: ok · cancel · lost · missing                         │
//!    └───────────────────┴──────────────────────── next job ◄───────────────────────────────────┘
//! ```
//!
//! Modules in reading order: what a stage sees and gives, where artifacts live, how reports survive a
//! crash, the settings, then the loop: held attempts, one attempt, messages, and [`serve`].
//!
//! *Never here:* a stage's own knowledge, a retry of a stage (one ask per attempt; the orchestrator
//! decides what comes next), the wall clock, the environment, an exit of the process.

mod error;
pub use error::KitError;

mod cache;
mod cancel;
mod job;
mod stage;
pub use cancel::{Cancel, Standing};
pub use job::Job;
pub use stage::{Done, Failure, Output, Stage, media};

mod blob_rpc;
mod blobs;
pub use blob_rpc::{BlobMove, serve_blobs};
pub use blobs::{BlobError, Blobs, LocalBlobs};

mod spool;
pub use spool::Spool;

mod config;
pub use config::{FaultPlan, Stop, WorkerConfig};

mod attempt;
pub use attempt::chain;
mod beat;
mod held;
mod messages;
mod serve;
pub use serve::serve;
