//! Pictures and pages: maps, runs and reports as SVG, PNG and HTML, in one palette and one font.
//!
//! ```text
//! Location ─► map layer ─┬─► annotated map (SVG, PNG)
//! Recording ─► tracks ───┼─► run picture (SVG, PNG)
//! Report ─► checklist ───┴─► report page (HTML, self-contained)
//! ```
//!
//! *Never here:* a file, a clock, a rule of scoring; everything drawn is handed in.

pub mod annotated;
pub mod batch;
pub mod facts;
#[cfg(test)]
mod fixture;
pub mod label;
pub mod map_layer;
pub mod page;
mod page_data;
pub mod palette;
mod play;
pub mod png;
pub mod run;
pub mod series;
pub mod svg;
mod template;

pub use annotated::annotated_map;
pub use batch::{BatchEntry, BatchPage};
pub use facts::fact_words;
pub use page::{Page, ProvenanceRow, StageRow};
pub use png::{PngError, png_from_svg};
pub use run::run_picture;
