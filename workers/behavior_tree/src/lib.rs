//! Behavior trees of humans: BehaviorTree.CPP XML of versions 3 and 4 in and out, ticked against a
//! small view of the world, made from rule lists, and checked without a simulator.
//!
//! ```text
//! XML ──► document ──► Tree (flat, shared) ──tick──► World: one motion, gestures,
//!          faults       ▲     │     │                  or every leaf in its own meaning
//! rules ──► TreeSpec ───┘     │     ├──► check, analyze: every case of the conditions, ticked
//!                             │     └──► trace: scripted leaves in, statuses and events out
//!                             └──► draw: text, SVG · convert: the other version, another library
//! ```
//!
//! *Never here:* a simulator, a planner, a map, a file, a clock, a random number, another agent's tree.

mod blackboard;
mod build;
pub mod check;
pub mod compile;
pub mod convert;
pub mod draw;
mod hints;
mod leaf;
pub mod nodes;
pub mod parse;
mod rules;
mod script;
pub mod sheet;
pub mod spec;
pub mod status;
mod tick;
pub mod trace;
pub mod tree;
mod values;
pub mod world;
mod write;
mod xml;

pub use check::{Analysis, CheckContext, CheckReport, Cover, analyze, check, check_report};
pub use compile::{compile, describe};
pub use convert::{Note, convert};
pub use draw::{draw_svg, draw_text};
pub use leaf::{LeafCall, LeafValue};
pub use nodes::{CATALOG, DIALECTS, RARE, STEPS};
pub use parse::{Includes, Meaning, Options, REGULAR_NAV, REGULAR_NAV_PATH};
pub use sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet};
pub use spec::{NodeSpec, TreeSpec, WALK};
pub use status::Status;
pub use trace::{Trace, trace};
pub use tree::{Format, Tree, TreeState};
pub use world::World;
pub use xml::decode;
