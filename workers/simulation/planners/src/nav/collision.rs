//! Whether a robot at a pose touches an obstacle of a costmap.

use socrates_model::{Point, Pose};

use crate::costmap::{Costmap, INSCRIBED, LETHAL, UNKNOWN};

/// Steps along an edge of an outline, in cells.
const STEP_CELLS: f64 = 0.5;

/// Whether the robot touches an obstacle: a disc (no outline) where its center costs 253 or 254, an outline where it crosses a cell
/// of 254. Cells beyond the map are free.
#[must_use]
pub fn touches(map: &Costmap, pose: &Pose, footprint: &[Point]) -> bool {
    if footprint.is_empty() {
        let cost = map.cost_at(&pose.point());
        return (INSCRIBED..UNKNOWN).contains(&cost);
    }
    let (sin, cos) = (libm::sin(pose.yaw), libm::cos(pose.yaw));
    let corner = |at: &Point| Point::new(pose.x + at.x * cos - at.y * sin, pose.y + at.x * sin + at.y * cos);
    let ends = footprint.iter().cycle().skip(1);
    footprint.iter().zip(ends).any(|(from, to)| {
        let (from, way) = (corner(from), corner(to) - corner(from));
        let steps = (way.norm() / (STEP_CELLS * map.resolution_m())).ceil().max(1.0);
        let places = (0_u32..).map(f64::from).take_while(|step| *step <= steps);
        places.map(|step| from + way * (step / steps)).any(|at| map.cost_at(&at) == LETHAL)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::FREE;

    #[test]
    fn a_disc_touches_by_its_center_and_an_outline_by_its_edges() {
        let mut map = Costmap::new(100, 100, 0.05, Point::new(-2.5, -2.5), FREE);
        let (column, row) = map.cell(&Point::new(0.42, 0.0)).unwrap();
        map.set(column, row, LETHAL);
        map.set(column - 1, row, INSCRIBED);
        let corners = [(0.5, 0.2), (-0.5, 0.2), (-0.5, -0.2), (0.5, -0.2)];
        let outline: Vec<Point> = corners.iter().map(|(x, y)| Point::new(*x, *y)).collect();
        let at = |x: f64, y: f64, yaw: f64| Pose::new(x, y, yaw);
        assert!(touches(&map, &at(0.38, 0.0, 0.0), &[]) && !touches(&map, &at(0.3, 0.0, 0.0), &[]));
        // The cell is inside the outline, at its front edge, and beside it once it is turned.
        assert!(!touches(&map, &at(0.0, 0.0, 0.0), &outline));
        assert!(touches(&map, &at(-0.08, 0.0, 0.0), &outline));
        assert!(!touches(&map, &at(0.0, 0.0, std::f64::consts::FRAC_PI_2), &outline));
        assert!(!touches(&map, &at(9.0, 0.0, 0.0), &outline), "beyond the map nothing is known to be");
    }
}
