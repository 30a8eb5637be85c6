//! Calibration of the judge: recordings that are wrong in a known way, and such that are as good as before.
//!
//! [`spoiled`] changes a realised recording so that it no longer shows what was asked (`spec/evaluation` §5.4 and
//! the lists N of the case studies); each must lose the verdict. [`harmless`] changes it so that a person would see
//! the same scenario; each must keep it. `socrates dev mutations` prints the share of both over real runs.

mod edit;
mod harmless;
mod spoil;

use socrates_model::Recording;

pub use harmless::harmless;
pub use spoil::spoiled;

/// A changed recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Mutant {
    /// Which kind of change, a fixed word.
    pub kind: &'static str,
    /// Who and how much, in words.
    pub about: String,
    /// The recording.
    pub recording: Recording,
}
