//! Tools for developers of SocRATES; no part of the product, and nothing depends on them.
//!
//! ```text
//! golden     recording hashes of everything that is shipped      fuzz       damaged inputs for every reader
//! mutations  calibration of the judge on changed real runs       bench      CPU, memory and rates on this machine
//! tokens     tokens of a scenario by style                       traces     our crowd and trees in the formats of reference traces
//! ```
//!
//! Each is a verb of the program `socrates-dev`. Those that start processes of the product find `socrates` beside it ([`program`]).
//!
//! *Never here:* what a user of SocRATES needs.

pub mod bench;
#[cfg(test)]
mod case_studies;
#[expect(dead_code, reason = "the tests of the crowd read more of a scene")]
mod crowd_trace;
pub mod fuzz;
pub mod golden;
#[cfg(test)]
mod mending_tests;
#[cfg(test)]
mod motion_runs;
pub mod mutants;
pub mod mutations;
#[cfg(test)]
mod online;
pub mod program;
pub mod tokens;
pub mod traces;
#[cfg(test)]
mod wishes_tests;

// Small scenarios of the judge's own tests, for those of the mutants.
#[cfg(test)]
#[expect(dead_code, reason = "the judge's tests need more of it")]
#[path = "../../../workers/scoring/src/cases.rs"]
mod cases;
#[cfg(test)]
#[expect(dead_code, reason = "the judge's tests need more of it")]
#[path = "../../../workers/scoring/src/fixture.rs"]
mod fixture;
#[cfg(test)]
use socrates_scoring::{Evidence, score};
