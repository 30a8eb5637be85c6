//! MPPI: the sampling controller of Nav2.
//!
//! ```text
//!            ┌──────────────────────────── every cycle ───────────────────────────┐
//! noise ─► controls ─► trajectories ─► critics ─► weights ─► mean control ─► limits ─► command
//! ```
//!
//! Modules in reading order: parameters ([`MppiParams`]) and what is wrong with them (faults), numbers side by side (lanes) and
//! elementary functions of them (elementary), a batch in memory (rows), its noise, the control sequence, trajectories (rollout), what
//! they are seen against (ground, scene), the critics ([`CATALOG`]), the mean (update), smoothing, limits, the validator, and the
//! controller that puts them together ([`Mppi`]).
//!
//! Formulas and defaults are those of Nav2's main branch of August 2026 (package 1.5), with a switch for Nav2 Humble (1.1.20).
//!
//! *Never here:* a plan, a costmap layer, a file, a clock.

mod critics;
mod elementary;
mod faults;
mod ground;
mod lanes;
mod limits;
mod noise;
mod optimizer;
mod params;
mod rollout;
mod rows;
mod scene;
mod sequence;
mod smoothing;
mod update;
mod validator;

#[cfg(test)]
mod tests;

pub use critics::{
    CATALOG, ConstraintParams, CostParams, CriticSheet, GoalAngleParams, GoalParams, ObstaclesParams, PathAlignParams,
    PathAngleMode, PathAngleParams, PathFollowParams, PreferForwardParams, TwirlingParams, VelocityDeadbandParams,
    named,
};
pub use faults::{BadParam, BadParams};
pub use lanes::Instructions;
pub use optimizer::Mppi;
pub use params::{BRINGUP_CRITICS, MotionModel, MppiParams, SgfOrder, Surroundings, TrajectoryValidatorParams};
