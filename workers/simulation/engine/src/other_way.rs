//! How far on a robot is that goes another way than the intended one.

use socrates_maps::{DistanceField, Geodesic};
use socrates_model::{Point, Polyline};

/// Steps along the intended way at which its distance to the end is known, m.
const STEP_M: f64 = 0.25;

/// Walking distance to the end of the intended way, from everywhere and along that way.
#[derive(Debug, Clone)]
pub(crate) struct OtherWay {
    to_end: Geodesic,
    /// From every step of the intended way, m.
    left_m: Vec<f64>,
}

impl OtherWay {
    /// Distances over the floor where a disc of `radius_m` fits; doors count as open.
    pub(crate) fn new(route: &Polyline, field: &DistanceField, radius_m: f64) -> Self {
        let to_end = Geodesic::to(field, &route.end().unwrap_or_else(Point::origin), radius_m);
        let steps = (0..).map(|step| f64::from(step) * STEP_M).take_while(|s: &f64| *s < route.length_m() + STEP_M);
        let left_m = steps.map(|s| to_end.distance(&route.point(s)).unwrap_or(f64::INFINITY)).collect();
        Self { to_end, left_m }
    }

    /// Length along the intended way, from `from_s` m on, of the first place from which it is no farther to the end than from here;
    /// `None` where no way leads from here to the end.
    pub(crate) fn level_s(&self, at: &Point, from_s: f64) -> Option<f64> {
        let here_m = self.to_end.distance(at)?;
        let marks = (0..).map(|step| f64::from(step) * STEP_M);
        marks.zip(&self.left_m).find(|(s, left_m)| *s >= from_s && **left_m <= here_m).map(|(s, _)| s)
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::Vector;

    use super::*;
    use crate::fixture::{carve, location, setup};
    use crate::floor::Floor;
    use crate::start;

    #[test]
    fn a_robot_on_the_other_side_of_a_block_is_as_far_on_as_it_has_to_go() {
        // Two corridors lead round a block: the intended way goes through the upper one, and the robot through the lower.
        let ring = [(0.1, 0.1, 19.9, 1.9), (0.1, 10.1, 19.9, 11.9), (0.1, 0.1, 1.9, 11.9), (18.1, 0.1, 19.9, 11.9)];
        let nodes = [("a", 1.0, 6.0), ("b", 1.0, 11.0), ("c", 19.0, 11.0), ("d", 19.0, 6.0)];
        let place = location(carve(20.0, 12.0, &ring), &nodes, &[("a", "b"), ("b", "c"), ("c", "d")]);
        let made = setup(place, &["a", "b", "c", "d"], &[], &[]);
        let floor = Floor::new(&made.location.grid);
        let mut robot = start::robot(&made, &floor);
        assert!((robot.route.length_m() - 28.0).abs() < 1e-9);
        let south = (0..=50).map(|k| Point::new(1.0, 6.0 - 0.1 * f64::from(k)));
        let east = (1..=180).map(|k| Point::new(1.0 + 0.1 * f64::from(k), 1.0));
        let mut marks: Vec<f64> = Vec::new();
        for at in south.chain(east) {
            robot.settle(at, Vector::zeros(), floor.field());
            marks.push(robot.s);
        }
        let (half, last) = (marks[50 + 90], marks[50 + 180]);
        assert!((half - 14.0).abs() < 1.5, "half of the way is half of the way: {half}");
        assert!((last - 23.0).abs() < 1.5, "5 m are left: {last}");
    }
}
