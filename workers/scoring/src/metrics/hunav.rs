//! The metrics of HuNavSim's evaluator (1.x) as its code has them, defects kept, for comparison with published numbers.
//!
//! Values are over the recording's own samples, as upstream takes them, at most 20 a second: sums grow with the
//! sampling rate, and some depend on how the map is turned. `WHY_OUR_NUMBER_DIFFERS.md` lists each defect with the metric of ours that has
//! none of it.

use socrates_model::geometry::wrap_angle;
use socrates_model::{Point, Vector};

use crate::metrics::forces::{FADED, faded};
use crate::metrics::{Family, Measure, Measured, Scene, count};
use crate::tracks::{Sample, Track, Tracks};

/// What upstream calls a collision, m.
const TOUCH_M: f64 = 0.02;
/// Radius of the goal that upstream forces, m.
const GOAL_M: f64 = 0.2;
/// How far ahead of its members a group's center is taken, m.
const STRIDE_M: f64 = 1.5;
/// Bounds of the zones about a person, m (Hall 1966).
const ZONES_M: [f64; 4] = [0.0, 0.45, 1.2, 3.6];

/// Samples nearer than this are left out, s: simulators publish states at about this rate.
const STEP_SECS: f64 = 0.05;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "hunav",
    thresholds: &[("touch_m", TOUCH_M), ("goal_m", GOAL_M), ("stride_m", STRIDE_M)],
    measure: Measure::Whole { measure, why: "the other tool's figures, as it computes them after a run" },
};

/// Step from a sample to the one before it, s.
fn steps(track: &Track) -> impl Iterator<Item = (&Sample, &Sample)> {
    track.samples.iter().zip(track.samples.iter().skip(1))
}

fn surface(robot: &Track, r: &Sample, human: &Track, h: &Sample) -> f64 {
    (r.at - h.at).norm() - robot.radius_m - human.radius_m
}

/// Social force with the angle as coded: `atan2(y, x)` of the line less `atan2(x, y)` of the interaction.
fn force(one: &Sample, other: &Sample) -> Vector {
    let line = other.at - one.at;
    let distance = line.norm();
    if distance <= 1e-9 {
        return Vector::zeros();
    }
    let e = line / distance;
    let t = (one.velocity - other.velocity) * 2.0 + e;
    let size = t.norm();
    if size <= 1e-9 {
        return Vector::zeros();
    }
    let b = 0.35 * size;
    let along = t / size;
    let left = Vector::new(-along.y, along.x);
    if distance > FADED * b {
        return Vector::zeros();
    }
    let theta = wrap_angle(libm::atan2(e.y, e.x) - libm::atan2(along.x, along.y));
    let decay = |n: f64| faded(distance / b + (n * b * theta) * (n * b * theta));
    let sign = if theta > 0.0 { 1.0 } else { -1.0 };
    along * (-2.1 * decay(3.0)) + left * (-2.1 * sign * decay(2.0))
}

/// Share of values in each zone, %.
fn zones(values: &[f64]) -> [f64; 3] {
    let mut found = [0.0; 3];
    let bounds = ZONES_M.iter().zip(ZONES_M.iter().skip(1));
    for (slot, (low, high)) in found.iter_mut().zip(bounds) {
        let inside = values.iter().filter(|value| **value >= *low && **value < *high).count();
        *slot = 100.0 * count(inside) / count(values.len().max(1));
    }
    found
}

/// Smallest distance of the robot's surface from a group's center at every sample; groups as the evidence names them.
fn group_distances(scene: &Scene<'_>, tracks: &Tracks, robot: &Track) -> Vec<f64> {
    let groups: Vec<Vec<&Track>> =
        scene.groups().iter().map(|group| group.iter().filter_map(|id| tracks.human(*id)).collect()).collect();
    robot
        .samples
        .iter()
        .enumerate()
        .filter_map(|(k, r)| {
            groups
                .iter()
                .filter_map(|members| {
                    let ahead: Vec<Point> = members
                        .iter()
                        .filter_map(|track| track.samples.get(k))
                        .filter(|sample| sample.there)
                        .map(|sample| sample.at + sample.facing() * STRIDE_M)
                        .collect();
                    let first = ahead.first()?;
                    let sum: Vector = ahead.iter().map(|point| point - first).sum();
                    Some((r.at - (first + sum / count(ahead.len()))).norm() - robot.radius_m)
                })
                .min_by(f64::total_cmp)
        })
        .collect()
}

