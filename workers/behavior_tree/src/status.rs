//! What a node is doing.

use std::fmt;

/// Status of a node, or the outcome of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Status {
    /// Not started, or put back.
    #[default]
    Idle,
    /// Not finished; it is ticked again.
    Running,
    /// Finished well.
    Success,
    /// Finished badly; for a condition: it does not hold.
    Failure,
    /// Left out by its own choice; only ever an outcome, never a lasting status.
    Skipped,
}

impl Status {
    /// Success or failure.
    #[must_use]
    pub const fn is_finished(self) -> bool {
        matches!(self, Self::Success | Self::Failure)
    }

    /// Success for true, failure for false.
    #[must_use]
    pub const fn of(holds: bool) -> Self {
        if holds { Self::Success } else { Self::Failure }
    }

    /// Spelled in capitals as BehaviorTree.CPP prints it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "IDLE",
            Self::Running => "RUNNING",
            Self::Success => "SUCCESS",
            Self::Failure => "FAILURE",
            Self::Skipped => "SKIPPED",
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
