//! Whose motion makes a collision likely.

use crate::metrics::collisions::closing_share;
use crate::metrics::ttc::{EXPOSED_SECS, time_to_collision};
use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, or_why};

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[Sheet {
        id: "blame",
        unit: "share",
        direction: Direction::Down,
        needs: &[Need::Robot, Need::Humans],
        source: "own: no canonical formula is published",
        about: "mean share of the robot in the closing speed while the time to collision is below 3 s; 0.5 when both come alike",
    }],
    measure,
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let (mut area, mut seconds) = (0.0, 0.0);
    for (robot, human) in scene.pairs() {
        let times = robot.between(human, |r, h| {
            let ttc = time_to_collision(r, h, robot.radius_m + human.radius_m).unwrap_or(2.0 * EXPOSED_SECS);
            ttc.min(2.0 * EXPOSED_SECS)
        });
        if times.least().is_none_or(|(_, least)| least >= EXPOSED_SECS) {
            continue;
        }
        let shares = robot.between(human, |r, h| closing_share(r, h).unwrap_or(0.0));
        let exposed = times.time_below(EXPOSED_SECS);
        if let Some(mean) = shares.mean_while_below(&times, EXPOSED_SECS) {
            area += mean * exposed;
            seconds += exposed;
        }
    }
    vec![or_why((seconds > 0.0).then(|| area / seconds), "the two are never on a collision course within 3 s")]
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn two_who_come_alike_share_the_blame_and_a_standing_robot_has_none() {
        let alike = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 8., 0., -1., 0.)], 3.5, 0.05);
        assert!((value(&alike, "blame").unwrap() - 0.5).abs() < 1e-6);
        let hit = recording(&[Walk::robot(0., 0., 0., 0.), Walk::human(1, 4., 0., -1., 0.)], 3.0, 0.05);
        assert!(value(&hit, "blame").unwrap().abs() < 1e-6);
    }
}
