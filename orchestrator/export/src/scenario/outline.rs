//! The walkable floor of a map as one polygon with holes, corner by corner of its cells.

use std::fmt::Write as _;

use socrates_model::{Cell, Grid, Point};

use super::frames::real;
use crate::graph::Unusable;
use crate::not_carried::Losses;
use crate::outline::{Corner, EXACT, STRAIGHT, outlines, placed};

/// Largest distance by which a place is moved to where there is room, m.
const AWAY_M: f64 = 2.0;
/// Least floor around a place, m.
const LEAST_ROOM_M: f64 = 0.1;

/// Both ends of each side of the straight outlines of the cells for which `inside` holds, in the map frame, m.
pub(crate) fn sides(grid: &Grid, inside: impl Fn(usize, usize) -> bool) -> Vec<[Point; 2]> {
    let mut sides = Vec::new();
    for ring in outlines(grid.width, grid.height, STRAIGHT, inside) {
        let next = ring.iter().cycle().skip(1);
        sides.extend(ring.iter().zip(next).map(|(from, to)| [placed(grid, *from), placed(grid, *to)]));
    }
    sides
}

/// The floor that hangs together, in the map frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Floor {
    /// Outline and holes, each closed by its first corner again.
    pub(crate) rings: Vec<Vec<Point>>,
    /// Whether each cell of the map belongs to it, row by row.
    pub(crate) cells: Vec<bool>,
}

impl Floor {
    /// The floor as `POLYGON ((…), (…))` of WKT.
    pub(crate) fn polygon(&self) -> String {
        let mut text = String::from("POLYGON (");
        for (place, ring) in self.rings.iter().enumerate() {
            text.push_str(if place == 0 { "(" } else { ", (" });
            for (corner, point) in ring.iter().enumerate() {
                let comma = if corner == 0 { "" } else { ", " };
                // Writing to a String cannot fail.
                let (Ok(()) | Err(std::fmt::Error)) = write!(text, "{comma}{} {}", real(point.x), real(point.y));
            }
            text.push(')');
        }
        text.push(')');
        text
    }

    /// The nearest place with this much floor around it, at most [`AWAY_M`] away, m; where there is none, with half as much, down to
    /// [`LEAST_ROOM_M`]. Beside it how much floor there is around it, at most what was wanted, m.
    pub(crate) fn spot(&self, grid: &Grid, at: &Point, room_m: f64) -> Option<(Point, f64)> {
        let mut wanted = room_m;
        while wanted >= LEAST_ROOM_M {
            let own = self.room(grid, at, room_m);
            if own >= wanted {
                return Some((*at, own));
            }
            let near = self.near(grid, at, AWAY_M).into_iter().filter(|(column, row)| self.has(grid, *column, *row));
            let near =
                near.map(|(column, row)| grid.center_of(column, row)).filter(|place| (place - at).norm() <= AWAY_M);
            let roomy = near.map(|place| (place, self.room(grid, &place, room_m))).filter(|(_, room)| *room >= wanted);
            let nearest = roomy.min_by(|one, other| (one.0 - at).norm().total_cmp(&(other.0 - at).norm()));
            if nearest.is_some() {
                return nearest;
            }
            wanted *= 0.5;
        }
        None
    }

    /// Distance from a place to what is no floor, at most `most_m`, m.
    fn room(&self, grid: &Grid, at: &Point, most_m: f64) -> f64 {
        let (px, py) = grid.pixel_from_world(at);
        let off = |pixel: f64, cell: usize| {
            #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
            let low = cell as f64;
            (low - pixel).max(pixel - low - 1.0).max(0.0)
        };
        if !grid.cell_of(at).is_some_and(|(column, row)| self.has(grid, column, row)) {
            return 0.0;
        }
        #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
        let (width, height) = (grid.width as f64, grid.height as f64);
        // The rim of the map bounds the floor as walls do.
        let rim = px.min(py).min(width - px).min(height - py).max(0.0) * grid.resolution_m;
        let near = self.near(grid, at, most_m).into_iter().filter(|(column, row)| !self.has(grid, *column, *row));
        let off_m = near.map(|(column, row)| off(px, column).hypot(off(py, row)) * grid.resolution_m);
        off_m.fold(rim.min(most_m), f64::min)
    }

    fn has(&self, grid: &Grid, column: usize, row: usize) -> bool {
        self.cells.get(row * grid.width + column).copied().unwrap_or_default()
    }

