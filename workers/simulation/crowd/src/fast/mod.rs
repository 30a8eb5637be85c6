//! Large crowds: the same law, much faster, within an error that can be set.
//!
//! ```text
//! people ──► cells ──► f32 test of pairs ──► f64 force of the pairs that matter ──► sums
//!            (rows side by side in memory)   (many at once, for both of a pair)
//! ```
//!
//! - **Error.** Pairs whose force is provably small are left out, so that the social force on each
//!   person is within [`Settings::error_mps2`] of the sum over all pairs. A fixed radius would not do:
//!   the range of this force grows with the speed of approach.
//! - **Same bytes everywhere.** Only IEEE 754 additions, multiplications, divisions and square roots,
//!   nothing fused, own polynomials for exponential and arc tangent, one order of summation. Wider
//!   registers do the same operations on more pairs at a time, so the processor changes the time a step
//!   takes and nothing else.
//! - **Each pair once.** The force of j on i is the opposite of that of i on j.
//!
//! Ties and edges:
//!
//! | case | rule |
//! |---|---|
//! | position or velocity not finite | the person feels nobody and is felt by nobody; other forces that are not numbers are 0 |
//! | two people on one spot, same velocity | no social force between them |
//! | two people on one spot, other velocities | the law with distance 0 |
//! | interaction straight at the other (within 1e-12 rad) | as [`crate::forces()`]: both directions by the portable functions, so the side is theirs |
//! | `dt` of 0 | nothing changes, headings included |
//! | somebody at rest | keeps the heading |

pub(crate) mod cells;
mod crowd;
mod density;
mod elementary;
mod lanes;
pub(crate) mod pairs;
mod prune;
mod rough;
mod settings;
mod social;
mod walls;

pub use crowd::Crowd;
pub use lanes::Lanes;
pub use settings::{BadSettings, BadStep, ERROR_MPS2, Instructions, Settings, WALL_RANGE_M};
pub use social::Social;
pub use walls::WallIndex;
