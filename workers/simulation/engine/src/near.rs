//! Who is near whom at the start of a tick.

use socrates_model::{GroupId, HumanId, Point, Vector};

use crate::human::Human;
use crate::robot::Robot;

/// Everybody whom somebody may take notice of on its way is nearer than this, m.
pub(crate) const NEAR_M: f64 = 7.0;
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
}

impl From<&Human> for Other {
    fn from(human: &Human) -> Self {
        Self {
            id: Some(human.id),
            at: human.at,
            velocity: human.velocity,
            radius_m: human.radius_m,
            group: human.group,
        }
    }
}

impl From<&Robot> for Other {
    fn from(robot: &Robot) -> Self {
        Self { id: None, at: robot.at(), velocity: robot.velocity, radius_m: robot.model.radius_m, group: None }
    }
}

/// Everybody at the start of a tick, humans first in their order, sorted into cells where they are many.
#[derive(Debug, Default)]
pub(crate) struct Near {
    others: Vec<Other>,
    low: (f64, f64),
    cell_m: f64,
    columns: usize,
    rows: usize,
    /// Everybody by cells, in the order of the list within a cell.
    sorted: Vec<Other>,
    /// Where the people of each cell begin in `sorted`; one more than there are cells.
    starts: Vec<usize>,
}

impl Near {
    /// Takes over a new moment.
    pub(crate) fn fill(&mut self, others: impl Iterator<Item = Other>) {
        self.others.clear();
        self.others.extend(others);
        if self.others.len() > FEW {
            self.sort();
        }
    }

    /// Everybody within [`NEAR_M`] of `at` but `me`: few in the order of the list, many by cells.
    pub(crate) fn around(&self, me: HumanId, at: &Point, found: &mut Vec<Other>) {
        found.clear();
        let near = |other: &Other| other.id != Some(me) && (other.at - at).norm_squared() < NEAR_M * NEAR_M;
        if self.others.len() <= FEW {
            found.extend(self.others.iter().filter(|other| near(other)));
            return;
        }
        let (column, row) = self.cell(at);
        for row in row.saturating_sub(CELLS_PER_REACH)..(row + CELLS_PER_REACH + 1).min(self.rows) {
            let from = column.saturating_sub(CELLS_PER_REACH);
            let to = (column + CELLS_PER_REACH + 1).min(self.columns);
            // The cells of a row lie one after the other, and so do the people in them.
            let start = self.starts.get(row * self.columns + from).copied().unwrap_or(0);
            let end = self.starts.get(row * self.columns + to).copied().unwrap_or(0);
            found.extend(self.sorted.get(start..end).into_iter().flatten().filter(|other| near(other)));
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
        self.cell_m = (NEAR_M / reach).max(side / MOST_CELLS);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 129")]
        let cells = |from: f64, to: f64| ((to - from).max(0.0) / self.cell_m) as usize + 1;
        (self.columns, self.rows) = (cells(low.0, high.0), cells(low.1, high.1));
        let count = self.columns * self.rows;
        let cells: Vec<usize> =
            self.others.iter().map(|other| self.cell(&other.at)).map(|(c, r)| r * self.columns + c).collect();
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
        let mut next = self.starts.clone();
        self.sorted.clone_from(&self.others);
        for (other, cell) in self.others.iter().zip(&cells) {
            let Some(slot) = next.get_mut(*cell) else { continue };
            if let Some(target) = self.sorted.get_mut(*slot) {
                *target = *other;
            }
            *slot += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            })
            .collect();
        let mut near = Near::default();
        near.fill(others.iter().copied());
        let mut found = Vec::new();
        for (me, other) in others.iter().enumerate() {
            near.around(other.id.unwrap(), &other.at, &mut found);
            let want: Vec<Option<HumanId>> = others
                .iter()
                .enumerate()
                .filter(|(place, o)| *place != me && (o.at - other.at).norm() < NEAR_M)
                .map(|(_, o)| o.id)
                .collect();
            let mut found: Vec<Option<HumanId>> = found.iter().map(|o| o.id).collect();
            found.sort_unstable();
            assert_eq!(found, want);
        }
    }
}
