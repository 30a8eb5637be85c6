//! A 360-beam scan over walls, doors and people.

use socrates_model::{Point, Pose, Vector};

use crate::floor::{Floor, ray_disc};

/// Beams of a scan; beam 0 is straight ahead, then counter-clockwise by one degree.
pub const BEAMS: usize = 360;

/// Ranges of one scan, m; a beam that meets nothing reads `max_m`.
#[must_use]
pub fn scan(floor: &Floor, from: &Pose, people: &[(Point, f64)], max_m: f64) -> Vec<f64> {
    let center = from.point();
    let near: Vec<&(Point, f64)> = people.iter().filter(|(at, radius)| (at - center).norm() - radius < max_m).collect();
    (0..BEAMS)
        .map(|beam| {
            #[expect(clippy::cast_precision_loss, reason = "360 beams")]
            let angle = from.yaw + (beam as f64).to_radians();
            let heading = Vector::new(libm::cos(angle), libm::sin(angle));
            let wall = floor.ray_m(&center, angle, max_m);
            near.iter().filter_map(|(at, radius)| ray_disc(&center, &heading, at, *radius)).fold(wall, f64::min)
        })
        .collect()
}
