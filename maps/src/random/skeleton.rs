//! How corridors lie in a building: small pictures, whose columns and rows are given widths.
//!
//! In a picture `#` is corridor, `.` is outside, and every letter is a rectangle for rooms. Columns and rows have a kind each:
//! `c` as wide as a corridor, `d` as deep as a room, `D` as deep as two rooms back to back, `l` long.

use super::chance::Chance;
use super::draft::WALL;
use super::shape::{Area, Side};

/// A picture with the kinds of its columns and rows.
#[derive(Debug)]
pub(super) struct Skeleton {
    /// What a description says of it.
    pub(super) words: &'static str,
    columns: &'static str,
    rows: &'static str,
    picture: &'static [&'static str],
}

pub(super) const SPINE: Skeleton = Skeleton {
    words: "rooms on both sides of one long corridor",
    columns: "ll",
    rows: "dcd",
    picture: &["AA", "##", "BB"],
};
pub(super) const BEND: Skeleton = Skeleton {
    words: "a corridor round a corner",
    columns: "dcdl",
    rows: "ldcd",
    picture: &["A#B.", "A#CC", "A###", "ADDD"],
};
pub(super) const TEE: Skeleton = Skeleton {
    words: "a corridor with a wing",
    columns: "ldcdl",
    rows: "ldcd",
    picture: &[".A#B.", "CC#DD", "#####", "EEEEE"],
};
pub(super) const CROSS: Skeleton = Skeleton {
    words: "two corridors that cross",
    columns: "ldcdl",
    rows: "ldcdl",
    picture: &[".A#B.", "CC#DD", "#####", "EE#FF", ".G#H."],
};
pub(super) const LADDER: Skeleton = Skeleton {
    words: "two wings and a corridor between them",
    columns: "dcdldcd",
    rows: "ldcdl",
    picture: &["A#B.C#D", "A#EEE#D", "A#####D", "A#FFF#D", "A#G.H#D"],
};
pub(super) const COMB: Skeleton = Skeleton {
    words: "a main corridor with two side corridors",
    columns: "dcDcd",
    rows: "lcd",
    picture: &["A#B#C", "#####", "DDDDD"],
};
pub(super) const LONG_COMB: Skeleton = Skeleton {
    words: "a main corridor with three side corridors",
    columns: "dcDcDcd",
    rows: "lcd",
    picture: &["A#B#C#D", "#######", "EEEEEEE"],
};
pub(super) const DOUBLE_COMB: Skeleton = Skeleton {
    words: "a main corridor with side corridors on both sides",
    columns: "dcDcd",
    rows: "lcl",
    picture: &["A#B#C", "#####", "D#E#F"],
};
pub(super) const RING: Skeleton = Skeleton {
    words: "a corridor all round a core of rooms",
    columns: "dclcd",
    rows: "dcDcd",
    picture: &["AAAAB", "####B", "C#D#B", "C####", "CEEEE"],
};
pub(super) const TWO_RINGS: Skeleton = Skeleton {
    words: "corridors round two cores of rooms",
    columns: "dclclcd",
    rows: "dcDcd",
    picture: &["AAAAAAB", "######B", "C#D#E#B", "C######", "CFFFFFF"],
};
/// A passage that ends in the largest room of a home.
pub(super) const PASSAGE: Skeleton = Skeleton {
    words: "a passage that leads to the living room",
    columns: "ll",
    rows: "dcd",
    picture: &["AC", "#C", "BC"],
};
/// A passage with a bend, for homes.
pub(super) const BENT_PASSAGE: Skeleton = Skeleton {
    words: "a passage round a corner",
    columns: "dcd",
    rows: "ldcd",
    picture: &["A#B", "A#B", "A##", "CCC"],
};
/// A passage across a home, with another one off it.
pub(super) const FORKED_PASSAGE: Skeleton =
    Skeleton { words: "a passage with a side passage", columns: "dcd", rows: "lcd", picture: &["A#B", "###", "CCC"] };

