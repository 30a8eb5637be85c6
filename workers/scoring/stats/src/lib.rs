//! Statistics that reviewers of a navigation study expect, and no more.
//!
//! ```text
//! counts of runs ─► wilson          labels of two raters ─► cohen_kappa
//! what a judge said, how often they err ─► corrected_share
//! pairs of runs  ─► mcnemar, paired_difference
//! times of runs  ─► kaplan_meier ─► restricted_mean
//! values of runs ─► quantile, median ─► bootstrap_median, bootstrap_mean (seeded)
//! values by scenario and planner ─► Clusters ─► means, paired differences, orders of every resample
//! scores of planners ─► kendall_tau            tracks of points ─► time_warp
//! ```
//!
//! Every function is pure: the same numbers (and the same seed) give the same answer on every
//! machine. Values that are not finite are an error, never silently dropped.
//!
//! *Never here:* a domain word, a file, a clock, a generator that was not seeded by the caller.

mod bootstrap;
mod clusters;
mod corrected;
mod dtw;
mod kappa;
mod mcnemar;
mod order;
mod paired;
mod rank;
mod survival;
mod wilson;

pub use bootstrap::{Bootstrap, bootstrap_mean, bootstrap_median};
pub use clusters::Clusters;
pub use corrected::{Corrected, Count, LEAST_YOUDEN, can_correct, corrected_share, youden};
pub use dtw::time_warp;
pub use kappa::{cohen_kappa, krippendorff_alpha};
pub use mcnemar::mcnemar;
pub use order::{mean, median, quantile, sample_sd};
pub use paired::paired_difference;
pub use rank::kendall_tau;
pub use survival::{kaplan_meier, restricted_mean};
pub use wilson::{Z_95, wilson};

/// An estimate with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The estimate itself.
    pub estimate: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Why a statistic could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StatsError {
    /// There are fewer values than the statistic needs.
    #[error("`{found}` values given, at least `{needed}` needed")]
    TooFew {
        /// Values given.
        found: usize,
        /// Values needed.
        needed: usize,
    },
    /// A value is NaN or infinite.
    #[error("value `{index}` is `{value}`: only finite values are allowed")]
    NotFinite {
        /// Position of the value, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A parameter is outside its range.
    #[error("`{name}` is `{value}`, allowed: {allowed}")]
    OutOfRange {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would be taken.
        allowed: &'static str,
    },
    /// Two lists that belong together differ in length.
    #[error("lists of `{left}` and `{right}` values, equal lengths needed")]
    Unequal {
        /// Length of the first list.
        left: usize,
        /// Length of the second list.
        right: usize,
    },
}

/// Refuses short lists and values that are not finite.
fn finite(values: &[f64], needed: usize) -> Result<(), StatsError> {
    if values.len() < needed {
        return Err(StatsError::TooFew { found: values.len(), needed });
    }
    values
        .iter()
        .enumerate()
        .find(|(_, value)| !value.is_finite())
        .map_or(Ok(()), |(index, value)| Err(StatsError::NotFinite { index, value: *value }))
}

/// A count as a float; counts of runs are far below 2^53.
#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
const fn float(count: usize) -> f64 {
    count as f64
}
