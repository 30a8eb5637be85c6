//! Whether the ways walked are free floor: G-FREE. A fault of the map, not of the author.

use std::collections::BTreeSet;

use socrates_model::{Cell, Fault, FaultCode, Location, NodeId, Paths, Point, Where};

use crate::routes::walks;

/// Distance between two looks at the floor, as a share of a cell.
const STEP_CELLS: f64 = 0.5;

/// A fault per edge that is walked and crosses a cell that is not free.
pub(crate) fn check(paths: &Paths, location: &Location) -> Vec<Fault> {
    let mut edges: BTreeSet<(&NodeId, &NodeId)> = BTreeSet::new();
    for (_, nodes) in walks(paths) {
        for pair in nodes.windows(2) {
            if let [a, b] = pair {
                edges.insert(if a < b { (a, b) } else { (b, a) });
            }
        }
    }
    edges
        .into_iter()
        .filter_map(|(a, b)| {
            let points = location.graph.edge_points(a, b)?;
            let hit = points.windows(2).find_map(|pair| if let [p, q] = pair { first_hit(p, q, location) } else { None })?;
            let message = format!(
                "the way between `{a}` and `{b}` is not free at ({:.2}, {:.2}); this is a fault of the map, not of the paths",
                hit.x, hit.y
            );
            Some(Fault::new(FaultCode::GFree, Where::key(format_args!("edge {a} {b}")), message))
        })
        .collect()
}

/// The first point of a segment that is a wall. Cells that were never seen are let pass here, as maps are drawn in parts.
fn first_hit(from: &Point, to: &Point, location: &Location) -> Option<Point> {
    let grid = &location.grid;
    let length_m = (to - from).norm();
    let step_m = (grid.resolution_m * STEP_CELLS).max(1e-3);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an edge has far fewer than 2^32 steps"
    )]
    let count = (length_m / step_m).ceil().clamp(1.0, 1e6) as u32;
    (0..=count)
        .map(|k| from + (to - from) * (f64::from(k) / f64::from(count)))
        .find(|point| grid.cell_of(point).is_some_and(|(column, row)| grid.at(column, row) == Cell::Occupied))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_paths, plus_map};

    #[test]
    fn a_wall_on_the_way_is_the_maps_fault() {
        let mut location = plus_map();
        assert!(check(&crossing_paths(), &location).is_empty());
        let (column, row) = location.grid.cell_of(&Point::new(1.5, 0.0)).unwrap();
        let index = row * location.grid.width + column;
        location.grid.cells[index] = Cell::Occupied;
        assert_eq!(codes(&check(&crossing_paths(), &location)), ["G-FREE"]);
    }
}
