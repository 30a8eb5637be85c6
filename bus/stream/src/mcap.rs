//! Recordings as MCAP files.
//!
//! | topic | encoding | what |
//! |---|---|---|
//! | `/socrates/header` | JSON | the header, before everything else |
//! | `/socrates/agents` | 64-byte records | every agent of one tick; the schema names the fields and where they are |
//! | `/socrates/events` | JSON | one event |
//! | `/socrates/end` | JSON | ticks, events and recording hash, after everything else |
//! | `/map` | protobuf, `foxglove.Grid` | the map once, occupancy in percent |
//! | `/scene` | protobuf, `foxglove.SceneUpdate` | walls and bodies with their names once; who comes, goes or gestures |
//! | `/tf` | protobuf, `foxglove.FrameTransforms` | every agent's frame in `map`, ten times a second |
//! | `/crowd` | protobuf, `foxglove.PosesInFrame` | the people with their headings, ten times a second |
//! | `/robot` | protobuf, `foxglove.PoseInFrame` | the robot, ten times a second |
//!
//! Foxglove and Lichtblick draw all of them, Rerun neither `/map` nor `/scene`. Whoever is absent is in none of the pictures.
//!
//! A file grows chunk by chunk and is good up to its last whole one at any moment. Times are those of the run and nothing
//! else is written, so the same recording gives the same bytes.

mod read;
mod scene;
mod tape;
mod write;

use serde::{Deserialize, Serialize};
use socrates_model::Digest;

pub use read::{Rest, begins, read, read_rest};
pub use tape::Tape;
pub use write::{Whole, Writer, record_schema, write};

const HEADER: &str = "/socrates/header";
const AGENTS: &str = "/socrates/agents";
const EVENTS: &str = "/socrates/events";
const END: &str = "/socrates/end";

/// The last message of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct End {
    ticks: u64,
    events: u64,
    hash: Digest,
}

#[cfg(test)]
mod tests;
