//! Exact Euclidean distance to the nearest wall, for every point of the map.

use std::sync::OnceLock;

use socrates_model::{Cell, Grid, Point, Vector};

use crate::layer::{Layer, Raster, floor_index};
use crate::sectors::Faces;

/// Distance to the nearest cell that is not free floor (occupied, unknown, or outside the map).
///
/// Computed once per map on a lattice of half cells (corners, edges and middles), so that the distance
/// to the *surface* of a wall cell is exact there; between lattice points it is bilinear. Exact
/// transform after Meijster, Roerdink and Hesselink (2000), in whole numbers.
#[derive(Debug, Clone)]
pub struct DistanceField {
    pub(crate) raster: Raster,
    lattice: Layer<f32>,
    faces: OnceLock<Faces>,
}

impl DistanceField {
    /// The field of a grid. Costs about 5 ns for each lattice point.
    #[must_use]
    pub fn new(grid: &Grid) -> Self {
        let mut lattice = down_and_up(grid);
        let width = lattice.width.max(1);
        let (mut squared, mut envelope) = (vec![0.0; width], Vec::new());
        for row in lattice.values.chunks_exact_mut(width) {
            across(row, &mut squared, &mut envelope);
            for (to, from) in row.iter_mut().zip(&squared) {
                // A square root is rounded exactly on every machine; `libm` has the same one, as a call.
                #[expect(clippy::cast_possible_truncation, reason = "24 bits of a distance in m are enough")]
                {
                    *to = (from.sqrt() * 0.5 * grid.resolution_m) as f32;
                }
            }
        }
        Self { raster: Raster::of(grid), lattice, faces: OnceLock::new() }
    }

    /// The wall surfaces, looked for when somebody first asks.
    fn faces(&self) -> &Faces {
        self.faces.get_or_init(|| Faces::of(&self.raster, |column, row| self.clearance_of_cell(column, row) > 0.0))
    }

    /// Distance from a point to the nearest wall surface, m; 0 in walls, in unknown space and outside the map.
    #[must_use]
    pub fn clearance(&self, point: &Point) -> f64 {
        let (px, py) = self.raster.pixel(point);
        self.clearance_at_pixel(px, py)
    }

    /// The same at a continuous pixel position; (0, 0) is the top left corner of the image.
    #[must_use]
    pub fn clearance_at_pixel(&self, px: f64, py: f64) -> f64 {
        let (u, v) = (px * 2.0, py * 2.0);
        if u.is_nan() || v.is_nan() || u < 0.0 || v < 0.0 {
            return 0.0;
        }
        let (column, row) = (floor_index(u), floor_index(v));
        #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
        let (right, down) = (u - column as f64, v - row as f64);
        let pair = |row: usize| self.lattice.pair(column, row).map(f64::from);
        let ([top_left, top_right], [bottom_left, bottom_right]) = (pair(row), pair(row + 1));
        let top = top_left * (1.0 - right) + top_right * right;
        let bottom = bottom_left * (1.0 - right) + bottom_right * right;
        top * (1.0 - down) + bottom * down
    }

    /// Clearance at the middle of a cell, m; 0 outside.
    #[must_use]
    pub fn clearance_of_cell(&self, column: usize, row: usize) -> f64 {
        self.lattice.get(column.saturating_mul(2) + 1, row.saturating_mul(2) + 1).map_or(0.0, f64::from)
    }

    /// The wall that a line from a point meets, as the first point with less clearance than `wall_m`, if it does so within `reach_m`.
    /// `along` has length 1.
    #[must_use]
    pub fn to_wall(&self, from: &Point, along: &Vector, wall_m: f64, reach_m: f64) -> Option<Point> {
        let mut gone_m = 0.0;
        while gone_m <= reach_m {
            let at = from + along * gone_m;
            let clear_m = self.clearance(&at);
            if clear_m < wall_m {
                return Some(at);
            }
            // Nothing is nearer than the clearance, which is bilinear between the cells.
            gone_m += (0.8 * clear_m).max(wall_m);
        }
        None
    }

    /// The nearest wall point in each of `n` equal angular sectors within `reach_m`, in sector order.
    ///
    /// Sector 0 is centered on the map's +x direction and the others follow counter-clockwise; a sector
    /// without a wall within reach gives no point. Only surfaces that face the point count. With `n = 8`
    /// and 3 m these are the wall points of the native social forces.
    #[must_use]
    pub fn sectors(&self, point: &Point, reach_m: f64, n: usize) -> Vec<Point> {
        self.faces().sectors(&self.raster, point, reach_m, n)
    }

