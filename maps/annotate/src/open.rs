//! Open floor: halls in which no walls show a way, and a lattice of places on them.

use std::collections::BTreeMap;

use socrates_maps::Layer;

use crate::cells::{Cell, ROUND, SIDES, height, parts, step};
use crate::floor::{Floor, Spot};
use crate::way::{LEAST_M, is_straight};

/// Clearance without furniture from which on floor is open, m: no corridor is twice as wide.
pub(crate) const CORE_M: f64 = 2.4;
/// Open floor goes on round its core for so far, m.
const ROUND_M: f64 = 1.9;
/// Least area of open floor, m²: what is smaller is where ways meet.
const LEAST_M2: f64 = 50.0;
/// Largest share of open floor that things cover: among more of them the ways between them are what counts.
const COVERED: f64 = 0.06;
/// Places on open floor are about so far apart, m.
const STEP_M: f64 = 4.8;
/// A place is moved at most so far, m, to floor that is free for so much round it, m.
const MOVED_M: f64 = 1.2;
/// See [`MOVED_M`].
const FREE_M: f64 = 0.5;

/// Places on one piece of open floor and the straight ways between them.
#[derive(Debug, Default)]
pub(crate) struct Lattice {
    pub(crate) spots: Vec<Spot>,
    pub(crate) ways: Vec<[usize; 2]>,
}

/// The open floor among some cells.
pub(crate) struct Open {
    /// Which cells are open floor.
    pub(crate) on: Layer<bool>,
    pub(crate) lattices: Vec<Lattice>,
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "cells of a map"
)]
impl Open {
    /// The open floor of the cells of ways.
    pub(crate) fn of(floor: &Floor, ways: &Layer<bool>) -> Self {
        let bare = |cell: Cell| f64::from(floor.bare_m.get(cell.0, cell.1).unwrap_or(0.0));
        let (width, rows) = (ways.width, height(ways));
        let mut on = Layer::filled(width, rows, false);
        let mut rim: Vec<Cell> = Vec::new();
        for row in 0..rows {
            for column in 0..width {
                // Cores lie where ways are, or under things on them.
                let thing = floor.clear_of((column, row)) < LEAST_M;
                if bare((column, row)) >= CORE_M && (ways.get(column, row) == Some(true) || thing) {
                    on.set(column, row, true);
                    rim.push((column, row));
                }
            }
        }
        for _ in 0..(ROUND_M / floor.cell_m) as usize {
            let mut next_rim = Vec::new();
            for cell in rim {
                for way in &SIDES {
                    let next = step(cell, *way);
                    if on.get(next.0, next.1) == Some(false) && bare(next) > LEAST_M {
                        on.set(next.0, next.1, true);
                        next_rim.push(next);
                    }
                }
            }
            rim = next_rim;
        }
        let (numbers, found) = parts(&on, &SIDES);
        let mut covered = vec![0_usize; found.len()];
        for (place, number) in numbers.values.iter().enumerate() {
            let thing = || floor.clear_of((place % width.max(1), place / width.max(1))) <= 0.0;
            if let Some(count) = (*number as usize).checked_sub(1).and_then(|at| covered.get_mut(at))
                && thing()
            {
                *count += 1;
            }
        }
        let is_open: Vec<bool> = found
            .iter()
            .zip(&covered)
            .map(|(part, covered)| {
                floor.area_m2(part.cells) >= LEAST_M2 && (*covered as f64) <= COVERED * part.cells as f64
            })
            .collect();
        let kept = |number: u32| (number as usize).checked_sub(1).and_then(|at| is_open.get(at)) == Some(&true);
        for (slot, number) in on.values.iter_mut().zip(&numbers.values) {
            *slot = kept(*number);
        }
        let lattices = found.iter().enumerate().filter(|(at, _)| is_open.get(*at) == Some(&true)).map(|(at, part)| {
            let own = |spot: &Spot| {
                let cell = floor.cell(spot);
                numbers.get(cell.0, cell.1).is_some_and(|number| number as usize == at + 1)
            };
            let low = floor.spot((part.extent.columns.0, part.extent.rows.0));
            let high = floor.spot((part.extent.columns.1, part.extent.rows.1));
            let count = |length: f64| ((length / STEP_M).round() as u32).clamp(1, 200);
            lattice(floor, (low, high), (count(high.x - low.x), count(high.y - low.y)), own)
        });
        let lattices = lattices.collect();
        Self { on, lattices }
    }

    /// Whether a spot lies at the rim of open floor, or on it.
    pub(crate) fn is_near(&self, floor: &Floor, spot: &Spot) -> bool {
        let cell = floor.cell(spot);
        let on = |cell: Cell| self.on.get(cell.0, cell.1) == Some(true);
        on(cell) || ROUND.iter().any(|way| on(step(cell, *way)))
    }
}

/// A lattice of so many columns and rows over a box, where its spots lie on its own floor.
fn lattice(
    floor: &Floor,
    (low, high): (Spot, Spot),
    (columns, rows): (u32, u32),
    own: impl Fn(&Spot) -> bool,
) -> Lattice {
    let mut made = Lattice::default();
    let mut numbers: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for row in 0..rows {
        for column in 0..columns {
            let share = |at: u32, count: u32| (f64::from(at) + 0.5) / f64::from(count);
            let x = low.x + (high.x - low.x) * share(column, columns);
            let y = low.y + (high.y - low.y) * share(row, rows);
            if let Some(spot) = free_near(floor, &Spot::new(x, y), FREE_M, &own) {
                numbers.insert((column, row), made.spots.len());
                made.spots.push(spot);
            }
        }
    }
    for ((column, row), from) in &numbers {
        for next in [(*column + 1, *row), (*column, *row + 1)] {
            let Some(to) = numbers.get(&next) else { continue };
            let ends = made.spots.get(*from).zip(made.spots.get(*to));
            if ends.is_some_and(|(a, b)| is_straight(floor, a, b, LEAST_M) && floor.clean_line_m(a, b) > 0.0) {
                made.ways.push([*from, *to]);
            }
        }
    }
    made
}

/// The nearest spot on its own floor that is free all round, if there is one nearby.
#[expect(clippy::cast_possible_truncation, reason = "a few steps")]
pub(crate) fn free_near(floor: &Floor, spot: &Spot, free_m: f64, own: &impl Fn(&Spot) -> bool) -> Option<Spot> {
    let reach = (MOVED_M / 0.2) as i32;
    let mut tried: Vec<Spot> = (-reach..=reach)
        .flat_map(|down| (-reach..=reach).map(move |right| (right, down)))
        .map(|(right, down)| spot + socrates_model::Vector::new(f64::from(right), f64::from(down)) * 0.2)
        .collect();
    tried.sort_by(|a, b| (a - spot).norm().total_cmp(&(b - spot).norm()));
    tried.into_iter().find(|near| own(near) && floor.raw_m(near) >= free_m)
}
