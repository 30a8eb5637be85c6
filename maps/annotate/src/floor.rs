//! The floor of a map as the annotation sees it: clearance with and without dust, in working cells.
//!
//! All positions of this crate up to its output are *spots*: meters on the picture, x to the right, y **down**, (0, 0) the upper
//! left corner. The turn and place of the map's origin come in only when nodes are written.

use socrates_maps::{DistanceField, Layer};
use socrates_model::{Cell as Kind, Grid, Point};

use crate::cells::{Cell, Extent, ROUND, SIDES, height, parts};
use crate::remark::{Remark, RemarkKind};
use crate::things::{Blocks, Things};

/// A position on the picture, m; see the module.
pub(crate) type Spot = Point;

/// Half the width of the robot that has to get everywhere, m.
pub(crate) const BODY_M: f64 = 0.3;
/// Side of a working cell, m: finer maps are looked at in steps of this.
const WORKING_M: f64 = 0.05;
/// Specks on free floor up to this size are dust of the scanner, m².
const DUST_M2: f64 = 0.02;
/// A thing that stands alone and is at most this long and wide does not part the floor into ways, m: a pillar, a chair.
const THING_M: f64 = 1.0;

/// A piece of wall is at most so thick and at least so long, m.
const PIER_M: (f64, f64) = (0.35, 0.5);

/// The floor of a map.
pub(crate) struct Floor {
    /// Side of a map cell, m.
    pub(crate) map_cell_m: f64,
    /// Side of a working cell, m.
    pub(crate) cell_m: f64,
    stride: usize,
    /// Distances on the map as it is: where edges and nodes may lie.
    raw: DistanceField,
    /// The map without dust and small things.
    cleaned: Grid,
    /// Distances on the cleaned map: how the floor hangs together. None where it is the map as it is.
    clean: Option<DistanceField>,
    /// The clean clearance of every working cell, m.
    pub(crate) clear_m: Layer<f32>,
    /// The clearance of every working cell without free-standing furniture, m: how wide a place is between its walls.
    pub(crate) bare_m: Layer<f32>,
    /// Furniture.
    pub(crate) things: Things,
    /// Blocks that stand free, outlines among them.
    pub(crate) blocks: Blocks,
}

#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells of a map, far below 2^53, and small positive numbers"
)]
impl Floor {
    /// The floor of a grid; what was left out of it goes to the remarks.
    pub(crate) fn of(grid: &Grid, remarks: &mut Vec<Remark>) -> Self {
        let raw = DistanceField::new(grid);
        let stride =
            if grid.resolution_m > WORKING_M * 0.8 { 1 } else { (WORKING_M / grid.resolution_m + 1e-9) as usize };
        let mut floor = Self {
            map_cell_m: grid.resolution_m,
            cell_m: grid.resolution_m * stride as f64,
            stride: stride.max(1),
            raw,
            cleaned: grid.clone(),
            clean: None,
            clear_m: Layer::filled(0, 0, 0.0),
            bare_m: Layer::filled(0, 0, 0.0),
            things: Things::none(),
            blocks: Blocks::none(),
        };
        let mut cleaned = grid.clone();
        if floor.drop_dust(&mut cleaned, remarks) {
            floor.clean = Some(DistanceField::new(&cleaned));
        }
        if floor.drop_things(&mut cleaned, remarks) {
            floor.clean = Some(DistanceField::new(&cleaned));
        }
        floor.things = Things::of(&cleaned);
        floor.cleaned = cleaned;
        floor.clear_m = floor.sampled(floor.clean.as_ref().unwrap_or(&floor.raw));
        floor.blocks = Blocks::of(&floor.clear_m, floor.cell_m);
        let mut bare = floor.cleaned.clone();
        floor.bare_m = if floor.things.clear_away(&mut bare) {
            floor.sampled(&DistanceField::new(&bare))
        } else {
            floor.clear_m.clone()
        };
        floor
    }

    /// Closes lines, such as those of doors, on the clean map; edges and nodes are not led by it.
    pub(crate) fn close(&mut self, lines: &[(Spot, Spot)]) {
        let mut closed = self.cleaned.clone();
        for (from, to) in lines {
            let along = (to - from).normalize() * self.map_cell_m;
            let (start, end) = (from - along, to + along);
            let steps = ((end - start).norm() / (0.25 * self.map_cell_m)).ceil().clamp(1.0, 1e5) as u32;
            for step in 0..=steps {
                let (px, py) = self.pixel(&(start + (end - start) * (f64::from(step) / f64::from(steps))));
                let (column, row) = (px.max(0.0) as usize, py.max(0.0) as usize);
                if column < closed.width
                    && let Some(cell) = closed.cells.get_mut(row * closed.width + column)
                {
                    *cell = Kind::Occupied;
                }
            }
        }
        let field = DistanceField::new(&closed);
        self.clear_m = self.sampled(&field);
        self.clean = Some(field);
        self.bare_m = if self.things.clear_away(&mut closed) {
            self.sampled(&DistanceField::new(&closed))
        } else {
            self.clear_m.clone()
        };
    }

