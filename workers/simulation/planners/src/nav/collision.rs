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
