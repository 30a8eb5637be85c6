//! Outlines of a set of cells as closed lines along the sides of the cells, straight parts in one piece.

use std::collections::BTreeMap;

use socrates_model::{Grid, Point};

/// A corner of cells: column and row of the cell to its lower right.
pub(crate) type Corner = (usize, usize);

/// A corner of cells in the map frame, m.
#[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
pub(crate) fn placed(grid: &Grid, (column, row): Corner) -> Point {
    grid.world_from_pixel(column as f64, row as f64)
}

/// Slack that makes stairs of slanted walls straight lines, cells.
pub(crate) const STRAIGHT: f64 = 0.8;
/// Slack that keeps every corner of the cells.
pub(crate) const EXACT: f64 = 0.0;

/// Closed outlines of the cells for which `inside` holds, each without its first corner again, by their first corners.
/// A corner lies at most `slack` cells off the line that stands for it.
pub(crate) fn outlines(
    width: usize,
    height: usize,
    slack: f64,
    inside: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<Corner>> {
    let is = |column: Option<usize>, row: Option<usize>| match (column, row) {
        (Some(column), Some(row)) => column < width && row < height && inside(column, row),
        _ => false,
    };
    // Sides with the inside on the right of their direction, by their first corner.
    let mut sides: BTreeMap<Corner, Vec<Corner>> = BTreeMap::new();
    for row in 0..height {
        for column in 0..width {
            if !inside(column, row) {
                continue;
            }
            let (right, below) = (column + 1, row + 1);
            let beside = [
                (is(Some(column), row.checked_sub(1)), (column, row), (right, row)),
                (is(Some(right), Some(row)), (right, row), (right, below)),
                (is(Some(column), Some(below)), (right, below), (column, below)),
                (is(column.checked_sub(1), Some(row)), (column, below), (column, row)),
            ];
            for (_, from, to) in beside.into_iter().filter(|(joined, _, _)| !joined) {
                sides.entry(from).or_default().push(to);
            }
        }
    }
    let mut out = Vec::new();
    while let Some((&first, _)) = sides.first_key_value() {
        let mut line = vec![first];
        let mut here = first;
        while let Some(next) = step(&mut sides, here, line.iter().rev().nth(1).copied()) {
            if next == first {
                break;
            }
            line.push(next);
            here = next;
        }
        out.push(straightened(&line, slack));
    }
    out
}

/// Takes a side that begins here; of two, the one that turns right, so that cells that touch at a corner stay apart.
fn step(sides: &mut BTreeMap<Corner, Vec<Corner>>, here: Corner, before: Option<Corner>) -> Option<Corner> {
    let ways = sides.get_mut(&here)?;
    let turn = |to: &Corner| before.is_some_and(|before| bend(before, here, *to) > 0.0);
    let place = ways.iter().position(turn).unwrap_or(0);
    let next = ways.swap_remove(place);
    if ways.is_empty() {
        sides.remove(&here);
    }
    Some(next)
}

#[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
fn real((column, row): Corner) -> (f64, f64) {
    (column as f64, row as f64)
}

/// Twice the area of the triangle; positive where the way turns right on the image, whose rows grow downward.
fn bend(a: Corner, b: Corner, c: Corner) -> f64 {
    let ((ax, ay), (bx, by), (cx, cy)) = (real(a), real(b), real(c));
    (bx - ax) * (cy - by) - (by - ay) * (cx - bx)
}

/// A closed line with the corners that matter alone.
fn straightened(line: &[Corner], slack: f64) -> Vec<Corner> {
    let count = line.len();
    let at = |place: usize| line.get(place % count).copied().unwrap_or_default();
    // Corners at which the direction changes; the first is one of them, since outlines begin at their least corner.
    let corners: Vec<Corner> =
        (0..count).filter(|place| bend(at(place + count - 1), at(*place), at(place + 1)).abs() > 0.0).map(at).collect();
    let Some((first, rest)) = corners.split_first() else { return Vec::new() };
    // The corner farthest from the first parts the ring into two lines.
    let far = rest
        .iter()
        .enumerate()
        .max_by(|a, b| gap(*first, *a.1).total_cmp(&gap(*first, *b.1)))
        .map_or(0, |(place, _)| place + 1);
    let ring: Vec<Corner> = corners.iter().copied().chain([*first]).collect();
    let mut kept = vec![*first];
    thinned(ring.get(..=far).unwrap_or_default(), slack, &mut kept);
    thinned(ring.get(far..).unwrap_or_default(), slack, &mut kept);
    kept.pop();
    kept
}

fn gap(a: Corner, b: Corner) -> f64 {
    let ((ax, ay), (bx, by)) = (real(a), real(b));
    (bx - ax).hypot(by - ay)
}

/// Adds the corners of a line behind its first that keep all others within the slack (Douglas and Peucker).
fn thinned(line: &[Corner], slack: f64, kept: &mut Vec<Corner>) {
    let (Some(first), Some(last)) = (line.first(), line.last()) else { return };
    let length = gap(*first, *last);
    let off = |corner: &Corner| {
        if length > 0.0 { (bend(*first, *last, *corner) / length).abs() } else { gap(*first, *corner) }
    };
    let inner = line.get(1..line.len().saturating_sub(1)).unwrap_or_default();
    let worst = inner.iter().enumerate().max_by(|a, b| off(a.1).total_cmp(&off(b.1)));
    match worst.filter(|(_, corner)| off(corner) > slack) {
        Some((place, _)) => {
            thinned(line.get(..=place + 1).unwrap_or_default(), slack, kept);
            thinned(line.get(place + 1..).unwrap_or_default(), slack, kept);
        }
        None => kept.push(*last),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_has_two_outlines_and_a_slanted_side_is_one_line() {
        let rows = ["......", ".####.", ".#..#.", ".####.", "......"];
        let inside = |column: usize, row: usize| rows[row].as_bytes()[column] == b'#';
        assert_eq!(
            outlines(6, 5, STRAIGHT, inside),
            [vec![(1, 1), (5, 1), (5, 4), (1, 4)], vec![(2, 2), (2, 3), (4, 3), (4, 2)]]
        );
        let stairs = |column: usize, row: usize| column <= row;
        assert_eq!(outlines(9, 9, STRAIGHT, stairs).len(), 1);
        assert!(outlines(9, 9, STRAIGHT, stairs)[0].len() <= 5, "{:?}", outlines(9, 9, STRAIGHT, stairs));
        assert_eq!(outlines(9, 9, EXACT, stairs)[0].len(), 20);
        // Cells that touch at a corner are two outlines.
        assert_eq!(outlines(2, 2, STRAIGHT, |column, row| column == row).len(), 2);
        assert!(outlines(3, 3, STRAIGHT, |_, _| false).is_empty());
    }
}
