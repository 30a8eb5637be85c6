//! Wall surfaces as straight segments, and the nearest of them in each direction.

use std::sync::LazyLock;

use socrates_model::{Point, Vector};

use crate::layer::{Raster, floor_index};

/// Side of a bucket in cells; a surface longer than that is cut, so that every piece has one bucket.
const BUCKET_CELLS: usize = 20;

/// A piece of wall surface: from, to, with the free side on the left.
#[derive(Debug, Clone, Copy)]
struct Face {
    from: Point,
    to: Point,
}

/// All wall surfaces of a map, sorted into square buckets.
#[derive(Debug, Clone)]
pub(crate) struct Faces {
    columns: usize,
    buckets: Vec<Vec<Face>>,
}

impl Faces {
    /// The surfaces between cells that are free floor and cells that are not.
    pub(crate) fn of(raster: &Raster, is_free: impl Fn(usize, usize) -> bool) -> Self {
        let columns = raster.width / BUCKET_CELLS + 1;
        let rows = raster.height / BUCKET_CELLS + 1;
        let mut faces = Self { columns, buckets: vec![Vec::new(); columns.saturating_mul(rows)] };
        let free = |column: Option<usize>, row: Option<usize>| {
            column.zip(row).is_some_and(|(column, row)| is_free(column, row))
        };
        // Surfaces along rows: between the row above and the row below a cell border.
        for border in 0..=raster.height {
            let side = |at: usize| facing(free(Some(at), border.checked_sub(1)), free(Some(at), Some(border)));
            faces.collect(raster.width, side, |from, to, first_side| {
                let ends = (raster.world(from, to_f64(border)), raster.world(to, to_f64(border)));
                // Image x grows to the right, so "left of the way" is up in the world, the row above.
                let face =
                    if first_side { Face { from: ends.0, to: ends.1 } } else { Face { from: ends.1, to: ends.0 } };
                (face, floor_index(from), border)
            });
        }
        for border in 0..=raster.width {
            let side = |at: usize| facing(free(border.checked_sub(1), Some(at)), free(Some(border), Some(at)));
            faces.collect(raster.height, side, |from, to, first_side| {
                let ends = (raster.world(to_f64(border), from), raster.world(to_f64(border), to));
                // Image y grows downward: going down, the left hand points to larger x, the second side.
                let face =
                    if first_side { Face { from: ends.1, to: ends.0 } } else { Face { from: ends.0, to: ends.1 } };
                (face, border, floor_index(from))
            });
        }
        faces
    }

    /// Joins equal neighbors along one cell border into pieces and files them.
    fn collect(
        &mut self,
        length: usize,
        side: impl Fn(usize) -> Option<bool>,
        make: impl Fn(f64, f64, bool) -> (Face, usize, usize),
    ) {
        let mut open: Option<(usize, bool)> = None;
        for at in 0..=length {
            let here = if at < length { side(at) } else { None };
            if let Some((from, first_side)) = open
                && (here != Some(first_side) || at % BUCKET_CELLS == 0)
            {
                let (face, column, row) = make(to_f64(from), to_f64(at), first_side);
                let bucket = (row / BUCKET_CELLS).saturating_mul(self.columns).saturating_add(column / BUCKET_CELLS);
                if let Some(bucket) = self.buckets.get_mut(bucket) {
                    bucket.push(face);
                }
                open = None;
            }
            if open.is_none() {
                open = here.map(|first_side| (at, first_side));
            }
        }
    }

    pub(crate) fn sectors(&self, raster: &Raster, point: &Point, reach_m: f64, n: usize) -> Vec<Point> {
        let (px, py) = raster.pixel(point);
        if n == 0 || !px.is_finite() || !py.is_finite() || reach_m <= 0.0 {
            return Vec::new();
        }
        let own;
        let directions = if n == 8 {
            &*EIGHT
        } else {
            own = Directions::of(n);
            &own
        };
        let mut wedges = Wedges::new(directions, reach_m);
        let reach = reach_m / raster.resolution_m + 1.0;
        let span = |at: f64, cells: usize| {
            let last = cells / BUCKET_CELLS;
            (floor_index((at - reach).max(0.0)) / BUCKET_CELLS)
                ..=(floor_index((at + reach).max(0.0)) / BUCKET_CELLS).min(last)
        };
        for row in span(py, raster.height) {
            for column in span(px, raster.width) {
                for face in
                    self.buckets.get(row.saturating_mul(self.columns).saturating_add(column)).into_iter().flatten()
                {
                    wedges.offer(&(face.from - point), &(face.to - point));
                }
            }
        }
        wedges.nearest.iter().filter_map(|(_, away)| away.map(|away| point + away)).collect()
    }
}

/// The side of a cell border that is free when the other is not: `Some(true)` for the first.
fn facing(first: bool, second: bool) -> Option<bool> {
    (first != second).then_some(first)
}

#[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
fn to_f64(at: usize) -> f64 {
    at as f64
}

/// Unit vectors of the middles and of the ends (counter-clockwise side) of equal sectors.
#[derive(Debug, Clone)]
struct Directions {
    middles: Vec<Vector>,
    ends: Vec<Vector>,
}

