//! What people say while they look at films: how good a run was, which way they think the robot goes, which of two is better.
//!
//! ```text
//! sliders ─► raters (drop rule) ─► kept ─► agreement with intervals, mean of each film
//! beliefs, ten a second ─► readiness, clarity, confusions of each film as people had them; agreement, with and without delay
//! pairs ─► strengths (Bradley and Terry; Davidson where some are equal)
//! ```

mod belief;
mod pairs;
mod raters;

pub use belief::{Believed, Trace, believed};
pub use pairs::{Choice, Pairs, Prefers, strengths};
pub use raters::{Agreement, Coefficient, FilmMean, Kept, Rater, Slide, agreement, means, raters};

/// Delays of an observer that are tried, s: 0 to 4, in steps of a sample.
pub const MOST_DELAY_SECS: f64 = 4.0;
/// Samples of a belief a second of film time.
pub const BELIEF_HZ: f64 = 10.0;
/// Belief from which on a viewer is sure.
pub const SURE: f64 = 0.5;
