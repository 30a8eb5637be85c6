//! Time inside a run.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Simulated time since tick 0 in whole nanoseconds; never the wall clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize, JsonSchema)]
pub struct SimTime(u64);

/// Length of one engine tick, s (fixed: the same steps on every machine).
pub const STEP_SECS: f64 = 0.01;
/// Length of one engine tick, ns.
pub const STEP_NANOS: u64 = 10_000_000;

impl SimTime {
    /// The start of the run.
    pub const ZERO: Self = Self(0);

    /// Time at the start of a tick.
    #[must_use]
    pub const fn at_tick(tick: u64) -> Self {
        Self(tick.saturating_mul(STEP_NANOS))
    }

    /// Time of the last of so many ticks; the start of the run where there is none.
    #[must_use]
    pub const fn of_last(ticks: u64) -> Self {
        Self::at_tick(ticks.saturating_sub(1))
    }

    /// Time of so many nanoseconds.
    #[must_use]
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos)
    }

    /// Whole nanoseconds.
    #[must_use]
    pub const fn nanos(self) -> u64 {
        self.0
    }

    /// Seconds.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "2^53 ns are 104 days of simulated time")]
    pub const fn secs(self) -> f64 {
        self.0 as f64 / 1e9
    }

    /// Number of the tick that holds this time.
    #[must_use]
    pub const fn tick(self) -> u64 {
        self.0 / STEP_NANOS
    }
}

impl fmt::Display for SimTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.2} s", self.secs())
    }
}
