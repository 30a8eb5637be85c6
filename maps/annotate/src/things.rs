//! Things that stand free on the floor and are thicker than walls: furniture, stands, machines.

use socrates_maps::Layer;
use socrates_model::{Cell, Grid};

use crate::cells::{ROUND, SIDES, parts, step};

/// Longest thing that is taken for furniture, m: what is longer is a row of racks or the core of a building.
const LONGEST_M: f64 = 5.5;
/// Twice the area over the rim of what is thicker than a free piece of wall, m: a wall of 0.3 m has less, a desk of 1.6 by 0.8 m 0.5.
const THICK_M: f64 = 0.32;

/// Free-standing things of a map.
pub(crate) struct Things {
    /// Number of the thing of each cell of the map, from 1.
    of_cell: Layer<u32>,
    is_thing: Vec<bool>,
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
        let blocked = Layer { width: grid.width, values: grid.cells.iter().map(|cell| *cell != Cell::Free).collect() };
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
        Self { is_thing: is_thing.collect(), of_cell }
    }

    /// No things.
    pub(crate) fn none() -> Self {
        Self { of_cell: Layer::filled(0, 0, 0), is_thing: Vec::new() }
    }

    /// Frees the cells of all things; says whether there are any.
    pub(crate) fn clear_away(&self, grid: &mut Grid) -> bool {
        for (cell, number) in grid.cells.iter_mut().zip(&self.of_cell.values) {
            if (*number as usize).checked_sub(1).and_then(|at| self.is_thing.get(at)) == Some(&true) {
                *cell = Cell::Free;
            }
        }
        self.is_thing.contains(&true)
    }

    /// Whether a thing lies at a pixel position.
    pub(crate) fn holds(&self, (px, py): (f64, f64)) -> bool {
        let inside = px >= 0.0 && py >= 0.0;
        let number = if inside { self.of_cell.get(px as usize, py as usize).unwrap_or(0) } else { 0 };
        (number as usize).checked_sub(1).and_then(|at| self.is_thing.get(at)) == Some(&true)
    }
}
