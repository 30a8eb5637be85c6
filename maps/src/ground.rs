//! What is computed of a grid once per process, for everybody who asks about the same grid.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use socrates_model::{Cell, Grid, Point};

use crate::field::DistanceField;
use crate::geodesic::Geodesic;
use crate::sight::Sight;

/// Grids that are kept at most: a library is made on a few locations.
const MAX_GRIDS: usize = 4;
/// Cells of the kept grids together, the newest not counted; what is computed of a cell takes about 40 bytes.
const MAX_CELLS: usize = 4_000_000;
/// Cells of the kept walking distances of one grid together, the newest not counted; 8 bytes each.
const MAX_WALKED: usize = 500_000;

/// Values of grids, kept by the content of the grid: those of the last few grids that were asked for.
///
/// The value is made while others wait, so it should make what is dear only when it is asked for it.
#[derive(Debug)]
pub struct Kept<T> {
    /// The newest last.
    shelf: Mutex<VecDeque<(Arc<Grid>, Arc<T>)>>,
}

impl<T> Kept<T> {
    /// Nothing kept yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { shelf: Mutex::new(VecDeque::new()) }
    }

    /// The value of a grid, made where there is none.
    pub fn of(&self, grid: &Grid, make: impl FnOnce(&Arc<Grid>) -> T) -> Arc<T> {
        // Entries are whole at any time.
        let mut shelf = self.shelf.lock().unwrap_or_else(PoisonError::into_inner);
        let at = shelf.iter().position(|(kept, _)| same(kept, grid));
        let entry = at.and_then(|at| shelf.remove(at)).unwrap_or_else(|| {
            let own = Arc::new(grid.clone());
            let value = Arc::new(make(&own));
            (own, value)
        });
        let value = Arc::clone(&entry.1);
        let older =
            |shelf: &VecDeque<(Arc<Grid>, Arc<T>)>| shelf.iter().map(|(grid, _)| grid.cells.len()).sum::<usize>();
        while shelf.len() >= MAX_GRIDS || !shelf.is_empty() && older(&shelf) > MAX_CELLS {
            shelf.pop_front();
        }
        shelf.push_back(entry);
        value
    }
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Whether two grids are the same to the last bit and cell.
fn same(a: &Grid, b: &Grid) -> bool {
    let frame = |grid: &Grid| {
        let origin = [grid.origin.x, grid.origin.y, grid.origin.yaw, grid.resolution_m];
        (grid.width, grid.height, grid.cells.len(), origin.map(f64::to_bits))
    };
    // Chunk by chunk without a look at each result, which the compiler does with wide registers.
    let alike = |a: &[Cell], b: &[Cell]| a.iter().zip(b).fold(true, |all, (a, b)| all & (a == b));
    frame(a) == frame(b) && a.cells.chunks(4096).zip(b.cells.chunks(4096)).all(|(a, b)| alike(a, b))
}

/// Distances, ways and sight over one grid, each computed when somebody first asks.
#[derive(Debug)]
pub struct Ground {
    grid: Arc<Grid>,
    field: OnceLock<Arc<DistanceField>>,
    sight: OnceLock<Sight>,
    /// Walking distances by goal and radius, the newest last.
    walked: Mutex<VecDeque<([u64; 3], Arc<Geodesic>)>>,
}

static GROUNDS: Kept<Ground> = Kept::new();

impl Ground {
    /// The ground of a grid; the same one for every grid of the same content, as long as it is kept.
    #[must_use]
    pub fn of(grid: &Grid) -> Arc<Self> {
        GROUNDS.of(grid, |grid| Self::new(Arc::clone(grid)))
    }

    /// A ground of its own, kept by nobody else.
    #[must_use]
    pub const fn new(grid: Arc<Grid>) -> Self {
        Self { grid, field: OnceLock::new(), sight: OnceLock::new(), walked: Mutex::new(VecDeque::new()) }
    }

    /// The grid.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Distance to the nearest wall.
    #[must_use]
    pub fn field(&self) -> &Arc<DistanceField> {
        self.field.get_or_init(|| Arc::new(DistanceField::new(&self.grid)))
    }

    /// Lines of sight.
    #[must_use]
    pub fn sight(&self) -> &Sight {
        self.sight.get_or_init(|| Sight::new(&self.grid))
    }

