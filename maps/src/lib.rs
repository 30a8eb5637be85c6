//! Locations: reading, checking, generating them, and asking their map for distances, ways and sight.
//!
//! ```text
//! map.yaml + image ─┐                     ┌─► DistanceField ─► Geodesic, shortest_path, sectors
//! scene_graph.json ─┼─► parse ─► Location ┤
//! location.toml ────┘      ▲              └─► Sight
//!                plan.toml ─ generate
//!                    ▲
//!      seed, kind ─ random
//! ```
//!
//! Modules in reading order: files in ([`parse`], [`load`]), what is checked ([`check`]), the grid's
//! questions (field, geodesic, route, sight; [`Ground`] keeps their answers), places, rooms and cars with their openings, the
//! shipped locations with their generator, and [`random`] ones whose plans are drawn by a seed.
//!
//! *Never here:* pictures with labels (they are drawn next door), moving agents, a clock, a random
//! number that no seed gave, a rule about scenarios.

mod cheapest;
mod check;
mod doors_file;
mod field;
mod finding;
mod generate;
mod geodesic;
mod graph_file;
mod ground;
mod image;
mod json_lines;
mod keys;
mod layer;
mod map_file;
mod plan;
mod read;
mod route;
mod sectors;
mod sight;

pub mod openings;
pub mod place;
pub mod random;
pub mod shipped;
pub mod written;

pub use cheapest::cheapest_way;
pub use check::{check, check_door, findings, is_area_name};
pub use field::{DistanceField, free_disc, nearest_free};
pub use finding::{About, Finding};
pub use generate::generate;
pub use geodesic::Geodesic;
pub use ground::{Ground, Kept};
pub use image::gray_png;
pub use layer::Layer;
pub use read::{Draft, EXTRA, GRAPH, MAP, MapWithFiles, draft, load, load_map, load_raw, parse, whole};
pub use route::shortest_path;
pub use sight::{Sight, sight_clear};