    /// The nearest wall point within `reach_m`, if any.
    #[must_use]
    pub fn nearest_wall(&self, point: &Point, reach_m: f64) -> Option<Point> {
        self.faces().sectors(&self.raster, point, reach_m, 1).into_iter().next()
    }
}

/// Whether a disc of this radius, m, lies wholly on free floor.
#[must_use]
pub fn free_disc(field: &DistanceField, point: &Point, radius_m: f64) -> bool {
    field.clearance(point) >= radius_m.max(f64::MIN_POSITIVE)
}

/// The nearest point to `point` where a disc of this radius fits, at most `max_m` away; the point itself where it fits.
#[must_use]
pub fn nearest_free(field: &DistanceField, point: &Point, radius_m: f64, max_m: f64) -> Option<Point> {
    if free_disc(field, point, radius_m) {
        return Some(*point);
    }
    nearest_cell(field, point, radius_m, max_m).map(|(column, row)| field.raster.center(column, row))
}

/// The nearest cell whose middle has this clearance, at most `max_m` away.
pub(crate) fn nearest_cell(field: &DistanceField, point: &Point, radius_m: f64, max_m: f64) -> Option<(usize, usize)> {
    let (px, py) = field.raster.pixel(point);
    if !px.is_finite() || !py.is_finite() {
        return None;
    }
    let radius_m = radius_m.max(f64::MIN_POSITIVE);
    let mut best: Option<(f64, (usize, usize))> = None;
    for (column, row) in field.raster.cells_around(px, py, max_m / field.raster.resolution_m) {
        if field.clearance_of_cell(column, row) < radius_m {
            continue;
        }
        let away = (field.raster.center(column, row) - point).norm();
        if away <= max_m && best.is_none_or(|(least, _)| away < least) {
            best = Some((away, (column, row)));
        }
    }
    best.map(|(_, cell)| cell)
}

/// First half of the transform: lattice distance to the nearest wall in the same lattice column.
///
/// Whole numbers; f32 holds them exactly up to 2^24, far more than a map has rows.
fn down_and_up(grid: &Grid) -> Layer<f32> {
    let (width, height) = (grid.width.saturating_mul(2) + 1, grid.height.saturating_mul(2) + 1);
    let mut layer = Layer::filled(width, height, 0.0_f32);
    let mut open = vec![false; width];
    let mut above = vec![0.0_f32; width];
    for (row, line) in layer.values.chunks_exact_mut(width).enumerate() {
        open_points(grid, row, &mut open);
        for ((value, open), before) in line.iter_mut().zip(&open).zip(above.iter_mut()) {
            *value = if *open { *before + 1.0 } else { 0.0 };
            *before = *value;
        }
    }
    let mut below = vec![0.0_f32; width];
    for line in layer.values.chunks_exact_mut(width).rev() {
        for (value, before) in line.iter_mut().zip(below.iter_mut()) {
            *value = if *before + 1.0 < *value { *before + 1.0 } else { *value };
            *before = *value;
        }
    }
    layer
}

/// Which points of a lattice row touch free cells alone.
fn open_points(grid: &Grid, row: usize, open: &mut [bool]) {
    // A lattice point with an odd coordinate is in the middle of one cell, with an even one between two.
    let (up, down) = if row % 2 == 1 { (Some(row / 2), row / 2) } else { ((row / 2).checked_sub(1), row / 2) };
    let cells = |row: usize| {
        let from = row.saturating_mul(grid.width).min(grid.cells.len());
        let to = if row < grid.height { from.saturating_add(grid.width).min(grid.cells.len()) } else { from };
        grid.cells.get(from..to).unwrap_or_default()
    };
    open.fill(false);
    let mut before = false;
    let both = up.map_or(&[][..], cells).iter().zip(cells(down));
    for (points, (up, down)) in open.chunks_exact_mut(2).zip(both) {
        let here = *up == Cell::Free && *down == Cell::Free;
        if let [border, middle] = points {
            (*border, *middle) = (before && here, here);
        }
        before = here;
    }
}

/// A parabola of the lower envelope: its lattice column, its height, the first column where it is the lowest.
type Part = (i64, i64, i64);

/// Second half: lower envelope of the parabolas of one row, as squared lattice distances.
///
/// Walls on both sides of an open stretch are nearer than whatever lies behind them, so each stretch is on its own;
/// the ends of a row are never open.
fn across(row: &[f32], squared: &mut [f64], envelope: &mut Vec<Part>) {
    squared.fill(0.0);
    let mut begin = 0;
    for stretch in row.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0)) {
        let end = begin + stretch.len();
        if stretch.first().is_some_and(|value| *value > 0.0)
            && let Some(out) = squared.get_mut(begin..end)
        {
            stretch_across(stretch, out, envelope);
        }
        begin = end;
    }
}

