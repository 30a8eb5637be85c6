//! From wall segments to the points that a person feels.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use crate::vector::{dot, norm};

/// A piece of wall; both ends equal for a single point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// One end, m.
    pub from: Point2<f64>,
    /// The other end, m.
    pub to: Point2<f64>,
}

impl Segment {
    /// The point of the segment that is closest to `position`.
    #[must_use]
    pub fn closest(&self, position: &Point2<f64>) -> Point2<f64> {
        let along = self.to - self.from;
        let length2 = dot(&along, &along);
        let share = if length2 > 0.0 { dot(&(position - self.from), &along) / length2 } else { 0.0 };
        self.from + along * share.clamp(0.0, 1.0)
    }
}

/// The closest point of every segment within `range_m` of `position`, in list order.
///
/// The reference and its users take 3 m; beyond it the obstacle force is below 1e-5 m/s².
#[must_use]
pub fn points_in_range(position: &Point2<f64>, segments: &[Segment], range_m: f64) -> Vec<Point2<f64>> {
    segments
        .iter()
        .map(|segment| segment.closest(position))
        .filter(|point| norm(&(position - point)) <= range_m)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closest_point_lies_on_the_segment_or_at_its_end() {
        let wall = Segment { from: Point2::new(0.0, 0.0), to: Point2::new(4.0, 0.0) };
        assert_eq!(wall.closest(&Point2::new(1.0, 2.0)), Point2::new(1.0, 0.0));
        assert_eq!(wall.closest(&Point2::new(9.0, 2.0)), Point2::new(4.0, 0.0));
        let post = Segment { from: Point2::new(1.0, 1.0), to: Point2::new(1.0, 1.0) };
        assert_eq!(post.closest(&Point2::new(9.0, 2.0)), Point2::new(1.0, 1.0));
    }

    #[test]
    fn far_walls_are_not_felt() {
        let wall = Segment { from: Point2::new(0.0, 3.1), to: Point2::new(4.0, 3.1) };
        assert!(points_in_range(&Point2::new(1.0, 0.0), &[wall], 3.0).is_empty());
        assert_eq!(points_in_range(&Point2::new(1.0, 0.2), &[wall], 3.0).len(), 1);
    }
}