    /// Cells of the map around a place, as a square.
    fn near(&self, grid: &Grid, at: &Point, far_m: f64) -> Vec<(usize, usize)> {
        let (px, py) = grid.pixel_from_world(at);
        let reach = far_m / grid.resolution_m + 1.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to the size of the map")]
        let cut = |pixel: f64, side: usize| (pixel.max(0.0) as usize).min(side);
        let columns = cut(px - reach, grid.width)..cut(px + reach + 1.0, grid.width);
        let rows = cut(py - reach, grid.height)..cut(py + reach + 1.0, grid.height);
        rows.flat_map(|row| columns.clone().map(move |column| (column, row))).collect()
    }
}

/// The largest part of the free floor; what hangs together with it at a corner alone is left out, and noted.
///
/// # Errors
/// A map without a free cell.
pub(crate) fn walkable(grid: &Grid, losses: &mut Losses) -> Result<Floor, Unusable> {
    let mut free: Vec<bool> = grid.cells.iter().map(|cell| *cell == Cell::Free).collect();
    let before = free.iter().filter(|free| **free).count();
    let kept = largest_part(grid, &free);
    let apart = before - kept.iter().filter(|kept| **kept).count();
    free = kept;
    let pinched = without_pinches(grid, &mut free);
    // A pinch may have been the only way to a part.
    free = largest_part(grid, &free);
    let inside = |column: usize, row: usize| free.get(row * grid.width + column).copied().unwrap_or_default();
    let mut rings = outlines(grid.width, grid.height, EXACT, inside);
    if rings.is_empty() {
        let problem = "the map has no free cell, so there is no floor to walk on";
        return Err(Unusable::new(
            "location.json grid",
            problem,
            "export the bundle to a format without a floor, such as `trajnet`",
        ));
    }
    if apart > 0 {
        let at = format!("location.json grid: {apart} free cells");
        losses.note(
            "floor that hangs together with nothing",
            at,
            "the format's floor is one piece; the largest was kept",
        );
    }
    if pinched > 0 {
        let at = format!("location.json grid: {pinched} free cells");
        losses.note("floor that touches at corners", at, "a ring of a polygon must not touch itself");
    }
    // The outline is the ring with the largest extent; all others are holes in it.
    let extent = |ring: &Vec<(usize, usize)>| {
        let columns = ring.iter().map(|corner| corner.0);
        columns.clone().max().unwrap_or_default() - columns.min().unwrap_or_default()
    };
    let outer = rings.iter().enumerate().max_by_key(|(place, ring)| (extent(ring), std::cmp::Reverse(*place)));
    let outer = outer.map_or(0, |(place, _)| place);
    rings.swap(0, outer);
    let closed = |ring: &Vec<Corner>| ring.iter().chain(ring.first()).map(|corner| placed(grid, *corner)).collect();
    let rings = rings.iter().map(closed);
    Ok(Floor { rings: rings.collect(), cells: free })
}

/// The cells of the largest part that hangs together over sides of cells.
fn largest_part(grid: &Grid, free: &[bool]) -> Vec<bool> {
    let mut seen = vec![false; free.len()];
    let mut largest: Vec<usize> = Vec::new();
    for start in 0..free.len() {
        let is_open = |seen: &[bool], cell: usize| {
            free.get(cell).copied().unwrap_or_default() && !seen.get(cell).copied().unwrap_or(true)
        };
        if !is_open(&seen, start) {
            continue;
        }
        let (mut part, mut next) = (vec![start], 0);
        if let Some(slot) = seen.get_mut(start) {
            *slot = true;
        }
        while let Some(&cell) = part.get(next) {
            next += 1;
            let column = cell % grid.width.max(1);
            let beside = [
                (column > 0).then(|| cell - 1),
                (column + 1 < grid.width).then_some(cell + 1),
                cell.checked_sub(grid.width),
                cell.checked_add(grid.width),
            ];
            for other in beside.into_iter().flatten() {
                if is_open(&seen, other)
                    && let Some(slot) = seen.get_mut(other)
                {
                    *slot = true;
                    part.push(other);
                }
            }
        }
        if part.len() > largest.len() {
            largest = part;
        }
    }
    let mut kept = vec![false; free.len()];
    for cell in largest {
        if let Some(slot) = kept.get_mut(cell) {
            *slot = true;
        }
    }
    kept
}

