//! Who is near whom at the start of a tick, and what each person has noticed of it.

use socrates_model::{GroupId, HumanId, Point, Vector};

use crate::floor::Floor;
use crate::human::Human;
use crate::models::Walks;
use crate::robot::Robot;

/// Everybody whom somebody may take notice of on its way is nearer than this, m.
pub(crate) const NEAR_M: f64 = 7.0;
/// A look round is taken every so many ticks, each person at its own: 20 times a second. What was seen then is
/// followed with its present place and velocity in between.
const LOOK_TICKS: u64 = 5;
/// How much nearer two can come, or somebody a wall, between two looks, m: 0.05 s at twice the speed of a run.
const BETWEEN_M: f64 = 0.2;
/// Nobody is touched soon who is farther away, m.
pub(crate) const CLOSE_M: f64 = 3.0;
/// Others farther away are not felt, m.
pub(crate) const FEEL_M: f64 = 5.0;
/// Where no wall is nearer than this none is felt, m: their reach and the blur of the distance field.
const WALLS_M: f64 = 3.2;
/// Nobody is carried farther than this towards a wall between two looks, neither by its feet nor by others, m.
const CARRIED_M: f64 = 0.7;
/// Up to so many everybody is looked at; more are sorted into cells first.
const FEW: usize = 64;
/// Cells that [`NEAR_M`] spans.
const CELLS_PER_REACH: usize = 2;
/// Most cells along a side: a very large floor gets larger cells.
const MOST_CELLS: f64 = 128.0;

/// Somebody else as a walker sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Other {
    /// `None` is the robot.
    pub(crate) id: Option<HumanId>,
    pub(crate) at: Point,
    pub(crate) velocity: Vector,
    pub(crate) radius_m: f64,
    pub(crate) group: Option<GroupId>,
    /// Whether the one who looks sees it, where it is near enough to be felt.
    pub(crate) seen: bool,
}

/// Somebody who was noticed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Noticed {
    /// Place in the list of everybody.
    place: usize,
    /// Whether it was in line of sight.
    seen: bool,
}

impl Noticed {
    const fn at(place: usize) -> Self {
        Self { place, seen: false }
    }
}

/// What somebody has noticed at its last look round.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notice {
    /// Whoever is near: the close ones first.
    near: Vec<Noticed>,
    /// How many of them are close.
    pub(crate) close: usize,
    /// Social force of those who are not close, m/s², kept until the next look: it hardly changes in that time.
    pub(crate) far: Option<Vector>,
    /// Wall points that are felt.
    pub(crate) walls: Vec<Point>,
    /// How far it means to go aside for whoever is in its way, m to the left.
    pub(crate) aside_m: f64,
    /// Share of that which the floor allows.
    pub(crate) share: f64,
    /// Whether its walking group has no room to walk abreast here.
    pub(crate) in_line: bool,
    /// Whether it and the robot are in line of sight, once that was asked since the last look.
    pub(crate) robot_seen: Option<bool>,
    /// Whether nothing stands between it and the next point of its way.
    pub(crate) straight: bool,
    /// Whether it stood so far from every wall that it touches none before its next look.
    pub(crate) clear: bool,
    /// Whether it does something else than at its last look, and has to look anew.
    pub(crate) stale: bool,
}

impl From<&Human> for Other {
    fn from(human: &Human) -> Self {
        Self {
            id: Some(human.id),
            at: human.at,
            velocity: human.velocity,
            radius_m: human.radius_m,
            group: human.group,
            seen: false,
        }
    }
}

impl From<&Robot> for Other {
    fn from(robot: &Robot) -> Self {
        Self {
            id: None,
            at: robot.at(),
            velocity: robot.velocity,
            radius_m: robot.model.radius_m,
            group: None,
            seen: false,
        }
    }
}

/// Everybody at the start of a tick, humans first in their order, sorted into cells where they are many.
#[derive(Debug, Default)]
pub(crate) struct Near {
    others: Vec<Other>,
    /// Room for the next moment.
    next: Vec<Other>,
    /// Where they are, close together in memory: most are too far away to be asked anything else.
    spots: Vec<Point>,
    low: (f64, f64),
    cell_m: f64,
    columns: usize,
    rows: usize,
    /// Places in the list by cells, in the order of the list within a cell, each with where that is.
    sorted: Vec<(usize, Point)>,
    /// Cell of everybody, in the order of the list, and where the next one of a cell goes.
    cells: Vec<usize>,
    slots: Vec<usize>,
    /// Where the people of each cell begin in `sorted`; one more than there are cells.
    starts: Vec<usize>,
}

