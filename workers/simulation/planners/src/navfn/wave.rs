//! The wave of potentials that spreads from the robot over the map.
//!
//! As Nav2's it takes cells in rounds, those beyond a rising threshold later. A neighbor is taken only where it can sink by
//! a whole step from this cell, so potentials end up to a few percent above those of an exact wave. Other than there, lists
//! grow as they must, and a cell that waits for its turn in a round is not put on the list of the next one as well.

use super::NavFnParams;
use crate::costmap::{Costmap, INSCRIBED, UNKNOWN};

/// Cost of a free cell.
pub(super) const NEUTRAL: f32 = 50.0;
/// Cost of a cell grows so much for each unit of the costmap.
const FACTOR: f64 = 0.8;
/// Costs from here on are obstacles.
const OBSTACLE: u8 = 254;
/// Cost of the dearest cell that a way may lead through, and of unknown ones.
const DEAREST: f32 = 253.0;
/// Potential of a cell that was not reached.
pub(super) const UNREACHED: f32 = 1e10;
/// The threshold between this round and later ones rises by so much.
const RISE: f32 = 2.0 * NEUTRAL;
/// 1 / sqrt 2.
const INV_SQRT_2: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// Side of a tile, cells: the potentials of one fill a page of memory, so that a front across many rows touches few pages.
const TILE: usize = 32;
const TILE_CELLS: usize = TILE * TILE;

/// Cells in tiles: tile by tile, row by row in each.
#[derive(Debug, Default, Clone, Copy)]
struct Tiles {
    /// Tiles from left to right.
    across: usize,
}

impl Tiles {
    const fn place(self, column: usize, row: usize) -> usize {
        (row / TILE * self.across + column / TILE) * TILE_CELLS + row % TILE * TILE + column % TILE
    }

    /// The cells to the left, to the right, below and above. Beside the map is an obstacle, a place of no cell, or padding.
    #[inline]
    const fn neighbors(self, place: usize) -> [usize; 4] {
        const ASIDE: usize = TILE_CELLS - (TILE - 1);
        let (x, y) = (place % TILE, place / TILE % TILE);
        let over = self.across * TILE_CELLS - (TILE - 1) * TILE;
        [
            place.wrapping_sub(if x == 0 { ASIDE } else { 1 }),
            place + if x == TILE - 1 { ASIDE } else { 1 },
            place.wrapping_sub(if y == 0 { over } else { TILE }),
            place + if y == TILE - 1 { over } else { TILE },
        ]
    }
}

/// Potentials over a map.
#[derive(Debug, Default)]
pub(super) struct Wave {
    pub(super) width: usize,
    pub(super) height: usize,
    tiles: Tiles,
    corners: Vec<(f32, f32)>,
    /// Costs of the costmap, its border an obstacle.
    costs: Vec<u8>,
    /// The potential of each cell; below 0 while the cell waits in a list.
    potentials: Vec<f32>,
    now: List,
    next: List,
    over: List,
}

/// Cells that wait. No cell waits twice, so a list as long as the map holds them all.
#[derive(Debug, Default)]
struct List {
    places: Vec<u32>,
    len: usize,
}

impl List {
    /// Makes room for the cells of a map, and forgets those in it.
    fn clear(&mut self, cells: usize) {
        self.len = 0;
        if self.places.len() <= cells {
            self.places.resize(cells + 1, 0);
        }
    }

    /// Adds those of a few places that are wanted. Each is written either way, because a jump that cannot be foreseen takes longer
    /// than a write.
    #[inline]
    fn push<const N: usize>(&mut self, places: [usize; N], wanted: [bool; N]) {
        let mut len = self.len;
        for (place, wanted) in places.into_iter().zip(wanted) {
            if let Some(slot) = self.places.get_mut(len) {
                *slot = place as u32;
                len += usize::from(wanted);
            }
        }
        self.len = len;
    }

    fn waiting(&self) -> &[u32] {
        self.places.get(..self.len).unwrap_or_default()
    }
}

