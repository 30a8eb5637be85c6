//! What a flat lidar in the middle of the robot would measure: the map's walls and the discs of people.

use socrates_maps::Sight;
use socrates_model::{Grid, Point};

/// Beams of a turn.
pub(super) const BEAMS: u32 = 360;
/// Least and largest range, m; nothing within the largest is infinite (REP 117).
pub(super) const NEAREST_M: f64 = 0.05;
pub(super) const FARTHEST_M: f64 = 12.0;

/// The lidar on a map.
pub(super) struct Lidar {
    sight: Sight,
}

impl Lidar {
    pub(super) fn of(grid: &Grid) -> Self {
        Self { sight: Sight::new(grid) }
    }

    /// Ranges of every beam, from straight behind counterclockwise, m.
    pub(super) fn ranges(&self, from: Point, yaw: f64, discs: &[(Point, f64)]) -> Vec<f64> {
        let step = std::f64::consts::TAU / f64::from(BEAMS);
        let beam = |number: u32| {
            let angle = yaw - std::f64::consts::PI + step * f64::from(number);
            let wall = self.sight.ray(&from, angle, FARTHEST_M);
            let nearest = discs.iter().filter_map(|disc| hit(&from, angle, disc)).fold(wall, f64::min);
            if nearest >= FARTHEST_M { f64::INFINITY } else { nearest }
        };
        (0..BEAMS).map(beam).collect()
    }
}

/// Distance along a ray to a disc, m; 0 from within it.
fn hit(from: &Point, angle: f64, (center, radius_m): &(Point, f64)) -> Option<f64> {
    let (sin, cos) = libm::sincos(angle);
    let to = center - from;
    let (along, across) = (to.x * cos + to.y * sin, to.y * cos - to.x * sin);
    let half = radius_m * radius_m - across * across;
    if half < 0.0 {
        return None;
    }
    let half = half.sqrt();
    (along + half >= 0.0).then(|| (along - half).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_ends_at_the_near_side_of_a_disc_before_it() {
        let disc = (Point::new(3.0, 0.0), 0.5);
        let origin = Point::origin();
        assert!((hit(&origin, 0.0, &disc).unwrap() - 2.5).abs() < 1e-12);
        assert_eq!(hit(&origin, 1.0, &disc), None);
        assert_eq!(hit(&origin, std::f64::consts::PI, &disc), None);
        assert_eq!(hit(&Point::new(3.1, 0.0), 0.0, &disc), Some(0.0));
    }
}
