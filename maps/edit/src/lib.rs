//! Drawing the scene graph and the doors of a location: what a person does as values, and what comes of it.
//!
//! ```text
//! files ─► Location ─► Sketch ── Edit ──► Sketch ─► files (the same writer as everybody's)
//!                        │        ▲ └─► History: undo and redo without end; Step: a line of a journal
//!                        │        │
//!                        │   opening, elevator, inside_of, Proposal: edits that geometry works out
//!                        └─► check ─► Remark: level, words, what it is about, where on the picture
//! ```
//!
//! Everything here is pure: the same sketch and edit give the same sketch. Positions are those of the image, in pixels from its top left
//! corner, since a person draws on the image and the file of the graph holds them; meters are worked out where somebody asks.
//!
//! *Never here:* a file, a server, a clock, chance, a picture with labels, a change of the map's image.

mod check;
mod edit;
mod history;
mod opening;
mod proposal;
mod said;
mod sketch;
mod tile;
mod way;

pub use check::{Level, Remark, Subject, check};
pub use edit::{Edit, EditError, Pair};
pub use history::{History, Step};
pub use opening::{Opening, elevator, inside_of, opening};
pub use proposal::Proposal;
pub use sketch::{Door, Edge, Node, Sketch, Spot};
pub use tile::{TILE_PX, levels, seen, tile};
pub use way::{Line, NoWay, Way, line, way};
