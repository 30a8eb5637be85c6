//! The skeleton of the floor: cells are taken away from the walls inward as long as nothing is torn or opened.
//!
//! Homotopic thinning in the order of the exact distance (Pudney 1998, "Distance-ordered homotopic thinning"), so that what stays
//! lies where the walls on both sides are equally far. A cell with one neighbor left is the tip of a way and stays.

use socrates_maps::Layer;

use crate::cells::{Cell, ROUND, height, step};

/// Steps of distance into which cells are sorted, per cell side.
const LEVELS_PER_CELL: f64 = 4.0;

/// The skeleton of the cells inside, by their clearance.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells of a map and small positive numbers"
)]
pub(crate) fn skeleton(inside: &Layer<bool>, clear_m: &Layer<f32>, cell_m: f64) -> Layer<bool> {
    let mut left = inside.clone();
    let level = |cell: Cell| {
        let clear = f64::from(clear_m.get(cell.0, cell.1).unwrap_or(0.0));
        (clear / cell_m * LEVELS_PER_CELL) as usize
    };
    let mut levels: Vec<Vec<Cell>> = Vec::new();
    for row in 0..height(inside) {
        for column in 0..inside.width {
            if inside.get(column, row) == Some(true) {
                let at = level((column, row));
                if levels.len() <= at {
                    levels.resize_with(at + 1, Vec::new);
                }
                if let Some(cells) = levels.get_mut(at) {
                    cells.push((column, row));
                }
            }
        }
    }
    let simple = simple_table();
    for (now, cells) in levels.into_iter().enumerate() {
        let mut open = cells;
        while !open.is_empty() {
            let mut again = Vec::new();
            for cell in open {
                let around = neighbors(&left, cell);
                let stays = around.count_ones() <= 1 || simple.get(usize::from(around)) != Some(&true);
                if stays || left.get(cell.0, cell.1) != Some(true) {
                    continue;
                }
                left.set(cell.0, cell.1, false);
                let passed = |next: &Cell| left.get(next.0, next.1) == Some(true) && level(*next) <= now;
                again.extend(ROUND.iter().map(|way| step(cell, *way)).filter(passed));
            }
            open = again;
        }
    }
    left
}

/// Which of the eight cells round a cell are there, a bit each, in the order of [`ROUND`].
pub(crate) fn neighbors(layer: &Layer<bool>, cell: Cell) -> u8 {
    ROUND.iter().enumerate().fold(0, |bits, (place, way)| {
        let next = step(cell, *way);
        bits | u8::from(layer.get(next.0, next.1) == Some(true)) << place
    })
}

/// For each neighborhood whether its middle can be taken away: what is there hangs together without it, and what is not there
/// touches it on a side, in one piece.
fn simple_table() -> Vec<bool> {
    (0..=u8::MAX).map(is_simple).collect()
}

fn is_simple(around: u8) -> bool {
    let there = |place: usize| around >> (place % 8) & 1 == 1;
    // Sides are the odd places. Yokoi's number for eight-neighbors: 1 where the middle is on the rim and tears nothing.
    let number: i32 = [1, 3, 5, 7]
        .iter()
        .map(|side| {
            let gone = |place: usize| i32::from(!there(place));
            gone(*side) - gone(*side) * gone(side + 1) * gone(side + 2)
        })
        .sum();
    number == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(rows: &[&str]) -> Layer<bool> {
        Layer { width: rows[0].len(), values: rows.concat().chars().map(|c| c == '#').collect() }
    }

    fn thinned(rows: &[&str]) -> Vec<String> {
        let inside = layer(rows);
        let grid = socrates_model::Grid {
            width: inside.width,
            height: rows.len(),
            resolution_m: 1.0,
            origin: socrates_model::Pose::new(0.0, 0.0, 0.0),
            cells: inside
                .values
                .iter()
                .map(|free| if *free { socrates_model::Cell::Free } else { socrates_model::Cell::Occupied })
                .collect(),
        };
        let field = socrates_maps::DistanceField::new(&grid);
        let mut clear = Layer::filled(inside.width, rows.len(), 0.0);
        for row in 0..rows.len() {
            for column in 0..inside.width {
                clear.set(column, row, field.clearance_of_cell(column, row) as f32);
            }
        }
        let left = skeleton(&inside, &clear, 1.0);
        left.values.chunks(left.width).map(|row| row.iter().map(|on| if *on { '#' } else { '.' }).collect()).collect()
    }

    #[test]
    fn a_bar_becomes_its_middle_line_without_spurs_into_corners() {
        let left = thinned(&["...........", ".#########.", ".#########.", ".#########.", "..........."]);
        assert_eq!(left[2], "..#######..");
        assert!(left.concat().matches('#').count() <= 9, "{left:#?}");
    }

    #[test]
    fn a_ring_stays_a_ring_and_a_tee_keeps_three_arms() {
        let ring = thinned(&[".......", ".#####.", ".#####.", ".##.##.", ".#####.", ".#####.", "......."]);
        let count = ring.concat().matches('#').count();
        assert!((4..=12).contains(&count), "{ring:#?}");
        let tee = thinned(&["#########", "#########", "#########", "...###...", "...###...", "...###...", "...###..."]);
        assert!(tee[5].contains('#') && tee[1].starts_with(".#") && tee[1].ends_with("#."), "{tee:#?}");
    }
}