/// Takes free cells away until no two touch at a corner alone; how many were taken.
fn without_pinches(grid: &Grid, free: &mut [bool]) -> usize {
    let mut taken = 0;
    loop {
        let before = taken;
        for row in 1..grid.height {
            for column in 1..grid.width {
                let at = |free: &[bool], column: usize, row: usize| {
                    free.get(row * grid.width + column).copied().unwrap_or_default()
                };
                let (a, b) = (at(free, column - 1, row - 1), at(free, column, row - 1));
                let (c, d) = (at(free, column - 1, row), at(free, column, row));
                let pinch = if a && d && !b && !c {
                    Some((column, row))
                } else if b && c && !a && !d {
                    Some((column - 1, row))
                } else {
                    None
                };
                if let Some((column, row)) = pinch
                    && let Some(slot) = free.get_mut(row * grid.width + column)
                {
                    *slot = false;
                    taken += 1;
                }
            }
        }
        if taken == before {
            return taken;
        }
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::Pose;

    use super::*;

    fn grid(rows: &[&str], origin: Pose) -> Grid {
        let cells = rows.iter().flat_map(|row| row.chars());
        let cells = cells.map(|letter| if letter == '.' { Cell::Free } else { Cell::Occupied }).collect();
        Grid { width: rows[0].len(), height: rows.len(), resolution_m: 0.5, origin, cells }
    }

    #[test]
    fn a_room_with_a_pillar_is_a_polygon_with_a_hole() {
        let mut losses = Losses::default();
        let floor =
            walkable(&grid(&["#####", "#...#", "#.#.#", "#...#", "#####"], Pose::new(-1.0, 2.0, 0.0)), &mut losses);
        assert_eq!(
            floor.unwrap().polygon(),
            "POLYGON ((-0.5 4.0, 1.0 4.0, 1.0 2.5, -0.5 2.5, -0.5 4.0), (0.0 3.5, 0.0 3.0, 0.5 3.0, 0.5 3.5, 0.0 3.5))"
        );
        assert!(losses.rows().is_empty());
    }

    #[test]
    fn a_turned_map_turns_its_floor() {
        let floor = walkable(&grid(&["."], Pose::new(0.0, 0.0, std::f64::consts::FRAC_PI_2)), &mut Losses::default());
        assert_eq!(floor.unwrap().polygon(), "POLYGON ((-0.5 0.0, -0.5 0.5, 0.0 0.5, 0.0 0.0, -0.5 0.0))");
    }

    #[test]
    fn a_place_beside_a_wall_is_moved_to_where_there_is_room() {
        let grid = grid(&["######", "#....#", "#....#", "#....#", "#....#", "######"], Pose::new(0.0, 0.0, 0.0));
        let floor = walkable(&grid, &mut Losses::default()).unwrap();
        let (at, room) = floor.spot(&grid, &Point::new(1.5, 1.4), 0.6).unwrap();
        assert!((at - Point::new(1.5, 1.4)).norm() < 1e-9 && (room - 0.6).abs() < 1e-9, "{at} {room}");
        let (at, room) = floor.spot(&grid, &Point::new(0.55, 1.3), 0.6).unwrap();
        assert!((at - Point::new(1.25, 1.25)).norm() < 1e-9 && (room - 0.6).abs() < 1e-9, "{at} {room}");
        // Nothing has 3 m around it: half as much is taken, and half of that.
        let (at, room) = floor.spot(&grid, &Point::new(1.5, 1.5), 3.0).unwrap();
        assert!((at - Point::new(1.5, 1.5)).norm() < 1e-9 && (room - 1.0).abs() < 1e-9, "{at} {room}");
        assert_eq!(floor.spot(&grid, &Point::new(9.0, 9.0), 0.3), None);
    }

    #[test]
    fn parts_and_corners_that_touch_are_left_out_and_noted() {
        let mut losses = Losses::default();
        let floor =
            walkable(&grid(&["..##", "..##", "##..", "####", "...."], Pose::new(0.0, 0.0, 0.0)), &mut losses).unwrap();
        assert_eq!(floor.rings.len(), 1);
        assert_eq!(losses.rows()[0].what, "floor that hangs together with nothing");
        // A ring of cells that touches itself at a corner.
        let mut losses = Losses::default();
        let floor = walkable(&grid(&["....", ".#..", "..#.", "...."], Pose::new(0.0, 0.0, 0.0)), &mut losses).unwrap();
        assert_eq!(losses.rows()[0].what, "floor that touches at corners");
        assert_eq!(floor.rings.len(), 2);
        assert!(walkable(&grid(&["##"], Pose::new(0.0, 0.0, 0.0)), &mut losses).is_err());
    }
}