/// The planner's cost of each cost of a costmap: 50 + 0.8 c cut to a whole number, up to 253; infinite for obstacles.
fn costs(allow_unknown: bool) -> [f32; 256] {
    std::array::from_fn(|cost| {
        let cost = u8::try_from(cost).unwrap_or(UNKNOWN);
        #[expect(clippy::cast_possible_truncation, reason = "between 50 and 253")]
        let dear = (f64::from(NEUTRAL) + FACTOR * f64::from(cost)).min(f64::from(DEAREST)).trunc() as f32;
        if cost < INSCRIBED {
            dear
        } else if cost == UNKNOWN && allow_unknown {
            DEAREST
        } else {
            f32::INFINITY
        }
    })
}

/// What the wave is bent by: the way that is left to the goal, or nothing.
trait Bent {
    fn left(&self, place: usize) -> f32;
}

/// Dijkstra.
struct Evenly;

impl Bent for Evenly {
    fn left(&self, _place: usize) -> f32 {
        0.0
    }
}

/// A*: the straight way to a cell over free floor.
struct Towards<'a> {
    goal: (f32, f32),
    /// Column and row at which each tile begins: looked up, because a division takes longer.
    corners: &'a [(f32, f32)],
}

impl Towards<'_> {
    fn from(&self, x: f32, y: f32) -> f32 {
        let (across, up) = (x - self.goal.0, y - self.goal.1);
        NEUTRAL * (across * across + up * up).sqrt()
    }
}

impl Bent for Towards<'_> {
    #[inline]
    fn left(&self, place: usize) -> f32 {
        let (column, row) = self.corners.get(place / TILE_CELLS).copied().unwrap_or_default();
        self.from(column + (place % TILE) as f32, row + (place / TILE % TILE) as f32)
    }
}

impl Wave {
    /// Spreads from the robot until the goal is reached.
    pub(super) fn spread(&mut self, map: &Costmap, from: (usize, usize), to: (usize, usize), params: &NavFnParams) {
        self.load(map);
        let tiles = self.tiles;
        let (start, goal) = (tiles.place(from.0, from.1), tiles.place(to.0, to.1));
        let costs = costs(params.allow_unknown);
        if let Some(potential) = self.potentials.get_mut(start) {
            *potential = 0.0;
        }
        for near in tiles.neighbors(start) {
            let cost = self.costs.get(near).and_then(|cost| costs.get(usize::from(*cost)));
            if let Some(potential) = self.potentials.get_mut(near).filter(|_| cost.is_some_and(|cost| cost.is_finite()))
            {
                *potential = -potential.abs();
                self.now.push([near], [true]);
            }
        }
        let cycles = (map.width() * map.height() / 20).max(map.width() + map.height());
        let threshold = f32::from(OBSTACLE);
        if params.use_astar {
            let mut corners = std::mem::take(&mut self.corners);
            corners.clear();
            let across = tiles.across.max(1);
            let corner = |tile: usize| ((tile % across * TILE) as f32, (tile / across * TILE) as f32);
            corners.extend((0..self.costs.len() / TILE_CELLS).map(corner));
            let towards = Towards { goal: (to.0 as f32, to.1 as f32), corners: &corners };
            let threshold = threshold + towards.from(from.0 as f32, from.1 as f32);
            self.run(&costs, &towards, goal, threshold, cycles);
            self.corners = corners;
        } else {
            self.run(&costs, &Evenly, goal, threshold, cycles);
        }
    }

    /// Takes over the costs; the border is an obstacle, and so is what fills up the last tiles.
    fn load(&mut self, map: &Costmap) {
        let (width, height) = (map.width(), map.height());
        (self.width, self.height) = (width, height);
        self.tiles = Tiles { across: width.div_ceil(TILE) };
        let cells = self.tiles.across * height.div_ceil(TILE) * TILE_CELLS;
        self.costs.clear();
        self.costs.resize(cells, OBSTACLE);
        for (row, costs) in map.costs().chunks_exact(width.max(1)).enumerate().skip(1).take(height.saturating_sub(2)) {
            for (tile, costs) in costs.chunks(TILE).enumerate() {
                let start = self.tiles.place(tile * TILE, row);
                if let Some(cells) = self.costs.get_mut(start..start + costs.len()) {
                    cells.copy_from_slice(costs);
                }
            }
            for end in [0, width - 1] {
                if let Some(cost) = self.costs.get_mut(self.tiles.place(end, row)) {
                    *cost = OBSTACLE;
                }
            }
        }
        self.potentials.clear();
        self.potentials.resize(cells, UNREACHED);
        for list in [&mut self.now, &mut self.next, &mut self.over] {
            list.clear(cells);
        }
    }

