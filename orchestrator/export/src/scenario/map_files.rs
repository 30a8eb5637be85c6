//! The map as `map_server` of ROS reads it: `map.yaml` and a gray image.

use socrates_model::{Cell, Grid};

use super::frames::real;
use super::{File, Files};

/// Gray of a free cell.
const FREE: u8 = 254;
/// Gray of a cell that was never seen.
const UNKNOWN: u8 = 205;
/// Gray of an occupied cell.
const OCCUPIED: u8 = 0;

/// Adds `FOLDER/map.yaml` and `FOLDER/map.pgm`.
pub(crate) fn add(files: &mut Files, folder: &str, grid: &Grid) {
    let origin = &grid.origin;
    let yaml = format!(
        "image: map.pgm\nmode: trinary\nresolution: {}\norigin: [{}, {}, {}]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        real(grid.resolution_m),
        real(origin.x),
        real(origin.y),
        real(origin.yaw)
    );
    let gray = |cell: &Cell| match cell {
        Cell::Free => FREE,
        Cell::Occupied => OCCUPIED,
        Cell::Unknown => UNKNOWN,
    };
    let mut image = format!("P5\n{} {}\n255\n", grid.width, grid.height).into_bytes();
    image.extend(grid.cells.iter().map(gray));
    files.insert(format!("{folder}/map.yaml"), File::Text(yaml));
    files.insert(format!("{folder}/map.pgm"), File::Bytes(image));
}
