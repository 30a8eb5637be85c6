//! HuNavSim agents files and what HuNavSim would do with them.
//!
//! ```text
//! agents YAML ──► AgentsFile ──► Run (profile, trees, crowd, robot) ──► Recording
//! ```
//!
//! *Never here:* a file, a socket, the wall clock, an unseeded random number, a scenario's proposal.
