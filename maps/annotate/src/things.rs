//! Things that stand free on the floor and are thicker than walls: furniture, stands, machines.

use socrates_maps::Layer;
use socrates_model::{Cell as Kind, Grid};

use crate::cells::{Cell, Part, ROUND, SIDES, height, parts, step};

/// Longest thing that is taken for furniture, m: what is longer is a row of racks or the core of a building.
const LONGEST_M: f64 = 5.5;
/// Twice the area over the rim of what is thicker than a free piece of wall, m: a wall of 0.3 m has less, a desk of 1.6 by 0.8 m 0.5.
const THICK_M: f64 = 0.32;

/// A free piece of wall shorter than this is no wall of a door, m: a bench, a leg of a table, a post.
const PIECE_M: f64 = 1.2;

/// Walls with less than this between them are one, m: scanners leave gaps in outlines.
const GAP_M: f64 = 0.3;
/// Sides of a block, m: a pier of a wall is thinner, no room is smaller than its walls.
const BLOCK_M: (f64, f64) = (0.8, 2.6);

/// Whether the mark of the part of this number, from 1, is set.
fn is_set(marks: &[bool], number: u32) -> bool {
    (number as usize).checked_sub(1).and_then(|at| marks.get(at)) == Some(&true)
}

/// Parts of a layer of which some are marked.
struct Marked {
    /// Number of the part of each cell, from 1.
    of_cell: Layer<u32>,
    is_marked: Vec<bool>,
}

impl Marked {
    fn none() -> Self {
        Self { of_cell: Layer::filled(0, 0, 0), is_marked: Vec::new() }
    }

    /// Whether the part of this number is marked.
    fn has(&self, number: u32) -> bool {
        is_set(&self.is_marked, number)
    }

    /// The marked part of a cell.
    fn at(&self, (column, row): Cell) -> Option<u32> {
        self.of_cell.get(column, row).filter(|number| self.has(*number))
    }
}

/// Free-standing things of a map, by its cells.
pub(crate) struct Things {
    furniture: Marked,
    /// By part: whether it is too short for a wall.
    is_piece: Vec<bool>,
}

#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells of a map"
)]
impl Things {
    /// The things of a grid.
    pub(crate) fn of(grid: &Grid) -> Self {
        let blocked = Layer { width: grid.width, values: grid.cells.iter().map(|cell| *cell != Kind::Free).collect() };
        let (of_cell, found) = parts(&blocked, &ROUND);
        let mut rims = vec![0_usize; found.len()];
        for row in 0..grid.height {
            for column in 0..grid.width {
                let Some(number) = (of_cell.get(column, row).unwrap_or(0) as usize).checked_sub(1) else { continue };
                let open = SIDES.iter().filter(|way| {
                    let next = step((column, row), **way);
                    blocked.get(next.0, next.1) == Some(false)
                });
                if let Some(rim) = rims.get_mut(number) {
                    *rim += open.count();
                }
            }
        }
        let longest = (LONGEST_M / grid.resolution_m) as usize;
        let is_thing = found.iter().zip(rims).map(|(part, rim)| {
            let thick_m = 2.0 * part.cells as f64 / rim.max(1) as f64 * grid.resolution_m;
            let free = !part.extent.is_at_rim((grid.width, grid.height)) && part.extent.longest() <= longest;
            free && thick_m > THICK_M
        });
        let is_marked = is_thing.collect();
        let short = (PIECE_M / grid.resolution_m) as usize;
        let is_piece = |part: &Part| !part.extent.is_at_rim((grid.width, grid.height)) && part.extent.longest() < short;
        Self { is_piece: found.iter().map(is_piece).collect(), furniture: Marked { is_marked, of_cell } }
    }

    /// No things.
    pub(crate) fn none() -> Self {
        Self { furniture: Marked::none(), is_piece: Vec::new() }
    }

    /// Frees the cells of all things; says whether there are any.
    pub(crate) fn clear_away(&self, grid: &mut Grid) -> bool {
        for (cell, number) in grid.cells.iter_mut().zip(&self.furniture.of_cell.values) {
            if self.furniture.has(*number) {
                *cell = Kind::Free;
            }
        }
        self.furniture.is_marked.contains(&true)
    }

    /// Whether a thing, or a piece too short for a wall, lies at a pixel position.
    pub(crate) fn holds(&self, (px, py): (f64, f64)) -> bool {
        if px < 0.0 || py < 0.0 {
            return false;
        }
        let number = self.furniture.of_cell.get(px as usize, py as usize).unwrap_or(0);
        is_set(&self.is_piece, number) || self.furniture.has(number)
    }
}

/// Free-standing blocks, outlines of crates and pallets among them: what lies between two of them, or beside one, is no door.
///
/// By working cells.
pub(crate) struct Blocks(Marked);

#[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "clearances and cells of a map")]
impl Blocks {
    /// The blocks of a floor by the clearance of its working cells, m, and their side, m.
    pub(crate) fn of(clear_m: &Layer<f32>, cell_m: f64) -> Self {
        let near = (0.5 * GAP_M) as f32;
        let beside = Layer { width: clear_m.width, values: clear_m.values.iter().map(|clear| *clear < near).collect() };
        let (of_cell, found) = parts(&beside, &ROUND);
        let size = (beside.width, height(&beside));
        // What is near a block on both sides belongs to its part.
        let side_m = |cells: usize| cells as f64 * cell_m - GAP_M;
        let is_block = |part: &Part| {
            let extent = &part.extent;
            !extent.is_at_rim(size) && side_m(extent.shortest()) >= BLOCK_M.0 && side_m(extent.longest()) <= BLOCK_M.1
        };
        Self(Marked { is_marked: found.iter().map(is_block).collect(), of_cell })
    }

    /// No blocks.
    pub(crate) fn none() -> Self {
        Self(Marked::none())
    }

    /// The block at a working cell.
    pub(crate) fn at(&self, cell: Cell) -> Option<u32> {
        self.0.at(cell)
    }
}
