//! Regions: what the floor falls into where its doors are closed.

use std::collections::{BTreeMap, BTreeSet};

use socrates_maps::Layer;

use crate::cells::{Cell, Extent, SIDES, height, parts, step};
use crate::floor::{BODY_M, Floor, Spot};
use crate::throat::Throat;

/// Pieces of floor smaller than this between doors are no places: one of the doors is none, m². A car of 1.1 by 1.4 m is one.
const LEAST_M2: f64 = 1.4;
/// The floor on a side of a door is looked for so far beyond it, m.
const BEYOND_M: [f64; 6] = [0.0, 0.15, 0.3, 0.45, 0.6, 0.75];
/// Share of the picture's rim along which the floor round a building lies.
const RIM_SHARE: f64 = 0.4;

/// A door with the regions on both sides: that before it and that behind it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passage {
    pub(crate) throat: Throat,
    pub(crate) sides: [usize; 2],
}

/// A piece of floor between doors.
#[derive(Debug, Clone)]
pub(crate) struct Region {
    pub(crate) extent: Extent,
    /// Free floor, m².
    pub(crate) area_m2: f64,
    /// The roomiest cell, and its clean clearance, m.
    pub(crate) roomiest: Cell,
    pub(crate) clear_m: f64,
    /// Largest clearance without furniture, m: half the width between its walls.
    pub(crate) bare_m: f64,
    /// Whether it is the floor round the building.
    pub(crate) outside: bool,
}

/// Regions and the doors between them.
pub(crate) struct Regions {
    /// Number of the region of each working cell on which the robot fits, from 1; 0 elsewhere.
    pub(crate) of_cell: Layer<u32>,
    pub(crate) all: Vec<Region>,
    pub(crate) passages: Vec<Passage>,
    /// Openings too narrow for the robot.
    pub(crate) gaps: Vec<Throat>,
}

impl Regions {
    /// The region of a cell, if it lies in one.
    pub(crate) fn of(&self, cell: Cell) -> Option<usize> {
        (self.of_cell.get(cell.0, cell.1)? as usize).checked_sub(1)
    }

    /// The passages of a region.
    pub(crate) fn passages_of(&self, region: usize) -> impl Iterator<Item = (usize, &Passage)> {
        self.passages.iter().enumerate().filter(move |(_, passage)| passage.sides.contains(&region))
    }

    /// The pieces of a floor on which throats are closed.
    pub(crate) fn cut(floor: &Floor, inside: &Layer<bool>, throats: &[Throat]) -> Self {
        let (mut of_cell, found) = parts(inside, &SIDES);
        let narrow = |throat: &&Throat| throat.width_m < 2.0 * BODY_M - 0.02;
        let (gaps, wide): (Vec<Throat>, Vec<Throat>) = throats.iter().partition(narrow);
        let side = |throat: &Throat, behind: bool, of_cell: &Layer<u32>| {
            BEYOND_M.iter().find_map(|off| {
                let (column, row) = floor.cell(&throat.beyond(behind, *off));
                of_cell.get(column, row).filter(|number| *number > 0)
            })
        };
        let mut passages: Vec<(Throat, [usize; 2])> = Vec::new();
        for throat in wide {
            let sides = side(&throat, false, &of_cell).zip(side(&throat, true, &of_cell));
            passages.extend(sides.map(|(a, b)| (throat, [a as usize - 1, b as usize - 1])));
        }
        let grown = grown(floor, &of_cell, throats);
        let mut areas: Vec<f64> = vec![0.0; found.len()];
        for number in &grown.values {
            if let Some(area) = (*number as usize).checked_sub(1).and_then(|at| areas.get_mut(at)) {
                *area += floor.area_m2(1);
            }
        }
        let joined = joined(&mut passages, &areas);
        let mut numbers: BTreeMap<usize, u32> = BTreeMap::new();
        for at in 0..found.len() {
            let next = u32::try_from(numbers.len() + 1).unwrap_or(u32::MAX);
            numbers.entry(joined.root(at)).or_insert(next);
        }
        let number = |at: usize| numbers.get(&joined.root(at)).copied().unwrap_or(0);
        for slot in &mut of_cell.values {
            *slot = (*slot as usize).checked_sub(1).map_or(0, number);
        }
        let passages = passages.into_iter().map(|(throat, sides)| {
            let sides = sides.map(|side| (number(side) as usize).saturating_sub(1));
            Passage { throat, sides }
        });
        let passages = passages.collect();
        let mut made = Self { all: measured(floor, &of_cell, numbers.len()), of_cell, passages, gaps };
        for (at, area) in areas.iter().enumerate() {
            if let Some(region) = made.all.get_mut((number(at) as usize).saturating_sub(1)) {
                region.area_m2 += area;
            }
        }
        made
    }

    /// The regions that hang together by doors with a region, itself among them; not through the floor round the building.
    pub(crate) fn reached(&self, from: usize) -> BTreeSet<usize> {
        let mut seen = BTreeSet::new();
        let mut open = vec![from];
        while let Some(region) = open.pop() {
            if !seen.insert(region) {
                continue;
            }
            let next = self.passages_of(region).flat_map(|(_, passage)| passage.sides);
            open.extend(next.filter(|next| self.all.get(*next).is_some_and(|region| !region.outside)));
        }
        seen
    }
}

