//! Walls as straight edges, so that a scan asks each edge which beams meet it and not each beam which cells it passes.
//!
//! An edge is a border between free floor and a blocked cell, joined with its neighbors in a row; the first wall along a
//! beam is the nearest of the edges it crosses from their free side, and the distance to it is worked out as the walk
//! over cells does ([`Cells::ray`]), so both give the same bits. Where rounding decides which cell a beam enters (near
//! corners of cells), the walk itself is asked.

use socrates_model::{Cell, Grid};

use crate::lidar::{BEAMS, SLACK_RAD, bearing, span};

/// Edges are cut at the borders of square tiles of so many cells a side, so that far ones are not looked at.
const TILE: usize = 128;
/// A beam that meets an edge nearer than this to a corner of a cell is left to the walk, cells. Rounding is below 1e-10
/// on maps of up to 100 000 cells a side.
const CORNER: f64 = 1e-7;
/// An edge whose border is nearer to the scanner than this is seen from its end; its beams are left to the walk, cells.
const LINE: f64 = 1e-6;
/// A scanner nearer than this to such an edge touches it: all its beams are left to the walk, cells.
const TOUCH: f64 = 1e-3;
/// More than the rounding of a distance, as a share.
const ROUNDING: f64 = 1e-9;
/// With more edges than this within reach the walk over cells is faster: about 25 ns an edge against 80 ns a beam.
const MOST: usize = 3000;
/// Added and taken away again, it leaves the nearest whole number.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Where an edge is seen from: the side of its free cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// From smaller columns; the edge runs along a column border.
    Left,
    /// From larger columns.
    Right,
    /// From smaller rows; the edge runs along a row border.
    Above,
    /// From larger rows.
    Below,
}

impl Side {
    const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Above, Self::Below];
}

/// A straight edge on a border between cells.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    /// The border it lies on: a column or a row.
    at: i32,
    /// Rows or columns that it covers, the last one not included.
    from: i32,
    to: i32,
}

/// The edges of a grid, tile by tile.
#[derive(Debug)]
pub(crate) struct Walls {
    across: usize,
    down: usize,
    edges: Vec<Edge>,
    /// Where the edges of each tile begin, four sides to a tile.
    starts: Vec<u32>,
}

/// The beams of one scanner in cells per meter, with meters per cell beside them.
pub(crate) struct Steps {
    pub(crate) right: [f64; BEAMS],
    pub(crate) down: [f64; BEAMS],
    pub(crate) per_right: [f64; BEAMS],
    pub(crate) per_down: [f64; BEAMS],
}

/// A scanner over the cells.
pub(crate) struct Eye {
    /// Its place in cells.
    pub(crate) at: (f64, f64),
    /// What turns cell directions (rows grow downward) into its own frame: cosine and sine.
    pub(crate) turn: (f64, f64),
    /// Its range in cells.
    pub(crate) reach: f64,
}

/// Beams that the edges do not settle: not 0 where the walk has to be asked.
pub(crate) type Doubtful = [f64; BEAMS];

impl Walls {
    pub(crate) fn new(grid: &Grid) -> Self {
        let (across, down) = (grid.width / TILE + 1, grid.height / TILE + 1);
        let mut found: Vec<(u32, Edge)> = Vec::new();
        let mut keep = |side: Side, column: usize, row: usize, edge: Edge| {
            let tile = (row / TILE) * across + column / TILE;
            found.push((u32::try_from(tile * 4).unwrap_or(u32::MAX).saturating_add(side as u32), edge));
        };
        let outside = vec![false; grid.width];
        let mut above = outside.clone();
        // First row of the edge that is open at each column border, by side.
        let mut open: [Vec<Option<usize>>; 2] = [vec![None; grid.width + 1], vec![None; grid.width + 1]];
        for row in 0..=grid.height {
            let here = if row < grid.height { free(grid, row) } else { outside.clone() };
            let mut run = |side: Side, from: usize, to: usize| keep(side, from, row, edge(row, from, to));
            along_row(&above, &here, &mut run);
            for (open, side) in open.iter_mut().zip([Side::Left, Side::Right]) {
                for (column, open) in open.iter_mut().enumerate() {
                    let before = column.checked_sub(1).and_then(|before| here.get(before)).copied().unwrap_or(false);
                    let after = here.get(column).copied().unwrap_or(false);
                    let wall = if side == Side::Left { before && !after } else { after && !before };
                    if let Some(from) = open.filter(|_| !wall || row.is_multiple_of(TILE)) {
                        keep(side, column, from, edge(column, from, row));
                        *open = None;
                    }
                    if wall && open.is_none() {
                        *open = Some(row);
                    }
                }
            }
            above = here;
        }
        found.sort_by_key(|(list, edge)| (*list, edge.at, edge.from));
        let mut starts = Vec::with_capacity(across * down * 4 + 1);
        for list in 0..=across * down * 4 {
            let start = found.partition_point(|(of, _)| (*of as usize) < list);
            starts.push(u32::try_from(start).unwrap_or(u32::MAX));
        }
        Self { across, down, edges: found.into_iter().map(|(_, edge)| edge).collect(), starts }
    }

