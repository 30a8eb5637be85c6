//! Free floor filled from points, with lines closed.

use std::collections::{BTreeSet, VecDeque};

use socrates_model::Point;

use crate::field::DistanceField;
use crate::layer::Layer;

/// A body is looked for this near to a node where it does not fit at the node itself, m.
const SNAP_M: f64 = 1.0;

/// A cell of the map: column and row.
pub(super) type Cell = (usize, usize);

/// Cells that closed lines cover, as their place in row order.
#[derive(Debug, Default)]
pub(super) struct Closed(BTreeSet<usize>);

impl Closed {
    /// The cells that lines pass through, each line longer by a cell at both ends, so that it meets its walls.
    pub(super) fn of(field: &DistanceField, lines: impl IntoIterator<Item = (Point, Point)>) -> Self {
        let raster = &field.raster;
        let cell_m = raster.resolution_m;
        let mut cells = BTreeSet::new();
        for (from, to) in lines {
            let length_m = (to - from).norm();
            if length_m <= 0.0 || !length_m.is_finite() {
                continue;
            }
            let along = (to - from) / length_m;
            let (start, end) = (from - along * cell_m, length_m + 2.0 * cell_m);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a door has at most 8 m")]
            let steps = (end / (0.25 * cell_m)).min(1e6) as u32;
            for step in 0..=steps {
                let at = start + along * (f64::from(step) * 0.25 * cell_m);
                let (px, py) = raster.pixel(&at);
                if let Some((column, row)) = raster.cell(px, py) {
                    cells.insert(row * raster.width + column);
                }
            }
        }
        Self(cells)
    }

    fn holds(&self, (column, row): Cell, width: usize) -> bool {
        self.0.contains(&(row * width + column))
    }
}

/// What stopped a fill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// It came to the forbidden point of this number.
    Reached(usize),
    /// It found no floor to begin on.
    NoFloor,
}

/// The cells of the floor that a disc of a radius reaches from any of some points without crossing closed lines; stops where it comes to a
/// forbidden point.
pub(super) fn fill(
    field: &DistanceField,
    closed: &Closed,
    radius_m: f64,
    from: &[Point],
    forbidden: &[Point],
) -> Result<Vec<Cell>, Stop> {
    let raster = &field.raster;
    let goals: Vec<Option<Cell>> = forbidden.iter().map(|point| start(field, closed, radius_m, point)).collect();
    let mut seen = Layer::filled(raster.width, raster.height, false);
    let mut open = VecDeque::new();
    for cell in from.iter().filter_map(|point| start(field, closed, radius_m, point)) {
        if seen.get(cell.0, cell.1) == Some(false) {
            seen.set(cell.0, cell.1, true);
            open.push_back(cell);
        }
    }
    let mut cells = Vec::new();
    while let Some(cell) = open.pop_front() {
        if let Some(goal) = goals.iter().position(|goal| *goal == Some(cell)) {
            return Err(Stop::Reached(goal));
        }
        cells.push(cell);
        for next in beside(cell) {
            if seen.get(next.0, next.1) == Some(false)
                && field.clearance_of_cell(next.0, next.1) >= radius_m
                && !closed.holds(next, raster.width)
            {
                seen.set(next.0, next.1, true);
                open.push_back(next);
            }
        }
    }
    if cells.is_empty() { Err(Stop::NoFloor) } else { Ok(cells) }
}

/// The four cells beside one; those that would lie off the map fail every look at the map.
fn beside((column, row): Cell) -> [Cell; 4] {
    [(column.wrapping_sub(1), row), (column + 1, row), (column, row.wrapping_sub(1)), (column, row + 1)]
}

/// The nearest cell where the disc fits, reached from the point over free floor without crossing closed lines.
fn start(field: &DistanceField, closed: &Closed, radius_m: f64, point: &Point) -> Option<Cell> {
    let raster = &field.raster;
    let (px, py) = raster.pixel(point);
    let first = raster.cell(px, py)?;
    let mut seen = BTreeSet::from([first]);
    let mut open = VecDeque::from([first]);
    while let Some(cell) = open.pop_front() {
        let free = field.clearance_of_cell(cell.0, cell.1);
        if free <= 0.0 || closed.holds(cell, raster.width) {
            continue;
        }
        if free >= radius_m {
            return Some(cell);
        }
        for next in beside(cell) {
            let near = next.0 < raster.width
                && next.1 < raster.height
                && (raster.center(next.0, next.1) - point).norm() <= SNAP_M;
            if near && seen.insert(next) {
                open.push_back(next);
            }
        }
    }
    None
}

/// Writes a number into cells and into the free floor round them, so far, m, where nothing is written yet; not across closed lines.
pub(super) fn paint(
    field: &DistanceField,
    closed: &Closed,
    floor: &mut Layer<u16>,
    (cells, reach_m): (&[Cell], f64),
    number: u16,
) {
    let raster = &field.raster;
    for (column, row) in cells {
        floor.set(*column, *row, number);
    }
    let mut rim: Vec<Cell> = cells.to_vec();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
    let rings = (reach_m / raster.resolution_m).ceil().min(1e4) as u32;
    for _ in 0..rings {
        let mut next_rim = Vec::new();
        for next in rim.iter().copied().flat_map(beside) {
            if floor.get(next.0, next.1) == Some(0)
                && field.clearance_of_cell(next.0, next.1) > 0.0
                && !closed.holds(next, raster.width)
            {
                floor.set(next.0, next.1, number);
                next_rim.push(next);
            }
        }
        rim = next_rim;
    }
}