/// Widths from which a skeleton's columns and rows are drawn, tenths.
#[derive(Debug, Clone, Copy)]
pub(super) struct Widths {
    pub(super) corridor: (i32, i32),
    pub(super) depth: (i32, i32),
    pub(super) length: (i32, i32),
}

/// A skeleton with sizes.
#[derive(Debug)]
pub(super) struct Laid {
    picture: &'static [&'static str],
    columns: Vec<Track>,
    rows: Vec<Track>,
}

/// A column or row.
#[derive(Debug, Clone, Copy)]
struct Track {
    corridor: bool,
    from: i32,
    to: i32,
}

impl Track {
    const fn middle(self) -> i32 {
        (self.from + self.to) / 2
    }
}

/// A straight corridor by its cells, from the first to the last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) along_x: bool,
    /// Its row or column.
    pub(super) track: usize,
    pub(super) first: usize,
    pub(super) last: usize,
}

/// A rectangle for rooms with the cells it covers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) area: Area,
    columns: (usize, usize),
    rows: (usize, usize),
}

impl Skeleton {
    /// Draws the widths of every column and row.
    pub(super) fn laid(&self, widths: &Widths, chance: &mut Chance) -> Laid {
        Laid {
            picture: self.picture,
            columns: tracks(self.columns, widths, chance),
            rows: tracks(self.rows, widths, chance),
        }
    }
}

fn tracks(kinds: &str, widths: &Widths, chance: &mut Chance) -> Vec<Track> {
    let mut from = 0;
    let mut out = Vec::new();
    for kind in kinds.chars() {
        let wide = match kind {
            'c' => chance.between(widths.corridor),
            'd' => chance.between(widths.depth),
            'D' => chance.between(widths.depth) + WALL + chance.between(widths.depth),
            _ => chance.between(widths.length),
        };
        out.push(Track { corridor: kind == 'c', from, to: from + wide });
        from += wide + WALL;
    }
    out
}

impl Laid {
    fn cell(&self, row: usize, column: usize) -> char {
        self.picture.get(row).and_then(|line| line.chars().nth(column)).unwrap_or('.')
    }

    fn corridor(&self, row: usize, column: usize) -> bool {
        self.cell(row, column) == '#'
    }

    fn of_run(&self, run: &Run, place: usize) -> bool {
        if run.along_x { self.corridor(run.track, place) } else { self.corridor(place, run.track) }
    }

    fn tracks(&self, along_x: bool) -> &[Track] {
        if along_x { &self.columns } else { &self.rows }
    }

    /// Every straight corridor: those along x first, from the first row on.
    pub(super) fn runs(&self) -> Vec<Run> {
        let mut out = Vec::new();
        for along_x in [true, false] {
            let across = self.tracks(!along_x).iter().enumerate().filter(|(_, track)| track.corridor);
            for (track, _) in across {
                let mut first: Option<usize> = None;
                for place in 0..=self.tracks(along_x).len() {
                    let here = Run { along_x, track, first: first.unwrap_or(place), last: place };
                    if self.of_run(&here, place) {
                        first = first.or(Some(place));
                    } else if let Some(start) = first.take() {
                        let run = Run { first: start, last: place - 1, ..here };
                        out.extend(self.is_long(&run).then_some(run));
                    }
                }
            }
        }
        out
    }

    /// Whether a run is a corridor of its own, not only the width of another one.
    fn is_long(&self, run: &Run) -> bool {
        run.last > run.first || self.tracks(run.along_x).get(run.first).is_some_and(|track| !track.corridor)
    }

    /// From where to where a run goes along its direction, tenths.
    pub(super) fn span(&self, run: &Run) -> (i32, i32) {
        let at = |place: usize| self.tracks(run.along_x).get(place).copied().unwrap_or(Track::NONE);
        (at(run.first).from, at(run.last).to)
    }

    /// Both long sides of a run across its direction, tenths.
    pub(super) fn sides(&self, run: &Run) -> (i32, i32) {
        let track = self.tracks(!run.along_x).get(run.track).copied().unwrap_or(Track::NONE);
        (track.from, track.to)
    }

