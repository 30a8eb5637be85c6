//! The path as far as the controller sees it.

use socrates_model::{Point, Pose};

use crate::costmap::Costmap;

/// Parameters of the path handler.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathParams {
    /// The path is seen so far ahead, m of its length; default 1.7, as in the paper's setup (Nav2 2.0).
    pub prune_distance: f64,
    /// The robot's place on the path is looked for so far on, m of its length; default, `None`: half the longer side of the local
    /// costmap.
    pub max_robot_pose_search_dist: Option<f64>,
}

impl Default for PathParams {
    fn default() -> Self {
        Self { prune_distance: 1.7, max_robot_pose_search_dist: None }
    }
}

/// Keeps a path, forgets what was passed, and shows the part ahead.
#[derive(Debug, Default)]
pub struct PathHandler {
    params: PathParams,
    path: Vec<Pose>,
    /// Poses before this one are passed.
    start: usize,
}

impl PathHandler {
    /// A handler without a path.
    #[must_use]
    pub fn new(params: &PathParams) -> Self {
        Self { params: *params, path: Vec::new(), start: 0 }
    }

    /// Takes over a new path; the list of the old one is given back, to be used again.
    pub fn set(&mut self, path: Vec<Pose>) -> Vec<Pose> {
        self.start = 0;
        std::mem::replace(&mut self.path, path)
    }

    /// Forgets the path.
    pub fn clear(&mut self) {
        self.path.clear();
        self.start = 0;
    }

    /// What is left of the path.
    #[must_use]
    pub fn left(&self) -> &[Pose] {
        self.path.get(self.start..).unwrap_or_default()
    }

    /// Length of what is left, m.
    #[must_use]
    pub fn left_m(&self) -> f64 {
        steps(self.left()).sum()
    }

    /// The part ahead: from the pose nearest to the robot on, up to the prune distance or the edge of the costmap. Empty where the
    /// robot is off the map or the path is used up.
    pub fn ahead(&mut self, robot: &Point, map: &Costmap) -> &[Pose] {
        let side_m = map.width().max(map.height()) as f64 * map.resolution_m();
        let search_m = self.params.max_robot_pose_search_dist.unwrap_or(side_m / 2.0);
        let left = self.left();
        let near = within(left, search_m);
        let nearest = near.iter().enumerate().map(|(place, pose)| ((pose.point() - robot).norm_squared(), place));
        let nearest = nearest.reduce(|best, next| if next.0 < best.0 { next } else { best });
        // Two poses at least are kept: a path of one has no direction.
        let nearest = nearest.map_or(0, |(_, place)| place).min(left.len().saturating_sub(2));
        self.start += nearest;
        let left = self.left();
        let ahead = within(left, self.params.prune_distance);
        let inside = ahead.iter().take_while(|pose| map.cell(&pose.point()).is_some()).count();
        left.get(..inside).unwrap_or_default()
    }
}

/// Lengths of the steps of a path, m.
fn steps(path: &[Pose]) -> impl Iterator<Item = f64> {
    path.iter().zip(path.iter().skip(1)).map(|(from, to)| (to.point() - from.point()).norm())
}

/// The poses up to the one after which the path is longer than a limit, m.
fn within(path: &[Pose], limit_m: f64) -> &[Pose] {
    let mut gone = 0.0;
    let count = steps(path).take_while(|step| {
        gone += step;
        gone <= limit_m
    });
    // One step more passes the limit.
    let count = count.count() + 2;
    path.get(..count.min(path.len())).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(end_m: f64) -> Vec<Pose> {
        (0..).map(|step| 0.1 * f64::from(step)).take_while(|x| *x < end_m).map(|x| Pose::new(x, 0.0, 0.0)).collect()
    }

    #[test]
    fn what_was_passed_is_forgotten_and_the_part_ahead_ends_at_the_prune_distance() {
        let map = Costmap::new(200, 100, 0.1, Point::new(-5.0, -5.0), 0);
        let mut handler = PathHandler::new(&PathParams { prune_distance: 2.0, max_robot_pose_search_dist: None });
        handler.set(straight(10.05));
        let ahead = handler.ahead(&Point::new(3.02, 0.4), &map);
        assert!((ahead[0].x - 3.0).abs() < 1e-9);
        assert!((ahead.last().unwrap().x - 5.1).abs() < 0.11, "{:?}", ahead.last());
        assert!((handler.left_m() - 7.0).abs() < 1e-9);
        // Back again: what was passed stays passed.
        assert!((handler.ahead(&Point::new(1.0, 0.0), &map)[0].x - 3.0).abs() < 1e-9);
        let end = handler.ahead(&Point::new(9.99, 0.0), &map).to_vec();
        assert_eq!(end.len(), 2, "two poses are kept");
    }

    #[test]
    fn a_path_that_comes_back_is_not_cut_short_at_the_crossing() {
        let map = Costmap::new(400, 400, 0.1, Point::new(-20.0, -20.0), 0);
        let mut there = straight(6.05);
        let back: Vec<Pose> = there.iter().rev().copied().collect();
        there.extend(back);
        let mut handler = PathHandler::new(&PathParams { max_robot_pose_search_dist: Some(3.0), prune_distance: 2.0 });
        handler.set(there);
        assert!(handler.ahead(&Point::new(0.5, 0.0), &map).last().unwrap().x > 2.0);
        assert!((handler.left_m() - 11.5).abs() < 1e-9);
    }

    #[test]
    fn the_part_ahead_ends_at_the_edge_of_the_costmap() {
        let map = Costmap::new(20, 20, 0.1, Point::new(-1.0, -1.0), 0);
        let mut handler = PathHandler::new(&PathParams::default());
        handler.set(straight(10.05));
        assert!(handler.ahead(&Point::new(0.0, 0.0), &map).last().unwrap().x < 1.0);
        handler.clear();
        assert!(handler.ahead(&Point::new(0.0, 0.0), &map).is_empty());
    }
}
