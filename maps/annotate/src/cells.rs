//! Parts of a layer that hang together, and steps from cell to cell.

use socrates_maps::Layer;

/// A cell: column and row, (0, 0) on top and left.
pub(crate) type Cell = (usize, usize);

/// The four sides of a cell.
pub(crate) const SIDES: [(isize, isize); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
/// The eight cells round a cell, clockwise from the upper left.
pub(crate) const ROUND: [(isize, isize); 8] = [(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)];

/// The cell one step away; off the map it is one that no layer holds.
pub(crate) const fn step((column, row): Cell, (dx, dy): (isize, isize)) -> Cell {
    (column.wrapping_add_signed(dx), row.wrapping_add_signed(dy))
}

/// Rows of a layer.
pub(crate) fn height<T>(layer: &Layer<T>) -> usize {
    layer.values.len().checked_div(layer.width).unwrap_or(0)
}

/// Columns and rows that cells cover: the first and the last of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extent {
    pub(crate) columns: (usize, usize),
    pub(crate) rows: (usize, usize),
}

impl Extent {
    pub(crate) const NONE: Self = Self { columns: (usize::MAX, 0), rows: (usize::MAX, 0) };

    pub(crate) fn add(&mut self, (column, row): Cell) {
        self.columns = (self.columns.0.min(column), self.columns.1.max(column));
        self.rows = (self.rows.0.min(row), self.rows.1.max(row));
    }

    fn sides(&self) -> [usize; 2] {
        [self.columns, self.rows].map(|(first, last)| (last + 1).saturating_sub(first))
    }

    /// The longer side, cells.
    pub(crate) fn longest(&self) -> usize {
        let [wide, tall] = self.sides();
        wide.max(tall)
    }

    /// The shorter side, cells.
    pub(crate) fn shortest(&self) -> usize {
        let [wide, tall] = self.sides();
        wide.min(tall)
    }

    /// Whether it reaches the rim of a layer of this size.
    pub(crate) const fn is_at_rim(&self, (width, height): (usize, usize)) -> bool {
        self.columns.0 == 0 || self.rows.0 == 0 || self.columns.1 + 1 >= width || self.rows.1 + 1 >= height
    }
}

/// A part of a layer whose cells hang together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Part {
    /// Its first cell in reading order.
    pub(crate) first: Cell,
    /// How many cells it has.
    pub(crate) cells: usize,
    pub(crate) extent: Extent,
}

/// The parts of the cells that are wanted: a layer with their numbers from 1, 0 elsewhere, and the parts in reading order.
pub(crate) fn parts(wanted: &Layer<bool>, steps: &[(isize, isize)]) -> (Layer<u32>, Vec<Part>) {
    let mut numbers = Layer::filled(wanted.width, height(wanted), 0_u32);
    let mut found = Vec::new();
    let mut open = Vec::new();
    for row in 0..height(wanted) {
        for column in 0..wanted.width {
            let first = (column, row);
            if wanted.get(column, row) != Some(true) || numbers.get(column, row) != Some(0) {
                continue;
            }
            let number = u32::try_from(found.len() + 1).unwrap_or(u32::MAX);
            let mut part = Part { first, cells: 0, extent: Extent::NONE };
            numbers.set(column, row, number);
            open.push(first);
            while let Some(cell) = open.pop() {
                part.cells += 1;
                part.extent.add(cell);
                for way in steps {
                    let next = step(cell, *way);
                    if wanted.get(next.0, next.1) == Some(true) && numbers.get(next.0, next.1) == Some(0) {
                        numbers.set(next.0, next.1, number);
                        open.push(next);
                    }
                }
            }
            found.push(part);
        }
    }
    (numbers, found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_numbered_in_reading_order_and_corners_join_only_by_eight_steps() {
        let wanted = Layer { width: 4, values: "#..##...".chars().map(|c| c == '#').collect() };
        let (numbers, four) = parts(&wanted, &SIDES);
        assert_eq!(numbers.values, [1, 0, 0, 2, 1, 0, 0, 0]);
        assert_eq!((four.len(), four[0].cells, four[1].first), (2, 2, (3, 0)));
        let wanted = Layer { width: 2, values: vec![true, false, false, true] };
        assert_eq!((parts(&wanted, &SIDES).1.len(), parts(&wanted, &ROUND).1.len()), (2, 1));
    }
}