/// The envelope over one open stretch; its columns count from 1, the walls at both ends are column 0 and the last.
fn stretch_across(stretch: &[f32], out: &mut [f64], envelope: &mut Vec<Part>) {
    let value = |x: i64, (at, height, _): Part| (x - at) * (x - at) + height;
    let last = i64::try_from(stretch.len()).unwrap_or(i64::MAX - 1) + 1;
    envelope.clear();
    envelope.push((0, 0, 0));
    #[expect(clippy::cast_possible_truncation, reason = "whole numbers below the height of the lattice")]
    let heights = stretch.iter().map(|value| (*value as i64) * (*value as i64));
    for (at, height) in (1_i64..).zip(heights.chain([0])) {
        // The wall in column 0 is never popped.
        while let Some(top) = envelope.last().copied() {
            let (before, low, from) = top;
            if value(from, top) > value(from, (at, height, 0)) {
                envelope.pop();
                continue;
            }
            // Where the older parabola is still the lower one; not before `from`, so never negative.
            let rise = at * at - before * before + height - low;
            let start = 1 + if at - before == 1 { rise / 2 } else { rise / (2 * (at - before)) };
            if start < last {
                envelope.push((at, height, start));
            }
            break;
        }
    }
    let mut parts = envelope.iter().copied();
    let Some(mut part) = parts.next() else { return };
    let mut next = parts.next();
    for (x, slot) in (1_i64..).zip(out.iter_mut()) {
        while let Some(nearer) = next.filter(|next| next.2 <= x) {
            part = nearer;
            next = parts.next();
        }
        #[expect(clippy::cast_precision_loss, reason = "squared lattice distances stay far below 2^53")]
        {
            *slot = value(x, part) as f64;
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use socrates_model::Pose;

    /// A grid from rows of `.` free, `#` occupied, `?` unknown; cells of 0.5 m, origin (0, 0).
    pub(crate) fn grid(rows: &[&str]) -> Grid {
        let text = rows.concat();
        let cells = text.chars().map(|c| match c {
            '.' => Cell::Free,
            '#' => Cell::Occupied,
            _ => Cell::Unknown,
        });
        let (width, height) = (rows[0].len(), rows.len());
        Grid { width, height, resolution_m: 0.5, origin: Pose::new(0.0, 0.0, 0.0), cells: cells.collect() }
    }

    fn brute(grid: &Grid, point: &Point) -> f64 {
        let mut best = f64::INFINITY;
        for row in -1..=grid.height as i64 {
            for column in -1..=grid.width as i64 {
                let free = row >= 0 && column >= 0 && grid.at(column as usize, row as usize) == Cell::Free;
                if free {
                    continue;
                }
                let low = Point::new(column as f64 * 0.5, (grid.height as i64 - row - 1) as f64 * 0.5);
                let dx = (low.x - point.x).max(point.x - low.x - 0.5).max(0.0);
                let dy = (low.y - point.y).max(point.y - low.y - 0.5).max(0.0);
                best = best.min(dx.hypot(dy));
            }
        }
        best
    }

    const ROOM: [&str; 7] =
        ["##########", "#........#", "#..#.....#", "#........#", "#.....?..#", "#........#", "##########"];

    #[test]
    fn the_distance_is_exact_at_the_middle_and_corners_of_every_cell() {
        let grid = grid(&ROOM);
        let field = DistanceField::new(&grid);
        for row in 0..=14 {
            for column in 0..=20 {
                let point = Point::new(f64::from(column) * 0.25, f64::from(row) * 0.25);
                let (got, want) = (field.clearance(&point), brute(&grid, &point));
                assert!((got - want).abs() < 1e-6, "{point}: {got} but {want}");
            }
        }
    }

    #[test]
    fn walls_and_the_outside_have_no_clearance() {
        let field = DistanceField::new(&grid(&ROOM));
        for (x, y) in [(1.75, 2.25), (3.25, 1.25), (-3.0, 1.0), (50.0, 1.0), (f64::NAN, 0.0)] {
            assert!(field.clearance(&Point::new(x, y)) < 1e-9, "{x} {y}");
        }
    }

    #[test]
    fn the_nearest_free_place_is_near_and_fits() {
        let field = DistanceField::new(&grid(&ROOM));
        let inside_wall = Point::new(0.3, 1.6);
        let found = nearest_free(&field, &inside_wall, 0.4, 2.0).unwrap();
        assert!(free_disc(&field, &found, 0.4) && (found - inside_wall).norm() < 1.1);
        assert_eq!(nearest_free(&field, &inside_wall, 5.0, 2.0), None);
    }
}