impl Near {
    /// Takes over a new moment. Says whether others are there than before: then everybody has to look anew.
    pub(crate) fn fill(&mut self, others: impl Iterator<Item = Other>) -> bool {
        let mut before = 0;
        let mut same = true;
        let mut next = std::mem::take(&mut self.next);
        next.clear();
        for other in others {
            same &= self.others.get(before).is_some_and(|known| known.id == other.id);
            before += 1;
            next.push(other);
        }
        same &= before == self.others.len();
        self.next = std::mem::replace(&mut self.others, next);
        self.spots.clear();
        self.spots.extend(self.others.iter().map(|other| other.at));
        if self.others.len() > FEW {
            self.sort();
        }
        !same
    }

    /// Whether it is the turn of the person at this place to look round.
    pub(crate) fn is_turn(tick: u64, place: usize) -> bool {
        (tick + place as u64).is_multiple_of(LOOK_TICKS)
    }

    /// A look round: who is near, who of them is in line of sight, which walls are felt.
    pub(crate) fn look(&self, human: &mut Human, floor: &Floor) {
        let mut near = std::mem::take(&mut human.notice.near);
        self.around(human.id, &human.at, &mut near);
        // Most of those who are felt are within open floor: no line has to be drawn to them.
        let clearance_m = floor.clearance_m(&human.at);
        let open_m = floor.open_of(clearance_m);
        let felt_m = if matches!(human.walks, Walks::Orca(_)) { NEAR_M } else { FEEL_M } + BETWEEN_M;
        let mut close = 0;
        for number in 0..near.len() {
            let Some(noticed) = near.get_mut(number) else { break };
            let Some(other) = self.others.get(noticed.place) else { continue };
            let apart_2 = (other.at - human.at).norm_squared();
            noticed.seen = apart_2 < felt_m * felt_m
                && (open_m > 0.0 && apart_2 < open_m * open_m || floor.sees(&human.at, &other.at));
            if apart_2 < (CLOSE_M + BETWEEN_M) * (CLOSE_M + BETWEEN_M) {
                near.swap(close, number);
                close += 1;
            }
        }
        human.notice.close = close;
        human.notice.near = near;
        human.notice.far = None;
        human.notice.robot_seen = None;
        human.notice.walls = if clearance_m > WALLS_M + BETWEEN_M { Vec::new() } else { floor.felt(&human.at) };
        human.notice.clear = clearance_m > human.radius_m + CARRIED_M;
        human.notice.stale = false;
    }

    /// Whom somebody has noticed, as they are now.
    pub(crate) fn noticed(&self, notice: &Notice, found: &mut Vec<Other>) {
        found.clear();
        let now = |noticed: &Noticed| Some(Other { seen: noticed.seen, ..*self.others.get(noticed.place)? });
        found.extend(notice.near.iter().filter_map(now));
    }

