//! Cells of a map as few boxes, in the map frame.

use socrates_model::{Cell, Grid, Point};

/// A box on the floor, turned as the map is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    /// Its middle, m.
    pub(crate) middle: Point,
    /// Length along the rows of the map, m.
    pub(crate) along_m: f64,
    /// Length across them, m.
    pub(crate) across_m: f64,
}

/// Boxes that cover the cells of a kind, each cell once: runs of a row, joined with the same runs below.
/// No side is longer than `longest_m`, but a box has at least one cell.
pub(crate) fn blocks(grid: &Grid, kind: Cell, longest_m: f64) -> Vec<Block> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to the size of the map")]
    let longest = ((longest_m / grid.resolution_m + 1e-9).floor().max(1.0) as usize).min(grid.width.max(grid.height));
    let mut covered = vec![false; grid.cells.len()];
    let mut out = Vec::new();
    for row in 0..grid.height {
        let mut column = 0;
        while column < grid.width {
            let is_open = |covered: &[bool], column: usize, row: usize| {
                row < grid.height
                    && grid.at(column, row) == kind
                    && !covered.get(row * grid.width + column).copied().unwrap_or(true)
            };
            if !is_open(&covered, column, row) {
                column += 1;
                continue;
            }
            let columns = (column..column + longest).take_while(|other| is_open(&covered, *other, row)).count();
            let whole = |other: &usize| (column..column + columns).all(|column| is_open(&covered, column, *other));
            let rows = (row..row + longest).take_while(whole).count();
            for below in row..row + rows {
                let from = below * grid.width + column;
                if let Some(cells) = covered.get_mut(from..from + columns) {
                    cells.fill(true);
                }
            }
            out.push(block(grid, (column, row), (columns, rows)));
            column += columns;
        }
    }
    out
}

#[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
fn block(grid: &Grid, (column, row): (usize, usize), (columns, rows): (usize, usize)) -> Block {
    let (width, height) = (columns as f64, rows as f64);
    let middle = grid.world_from_pixel(column as f64 + width * 0.5, row as f64 + height * 0.5);
    Block { middle, along_m: width * grid.resolution_m, across_m: height * grid.resolution_m }
}

#[cfg(test)]
mod tests {
    use socrates_model::Pose;

    use super::*;

    fn grid(rows: &[&str]) -> Grid {
        let cells = rows.iter().flat_map(|row| row.chars());
        let cells = cells.map(|letter| if letter == '.' { Cell::Free } else { Cell::Occupied }).collect();
        let origin = Pose::new(-1.0, 2.0, 0.0);
        Grid { width: rows[0].len(), height: rows.len(), resolution_m: 0.5, origin, cells }
    }

    #[test]
    fn every_occupied_cell_is_covered_once() {
        let grid = grid(&["####.#", "##...#", "##.#.#", "......", "######"]);
        for (longest_m, count) in [(100.0, 5), (1.0, 9), (0.1, 18)] {
            let blocks = blocks(&grid, Cell::Occupied, longest_m);
            assert_eq!(blocks.len(), count, "{longest_m}: {blocks:?}");
            let longest = blocks.iter().map(|block| block.along_m.max(block.across_m)).fold(0.0, f64::max);
            assert!(longest <= longest_m.max(0.5) + 1e-9);
            for row in 0..grid.height {
                for column in 0..grid.width {
                    let at = grid.center_of(column, row);
                    let over = blocks.iter().filter(|block| {
                        (at.x - block.middle.x).abs() < block.along_m / 2.0
                            && (at.y - block.middle.y).abs() < block.across_m / 2.0
                    });
                    assert_eq!(over.count() == 1, grid.at(column, row) == Cell::Occupied, "{column} {row}");
                }
            }
        }
    }
}