    fn run(&mut self, costs: &[f32; 256], bent: &impl Bent, goal: usize, mut threshold: f32, cycles: usize) {
        for _ in 0..cycles {
            if self.now.len == 0 {
                return;
            }
            let Self { costs: cells, potentials, now, next, over, tiles, .. } = self;
            let floor = Floor { cells: cells.as_slice(), costs, tiles: *tiles };
            for place in now.waiting() {
                update(&floor, potentials, (next, over), *place as usize, threshold, bent);
            }
            now.len = 0;
            std::mem::swap(now, next);
            if now.len == 0 {
                threshold += RISE;
                std::mem::swap(now, over);
            }
            if self.potentials.get(goal).is_some_and(|potential| potential.abs() < UNREACHED) {
                return;
            }
        }
    }

    pub(super) fn is_reached(&self, column: usize, row: usize) -> bool {
        self.potential(column, row).is_some()
    }

    pub(super) fn potential(&self, column: usize, row: usize) -> Option<f32> {
        if column >= self.width || row >= self.height {
            return None;
        }
        let potential = self.potentials.get(self.tiles.place(column, row)).map(|potential| potential.abs());
        potential.filter(|potential| *potential < UNREACHED)
    }

    /// Potential of the cell at a place counted row by row; that of an unreached one outside the map.
    pub(super) fn at(&self, place: usize) -> f32 {
        let width = self.width.max(1);
        self.potential(place % width, place / width).unwrap_or(UNREACHED)
    }
}

/// What the wave spreads over.
struct Floor<'a> {
    cells: &'a [u8],
    costs: &'a [f32; 256],
    tiles: Tiles,
}

impl Floor<'_> {
    #[inline]
    fn cost(&self, place: usize) -> f32 {
        self.cells.get(place).and_then(|cell| self.costs.get(usize::from(*cell))).copied().unwrap_or(f32::INFINITY)
    }
}

/// Reckons the potential of a cell anew from its neighbors', as of a plane wave; where it sank, the neighbors are next.
#[inline]
fn update(
    floor: &Floor<'_>,
    potentials: &mut [f32],
    (next, over): (&mut List, &mut List),
    place: usize,
    threshold: f32,
    bent: &impl Bent,
) {
    let places = floor.tiles.neighbors(place);
    let waiting = places.map(|place| potentials.get(place).copied().unwrap_or(-UNREACHED));
    let [left, right, below, above] = waiting.map(f32::abs);
    let (across, up) = (left.min(right), below.min(above));
    let (apart, least) = ((across - up).abs(), across.min(up));
    let cost = floor.cost(place);
    // A quadratic fit of the plane wave's arrival time; where the wave comes along an axis, one whole cell.
    let share = apart / cost;
    let fit = -0.2301 * share * share + 0.5307 * share + 0.7040;
    let potential = least + cost * if share >= 1.0 { 1.0 } else { fit };
    let Some(here) = potentials.get_mut(place) else { return };
    let before = here.abs();
    *here = before.min(potential);
    if potential >= before {
        return;
    }
    let bent = potential + bent.left(place);
    let list = if bent < threshold { next } else { over };
    let mut wanted = [false; 4];
    for ((wanted, waiting), place) in wanted.iter_mut().zip(waiting).zip(places) {
        // Neither an obstacle nor a cell that waits is taken: the one is infinitely dear, the other below 0.
        *wanted = waiting > bent + INV_SQRT_2 * floor.cost(place);
        if let Some(neighbor) = potentials.get_mut(place) {
            *neighbor = if *wanted { -waiting } else { waiting };
        }
    }
    list.push(places, wanted);
}
