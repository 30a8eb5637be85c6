//! The wave of potentials that spreads from the robot over the map.

use super::NavFnParams;
use crate::costmap::{Costmap, INSCRIBED, UNKNOWN};

/// Cost of a free cell.
pub(super) const NEUTRAL: f32 = 50.0;
/// Cost of a cell grows so much for each unit of the costmap.
const FACTOR: f64 = 0.8;
/// Costs from here on are obstacles.
const OBSTACLE: u8 = 254;
/// Cost of the dearest cell that a way may lead through, and of unknown ones.
const DEAREST: u8 = 253;
/// Potential of a cell that was not reached.
pub(super) const UNREACHED: f32 = 1e10;
/// The threshold between this round and later ones rises by so much.
const RISE: f32 = 2.0 * NEUTRAL;
/// 1 / sqrt 2.
const INV_SQRT_2: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// One cell: all that an update reads of it, side by side.
#[derive(Debug, Clone, Copy)]
struct Cell {
    potential: f32,
    cost: u8,
    pending: bool,
}

const OUTSIDE: Cell = Cell { potential: UNREACHED, cost: OBSTACLE, pending: true };

/// Potentials over a map.
#[derive(Debug, Default)]
pub(super) struct Wave {
    pub(super) width: usize,
    pub(super) height: usize,
    cells: Vec<Cell>,
    now: Vec<u32>,
    next: Vec<u32>,
    over: Vec<u32>,
}

/// The planner's cost of each cost of a costmap: 50 + 0.8 c up to 253, obstacles 254.
fn costs(allow_unknown: bool) -> [u8; 256] {
    std::array::from_fn(|cost| {
        let cost = u8::try_from(cost).unwrap_or(UNKNOWN);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 50 and 253")]
        let dear = (f64::from(NEUTRAL) + FACTOR * f64::from(cost)).min(f64::from(DEAREST)) as u8;
        if cost < INSCRIBED {
            dear
        } else if cost == UNKNOWN && allow_unknown {
            DEAREST
        } else {
            OBSTACLE
        }
    })
}

/// What the wave is bent by: the way that is left to the goal, or nothing.
trait Bent {
    fn left(&self, place: usize, width: usize) -> f32;
}

/// Dijkstra.
struct Evenly;

impl Bent for Evenly {
    fn left(&self, _place: usize, _width: usize) -> f32 {
        0.0
    }
}

/// A*: the straight way to a cell over free floor.
struct Towards(f32, f32);

impl Towards {
    fn from(&self, x: f32, y: f32) -> f32 {
        let (across, up) = (x - self.0, y - self.1);
        NEUTRAL * (across * across + up * up).sqrt()
    }
}

impl Bent for Towards {
    fn left(&self, place: usize, width: usize) -> f32 {
        // 32 bits divide faster than 64.
        let (place, width) = (place as u32, width as u32);
        self.from((place % width) as f32, (place / width) as f32)
    }
}

impl Wave {
    /// Spreads from the robot until the goal is reached.
    pub(super) fn spread(&mut self, map: &Costmap, from: (usize, usize), to: (usize, usize), params: &NavFnParams) {
        self.load(map, params.allow_unknown);
        (self.width, self.height) = (map.width(), map.height());
        let place = |(column, row): (usize, usize)| row * map.width() + column;
        let (start, goal) = (place(from), place(to));
        if let Some(cell) = self.cells.get_mut(start) {
            cell.potential = 0.0;
        }
        for list in [&mut self.now, &mut self.next, &mut self.over] {
            list.clear();
        }
        let width = self.width;
        for near in [start.wrapping_add(1), start.wrapping_sub(1), start.wrapping_sub(width), start + width] {
            push(&mut self.cells, &mut self.now, near);
        }
        let cycles = (map.width() * map.height() / 20).max(map.width() + map.height());
        let threshold = f32::from(OBSTACLE);
        if params.use_astar {
            let towards = Towards(to.0 as f32, to.1 as f32);
            let threshold = threshold + towards.from(from.0 as f32, from.1 as f32);
            self.run(&towards, goal, threshold, cycles);
        } else {
            self.run(&Evenly, goal, threshold, cycles);
        }
    }

