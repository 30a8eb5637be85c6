//! Pictures and pages: maps, runs and reports as SVG, PNG and HTML, in one palette and one font.
//!
//! ```text
//! Location ─► map layer ─┬─► annotated map (SVG, PNG)
//! Recording ─► tracks ───┼─► run picture (SVG, PNG)
//! Report ─► checklist ───┴─► report page (HTML, self-contained)
//! ```
//!
//! *Never here:* a file but the fonts of the system, a clock, a rule of scoring; everything drawn is handed in.

mod actor;
pub mod annotated;
pub mod batch;
pub mod camera;
pub mod compare_page;
pub mod draft;
pub mod facts;
pub mod figure;
pub mod film;
mod film_cards;
pub mod film_eyes;
mod film_svg;
pub mod film_times;
#[cfg(test)]
mod fixture;
mod fonts;
pub mod gif;
pub mod label;
pub mod label_page;
pub mod live_floor;
pub mod map_layer;
mod marks;
pub mod observe_page;
pub mod page;
mod page_data;
pub mod palette;
pub mod pdf;
mod play;
pub mod png;
mod presence;
pub mod run;
pub mod series;
pub mod stills;
pub mod svg;
mod template;
pub mod track_page;

pub use annotated::{MapNote, annotated_graph, annotated_map, annotated_map_with};
pub use batch::{BatchEntry, BatchPage, BatchRow, Covered, Figures, Lies};
pub use compare_page::{Beside, ComparePage, Head, MeanRow, MetricRow, Part, PlannerRow};
pub use draft::draft_picture;
pub use facts::fact_words;
pub use figure::{FigureError, figure};
pub use film::{Film, FilmError, FilmOptions, Seen, Shown, Strip};
pub use label_page::{Asks, LabelFiles, LabelPage, Labeled};
pub use observe_page::{Look, LookKind, ObservePage, Observed};
pub use page::{Page, ProvenanceRow, StageRow};
pub use pdf::{PdfError, pdf_from_svg};
pub use png::{PngError, png_at_dpi, png_from_svg};
pub use run::{Heading, run_picture};
pub use stills::{Signs, contact_sheet, letter};
pub use track_page::{FigureRow, TrackPage};
