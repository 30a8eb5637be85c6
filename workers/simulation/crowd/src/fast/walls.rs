//! Walls near a place, without looking at all of them.

use nalgebra::Point2;

use crate::obstacle::Segment;
use crate::vector::norm;

/// Cells per range: smaller cells hold fewer walls and need more memory.
const CELLS_PER_RANGE: f64 = 2.0;
/// Smallest cell, m.
const SMALLEST_CELL_M: f64 = 0.5;
/// At most so many cells along a side; cells of larger floors grow.
const MOST_CELLS_PER_SIDE: f64 = 256.0;
/// Beyond this coordinate, m, rounding would blur the cells: then one cell holds all walls.
const FARTHEST_M: f64 = 1e6;
/// Covers the rounding of distances up to there, m.
const SLACK_M: f64 = 1e-6;

/// Wall segments sorted into a grid, for one range. Gives the same points in the same order as
/// [`crate::points_in_range`].
#[derive(Debug, Clone)]
pub struct WallIndex {
    segments: Vec<Segment>,
    range_m: f64,
    left: f64,
    bottom: f64,
    cell_m: f64,
    columns: usize,
    rows: usize,
    /// Where the list of each cell begins in `lists`; one more entry for the end.
    starts: Vec<u32>,
    /// Places of segments, ascending in every cell.
    lists: Vec<u32>,
}

impl WallIndex {
    /// An index of `segments` that are felt within `range_m`. A segment whose ends are not finite is
    /// never felt, nor is any if the range is not a number.
    #[must_use]
    pub fn new(segments: &[Segment], range_m: f64) -> Self {
        let mut index = Self {
            segments: segments.to_vec(),
            range_m,
            left: f64::NEG_INFINITY,
            bottom: f64::NEG_INFINITY,
            cell_m: f64::INFINITY,
            columns: 1,
            rows: 1,
            starts: Vec::new(),
            lists: Vec::new(),
        };
        index.lay_out();
        index.fill();
        index
    }