    /// Takes over the costs; the border is an obstacle.
    fn load(&mut self, map: &Costmap, allow_unknown: bool) {
        let costs = costs(allow_unknown);
        let cell = |cost: &u8| {
            let cost = costs.get(usize::from(*cost)).copied().unwrap_or(OBSTACLE);
            Cell { potential: UNREACHED, cost, pending: false }
        };
        self.cells.clear();
        self.cells.extend(map.costs().iter().map(cell));
        let width = map.width().max(1);
        let mut rows = self.cells.chunks_exact_mut(width);
        for row in [rows.next(), rows.next_back()].into_iter().flatten() {
            row.iter_mut().for_each(|cell| cell.cost = OBSTACLE);
        }
        for row in rows {
            for end in [0, width - 1] {
                if let Some(cell) = row.get_mut(end) {
                    cell.cost = OBSTACLE;
                }
            }
        }
    }

    fn run(&mut self, bent: &impl Bent, goal: usize, mut threshold: f32, cycles: usize) {
        for _ in 0..cycles {
            if self.now.is_empty() && self.next.is_empty() {
                return;
            }
            let Self { cells, now, next, over, width, .. } = self;
            for place in now.iter() {
                if let Some(cell) = cells.get_mut(*place as usize) {
                    cell.pending = false;
                }
            }
            for place in now.iter() {
                update(cells, next, over, *place as usize, *width, threshold, bent);
            }
            now.clear();
            std::mem::swap(now, next);
            if now.is_empty() {
                threshold += RISE;
                std::mem::swap(now, over);
            }
            if self.cells.get(goal).is_some_and(|cell| cell.potential < UNREACHED) {
                return;
            }
        }
    }

    pub(super) fn is_reached(&self, column: usize, row: usize) -> bool {
        self.potential(column, row).is_some()
    }

    pub(super) fn potential(&self, column: usize, row: usize) -> Option<f32> {
        let potential = (column < self.width).then(|| self.at(row * self.width + column))?;
        (potential < UNREACHED).then_some(potential)
    }

    /// Potential of a cell by its place; that of an unreached one outside the map.
    pub(super) fn at(&self, place: usize) -> f32 {
        self.cells.get(place).map_or(UNREACHED, |cell| cell.potential)
    }

    /// Whether ways may not lead through a cell.
    #[cfg(test)]
    pub(super) fn is_obstacle(&self, place: usize) -> bool {
        self.cells.get(place).is_none_or(|cell| cell.cost >= OBSTACLE)
    }
}

fn push(cells: &mut [Cell], list: &mut Vec<u32>, place: usize) {
    if let Some(cell) = cells.get_mut(place)
        && !cell.pending
        && cell.cost < OBSTACLE
    {
        cell.pending = true;
        list.push(place as u32);
    }
}

/// Reckons the potential of a cell anew from its neighbors', as of a plane wave; where it sank, the neighbors are next.
#[inline]
fn update(
    cells: &mut [Cell],
    next: &mut Vec<u32>,
    over: &mut Vec<u32>,
    place: usize,
    width: usize,
    threshold: f32,
    bent: &impl Bent,
) {
    let of = |place: usize| cells.get(place).copied().unwrap_or(OUTSIDE);
    let here = of(place);
    if here.cost >= OBSTACLE {
        return;
    }
    let (left, right) = (of(place.wrapping_sub(1)), of(place + 1));
    let (below, above) = (of(place.wrapping_sub(width)), of(place + width));
    let across = left.potential.min(right.potential);
    let up = below.potential.min(above.potential);
    let apart = (across - up).abs();
    let least = across.min(up);
    let cost = f32::from(here.cost);
    let potential = if apart >= cost {
        least + cost
    } else {
        // A quadratic fit of the plane wave's arrival time.
        let share = apart / cost;
        least + cost * (-0.2301 * share * share + 0.5307 * share + 0.7040)
    };
    if potential >= here.potential {
        return;
    }
    if let Some(cell) = cells.get_mut(place) {
        cell.potential = potential;
    }
    let bent = potential + bent.left(place, width);
    let list = if bent < threshold { next } else { over };
    let neighbors =
        [(left, place.wrapping_sub(1)), (right, place + 1), (below, place.wrapping_sub(width)), (above, place + width)];
    for (neighbor, place) in neighbors {
        if neighbor.potential > bent + INV_SQRT_2 * f32::from(neighbor.cost) && !neighbor.pending {
            push(cells, list, place);
        }
    }
}
