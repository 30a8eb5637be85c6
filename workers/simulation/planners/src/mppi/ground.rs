//! The costmap as trajectories see it: from the robot, with the robot's outline.

use pulp::Simd;
use socrates_model::{Point, Pose};

use super::elementary::floor;
use super::lanes::Lanes;
use crate::costmap::{Costmap, INSCRIBED, LETHAL, UNKNOWN};

/// No cell has this number.
const OUTSIDE: u32 = u32::MAX;

/// Costs in axes of the map with the robot at the origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ground<'a> {
    costmap: &'a Costmap,
    robot: Point,
    /// Lower left corner from the robot, m.
    corner: [f32; 2],
    /// Cells to the right and up.
    size: [f32; 2],
    columns: u32,
    cells_per_m: f32,
    /// Outline of the robot in its own frame, m; empty for a disc.
    pub(crate) footprint: &'a [Point],
    /// Whether unknown cells may be in the map.
    pub(crate) track_unknown: bool,
}

impl<'a> Ground<'a> {
    pub(crate) fn new(costmap: &'a Costmap, robot: &Pose, footprint: &'a [Point], track_unknown: bool) -> Self {
        let corner = costmap.origin() - robot.point();
        Self {
            costmap,
            robot: robot.point(),
            corner: [corner.x as f32, corner.y as f32],
            size: [costmap.width() as f32, costmap.height() as f32],
            columns: u32::try_from(costmap.width()).unwrap_or(OUTSIDE),
            cells_per_m: (1.0 / costmap.resolution_m()) as f32,
            footprint,
            track_unknown,
        }
    }

    /// Numbers of the cells that points from the robot are in; what is outside has a number that no cell has.
    #[inline(always)]
    pub(crate) fn cells<S: Simd>(&self, x: Lanes<S>, y: Lanes<S>) -> S::u32s {
        let simd = x.simd();
        let (zero, per_m) = (x.like(0.0), x.like(self.cells_per_m));
        let [left, low] = self.corner;
        let [width, height] = self.size;
        let (column, row) = ((x - x.like(left)) * per_m, (y - y.like(low)) * per_m);
        let right_of = zero.at_most(column).and(column.below(x.like(width)));
        let inside = right_of.and(zero.at_most(row).and(row.below(x.like(height))));
        let (column, row) = (floor(inside.select(column, zero)), floor(inside.select(row, zero)));
        let number = simd.add_u32s(simd.mul_u32s(row, simd.splat_u32s(self.columns)), column);
        simd.select_u32s(inside.raw, number, simd.splat_u32s(OUTSIDE))
    }

    /// Cost of a cell; unknown outside the map.
    #[inline(always)]
    pub(crate) fn cost_of(&self, cell: u32) -> u8 {
        self.costmap.costs().get(cell as usize).copied().unwrap_or(UNKNOWN)
    }

    /// Cost of a point from the robot; unknown outside the map.
    pub(crate) fn cost(&self, x: f32, y: f32) -> u8 {
        let simd = pulp::Scalar::new();
        self.cost_of(self.cells(Lanes::splat(simd, x), Lanes::splat(simd, y)))
    }

    /// Whether a path point is free to be followed.
    pub(crate) fn is_valid(&self, x: f32, y: f32) -> bool {
        let simd = pulp::Scalar::new();
        let cell = self.cells(Lanes::splat(simd, x), Lanes::splat(simd, y));
        let cost = self.cost_of(cell);
        cell != OUTSIDE && cost != LETHAL && cost != INSCRIBED && (cost != UNKNOWN || self.track_unknown)
    }

    /// Whether the outline of the robot at a pose from the robot touches an obstacle.
    pub(crate) fn footprint_hits(&self, x: f32, y: f32, yaw: f32) -> bool {
        let (sine, cosine) = libm::sincos(f64::from(yaw));
        let (x, y) = (self.robot.x + f64::from(x), self.robot.y + f64::from(y));
        let corner =
            |point: &Point| Point::new(x + point.x * cosine - point.y * sine, y + point.x * sine + point.y * cosine);
        let next = self.footprint.iter().cycle().skip(1);
        self.footprint.iter().zip(next).any(|(from, to)| self.edge_hits(&corner(from), &corner(to)))
    }

    /// Whether a cell on the straight line between two points is lethal.
    fn edge_hits(&self, from: &Point, to: &Point) -> bool {
        let way = to - from;
        // A sample in every row and column of cells that the line crosses.
        let count = (way.x.abs().max(way.y.abs()) / self.costmap.resolution_m()).ceil().clamp(1.0, 1e4) as u32;
        (0..=count).any(|step| self.costmap.cost_at(&(from + way * (f64::from(step) / f64::from(count)))) == LETHAL)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::FREE;

    fn floor_plan() -> Costmap {
        let mut costmap = Costmap::new(40, 30, 0.1, Point::new(-1.0, 2.0), FREE);
        for (cell, cost) in (0_u32..).zip(costmap.costs_mut()) {
            *cost = (cell % 251) as u8;
        }
        costmap
    }

    #[test]
    fn a_cost_seen_from_the_robot_is_that_of_the_map() {
        let costmap = floor_plan();
        let robot = Pose::new(0.37, 3.21, 0.0);
        let ground = Ground::new(&costmap, &robot, &[], false);
        let mut inside = 0;
        for step in 0..4000_u16 {
            let (x, y) = (f32::from(step % 61) * 0.0917 - 2.7, f32::from(step / 61) * 0.0813 - 2.6);
            let wanted = costmap.cost_at(&Point::new(robot.x + f64::from(x), robot.y + f64::from(y)));
            inside += u32::from(wanted != UNKNOWN);
            assert_eq!(ground.cost(x, y), wanted, "{x} {y}");
        }
        assert!(inside > 1000);
    }

    #[test]
    fn a_path_point_is_valid_where_a_robot_may_be() {
        let mut costmap = Costmap::new(10, 10, 0.1, Point::origin(), FREE);
        let robot = Pose::new(0.0, 0.0, 0.0);
        for (cost, valid) in [(0, true), (252, true), (253, false), (254, false), (255, false)] {
            costmap.set(3, 3, cost);
            assert_eq!(Ground::new(&costmap, &robot, &[], false).is_valid(0.35, 0.35), valid);
        }
        assert!(Ground::new(&costmap, &robot, &[], true).is_valid(0.35, 0.35), "unknown is tracked");
        assert!(!Ground::new(&costmap, &robot, &[], true).is_valid(1.05, 0.35), "outside the map");
    }

    #[test]
    fn an_outline_hits_what_its_edges_cross() {
        let mut costmap = Costmap::new(40, 40, 0.05, Point::origin(), FREE);
        let robot = Pose::new(1.0, 1.0, 0.0);
        let outline = [(0.3, 0.1), (-0.3, 0.1), (-0.3, -0.1), (0.3, -0.1)].map(|(x, y)| Point::new(x, y));
        costmap.set(20, 24, LETHAL);
        let ground = Ground::new(&costmap, &robot, &outline, false);
        assert!(!ground.footprint_hits(0.0, 0.0, 0.0), "the cell is 0.2 m to the side");
        assert!(!ground.footprint_hits(0.0, 0.0, 1.57), "the cell is inside the outline, its edges are free");
        assert!(ground.footprint_hits(0.04, 0.0, 1.2));
        assert!(ground.footprint_hits(0.0, 0.125, 0.0));
    }
}
