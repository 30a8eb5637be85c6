//! The map as tiles: pieces of the image at halved, quartered … sizes, so that a browser never holds all of a large map.

use socrates_maps::gray_png;
use socrates_model::{Cell, Grid};

/// Side of a tile, pixels.
pub const TILE_PX: usize = 512;

/// Shades of free floor, of what nobody has seen, and of walls.
const FREE: u8 = 255;
const UNKNOWN: u8 = 205;
const WALL: u8 = 40;

/// How many sizes there are: 0 is the image as it is, and each further one has half the pixels of a side, until one tile holds it all.
#[must_use]
pub fn levels(grid: &Grid) -> u32 {
    let tiles = grid.width.max(grid.height).div_ceil(TILE_PX).max(1);
    tiles.next_power_of_two().trailing_zeros() + 1
}

/// The part of the image on which anything is known: left, top, right and bottom, pixels; all of it where nothing is.
#[must_use]
pub fn seen(grid: &Grid) -> [usize; 4] {
    let known = |cell: &Cell| *cell != Cell::Unknown;
    let (mut columns, mut rows) = ((grid.width, 0), (grid.height, 0));
    for (row, line) in grid.cells.chunks_exact(grid.width.max(1)).enumerate() {
        if let Some((first, last)) = line.iter().position(known).zip(line.iter().rposition(known)) {
            columns = (columns.0.min(first), columns.1.max(last + 1));
            rows = (rows.0.min(row), rows.1.max(row + 1));
        }
    }
    if columns.1 == 0 { [0, 0, grid.width, grid.height] } else { [columns.0, rows.0, columns.1, rows.1] }
}

/// A tile as a PNG: `column` and `row` count tiles from the top left; those at the right and lower edge are cut. None where there is none.
///
/// A pixel that stands for several cells is a wall where one of them is: a thin wall stays in sight.
#[must_use]
pub fn tile(grid: &Grid, level: u32, column: usize, row: usize) -> Option<Vec<u8>> {
    if level >= levels(grid) {
        return None;
    }
    let each = 1_usize << level;
    let (left, top) = (column.checked_mul(TILE_PX)?.checked_mul(each)?, row.checked_mul(TILE_PX)?.checked_mul(each)?);
    let side = |all: usize, first: usize| all.checked_sub(first).map(|rest| rest.div_ceil(each).min(TILE_PX));
    let (width, height) = (side(grid.width, left)?, side(grid.height, top)?);
    if width == 0 || height == 0 {
        return None;
    }
    let mut shades = vec![0_u8; width * height];
    for (line, out) in shades.chunks_exact_mut(width).enumerate() {
        let rows = top + line * each..(top + (line + 1) * each).min(grid.height);
        for (place, shade) in out.iter_mut().enumerate() {
            let columns = left + place * each..(left + (place + 1) * each).min(grid.width);
            *shade = darkest(grid, columns, rows.clone());
        }
    }
    gray_png(width, height, &shades).ok()
}

fn darkest(grid: &Grid, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> u8 {
    let mut shade = FREE;
    for row in rows {
        let line = grid.cells.get(row * grid.width + columns.start..row * grid.width + columns.end).unwrap_or_default();
        for cell in line {
            match cell {
                Cell::Occupied => return WALL,
                Cell::Unknown => shade = UNKNOWN,
                Cell::Free => {}
            }
        }
    }
    shade
}
