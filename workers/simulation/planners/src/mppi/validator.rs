//! A last look at the chosen trajectory before its first command is sent.

use super::ground::Ground;
use super::params::TrajectoryValidatorParams;
use super::sequence::Sequence;
use crate::costmap::{INSCRIBED, LETHAL};

/// Whether the robot stays free of obstacles while it carries out a sequence, for as long as the validator looks.
pub(crate) fn is_free(
    sequence: &Sequence,
    dt: f32,
    yaw: f32,
    ground: &Ground<'_>,
    params: &TrajectoryValidatorParams,
) -> bool {
    let steps = (params.collision_lookahead_time / f64::from(dt) + 0.5) as usize;
    let outline = params.consider_footprint && !ground.footprint.is_empty();
    let (mut x, mut y, mut yaw) = (0.0, 0.0, yaw);
    let commands = sequence.vx.iter().zip(&sequence.vy).zip(&sequence.wz);
    commands.take(steps).all(|((vx, vy), wz)| {
        let (sine, cosine) = libm::sincosf(yaw);
        x += dt * (vx * cosine - vy * sine);
        y += dt * (vx * sine + vy * cosine);
        yaw += dt * wz;
        let cost = ground.cost(x, y);
        if outline { cost != LETHAL && !ground.footprint_hits(x, y, yaw) } else { !matches!(cost, INSCRIBED | LETHAL) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::{Costmap, FREE};
    use socrates_model::{Point, Pose};

    #[test]
    fn a_wall_within_the_time_looked_ahead_stops_a_sequence() {
        let mut costmap = Costmap::new(60, 60, 0.1, Point::new(-3.0, -3.0), FREE);
        (0..60).for_each(|row| costmap.set(42, row, INSCRIBED));
        let robot = Pose::new(0.0, 0.0, 0.0);
        let straight = |vx: f32| Sequence { vx: vec![vx; 56], ..Sequence::zeros(56) };
        let free = |sequence: &Sequence, seconds: f64, outline: &[Point]| {
            let params = TrajectoryValidatorParams {
                collision_lookahead_time: seconds,
                consider_footprint: !outline.is_empty(),
            };
            is_free(sequence, 0.05, 0.0, &Ground::new(&costmap, &robot, outline, false), &params)
        };
        // The wall begins 1.2 m ahead.
        assert!(!free(&straight(0.7), 2.0, &[]));
        assert!(free(&straight(0.5), 2.0, &[]));
        assert!(!free(&straight(0.5), 2.8, &[]));
        assert!(free(&straight(-0.7), 2.0, &[]));
        let turning = Sequence { wz: vec![1.5; 56], ..straight(0.7) };
        assert!(free(&turning, 2.0, &[]));
        let outline = [(0.2, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.2, -0.1)].map(|(x, y)| Point::new(x, y));
        assert!(free(&straight(0.7), 2.0, &outline), "with an outline only lethal cells stop it");
    }
}
