//! A human study from answers to published statistics: what people said of films, in tables, tests, a page and words.
//!
//! ```text
//! study.toml ─► Design ─► preregistration                    simulate ─► answers, to try it
//! files of answers ─► read ─► Table (one row per rating) ─► exclude ─► analyze ─► report page, methods, scripts
//! study.toml ─► kit ─► survey page, files of other survey programs, the book of answers
//! instruments (data) ─► score ─┘                              plan ─► power, orders, time, pay
//!                                  └─► correlate ◄─ metrics of the runs that films show
//! sliders, beliefs and pairs of observers ─► observe ─► who is kept, agreement, means of films, what a viewer knew when, strengths
//! stats: reliability, agreement, ranks, mixed ordinal model, paired comparison, bootstrap; numbers in, numbers out
//! ```
//!
//! A rating that was never given is [`Rating::Missing`], which takes part in no mean, rank or count; it is never 0.
//!
//! *Never here:* a file, a clock, a network, a generator without a seed, an address or a place of a participant.

pub mod analyze;
pub mod cell;
pub mod correlate;
pub mod design;
pub mod exclude;
pub mod instrument;
pub mod kit;
pub mod observe;
pub mod page;
pub mod plan;
mod problem;
pub mod rating;
pub mod read;
pub mod simulate;
pub mod stats;
pub mod words;

pub use problem::Problem;

/// The script in R that computes the figures again.
pub const SCRIPT_R: &str = include_str!("../scripts/analysis.R");
/// The same in Python.
pub const SCRIPT_PYTHON: &str = include_str!("../scripts/analysis.py");
pub use rating::Rating;
