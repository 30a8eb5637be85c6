//! `NavFn`: the shortest way over a costmap, as Nav2 plans it.
//!
//! ```text
//! costs ─► wave of potentials from the robot (wave) ─► path down the gradient from the goal (descent) ─► poses
//! ```
//!
//! A point falls to the cell whose *corner* is nearest, and a cell stands for its lower left corner: so does Nav2's planner, half a
//! cell off the costmap's own way.

mod descent;
mod wave;

#[cfg(test)]
mod tests;

use socrates_model::{Point, Pose};

use crate::costmap::{Costmap, LETHAL};
use wave::Wave;

/// Parameters of the planner; defaults are Nav2's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavFnParams {
    /// A place so near to the goal will do where the goal itself cannot be reached, m along each axis; default 0.5.
    pub tolerance: f64,
    /// Whether the wave keeps to the cells that lie towards the goal; default false: it spreads evenly (Dijkstra).
    pub use_astar: bool,
    /// Whether ways may lead through unknown cells; default true.
    pub allow_unknown: bool,
    /// Whether the robot arrives facing the way it came; default false: as the goal says.
    pub use_final_approach_orientation: bool,
    /// The way may have so many times the steps of the map's longer side, in cells; default 4.
    pub max_cycles_factor: usize,
}

impl Default for NavFnParams {
    fn default() -> Self {
        Self {
            tolerance: 0.5,
            use_astar: false,
            allow_unknown: true,
            use_final_approach_orientation: false,
            max_cycles_factor: 4,
        }
    }
}

/// Why there is no plan, with Nav2's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
pub enum PlanError {
    /// 203: the robot is not on the map.
    #[error("the start is outside the map")]
    StartOutsideMap,
    /// 204: the goal is not on the map.
    #[error("the goal is outside the map")]
    GoalOutsideMap,
    /// 205: the robot is in an obstacle. `NavFn` never says so: it frees the robot's cell.
    #[error("the start is occupied")]
    StartOccupied,
    /// 206: the goal is in an obstacle and there is no tolerance.
    #[error("the goal is occupied")]
    GoalOccupied,
    /// 207: planning took too long. `NavFn` never says so: it counts steps, and ends with [`PlanError::NoValidPath`].
    #[error("planning took too long")]
    Timeout,
    /// 208: no way leads to the goal or near to it.
    #[error("no way leads to the goal")]
    NoValidPath,
}

impl PlanError {
    /// Nav2's number for it.
    #[must_use]
    pub const fn code(self) -> u16 {
        match self {
            Self::StartOutsideMap => 203,
            Self::GoalOutsideMap => 204,
            Self::StartOccupied => 205,
            Self::GoalOccupied => 206,
            Self::Timeout => 207,
            Self::NoValidPath => 208,
        }
    }
}

/// The planner with its memory, which is used again for every plan.
#[derive(Debug, Default)]
pub struct NavFn {
    params: NavFnParams,
    wave: Wave,
    /// The way in cells, from the goal back to the robot.
    cells: Vec<(f64, f64)>,
}

impl NavFn {
    /// The planner.
    #[must_use]
    pub fn new(params: &NavFnParams) -> Self {
        Self { params: *params, ..Self::default() }
    }