impl Directions {
    fn of(n: usize) -> Self {
        let unit = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            Vector::new(cos, sin)
        };
        let step = std::f64::consts::TAU / to_f64(n);
        Self {
            middles: (0..n).map(|k| unit(to_f64(k) * step)).collect(),
            ends: (0..n).map(|k| unit((to_f64(k) + 0.5) * step)).collect(),
        }
    }
}

/// The sectors that people's forces ask for at every tick.
static EIGHT: LazyLock<Directions> = LazyLock::new(|| Directions::of(8));

/// The directions round a point, and the nearest surface found in each so far.
struct Wedges<'a> {
    directions: &'a Directions,
    nearest: Vec<(f64, Option<Vector>)>,
}

impl<'a> Wedges<'a> {
    fn new(directions: &'a Directions, reach_m: f64) -> Self {
        Self { directions, nearest: vec![(reach_m, None); directions.middles.len()] }
    }

    /// Takes a surface given relative to the point.
    fn offer(&mut self, from: &Vector, to: &Vector) {
        let along = to - from;
        // The free side is on the left of the way; a point on the right of it sees the wall's back.
        let depth = from.perp(to);
        if depth < 0.0 {
            return;
        }
        let length2 = along.norm_squared();
        if length2 <= 0.0 {
            return;
        }
        let share = (-from.dot(&along) / length2).clamp(0.0, 1.0);
        let foot = from + along * share;
        let reach = self.nearest.iter().fold(0.0_f64, |most, (away, _)| most.max(*away));
        if foot.norm_squared() > reach * reach {
            return;
        }
        for candidate in [&foot, from, to] {
            if let Some(sector) = self.sector(candidate) {
                self.take(sector, candidate);
            }
        }
        // The part of a surface inside a sector is nearest at its foot or where the sector ends.
        let ends = &self.directions.ends;
        let n = ends.len();
        if n < 2 {
            return;
        }
        for sector in 0..n {
            let Some(ray) = ends.get(sector).copied() else { continue };
            let across = ray.perp(&along);
            if across <= 0.0 {
                continue;
            }
            let beyond = from.perp(&ray);
            // Most surfaces lie in one or two sectors: no division for the others.
            if beyond < 0.0 || beyond > across * 1.000_001 {
                continue;
            }
            let (away, share) = (from.perp(&along) / across, beyond / across);
            if away >= 0.0 && (0.0..=1.0).contains(&share) {
                self.take(sector, &(ray * away));
                self.take((sector + 1) % n, &(ray * away));
            }
        }
    }

    /// The sector of a direction: the one whose middle is nearest.
    fn sector(&self, away: &Vector) -> Option<usize> {
        let mut best: Option<(f64, usize)> = None;
        for (k, middle) in self.directions.middles.iter().enumerate() {
            let likeness = middle.dot(away);
            if best.is_none_or(|(most, _)| likeness > most) {
                best = Some((likeness, k));
            }
        }
        best.map(|(_, k)| k)
    }

    fn take(&mut self, sector: usize, away: &Vector) {
        if let Some(slot) = self.nearest.get_mut(sector) {
            let distance = away.norm();
            if distance < slot.0 {
                *slot = (distance, Some(*away));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::DistanceField;
    use crate::field::tests::grid;

    const HALL: [&str; 6] =
        ["############", "#..........#", "#..........#", "#......#...#", "#..........#", "############"];

    #[test]
    fn the_nearest_wall_point_agrees_with_the_clearance() {
        let field = DistanceField::new(&grid(&HALL));
        for (x, y) in [(1.0, 1.5), (2.75, 1.75), (3.2, 1.9), (5.0, 0.75), (4.75, 2.25)] {
            let point = Point::new(x, y);
            let found = field.nearest_wall(&point, 3.0).unwrap();
            // Cells are 0.5 m here: between the lattice points 0.25 m apart the field is interpolated.
            assert!(((found - point).norm() - field.clearance(&point)).abs() < 0.05, "{point} {found}");
        }
    }

    #[test]
    fn eight_sectors_of_a_square_room_are_symmetric() {
        let field = DistanceField::new(&grid(&["######", "#....#", "#....#", "#....#", "#....#", "######"]));
        let middle = Point::new(1.5, 1.5);
        let found = field.sectors(&middle, 3.0, 8);
        assert_eq!(found.len(), 8);
        // Straight ahead the wall is 1 m away; in a diagonal sector it is nearest where the sector begins or ends.
        let slanted = 1.0 / (std::f64::consts::PI / 8.0).cos();
        for (k, wall) in found.iter().enumerate() {
            let want = if k % 2 == 0 { 1.0 } else { slanted };
            assert!(((wall - middle).norm() - want).abs() < 1e-9, "{k}: {wall}");
        }
        assert!((found[0] - Point::new(2.5, 1.5)).norm() < 1e-9 && (found[2] - Point::new(1.5, 2.5)).norm() < 1e-9);
    }

    #[test]
    fn a_surface_out_of_reach_or_facing_away_is_not_given() {
        let field = DistanceField::new(&grid(&HALL));
        assert!(field.sectors(&Point::new(2.0, 1.5), 0.4, 8).is_empty());
        let west_of_pillar = Point::new(3.0, 1.25);
        assert!(field.sectors(&west_of_pillar, 0.7, 8).iter().all(|wall| wall.x <= 3.5 + 1e-9));
    }
}