/// Contacts by sample: `(robot at fault, person at fault)`.
fn contacts(robot: &Track, humans: &[Track]) -> (usize, usize) {
    let (mut by_robot, mut by_person) = (0, 0);
    for human in humans {
        for (r, h) in robot.beside(human) {
            if surface(robot, r, human, h) >= TOUCH_M {
                continue;
            }
            let line = r.at - h.at;
            let seen = wrap_angle(libm::atan2(line.y, line.x) - h.yaw).abs();
            // The arguments are the wrong way round, so this bearing is taken from the other axis.
            let swapped = wrap_angle(libm::atan2(-line.x, -line.y) - r.yaw).abs();
            if seen < swapped {
                by_robot += 1;
            } else if seen > swapped {
                by_person += 1;
            }
        }
    }
    (by_robot, by_person)
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let tracks = scene.recorded.thinned(STEP_SECS);
    let Some(robot) = &tracks.robot else { return Vec::new() };
    let humans = &tracks.humans;
    let n = count(robot.samples.len().max(1));
    let (Some(first), Some(last)) = (robot.samples.first(), robot.samples.last()) else { return Vec::new() };
    let whole = last.t - first.t;
    let mean = |sum: f64| Ok(sum / n);
    let at = |track: &Track, k: usize| track.samples.get(k).copied().filter(|sample| sample.there);
    let nearest: Vec<f64> = robot
        .samples
        .iter()
        .enumerate()
        .map(|(k, r)| {
            humans.iter().filter_map(|h| Some(surface(robot, r, h, &at(h, k)?))).fold(f64::INFINITY, f64::min)
        })
        .collect();
    let closest_speed: f64 = robot
        .samples
        .iter()
        .enumerate()
        .filter_map(|(k, r)| {
            humans
                .iter()
                .filter_map(|h| at(h, k))
                .min_by(|a, b| (a.at - r.at).norm().total_cmp(&(b.at - r.at).norm()))
                .map(|h| h.speed())
        })
        .sum();
    let farthest = humans
        .iter()
        .flat_map(|h| robot.beside(h))
        .map(|(r, h)| (r.at - h.at).norm() - robot.radius_m)
        .fold(0.0, f64::max);
    let turning = |a: &Sample, b: &Sample| if b.t > a.t { wrap_angle(b.yaw - a.yaw) / (b.t - a.t) } else { 0.0 };
    let still = steps(robot).filter(|(a, b)| b.speed() < 0.01 && turning(a, b) < 0.02).count();
    let change = |power: i32| {
        steps(robot)
            .filter(|(a, b)| b.t > a.t)
            .map(|(a, b)| ((b.speed() - a.speed()) / (b.t - a.t).powi(power)).abs())
            .sum::<f64>()
    };
    let target: Vec<f64> =
        scene.goal.map_or_else(Vec::new, |goal| robot.samples.iter().map(|r| (r.at - goal).norm()).collect());
    let final_m = target.last().copied().unwrap_or(10_000.0);
    let zone = zones(&nearest);
    let group = zones(&group_distances(scene, &tracks, robot));
    let (by_robot, by_person) = contacts(robot, humans);
    let (mut on_agents, mut on_robot, mut summed) = (0.0, 0.0, 0.0);
    for (k, r) in robot.samples.iter().enumerate() {
        let mut all = Vector::zeros();
        for h in humans.iter().filter_map(|h| at(h, k)) {
            on_agents += force(&h, r).norm();
            let pull = force(r, &h);
            on_robot += pull.norm();
            all += pull;
        }
        summed += all.norm();
    }
    let wall = |track: &Track| -> f64 {
        scene.signals.field.as_ref().map_or(0.0, |field| {
            let each = track.present();
            each.map(|s| 10.0 * libm::exp(-(field.clearance(&s.at) - track.radius_m) / 0.2)).sum()
        })
    };
    let on_walls: f64 = humans.iter().map(wall).sum::<f64>() / count(humans.len().max(1));
    let ways: f64 = steps(robot).map(|(a, b)| (b.at - a.at).norm()).sum();
    let headings: f64 = steps(robot).map(|(a, b)| wrap_angle(a.yaw - b.yaw).abs()).sum();
    let speeds: f64 = humans.iter().flat_map(Track::present).map(Sample::speed).sum();
    vec![
        Ok(whole),
        Ok(ways),
        Ok(headings),
        mean(nearest.iter().map(|distance| distance.max(0.0)).sum()),
        Ok(nearest.iter().copied().fold(f64::INFINITY, f64::min).max(0.0)),
        Ok(farthest),
        Ok(zone[0]),
        Ok(zone[1]),
        Ok(zone[2]),
        Ok(group[0]),
        Ok(group[1]),
        Ok(group[2]),
        Ok(if final_m - GOAL_M < 0.0 { 1.0 } else { 0.0 }),
        Ok(target.iter().copied().fold(10_000.0, f64::min)),
        Ok(final_m),
        Ok(count(by_robot)),
        Ok(count(by_person)),
        Ok(whole / n * count(still)),
        mean(robot.samples.iter().map(Sample::speed).sum()),
        mean(steps(robot).map(|(a, b)| turning(a, b).abs()).sum()),
        mean(change(1)),
        mean(change(2)),
        Ok(speeds / (n * count(humans.len().max(1)))),
        mean(closest_speed),
        Ok(on_agents),
        Ok(on_robot),
        Ok(summed + wall(robot) + on_agents),
        Ok(wall(robot)),
        Ok(on_walls),
    ]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_4, PI};

    use socrates_model::AgentId;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    fn past(step: f64) -> socrates_model::Recording {
        recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 3., 0.6, -0.5, 0.)], 6.0, step)
    }

    #[test]
    fn upstream_sums_grow_with_the_rate_and_ours_do_not() {
        let (coarse, fine) = (past(0.1), past(0.05));
        for id in ["hunav.social_force_on_agents", "hunav.social_force_on_robot"] {
            let (a, b) = (value(&coarse, id).unwrap(), value(&fine, id).unwrap());
            assert!(b > 1.9 * a, "{id}: {a} at 10 Hz, {b} at 20 Hz");
        }
        let (a, b) =
            (value(&coarse, "social_force_on_people").unwrap(), value(&fine, "social_force_on_people").unwrap());
        assert!((a - b).abs() < 0.02 * b);
    }

    #[test]
    fn upstream_jerk_is_an_acceleration_over_time_once_more() {
        // From 0 to 1 m/s in 1 s, even: an acceleration of 1 m/s² and no jerk at all in between.
        for (step, wanted) in [(0.1, 10.0), (0.05, 20.0)] {
            let mut run = recording(&[Walk::through(AgentId::Robot, &[(0., 0., 0.)])], 1.0, step);
            for state in &mut run.frames {
                let t = state.tick as f64 * step;
                (state.vx, state.x) = (t, t * t / 2.0);
            }
            let found = value(&run, "hunav.avg_overacceleration").unwrap();
            assert!((found - wanted).abs() < 0.1 * wanted, "{found} at a step of {step}");
            assert!(value(&run, "jerk_mean").unwrap() < 0.05);
        }
    }

    #[test]
    fn upstream_takes_every_turn_to_the_right_for_standing_still() {
        let spin = |omega: f64| {
            let mut run = recording(&[Walk::through(AgentId::Robot, &[(0., 0., 0.)])], 4.0, 0.1);
            for state in &mut run.frames {
                state.yaw = omega * state.tick as f64 * 0.1;
            }
            value(&run, "hunav.time_not_moving").unwrap()
        };
        assert!(spin(0.5) < 1e-9 && spin(-0.5) > 3.5, "{} {}", spin(0.5), spin(-0.5));
    }

    #[test]
    fn upstream_blame_turns_with_the_map() {
        // A robot that looks at a person who looks 1 rad past it: the same scene, turned as a whole.
        let hit = |turn: f64| {
            let robot = Walk::robot(0., 0., 0., 0.).facing(turn);
            let person = Walk::human(1, 0.5 * turn.cos(), 0.5 * turn.sin(), 0., 0.).facing(turn + PI + 1.0);
            let run = recording(&[robot, person], 1.0, 0.1);
            let of = |id: &str| value(&run, id).unwrap();
            (of("hunav.robot_on_person_collision"), of("hunav.person_on_robot_collision"))
        };
        assert_eq!(hit(0.0), (11.0, 0.0));
        assert_eq!(hit(FRAC_PI_4), (0.0, 11.0));
    }

    #[test]
    fn upstream_counts_samples_of_a_contact_and_leaves_out_the_persons_radius() {
        let run = recording(&[Walk::robot(0., 0., 0., 0.), Walk::human(1, 0.4, 0.1, 0., 0.)], 2.0, 0.1);
        let both = value(&run, "hunav.robot_on_person_collision").unwrap()
            + value(&run, "hunav.person_on_robot_collision").unwrap();
        assert!(both > 15.0 && value(&run, "human_collisions") == Some(1.0), "{both}");
        let away = recording(&[Walk::robot(0., 0., 0., 0.), Walk::human(1, 4., 0., 0., 0.)], 2.0, 0.1);
        assert!((value(&away, "hunav.maximum_distance_to_people").unwrap() - 3.75).abs() < 1e-9);
    }
}