    /// A clearance at the middle of every working cell.
    fn sampled(&self, field: &DistanceField) -> Layer<f32> {
        let grid = &self.cleaned;
        let (width, height) = (grid.width.div_ceil(self.stride), grid.height.div_ceil(self.stride));
        let mut layer = Layer::filled(width, height, 0.0_f32);
        for (row, line) in layer.values.chunks_exact_mut(width.max(1)).enumerate() {
            for (column, slot) in line.iter_mut().enumerate() {
                *slot = if self.stride == 1 {
                    field.clearance_of_cell(column, row) as f32
                } else {
                    let middle = |at: usize| (at as f64 + 0.5) * self.stride as f64;
                    field.clearance_at_pixel(middle(column), middle(row)) as f32
                };
            }
        }
        layer
    }

    /// Frees specks of a few cells; says whether there were any.
    fn drop_dust(&self, grid: &mut Grid, remarks: &mut Vec<Remark>) -> bool {
        let blocked = Layer { width: grid.width, values: grid.cells.iter().map(|cell| *cell != Kind::Free).collect() };
        let most = (DUST_M2 / (self.map_cell_m * self.map_cell_m) + 1e-6).max(1.0) as usize;
        let (numbers, found) = parts(&blocked, &ROUND);
        let size = (grid.width, grid.height);
        let is_dust: Vec<bool> = found.iter().map(|part| part.cells <= most && !part.extent.is_at_rim(size)).collect();
        let specks = is_dust.iter().filter(|dust| **dust).count();
        if specks == 0 {
            return false;
        }
        free(grid, &numbers, &is_dust);
        let first = found.iter().zip(&is_dust).find(|(_, dust)| **dust).map(|(part, _)| part.first);
        let at = first.map(|(column, row)| self.map_spot((column, row)));
        remarks.push(Remark::new(RemarkKind::Dust, at, format!("on free floor lie specks of at most {DUST_M2} m² ({specks} of them); they part no rooms, but people walk round them: clean the picture if they are dust")));
        true
    }

    /// Frees things that stand alone and are small; says whether there were any.
    fn drop_things(&self, grid: &mut Grid, remarks: &mut Vec<Remark>) -> bool {
        let field = self.clean.as_ref().unwrap_or(&self.raw);
        // Nobody fits between a thing and what is as near to it as this: together they are one.
        let narrow = BODY_M as f32;
        let tight = Layer {
            width: grid.width,
            values: (0..grid.height)
                .flat_map(|row| (0..grid.width).map(move |column| (column, row)))
                .map(|(column, row)| (field.clearance_of_cell(column, row) as f32) < narrow)
                .collect(),
        };
        let (numbers, found) = parts(&tight, &SIDES);
        let size = (grid.width, grid.height);
        let most = ((THING_M + 2.0 * BODY_M) / self.map_cell_m + 1e-6) as usize;
        let mut blocked = vec![Extent::NONE; found.len()];
        for (place, (number, cell)) in numbers.values.iter().zip(&grid.cells).enumerate() {
            let own = (*number as usize).checked_sub(1).filter(|_| *cell != Kind::Free);
            if let Some(extent) = own.and_then(|part| blocked.get_mut(part)) {
                extent.add((place % grid.width, place / grid.width));
            }
        }
        let cells = |meters: f64| (meters / self.map_cell_m + 1e-6) as usize;
        // A piece of wall between two doors is none.
        let pier = |extent: &Extent| extent.shortest() <= cells(PIER_M.0) && extent.longest() >= cells(PIER_M.1);
        let small: Vec<bool> = found
            .iter()
            .zip(&blocked)
            .map(|(part, blocked)| part.extent.longest() <= most && !part.extent.is_at_rim(size) && !pier(blocked))
            .collect();
        let things = small.iter().filter(|small| **small).count();
        if things == 0 {
            return false;
        }
        free(grid, &numbers, &small);
        let first = found.iter().zip(&small).find(|(_, small)| **small).map(|(part, _)| part.first);
        let at = first.map(|(column, row)| self.map_spot((column, row)));
        remarks.push(Remark::new(RemarkKind::Things, at, format!("on the floor stand things of at most {THING_M} m alone ({things} of them: pillars, chairs, tables); ways lead round them, but no corridor is made of them")));
        true
    }