    /// The way from a pose to another. It ends at the goal, or at the reachable place nearest to it within the tolerance.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn plan(&mut self, map: &Costmap, start: &Pose, goal: &Pose) -> Result<Vec<Pose>, PlanError> {
        let mut path = Vec::new();
        self.plan_into(map, start, goal, &mut path)?;
        Ok(path)
    }

    /// The same, into a list that is used again.
    ///
    /// # Errors
    /// [`PlanError`]; then the list is empty.
    pub fn plan_into(
        &mut self,
        map: &Costmap,
        start: &Pose,
        goal: &Pose,
        path: &mut Vec<Pose>,
    ) -> Result<(), PlanError> {
        path.clear();
        let from = cell_of(map, &start.point()).ok_or(PlanError::StartOutsideMap)?;
        let to = cell_of(map, &goal.point()).ok_or(PlanError::GoalOutsideMap)?;
        if self.params.tolerance <= 0.0 && map.cost(to.0, to.1) == LETHAL {
            return Err(PlanError::GoalOccupied);
        }
        if start.point() == goal.point() {
            let yaw = if self.params.use_final_approach_orientation { start.yaw } else { goal.yaw };
            path.push(Pose::new(start.x, start.y, yaw));
            return Ok(());
        }
        self.wave.spread(map, from, to, &self.params);
        let best = self.reachable(map, goal).ok_or(PlanError::NoValidPath)?;
        let end = cell_of(map, &best).ok_or(PlanError::NoValidPath)?;
        let most = map.width().max(map.height()).saturating_mul(self.params.max_cycles_factor);
        if !descent::descend(&self.wave, end, most, &mut self.cells) {
            return Err(PlanError::NoValidPath);
        }
        let (origin, cell_m) = (map.origin(), map.resolution_m());
        let places = self.cells.iter().rev();
        path.extend(places.map(|(x, y)| Pose::new(origin.x + x * cell_m, origin.y + y * cell_m, 0.0)));
        approach(path, &Pose::new(best.x, best.y, goal.yaw));
        if self.params.use_final_approach_orientation {
            face_the_way(path, start);
        }
        Ok(())
    }

    /// The goal, or the place nearest to it that the wave reached, on a square of places a cell apart.
    fn reachable(&self, map: &Costmap, goal: &Pose) -> Option<Point> {
        let goal = goal.point();
        let reached = |at: &Point| cell_of(map, at).is_some_and(|(column, row)| self.wave.is_reached(column, row));
        if reached(&goal) {
            return Some(goal);
        }
        let (tolerance, step) = (self.params.tolerance, map.resolution_m());
        let offsets = || {
            let steps = (0_u32..).map(move |count| f64::from(count) * step - tolerance);
            steps.take_while(move |offset| *offset <= tolerance)
        };
        let mut best: Option<(f64, Point)> = None;
        for y in offsets() {
            for x in offsets() {
                let at = Point::new(goal.x + x, goal.y + y);
                let away = x * x + y * y;
                if best.is_none_or(|(least, _)| away < least) && reached(&at) {
                    best = Some((away, at));
                }
            }
        }
        best.map(|(_, at)| at)
    }

    /// How dear the cheapest way to a cell was at the last plan, in costs of the planner (50 for a free cell); `None` where no way
    /// was found.
    #[must_use]
    pub fn potential(&self, column: usize, row: usize) -> Option<f32> {
        self.wave.potential(column, row)
    }
}

/// The cell whose corner is nearest to a point; `None` outside the map.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked against the size of the map")]
fn cell_of(map: &Costmap, point: &Point) -> Option<(usize, usize)> {
    let of = |at: f64, from: f64| ((at - from) / map.resolution_m()).round();
    let (column, row) = (of(point.x, map.origin().x), of(point.y, map.origin().y));
    let inside = column >= 0.0 && row >= 0.0 && column < map.width() as f64 && row < map.height() as f64;
    inside.then_some((column as usize, row as usize))
}

/// Ends a path at the goal: in place of a last pose beyond it, with its heading where the last pose is there, else one pose more.
fn approach(path: &mut Vec<Pose>, goal: &Pose) {
    let before = path.len().checked_sub(2).and_then(|place| path.get(place)).copied();
    let Some(last) = path.last_mut() else { return };
    let beyond = before.is_some_and(|before| {
        let before = before.point();
        (last.point() - before).norm_squared() > (goal.point() - before).norm_squared()
    });
    if beyond || last.point() == goal.point() {
        *last = *goal;
    } else {
        path.push(*goal);
    }
}

/// Turns the last pose to where the path leads.
fn face_the_way(path: &mut [Pose], start: &Pose) {
    let before = path.len().checked_sub(2).and_then(|place| path.get(place)).copied();
    if let Some(last) = path.last_mut() {
        last.yaw = before.map_or(start.yaw, |before| libm::atan2(last.y - before.y, last.x - before.x));
    }
}
