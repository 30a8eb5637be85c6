//! Scenario bundles and locations in other tools' formats, one file or folder per format.
//!
//! ```text
//! Proposal + Paths + Behaviors ─► scenario.json trajectory.json bt.json, or one combined file ─► back again
//! questions and answers of authors ─► chat.jsonl preferences.jsonl index.jsonl
//! Scenario with one run ─► trajectories, worlds and kits of simulators, see `scenario`
//! Location ─► scene graph of node-link, route graph of Nav2, building of RMF ─► Graph, Floor
//! ```
//!
//! What a format cannot hold is listed beside the file ([`Losses`]).
//!
//! *Never here:* a file, a socket, a rule of simulation. Text in, text out.

pub mod chat_jsonl;
pub mod nav2_route;
pub mod node_link;
pub mod rmf;
pub mod scenario;
pub mod socrates_json;

mod graph;
mod not_carried;
mod outline;

pub use graph::{Graph, Unusable};
pub use not_carried::{Losses, NotCarried};
pub use socrates_json::{Imported, SocratesJsonError};
