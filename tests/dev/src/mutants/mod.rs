//! Calibration of the judge: recordings that are wrong in a known way, and such that are as good as before.
//!
//! [`spoiled`] changes a realised recording so that it no longer shows what was asked: a person is gone, comes
//! late, walks backwards, says another gesture, a group breaks up; each must lose the verdict. [`harmless`] changes it so that a person would see
//! the same scenario; each must keep it. `socrates-dev mutations` prints the share of both over real runs.

mod early;
mod edit;
mod facing;
mod harmless;
mod lacks;
mod named_way;
mod sides;
mod spoil;
mod steps;

use socrates_model::{AgentId, HumanId, Recording, Verdict};
use socrates_scoring::Evidence;

pub use harmless::harmless;
pub use lacks::{Lack, Lacking, ROWS, Row, lacking, row};
pub use spoil::spoiled;

/// Shifts that are tried for the time margin, s.
const SHIFTS_S: [f64; 8] = [0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0];

/// Time robustness of a realised run for one human, s: by how much it could have done everything sooner and later,
/// each the largest of the shifts tried up to which the verdict stays `realised`.
#[must_use]
pub fn time_margin(evidence: &Evidence<'_>, human: HumanId) -> (f64, f64) {
    let stays = |sign: f64| {
        let mut reached = 0.0;
        for shift in SHIFTS_S {
            let recording = edit::delayed(evidence.recording, AgentId::Human(human), sign * shift);
            let shifted = Evidence { recording: &recording, ..*evidence };
            if socrates_scoring::verdict_of(&shifted) != Ok(Verdict::Realised) {
                break;
            }
            reached = shift;
        }
        reached
    };
    (stays(-1.0), stays(1.0))
}

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

#[cfg(test)]
mod tests {
    mod reasons;
    mod signs;
    mod steps;
}