    /// Middle of a map cell.
    fn map_spot(&self, (column, row): Cell) -> Spot {
        Spot::new((column as f64 + 0.5) * self.map_cell_m, (row as f64 + 0.5) * self.map_cell_m)
    }

    /// Middle of a working cell.
    pub(crate) fn spot(&self, (column, row): Cell) -> Spot {
        Spot::new((column as f64 + 0.5) * self.cell_m, (row as f64 + 0.5) * self.cell_m)
    }

    /// The working cell under a spot; off the map it is one that no layer holds.
    pub(crate) fn cell(&self, spot: &Spot) -> Cell {
        let index = |meters: f64| if meters >= 0.0 { (meters / self.cell_m) as usize } else { usize::MAX };
        (index(spot.x), index(spot.y))
    }

    /// Pixel position of a spot on the map's image.
    pub(crate) fn pixel(&self, spot: &Spot) -> (f64, f64) {
        (spot.x / self.map_cell_m, spot.y / self.map_cell_m)
    }

    /// Clearance on the map as it is, m.
    pub(crate) fn raw_m(&self, spot: &Spot) -> f64 {
        let (px, py) = self.pixel(spot);
        self.raw.clearance_at_pixel(px, py)
    }

    /// Clearance without dust and small things, m.
    pub(crate) fn clean_m(&self, spot: &Spot) -> f64 {
        let (px, py) = self.pixel(spot);
        self.clean.as_ref().unwrap_or(&self.raw).clearance_at_pixel(px, py)
    }

    /// Clearance without free-standing furniture, m; that of the working cell.
    pub(crate) fn bare_at(&self, spot: &Spot) -> f64 {
        let (column, row) = self.cell(spot);
        f64::from(self.bare_m.get(column, row).unwrap_or(0.0))
    }

    /// The clean clearance of a working cell, m; 0 outside.
    pub(crate) fn clear_of(&self, (column, row): Cell) -> f64 {
        f64::from(self.clear_m.get(column, row).unwrap_or(0.0))
    }

    /// Whether the middle of a working cell is free on the clean map.
    pub(crate) fn is_free(&self, (column, row): Cell) -> bool {
        let middle = |at: usize, most: usize| (at * self.stride + self.stride / 2).min(most.saturating_sub(1));
        let (column, row) = (middle(column, self.cleaned.width), middle(row, self.cleaned.height));
        self.cleaned.at(column, row) == Kind::Free
    }

    /// Columns and rows of working cells.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.clear_m.width, height(&self.clear_m))
    }

    /// Least clearance of the middle of a cell through which the robot gets, m: half a cell less than its half width, since the middle
    /// of an opening of an even number of cells lies between the middles of cells.
    pub(crate) fn body_of_cell_m(&self) -> f64 {
        BODY_M - 0.5 * self.cell_m.min(0.1)
    }

    /// Area of so many working cells, m².
    pub(crate) fn area_m2(&self, cells: usize) -> f64 {
        cells as f64 * self.cell_m * self.cell_m
    }

    /// Least raw clearance along the straight line between two spots, m, looked at twice a cell.
    pub(crate) fn line_m(&self, from: &Spot, to: &Spot) -> f64 {
        self.least_on_line(from, to, |spot| self.raw_m(spot))
    }

    /// Least clean clearance along the straight line between two spots, m; 0 across a closed door.
    pub(crate) fn clean_line_m(&self, from: &Spot, to: &Spot) -> f64 {
        self.least_on_line(from, to, |spot| self.clean_m(spot))
    }

    fn least_on_line(&self, from: &Spot, to: &Spot, clearance: impl Fn(&Spot) -> f64) -> f64 {
        let along = to - from;
        let steps = (along.norm() / (0.5 * self.map_cell_m.max(0.02))).ceil().clamp(1.0, 1e5) as u32;
        (0..=steps)
            .map(|step| clearance(&(from + along * (f64::from(step) / f64::from(steps)))))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Frees the cells of the parts that are named.
fn free(grid: &mut Grid, numbers: &Layer<u32>, freed: &[bool]) {
    for (cell, number) in grid.cells.iter_mut().zip(&numbers.values) {
        let part = (*number as usize).checked_sub(1);
        if part.and_then(|part| freed.get(part)) == Some(&true) {
            *cell = Kind::Free;
        }
    }
}