    /// The close ones of those whom somebody has noticed, as they are now; whether it sees them.
    pub(crate) fn close<'a>(&'a self, notice: &'a Notice) -> impl Iterator<Item = (&'a Other, bool)> {
        self.of(notice.near.get(..notice.close).unwrap_or(&[]))
    }

    /// The others of those whom somebody has noticed.
    pub(crate) fn far<'a>(&'a self, notice: &'a Notice) -> impl Iterator<Item = (&'a Other, bool)> {
        self.of(notice.near.get(notice.close..).unwrap_or(&[]))
    }

    fn of<'a>(&'a self, noticed: &'a [Noticed]) -> impl Iterator<Item = (&'a Other, bool)> {
        noticed.iter().filter_map(|noticed| Some((self.others.get(noticed.place)?, noticed.seen)))
    }

    /// Everybody within [`NEAR_M`] of `at` but `me`.
    fn around(&self, me: HumanId, at: &Point, found: &mut Vec<Noticed>) {
        found.clear();
        let reach = NEAR_M + BETWEEN_M;
        let near = |spot: &Point| (spot - at).norm_squared() < reach * reach;
        let other = |place: &usize| self.others.get(*place).is_some_and(|other| other.id != Some(me));
        if self.others.len() <= FEW {
            let places = self.spots.iter().enumerate().filter(|(_, spot)| near(spot)).map(|(place, _)| place);
            found.extend(places.filter(other).map(Noticed::at));
            return;
        }
        let (column, row) = self.cell(at);
        for row in row.saturating_sub(CELLS_PER_REACH)..(row + CELLS_PER_REACH + 1).min(self.rows) {
            let from = column.saturating_sub(CELLS_PER_REACH);
            let to = (column + CELLS_PER_REACH + 1).min(self.columns);
            // The cells of a row lie one after the other, and so do the people in them.
            let start = self.starts.get(row * self.columns + from).copied().unwrap_or(0);
            let end = self.starts.get(row * self.columns + to).copied().unwrap_or(0);
            let places = self.sorted.get(start..end).into_iter().flatten().filter(|(_, spot)| near(spot));
            found.extend(places.map(|(place, _)| *place).filter(other).map(Noticed::at));
        }
    }

    fn cell(&self, at: &Point) -> (usize, usize) {
        let along = |value: f64, low: f64, cells: usize| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a cell number; below the first and no number at all are the first"
            )]
            let cell = ((value - low) / self.cell_m).max(0.0) as usize;
            cell.min(cells.saturating_sub(1))
        };
        (along(at.x, self.low.0, self.columns), along(at.y, self.low.1, self.rows))
    }

    /// Sorts everybody into cells, keeping the order within a cell.
    fn sort(&mut self) {
        let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for other in &self.others {
            low = (low.0.min(other.at.x), low.1.min(other.at.y));
            high = (high.0.max(other.at.x), high.1.max(other.at.y));
        }
        let side = (high.0 - low.0).max(high.1 - low.1).max(0.0);
        self.low = low;
        #[expect(clippy::cast_precision_loss, reason = "two")]
        let reach = CELLS_PER_REACH as f64;
        self.cell_m = ((NEAR_M + BETWEEN_M) / reach).max(side / MOST_CELLS);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 129")]
        let cells = |from: f64, to: f64| ((to - from).max(0.0) / self.cell_m) as usize + 1;
        (self.columns, self.rows) = (cells(low.0, high.0), cells(low.1, high.1));
        let count = self.columns * self.rows;
        let mut cells = std::mem::take(&mut self.cells);
        cells.clear();
        cells.extend(self.spots.iter().map(|spot| self.cell(spot)).map(|(column, row)| row * self.columns + column));
        self.starts.clear();
        self.starts.resize(count + 1, 0);
        for cell in &cells {
            if let Some(start) = self.starts.get_mut(cell + 1) {
                *start += 1;
            }
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.slots.clone_from(&self.starts);
        self.sorted.clear();
        self.sorted.resize(self.others.len(), (0, Point::origin()));
        for ((place, spot), cell) in self.spots.iter().enumerate().zip(&cells) {
            let Some(slot) = self.slots.get_mut(*cell) else { continue };
            if let Some(target) = self.sorted.get_mut(*slot) {
                *target = (place, *spot);
            }
            *slot += 1;
        }
        self.cells = cells;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_crowd::cross::SplitMix64;
    use socrates_model::{Cell, Grid};

    #[test]
    fn many_find_the_same_neighbors_as_few() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let others: Vec<Other> = (0..900_u32)
            .map(|number| Other {
                id: Some(HumanId::new(number + 1)),
                at: Point::new(80.0 * random() - 30.0, 50.0 * random()),
                velocity: Vector::zeros(),
                radius_m: 0.3,
                group: None,
                seen: false,
            })
            .collect();
        let mut near = Near::default();
        near.fill(others.iter().copied());
        let mut found = Vec::new();
        for (me, other) in others.iter().enumerate() {
            near.around(other.id.unwrap(), &other.at, &mut found);
            let want: Vec<Noticed> = others
                .iter()
                .enumerate()
                .filter(|(place, o)| *place != me && (o.at - other.at).norm() < NEAR_M + BETWEEN_M)
                .map(|(place, _)| Noticed::at(place))
                .collect();
            found.sort_unstable();
            assert_eq!(found, want);
        }
    }

    #[test]
    fn what_is_within_the_open_distance_is_seen() {
        let mut random = SplitMix64::new(21);
        let mut asked = 0;
        for (share, resolution_m) in [(0.0, 0.1), (0.002, 0.1), (0.02, 0.05), (0.002, 0.5)] {
            let size = 160;
            let cells = (0..size * size).map(|_| if random.next_f64() < share { Cell::Occupied } else { Cell::Free });
            let origin = socrates_model::Pose::new(-3.0, 2.0, 0.4);
            let grid = Grid { width: size, height: size, resolution_m, origin, cells: cells.collect() };
            let mut floor = Floor::new(&grid);
            floor.close(vec![(Point::new(-2.0, 5.0), Point::new(-1.0, 5.5))]);
            let side_m = size as f64 * resolution_m;
            for _ in 0..20_000 {
                let at = Point::new(side_m * (random.next_f64() * 1.6 - 0.6), side_m * (random.next_f64() * 1.6 - 0.3));
                let open_m = floor.open_m(&at);
                if open_m > 0.0 {
                    let (sin, cos) = libm::sincos(7.0 * random.next_f64());
                    let to = at + Vector::new(cos, sin) * (open_m * random.next_f64() * (1.0 - 1e-12));
                    assert!(floor.sees(&at, &to), "{at} {to} {open_m}");
                    asked += 1;
                }
            }
        }
        assert!(asked > 10_000, "{asked}");
    }
}