/// The cells that a closed throat covers, a little longer than its line.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a door has at most 2 m")]
fn line(floor: &Floor, throat: &Throat) -> BTreeSet<Cell> {
    let along = throat.to - throat.from;
    let (length, more) = (along.norm(), floor.cell_m);
    let unit = along / length.max(1e-9);
    let steps = ((length + 2.0 * more) / (0.25 * floor.cell_m)) as u32 + 1;
    let at = |step: u32| throat.from + unit * (f64::from(step) * 0.25 * floor.cell_m - more);
    (0..=steps).map(|step| floor.cell(&at(step))).collect()
}

/// The numbers of regions, grown over the free floor beside them where the robot does not fit.
fn grown(floor: &Floor, of_cell: &Layer<u32>, throats: &[Throat]) -> Layer<u32> {
    let mut grown = of_cell.clone();
    let closed: BTreeSet<Cell> = throats.iter().flat_map(|throat| line(floor, throat)).collect();
    let mut rim: Vec<Cell> = Vec::new();
    for row in 0..height(of_cell) {
        for column in 0..of_cell.width {
            let cell = (column, row);
            let own = of_cell.get(column, row).unwrap_or(0);
            let at_rim = || {
                SIDES.iter().any(|way| {
                    let next = step(cell, *way);
                    of_cell.get(next.0, next.1) == Some(0)
                })
            };
            if own > 0 && at_rim() {
                rim.push(cell);
            }
        }
    }
    while !rim.is_empty() {
        let mut next_rim = Vec::new();
        for cell in rim {
            let number = grown.get(cell.0, cell.1).unwrap_or(0);
            for way in &SIDES {
                let next = step(cell, *way);
                if grown.get(next.0, next.1) == Some(0) && floor.clear_of(next) > 0.0 && !closed.contains(&next) {
                    grown.set(next.0, next.1, number);
                    next_rim.push(next);
                }
            }
        }
        rim = next_rim;
    }
    grown
}

/// Which pieces are one.
struct Joined(Vec<usize>);

impl Joined {
    fn root(&self, mut at: usize) -> usize {
        while let Some(up) = self.0.get(at).copied().filter(|up| *up != at) {
            at = up;
        }
        at
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if let Some(slot) = self.0.get_mut(a.max(b)) {
            *slot = a.min(b);
        }
    }
}

/// Takes away the doubtful doors of pieces too small to be places, and says which pieces are one without them.
fn joined(passages: &mut Vec<(Throat, [usize; 2])>, areas: &[f64]) -> Joined {
    let mut joined = Joined((0..areas.len()).collect());
    loop {
        let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
        for (at, area) in areas.iter().enumerate() {
            *sums.entry(joined.root(at)).or_insert(0.0) += area;
        }
        let small = |side: usize| sums.get(&joined.root(side)).is_some_and(|area| *area < LEAST_M2);
        let weakest = passages
            .iter()
            .enumerate()
            .filter(|(_, (_, sides))| sides.iter().any(|side| small(*side)))
            .min_by(|(_, (a, _)), (_, (b, _))| a.confidence().total_cmp(&b.confidence()))
            .map(|(at, _)| at);
        let Some(weakest) = weakest else { return joined };
        let (_, [a, b]) = passages.remove(weakest);
        joined.join(a, b);
    }
}

/// Extent, roomiest place and place at the rim of each region; areas are added by the caller.
#[expect(clippy::cast_precision_loss, reason = "cells of a map")]
fn measured(floor: &Floor, of_cell: &Layer<u32>, count: usize) -> Vec<Region> {
    let none =
        Region { extent: Extent::NONE, area_m2: 0.0, roomiest: (0, 0), clear_m: 0.0, bare_m: 0.0, outside: false };
    let mut all = vec![none; count];
    let (width, rows) = floor.size();
    for row in 0..rows {
        for column in 0..width {
            let number = of_cell.get(column, row).unwrap_or(0) as usize;
            let Some(region) = number.checked_sub(1).and_then(|at| all.get_mut(at)) else { continue };
            region.extent.add((column, row));
            let clear_m = floor.clear_of((column, row));
            region.bare_m = region.bare_m.max(f64::from(floor.bare_m.get(column, row).unwrap_or(0.0)));
            if clear_m > region.clear_m {
                (region.roomiest, region.clear_m) = ((column, row), clear_m);
            }
        }
    }
    // The middle of the robot keeps its half width, and a cell, from the rim of the picture.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few cells")]
    let inward = (BODY_M / floor.cell_m) as usize + 1;
    let mut at_rim = vec![0_usize; count];
    // Floor of a building that comes near to the rim has a wall before it; floor round one goes on to the rim itself.
    let mut count_at = |rim: Cell, cell: Cell| {
        let number = of_cell.get(cell.0, cell.1).unwrap_or(0) as usize;
        if let Some(count) = number.checked_sub(1).filter(|_| floor.is_free(rim)).and_then(|at| at_rim.get_mut(at)) {
            *count += 1;
        }
    };
    for column in 0..width {
        count_at((column, 0), (column, inward));
        count_at((column, rows.wrapping_sub(1)), (column, rows.wrapping_sub(inward + 1)));
    }
    for row in 0..rows {
        count_at((0, row), (inward, row));
        count_at((width.wrapping_sub(1), row), (width.wrapping_sub(inward + 1), row));
    }
    for (region, count) in all.iter_mut().zip(at_rim) {
        region.outside = count as f64 >= RIM_SHARE * 2.0 * (width + rows) as f64;
    }
    all
}

/// Middle of a region's roomiest cell.
pub(crate) fn roomiest(floor: &Floor, region: &Region) -> Spot {
    floor.spot(region.roomiest)
}
