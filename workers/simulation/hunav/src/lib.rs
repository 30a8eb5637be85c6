//! HuNavSim agents files, and what HuNavSim would do with them.
//!
//! ```text
//! agents YAML ──► AgentsFile ──► Run: profile, trees, forces, robot ──► Recording
//! (1.0, 1.1, 2.0)     │  ▲             native: walls, sight, contacts
//!                     ▼  └── YAML      others: as upstream, defects included
//!             problems, all at once
//! ```
//!
//! Modules in reading order: what is wrong with an input ([`problem`]), agents files ([`agents`]), the numbers of a
//! behavior ([`mod@configure`]), default trees ([`trees`]), whose semantics a run has ([`profile`]), the run ([`run`]).
//!
//! *Never here:* a file, a socket, the wall clock, an unseeded random number, a planner, a scenario's proposal.

pub mod agents;
pub mod configure;
pub mod problem;
pub mod profile;
pub mod run;
pub mod trees;

pub use agents::{
    AgentEntry, AgentsFile, BehaviorEntry, Configuration, Dialect, GoalEntry, InitPose, Reaction, check_on_map,
};
pub use configure::{Limits, Parameters, configure, limits};
pub use problem::{Problem, Severity};
pub use profile::{BadProfile, Profile};
pub use run::{Bounds, HumanModel, Inputs, RobotSpec, check, simulate, simulate_into};
pub use trees::{TreeFiles, default_tree, default_tree_file};