    fn list(&self, tile: usize, side: Side) -> &[Edge] {
        let at = tile * 4 + side as usize;
        let ends = self.starts.get(at).zip(self.starts.get(at + 1));
        ends.and_then(|(from, to)| self.edges.get(*from as usize..*to as usize)).unwrap_or(&[])
    }

    /// Tiles within reach, first and last column and row of them.
    fn tiles(&self, eye: &Eye) -> [(usize, usize); 2] {
        let tile = |cells: f64, count: usize| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to the tiles there are")]
            let number = (cells.max(0.0) as usize) / TILE;
            number.min(count - 1)
        };
        let both = |at: f64, count: usize| (tile(at - eye.reach - 1.0, count), tile(at + eye.reach + 1.0, count));
        [both(eye.at.0, self.across), both(eye.at.1, self.down)]
    }

    /// Whether a scanner here is better served by edges than by walks over cells.
    pub(crate) fn serves(&self, eye: &Eye) -> bool {
        if !(eye.at.0.is_finite() && eye.at.1.is_finite() && eye.reach.is_finite()) {
            return false;
        }
        let [(left, right), (top, bottom)] = self.tiles(eye);
        let edges = |row: usize| {
            let list = |column: usize| self.starts.get((row * self.across + column) * 4).copied().unwrap_or(0);
            // The tiles of a row lie one behind the other; the list after the last of them begins where they end.
            (list(right + 1) - list(left)) as usize
        };
        (top..=bottom).map(edges).sum::<usize>() <= MOST
    }

    /// Shortens the beams that meet a wall, m, and marks those that rounding decides.
    #[inline(always)]
    pub(crate) fn meet(&self, eye: &Eye, steps: &Steps, ranges: &mut [f64; BEAMS], doubtful: &mut Doubtful) {
        let [(left, right), (top, bottom)] = self.tiles(eye);
        let (column, row) = eye.at;
        for tile in (top..=bottom).flat_map(|row| (left..=right).map(move |column| row * self.across + column)) {
            for side in Side::ALL {
                let upright = matches!(side, Side::Left | Side::Right);
                let (own, other) = if upright { (column, row) } else { (row, column) };
                let facing = matches!(side, Side::Left | Side::Above);
                for edge in self.list(tile, side) {
                    let away = f64::from(edge.at) - own;
                    let (from, to) = (f64::from(edge.from), f64::from(edge.to));
                    let aside = (from - other).max(other - to).max(0.0);
                    let in_reach = away * away + aside * aside <= eye.reach * eye.reach * (1.0 + ROUNDING);
                    let in_line = away.abs() < LINE;
                    if !in_reach || !in_line && (away > 0.0) != facing {
                        continue;
                    }
                    if in_line && aside < TOUCH {
                        doubtful.fill(1.0);
                        return;
                    }
                    let (ends, lanes) = if upright {
                        ([(away, from - other), (away, to - other)], (&steps.per_right, &steps.down))
                    } else {
                        ([(from - other, away), (to - other, away)], (&steps.per_down, &steps.right))
                    };
                    let line = Line { away, other, from, to };
                    for beams in seen(eye, ends) {
                        if in_line {
                            doubtful.get_mut(beams).into_iter().flatten().for_each(|doubt| *doubt = 1.0);
                        } else {
                            cross(&line, lanes, beams, ranges, doubtful);
                        }
                    }
                }
            }
        }
    }
}

