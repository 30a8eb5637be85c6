//! Buildings of Open-RMF: `building.yaml` as its traffic editor and site editor write it.
//!
//! Facts of the format are those of `rmf_building_map_tools/building_map`: a vertex is `[x, y, z, name, parameters]`, a wall, lane or
//! door `[from, to, parameters]`, a parameter `[type, value]` with types 1 text, 2 integer, 3 real, 4 truth. Positions are meters
//! upward (`cartesian_meters`) or pixels downward (`reference_image`, whose scale is that of its measurements).

mod floor;
mod read;
mod write;

pub use read::{Building, Floor};
pub use write::write;

/// Parameter of our own: the type of a node or way.
const TYPE: &str = "socrates_type";
/// Parameter of our own: a vertex that is a bend of a way and no node.
const BEND: &str = "socrates_bend";
/// Parameter of our own: the names of areas to which a vertex belongs, one to a line.
const NAMES: &str = "socrates_names";
/// Parameter of our own: the kind of a door.
const KIND: &str = "socrates_kind";
/// Name of the one level that is written.
const LEVEL: &str = "L1";
