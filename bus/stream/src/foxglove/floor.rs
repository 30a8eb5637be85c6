//! A map as viewers take it: how likely each cell is occupied, in as many cells as they can draw.

use socrates_model::grid::{Cell, Grid};

/// Cells of a map, at most; a larger one is made coarser.
pub const FLOOR_CELLS: usize = 4_000_000;
/// Value of a free cell.
const FREE: u8 = 0;
/// Value of a cell that was never seen.
const UNKNOWN: u8 = 50;
/// Value of an occupied cell.
const OCCUPIED: u8 = 100;

/// How likely each cell is occupied, percent.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Floor {
    /// Cells of a row.
    pub(super) columns: usize,
    /// Side of a cell, m.
    pub(super) side_m: f64,
    /// The cells, row by row from the lower left.
    pub(super) cells: Vec<u8>,
}

/// The floor of a map; none where cells are missing or there are none.
pub(super) fn floor(grid: &Grid) -> Option<Floor> {
    if grid.width == 0 || grid.height == 0 || grid.width.checked_mul(grid.height) != Some(grid.cells.len()) {
        return None;
    }
    let coarse = coarseness(grid.width, grid.height);
    let columns = grid.width.div_ceil(coarse);
    let mut cells = Vec::with_capacity(columns * grid.height.div_ceil(coarse));
    let rows: Vec<&[Cell]> = grid.cells.chunks_exact(grid.width).rev().collect();
    for block in rows.chunks(coarse) {
        let begin = cells.len();
        cells.resize(begin + columns, UNKNOWN);
        for row in block {
            let line = cells.iter_mut().skip(begin);
            line.zip(row.chunks(coarse)).for_each(|(slot, some)| *slot = some.iter().fold(*slot, joined));
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    let side_m = grid.resolution_m * coarse as f64;
    Some(Floor { columns, side_m, cells })
}

/// By which whole number a map is made coarser.
fn coarseness(width: usize, height: usize) -> usize {
    (1..).find(|by| width.div_ceil(*by).saturating_mul(height.div_ceil(*by)) <= FLOOR_CELLS).unwrap_or(1)
}

/// Occupancy of a place with one more cell: a wall stays a wall, and free floor is told from what was never seen.
const fn joined(so_far: u8, cell: &Cell) -> u8 {
    match (so_far, cell) {
        (OCCUPIED, _) | (_, Cell::Occupied) => OCCUPIED,
        (FREE, _) | (_, Cell::Free) => FREE,
        (_, Cell::Unknown) => UNKNOWN,
    }
}