/// Which cells of a row are free.
fn free(grid: &Grid, row: usize) -> Vec<bool> {
    let from = row.saturating_mul(grid.width).min(grid.cells.len());
    let to = from.saturating_add(grid.width).min(grid.cells.len());
    let mut line: Vec<bool> =
        grid.cells.get(from..to).unwrap_or_default().iter().map(|cell| *cell == Cell::Free).collect();
    line.resize(grid.width, false);
    line
}

fn edge(at: usize, from: usize, to: usize) -> Edge {
    let short = |number: usize| i32::try_from(number).unwrap_or(i32::MAX);
    Edge { at: short(at), from: short(from), to: short(to) }
}

/// The edges on the border between two rows, cut at tiles.
fn along_row(above: &[bool], here: &[bool], keep: &mut impl FnMut(Side, usize, usize)) {
    let side = |column: usize| match (above.get(column), here.get(column)) {
        (Some(true), Some(false)) => Some(Side::Above),
        (Some(false), Some(true)) => Some(Side::Below),
        (Some(_), Some(_)) | (None, _) | (_, None) => None,
    };
    let mut open: Option<(Side, usize)> = None;
    for column in 0..=here.len() {
        let now = side(column);
        if let Some((of, from)) = open.filter(|(of, _)| now != Some(*of) || column.is_multiple_of(TILE)) {
            keep(of, from, column);
            open = None;
        }
        if open.is_none() {
            open = now.map(|of| (of, column));
        }
    }
}

/// The beams that an edge may meet, by its ends from the scanner on, cells.
#[inline(always)]
fn seen(eye: &Eye, ends: [(f64, f64); 2]) -> [std::ops::Range<usize>; 2] {
    let (cos, sin) = eye.turn;
    let [a, b] = ends.map(|(x, y)| socrates_model::Vector::new(x * cos + y * sin, x * sin - y * cos));
    let (right, left) = if a.x * b.y - a.y * b.x > 0.0 { (a, b) } else { (b, a) };
    let (from, to) = (bearing(&right), bearing(&left));
    span(from - SLACK_RAD, if to < from - SLACK_RAD { to + std::f64::consts::TAU } else { to } + SLACK_RAD)
}

/// An edge from the scanner on, cells: how far away its border is, and what it covers of the other axis, on which the
/// scanner is at `other`.
struct Line {
    away: f64,
    other: f64,
    from: f64,
    to: f64,
}

/// Shortens the beams of a run of numbers that cross an edge. Lanes are meters per cell across the border, and cells
/// per meter along it.
#[inline(always)]
fn cross(
    line: &Line,
    lanes: (&[f64; BEAMS], &[f64; BEAMS]),
    beams: std::ops::Range<usize>,
    ranges: &mut [f64; BEAMS],
    doubtful: &mut Doubtful,
) {
    let (Some(ranges), Some(doubtful)) = (ranges.get_mut(beams.clone()), doubtful.get_mut(beams.clone())) else {
        return;
    };
    let (Some(per_cell), Some(along)) = (lanes.0.get(beams.clone()), lanes.1.get(beams)) else { return };
    let both = ranges.iter_mut().zip(doubtful.iter_mut());
    for ((range, doubtful), (per_cell, along)) in both.zip(per_cell.iter().zip(along)) {
        let gone = line.away * per_cell;
        let met = line.other + gone * along;
        let corner = ((met + WHOLE) - WHOLE - met).abs() < CORNER;
        let near = (gone >= 0.0) & (gone < *range) & (met > line.from - CORNER) & (met < line.to + CORNER);
        *doubtful = if near & corner { 1.0 } else { *doubtful };
        *range = if near & (met >= line.from) & (met < line.to) { gone } else { *range };
    }
}
