//! Why a worker cannot serve.

use std::path::PathBuf;

use socrates_link::LinkError;
use socrates_model::{Fault, FaultCode};

/// What ends [`crate::serve`] other than an orderly stop.
#[derive(Debug, thiserror::Error)]
pub enum KitError {
    /// The bus refused a declaration.
    #[error("worker cannot join the bus")]
    Link(#[from] LinkError),
    /// The orchestrator works with another version: J-VERSION.
    #[error("{0}")]
    Incompatible(Fault),
    /// A folder of the worker cannot be used.
    #[error("`{}` cannot be used: {why}", path.display())]
    Folder {
        /// Which folder or file.
        path: PathBuf,
        /// The system's words.
        why: String,
    },
    /// A fault plan is not well formed.
    #[error("`{found}` is not a fault; allowed: die_before_report=N, die_after_report=N, drop_report=N, delay_ms=N")]
    FaultPlan {
        /// The text that was found.
        found: String,
    },
    /// The fault plan asked for a death here. Whoever called should let the process die at once.
    #[error("died as the fault plan asked, {at}")]
    InjectedDeath {
        /// Where: before or after a report.
        at: &'static str,
    },
}

impl KitError {
    /// A worker of version `ours` and an orchestrator that works with version `theirs`.
    #[must_use]
    pub fn incompatible(ours: &str, theirs: &str) -> Self {
        let message = format!("this worker has version {ours}, the orchestrator works with {theirs}");
        Self::Incompatible(Fault::new(FaultCode::JVersion, "version", message))
    }
}
