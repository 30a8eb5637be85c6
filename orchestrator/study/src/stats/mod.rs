//! Statistics of ratings: numbers in, numbers out.
//!
//! A table of people by conditions is a `DMatrix`; what is missing has been left out before, or is `None` where a statistic can
//! do without it. Sources of the formulas stand at the functions; `docs/study.md` lists them.

mod agreement;
mod bootstrap;
mod dist;
#[cfg(test)]
mod fixture_tests;
mod friedman;
mod holm;
mod likelihood;
mod mixed;
mod optimize;
mod ordinal;
mod paired;
mod posthoc;
mod rank;
mod reliability;
mod squares;
mod wilcoxon;

pub use agreement::{Level, krippendorff, weighted_kappa};
pub use bootstrap::{Clustered, clustered_bca};
pub use friedman::{Friedman, friedman, friedman_by_chi2};
pub use holm::holm;
pub use mixed::{Balanced, balanced_mixed};
pub use ordinal::{Ordinal, Term, ordinal};
pub use paired::{BradleyTerry, Davidson, Equivalence, bradley_terry, cliffs_delta, davidson, equivalence};
pub use posthoc::{Posthoc, posthoc};
pub use rank::{kendall, midranks, spearman};
pub use reliability::{Alpha, Icc, Iccs, cronbach, icc, omega};
pub use wilcoxon::{Wilcoxon, Zeros, wilcoxon};

pub(crate) use dist::chi_upper;

/// Why a statistic has no value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoValue {
    /// There is too little to compute it from.
    #[error("{found} {what}, at least {needed} are needed")]
    TooFew {
        /// What there is too little of.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// All values are alike.
    #[error("all answers are the same")]
    Constant,
    /// Paired comparisons that no chain of wins joins in both directions (Ford 1957).
    #[error("some conditions always won or always lost against the others: strengths have no finite estimate")]
    NotConnected,
    /// The likelihood has no maximum that could be found.
    #[error("no maximum of the likelihood was found")]
    NoMaximum,
}

/// A count as a float; counts are far below 2^53.
#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
pub(crate) const fn float(count: usize) -> f64 {
    count as f64
}