    /// Walking distances of a disc of `radius_m` to a goal; those of the last few goals are kept.
    #[must_use]
    pub fn geodesic(&self, goal: &Point, radius_m: f64) -> Arc<Geodesic> {
        let key = [goal.x, goal.y, radius_m].map(f64::to_bits);
        let lock = || self.walked.lock().unwrap_or_else(PoisonError::into_inner);
        let take = |shelf: &mut VecDeque<([u64; 3], Arc<Geodesic>)>| {
            let at = shelf.iter().position(|(kept, _)| *kept == key)?;
            shelf.remove(at)
        };
        let known = take(&mut lock());
        // Not under the lock: others have other goals.
        let entry = known.unwrap_or_else(|| (key, Arc::new(Geodesic::to(self.field(), goal, radius_m))));
        let made = Arc::clone(&entry.1);
        let mut shelf = lock();
        let twice = take(&mut shelf);
        drop(twice);
        let most = MAX_WALKED / self.grid.cells.len().max(1);
        while shelf.len() > most {
            shelf.pop_front();
        }
        shelf.push_back(entry);
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::grid;

    const ROOM: [&str; 5] = ["######", "#....#", "#.#..#", "#....#", "######"];

    #[test]
    fn grids_of_the_same_content_share_what_is_computed_and_others_do_not() {
        static COUNTS: Kept<usize> = Kept::new();
        let one = grid(&ROOM);
        let free = |grid: &Arc<Grid>| grid.cells.iter().filter(|cell| **cell == Cell::Free).count();
        let first = COUNTS.of(&one, free);
        assert!(*first == 11 && Arc::ptr_eq(&first, &COUNTS.of(&one.clone(), free)));
        // One cell, the frame or the size: another grid.
        let mut other = one.clone();
        other.cells[14] = Cell::Free;
        assert_eq!(*COUNTS.of(&other, free), 12);
        let mut moved = one.clone();
        moved.origin.yaw = 1e-9;
        assert!(!Arc::ptr_eq(&first, &COUNTS.of(&moved, free)));
        assert!(Arc::ptr_eq(&first, &COUNTS.of(&one, free)));
    }

    #[test]
    fn only_the_last_few_grids_are_kept() {
        let kept: Kept<()> = Kept::new();
        let mut one = grid(&ROOM);
        let made = std::cell::Cell::new(0);
        let mut ask = |resolution_m: f64| {
            one.resolution_m = resolution_m;
            kept.of(&one, |_| made.set(made.get() + 1));
            made.get()
        };
        assert_eq!([0.1, 0.2, 0.3, 0.4].map(&mut ask), [1, 2, 3, 4]);
        // The oldest is the one that was not asked for the longest.
        assert_eq!([0.1, 0.5, 0.1, 0.3, 0.2].map(&mut ask), [4, 5, 5, 5, 6]);
        assert_eq!(kept.shelf.lock().unwrap().len(), MAX_GRIDS);
    }

    #[test]
    fn large_grids_are_not_piled_up() {
        let kept: Kept<()> = Kept::new();
        let side = 2001;
        for resolution_m in [0.1, 0.2, 0.3] {
            let cells = vec![Cell::Free; side * side];
            let origin = socrates_model::Pose::new(0.0, 0.0, 0.0);
            kept.of(&Grid { width: side, height: side, resolution_m, origin, cells }, |_| ());
        }
        assert_eq!(kept.shelf.lock().unwrap().len(), 1);
    }

    #[test]
    fn the_ground_says_what_its_parts_say_when_they_are_made_anew() {
        let one = grid(&ROOM);
        let ground = Ground::of(&one);
        let (field, sight) = (DistanceField::new(&one), Sight::new(&one));
        let goal = Point::new(2.2, 1.9);
        for place in 0..400_u32 {
            let at = Point::new(f64::from(place % 20) * 0.15, f64::from(place / 20) * 0.125);
            assert_eq!(ground.field().clearance(&at).to_bits(), field.clearance(&at).to_bits());
            assert_eq!(ground.sight().clear(&at, &goal), sight.clear(&at, &goal));
            for radius_m in [0.1, 0.2] {
                let anew = Geodesic::to(&field, &goal, radius_m).distance(&at);
                assert_eq!(ground.geodesic(&goal, radius_m).distance(&at).map(f64::to_bits), anew.map(f64::to_bits));
            }
        }
        assert!(Arc::ptr_eq(&ground.geodesic(&goal, 0.1), &ground.geodesic(&goal, 0.1)));
        assert_eq!(ground.walked.lock().unwrap().len(), 2);
    }
}
