//! Quantities over time of one run, for plots.

use socrates_model::{AgentState, Recording};

use crate::presence::There;

/// Quantities of one run at fixed steps. `None`: there is nothing to measure at that moment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curves {
    /// Surface distance of the robot to the nearest human, m; negative in contact.
    pub distance_m: Vec<Option<f64>>,
    /// That human's number.
    pub distance_to: Vec<u32>,
    /// Speed of the robot, m/s.
    pub speed_mps: Vec<Option<f64>>,
    /// Smallest time to collision of the robot with a human at constant velocity, s.
    pub ttc_s: Vec<Option<f64>>,
    /// That human's number.
    pub ttc_to: Vec<u32>,
}

/// The curves of a recording at every n-th tick.
#[must_use]
pub fn curves(recording: &Recording, every: usize) -> Curves {
    let mut curves = Curves::default();
    let there = There::of(recording);
    let radius: Vec<f64> = recording.header.agents.iter().map(|info| info.radius_m).collect();
    for tick in (0..recording.ticks()).step_by(every.max(1)) {
        let states = recording.tick(tick);
        let robot = states.iter().zip(&radius).find(|(state, _)| state.agent == 0);
        let mut near: Option<(f64, u32)> = None;
        let mut soon: Option<(f64, u32)> = None;
        if let Some((robot, robot_radius)) = robot {
            for (human, human_radius) in states.iter().zip(&radius).filter(|(s, _)| s.agent != 0 && there.is(s)) {
                let radii = robot_radius + human_radius;
                let gap = (human.x - robot.x).hypot(human.y - robot.y) - radii;
                if gap.is_finite() && near.is_none_or(|(least, _)| gap < least) {
                    near = Some((gap, human.agent));
                }
                if let Some(time) = time_to_collision(robot, human, radii)
                    && soon.is_none_or(|(least, _)| time < least)
                {
                    soon = Some((time, human.agent));
                }
            }
        }
        curves.distance_m.push(near.map(|(gap, _)| gap));
        curves.distance_to.push(near.map_or(0, |(_, who)| who));
        curves.speed_mps.push(robot.map(|(robot, _)| robot.speed()).filter(|speed| speed.is_finite()));
        curves.ttc_s.push(soon.map(|(time, _)| time));
        curves.ttc_to.push(soon.map_or(0, |(_, who)| who));
    }
    curves
}

/// Time until two discs touch at constant velocity, s; 0 in contact, `None` when they never do.
/// With `p` the difference of positions, `w` of velocities, `R` the sum of radii:
/// `(-p.w - √((p.w)² - w.w (p.p - R²))) / w.w`.
fn time_to_collision(robot: &AgentState, human: &AgentState, radii_m: f64) -> Option<f64> {
    let (px, py) = (human.x - robot.x, human.y - robot.y);
    let (wx, wy) = (human.vx - robot.vx, human.vy - robot.vy);
    let c = px * px + py * py - radii_m * radii_m;
    if c < 0.0 {
        return Some(0.0);
    }
    let (a, b) = (wx * wx + wy * wy, px * wx + py * wy);
    let root = b * b - a * c;
    (b < 0.0 && root >= 0.0 && a > 1e-12).then(|| (-b - root.sqrt()) / a).filter(|time| time.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{human, recording, robot};

    #[test]
    fn two_discs_head_on_meet_when_their_rims_do() {
        // 4.6 m apart, radii 0.3 each, closing at 2 m/s: 4 m to go.
        let run = recording(&[&[robot(0.0, 0.0, 1.0, 0.0), human(1, 4.6, 0.0, -1.0, 0.0)]]);
        let curves = curves(&run, 1);
        assert!((curves.distance_m[0].unwrap() - 4.0).abs() < 1e-12);
        assert!((curves.ttc_s[0].unwrap() - 2.0).abs() < 1e-12);
        assert!((curves.speed_mps[0].unwrap() - 1.0).abs() < 1e-12);
        assert_eq!((curves.distance_to[0], curves.ttc_to[0]), (1, 1));
    }

    #[test]
    fn the_nearest_human_need_not_be_the_one_on_a_collision_course() {
        let run =
            recording(&[&[robot(0.0, 0.0, 1.0, 0.0), human(1, 0.0, 1.0, 0.0, 0.0), human(2, 3.0, 0.0, 0.0, 0.0)]]);
        let curves = curves(&run, 1);
        assert_eq!((curves.distance_to[0], curves.ttc_to[0]), (1, 2));
    }

    #[test]
    fn without_humans_or_without_a_robot_there_is_no_distance() {
        let alone = curves(&recording(&[&[robot(0.0, 0.0, 0.5, 0.0)]]), 1);
        assert_eq!((alone.distance_m[0], alone.ttc_s[0], alone.speed_mps[0]), (None, None, Some(0.5)));
        let people = curves(&recording(&[&[human(1, 0.0, 0.0, 0.0, 0.0)]]), 1);
        assert_eq!((people.distance_m[0], people.speed_mps[0]), (None, None));
        let broken = curves(&recording(&[&[robot(f64::NAN, 0.0, 0.0, 0.0), human(1, 0.0, 0.0, 0.0, 0.0)]]), 1);
        assert_eq!((broken.distance_m[0], broken.ttc_s[0]), (None, None));
    }
}
