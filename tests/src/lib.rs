//! Tests that need more than one room: the house rules, the main job with real processes, and chaos.
//!
//! ```text
//! house/    walls, homes of foreign libraries, file cap, fault pages, links in documents
//! golden/   recording hashes of everything that is shipped
//! life/     requests in, bundles out, with real processes
//! chaos/    faults during a batch: kill -9 of any process, freezes, a full disk, clocks that jump
//! dev/      tools for developers, a room of its own
//! foreign/  with programs of others: browsers, servers of models, players, readers
//! ```
//!
//! *Never here:* product code.

pub mod browser;
pub mod console;
pub mod editor;
pub mod program;
pub mod skip;

pub use tempfile;

use std::path::PathBuf;

/// A location in the style of those that others publish: an extra key, an origin off the center.
pub const ANNEX: &str = "maps/tests/data/annex";

/// The root of the repository.
#[must_use]
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).parent().map(PathBuf::from).unwrap_or_default()
}