    /// The walls, in the order given.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The range, m.
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.range_m
    }

    /// Every segment within the range of `position`, in the order given; some more may be among them.
    pub fn around(&self, position: &Point2<f64>) -> impl Iterator<Item = &Segment> + use<'_> {
        self.near(position).iter().filter_map(|place| self.segments.get(*place as usize))
    }

    /// The closest point of every segment within the range of `position`, in the order of the segments.
    pub fn points(&self, position: Point2<f64>) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.around(&position)
            .map(move |segment| segment.closest(&position))
            .filter(move |point| norm(&(position - point)) <= self.range_m)
    }

    /// Places of the segments that may be in range.
    fn near(&self, position: &Point2<f64>) -> &[u32] {
        if self.columns * self.rows == 1 {
            return &self.lists;
        }
        let (column, row) = ((position.x - self.left) / self.cell_m, (position.y - self.bottom) / self.cell_m);
        if !(column >= 0.0 && row >= 0.0) {
            return &[];
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative; a cast keeps to the range"
        )]
        let (column, row) = (column as usize, row as usize);
        if column >= self.columns || row >= self.rows {
            return &[];
        }
        let cell = row * self.columns + column;
        let at = |cell: usize| self.starts.get(cell).map_or(0, |start| *start as usize);
        self.lists.get(at(cell)..at(cell + 1)).unwrap_or_default()
    }

    /// Chooses the grid: around all walls and as far as they are felt.
    fn lay_out(&mut self) {
        let ends = || self.segments.iter().flat_map(|segment| [segment.from, segment.to]);
        let size = ends().fold(self.range_m.abs(), |size, end| size.max(end.x.abs()).max(end.y.abs()));
        let finite = self.range_m.is_finite() && ends().all(|end| (end.x + end.y).is_finite());
        if self.segments.is_empty() || !finite || size >= FARTHEST_M {
            return;
        }
        let margin = self.range_m + SLACK_M;
        let low = ends().fold(Point2::new(size, size), |low, end| Point2::new(low.x.min(end.x), low.y.min(end.y)));
        let high =
            ends().fold(Point2::new(-size, -size), |high, end| Point2::new(high.x.max(end.x), high.y.max(end.y)));
        self.left = low.x - margin;
        self.bottom = low.y - margin;
        let (across, up) = (high.x + margin - self.left, high.y + margin - self.bottom);
        let smallest = SMALLEST_CELL_M.max(self.range_m / CELLS_PER_RANGE);
        self.cell_m = smallest.max(across / MOST_CELLS_PER_SIDE).max(up / MOST_CELLS_PER_SIDE);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most a few hundred")]
        let cells = |side: f64| (side / self.cell_m) as usize + 1;
        (self.columns, self.rows) = (cells(across), cells(up));
    }

    /// Puts every segment into the cells from which it may be felt.
    fn fill(&mut self) {
        let segments = (0_u32..).zip(&self.segments);
        if self.columns * self.rows == 1 {
            self.lists = segments.map(|(place, _)| place).collect();
            return;
        }
        let mut of_cell = vec![Vec::new(); self.columns * self.rows];
        for (place, segment) in segments {
            for cell in self.cells_of(segment) {
                if let Some(list) = of_cell.get_mut(cell) {
                    list.push(place);
                }
            }
        }
        self.starts.push(0);
        for list in of_cell {
            self.lists.extend(list);
            self.starts.push(u32::try_from(self.lists.len()).unwrap_or(u32::MAX));
        }
    }

    /// Cells that have a place within the range of a segment; some more may be among them.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "grid places are small and not negative; a cast keeps to the range"
    )]
    fn cells_of(&self, segment: &Segment) -> Vec<usize> {
        let margin = self.range_m + SLACK_M;
        let span = |a: f64, b: f64, low: f64, count: usize| {
            let place = |at: f64| ((at - low) / self.cell_m) as usize;
            place(a.min(b) - margin)..=place(a.max(b) + margin).min(count - 1)
        };
        let reach = margin + self.cell_m * std::f64::consts::FRAC_1_SQRT_2;
        let mut cells = Vec::new();
        for row in span(segment.from.y, segment.to.y, self.bottom, self.rows) {
            for column in span(segment.from.x, segment.to.x, self.left, self.columns) {
                let center = Point2::new(
                    self.left + (column as f64 + 0.5) * self.cell_m,
                    self.bottom + (row as f64 + 0.5) * self.cell_m,
                );
                if norm(&(center - segment.closest(&center))) <= reach {
                    cells.push(row * self.columns + column);
                }
            }
        }
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::{SplitMix64, cross};
    use crate::obstacle::points_in_range;

    fn same_as_brute_force(segments: &[Segment], range_m: f64, places: impl Iterator<Item = Point2<f64>>) {
        let index = WallIndex::new(segments, range_m);
        for place in places {
            let found: Vec<Point2<f64>> = index.points(place).collect();
            assert_eq!(found, points_in_range(&place, segments, range_m), "{place}");
        }
    }

    #[test]
    fn the_index_gives_what_looking_at_all_walls_gives() {
        let mut random = SplitMix64::new(5);
        for (count, size, length) in [(1, 5.0, 3.0), (40, 60.0, 8.0), (300, 100.0, 60.0), (60, 3e4, 20.0)] {
            let mut number = |size: f64| (random.next_f64() - 0.5) * size;
            let mut segments: Vec<Segment> = (0..count)
                .map(|_| {
                    let from = Point2::new(number(size), number(size));
                    Segment { from, to: Point2::new(from.x + number(length), from.y + number(length)) }
                })
                .collect();
            // A point, walls along the axes, and the same wall twice.
            let first = segments[0];
            segments.push(Segment { to: first.from, ..first });
            segments.push(Segment { from: Point2::new(-size / 2.0, 1.0), to: Point2::new(size / 2.0, 1.0) });
            segments.push(first);
            let places: Vec<Point2<f64>> = (0..2000)
                .map(|place| match place % 3 {
                    0 => segments[place % segments.len()].from + nalgebra::Vector2::new(number(7.0), number(7.0)),
                    _ => Point2::new(number(size * 1.3), number(size * 1.3)),
                })
                .collect();
            for range_m in [0.0, 0.3, 3.0, 40.0] {
                same_as_brute_force(&segments, range_m, places.iter().copied());
            }
        }
    }

    #[test]
    fn the_crossing_floor_is_indexed_rightly() {
        let floor = cross(1000);
        same_as_brute_force(&floor.walls, 3.0, floor.walkers.iter().map(|walker| walker.person.position));
    }

    #[test]
    fn walls_and_places_beyond_all_measure_are_no_harm() {
        let wall = |x: f64| Segment { from: Point2::new(x, 0.0), to: Point2::new(x + 1.0, 2.0) };
        let places =
            || [0.0, 1.5, -4.0, 1e5, 1e9, 1e300, f64::INFINITY, f64::NAN].into_iter().map(|x| Point2::new(x, 0.5));
        same_as_brute_force(&[], 3.0, places());
        for strange in [1e5, 1e9, 1e200, f64::MAX, f64::INFINITY, f64::NAN] {
            same_as_brute_force(&[wall(0.0), wall(strange)], 3.0, places());
        }
        same_as_brute_force(&[wall(0.0)], f64::NAN, places());
        same_as_brute_force(&[wall(0.0)], f64::INFINITY, places());
    }
}