    /// Where other corridors meet a run: the cell as (row, column), the middle along the run, and how many ways leave it.
    pub(super) fn crossings(&self, run: &Run) -> Vec<((usize, usize), i32, usize)> {
        let mut out = Vec::new();
        for place in run.first..=run.last {
            let Some(track) = self.tracks(run.along_x).get(place).filter(|track| track.corridor) else { continue };
            let (row, column) = if run.along_x { (run.track, place) } else { (place, run.track) };
            let beside = |down: bool, far: bool| {
                let step = |at: usize, moves: bool| match (moves, far) {
                    (false, _) => Some(at),
                    (true, true) => Some(at + 1),
                    (true, false) => at.checked_sub(1),
                };
                step(row, down).zip(step(column, !down)).is_some_and(|(r, c)| self.corridor(r, c))
            };
            let ways = [(true, true), (true, false), (false, true), (false, false)];
            let degree = ways.iter().filter(|(down, far)| beside(*down, *far)).count();
            if beside(run.along_x, true) || beside(run.along_x, false) {
                out.push(((row, column), track.middle(), degree));
            }
        }
        out
    }

    /// What lies past an end of a run: a letter, or `.` for the outside.
    pub(super) fn past(&self, run: &Run, last: bool) -> char {
        let place = if last { Some(run.last + 1) } else { run.first.checked_sub(1) };
        let Some(place) = place else { return '.' };
        if run.along_x { self.cell(run.track, place) } else { self.cell(place, run.track) }
    }

    /// The rectangles for rooms, by their letters.
    pub(super) fn blocks(&self) -> Vec<Block> {
        let mut letters: Vec<char> =
            self.picture.iter().flat_map(|line| line.chars()).filter(char::is_ascii_uppercase).collect();
        letters.sort_unstable();
        letters.dedup();
        letters.into_iter().filter_map(|letter| self.block(letter)).collect()
    }

    fn block(&self, letter: char) -> Option<Block> {
        let here = |row: usize, column: usize| self.cell(row, column) == letter;
        let (wide, high) = (self.columns.len(), self.rows.len());
        let columns: Vec<usize> = (0..wide).filter(|column| (0..high).any(|row| here(row, *column))).collect();
        let rows: Vec<usize> = (0..high).filter(|row| (0..wide).any(|column| here(*row, column))).collect();
        let (columns, rows) = ((*columns.first()?, *columns.last()?), (*rows.first()?, *rows.last()?));
        let area = Area {
            x0: self.columns.get(columns.0)?.from,
            y0: self.rows.get(rows.0)?.from,
            x1: self.columns.get(columns.1)?.to,
            y1: self.rows.get(rows.1)?.to,
        };
        Some(Block { area, columns, rows })
    }

    /// Whether a run goes along this side of a block, one wall away.
    pub(super) fn borders(&self, run: &Run, block: &Block, side: Side) -> bool {
        let track = match side {
            Side::Left => block.columns.0.checked_sub(1),
            Side::Right => Some(block.columns.1 + 1),
            Side::Bottom => block.rows.0.checked_sub(1),
            Side::Top => Some(block.rows.1 + 1),
        };
        let (first, last) = if side.along_x() { block.columns } else { block.rows };
        run.along_x == side.along_x() && Some(run.track) == track && run.first <= last && first <= run.last
    }

    /// Whether a run ends at this side of a block, and with its last cell.
    pub(super) fn ends_at(&self, run: &Run, block: &Block, side: Side) -> Option<bool> {
        let (first, last) = if side.along_x() { block.columns } else { block.rows };
        if run.along_x == side.along_x() || run.track < first || run.track > last {
            return None;
        }
        let (before, after) = if side.along_x() { block.rows } else { block.columns };
        match side {
            Side::Left | Side::Bottom => (run.last + 1 == before).then_some(true),
            Side::Right | Side::Top => (run.first == after + 1).then_some(false),
        }
    }
}

impl Track {
    const NONE: Self = Self { corridor: false, from: 0, to: 0 };
}
