//! Agents files of HuNavSim in its three dialects, in and out.
//!
//! ```text
//! YAML ──► node (bounded) ──► section (typed keys) ──► AgentsFile ──► YAML of any dialect
//!                       problems with lines ◄──┘            └──► check against a map
//! ```

mod check;
mod file;
mod lines;
mod node;
mod read;
mod section;
mod write;

pub use check::check_on_map;
pub use file::{AgentEntry, AgentsFile, BehaviorEntry, Configuration, Dialect, GoalEntry, InitPose, Reaction};
pub use read::MAX_AGENTS;
