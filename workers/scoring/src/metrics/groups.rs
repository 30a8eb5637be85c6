//! The space of groups.

use socrates_model::{HumanId, Point};

use crate::circle::{Circle, P_SPACE_M, STANDING_MPS};
use crate::hull::{convex_hull, outside_hull_m};
use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::running::Least;
use crate::series::Series;
use crate::tracks::{Sample, Track};

/// Members nearer to each other than this are together; a robot between them splits the group, m.
const TOGETHER_M: f64 = 2.5;
/// Foot points nearer to the line between two members than this disturb them, m (Okal and Arras).
const RELATION_M: f64 = 0.6;

/// The hull of a group is inflated by this, m.
const HULL_M: f64 = 0.45;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "groups",
    thresholds: &[
        ("together_m", TOGETHER_M),
        ("relation_m", RELATION_M),
        ("hull_m", HULL_M),
        ("p_space_m", P_SPACE_M),
        ("standing_mps", STANDING_MPS),
    ],
    measure: Measure::Whole { measure, why: "members are looked at together, and only those who ever come" },
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let Some(robot) = scene.robot() else { return Vec::new() };
    let groups: Vec<Vec<&Track>> =
        scene.groups().iter().map(|group| members(scene, group)).filter(|group| group.len() >= 2).collect();
    if groups.is_empty() {
        return FAMILY.sheets().iter().map(|_| Err("no group of two is in the recording".to_owned())).collect();
    }
    let (mut seconds, mut entries) = (0.0, 0_usize);
    let mut deepest: Option<f64> = None;
    let (mut splits, mut disturbed) = (0_usize, 0.0);
    let (mut ring, mut in_hull) = (0.0, 0.0);
    let mut nearest = Least::default();
    for group in &groups {
        let outside = outside(robot, group);
        seconds += outside.time_below(0.0);
        ring += outside.time_below(P_SPACE_M) - outside.time_below(0.0);
        let beside = beside_hull(robot, group);
        in_hull += beside.time_below(HULL_M);
        nearest.add(beside.least().map(|(_, least)| least.max(0.0)));
        entries += outside.stretches_below(0.0, 0.05, 0.5).len();
        if let Some((_, least)) = outside.least() {
            deepest = Some(deepest.map_or(-least, |old: f64| old.max(-least)).max(0.0));
        }
        for (index, a) in group.iter().enumerate() {
            for b in group.iter().skip(index + 1) {
                splits += crossings(robot, a, b);
                disturbed += disturbance(robot, a, b).time_below(0.0);
            }
        }
    }
    let standing = "the group never stands in a circle";
    vec![
        or_why(deepest.map(|_| seconds), standing),
        or_why(deepest, standing),
        or_why(deepest.map(|_| count(entries)), standing),
        Ok(count(splits)),
        Ok(disturbed),
        or_why(deepest.map(|_| ring), standing),
        Ok(in_hull),
        Ok(if in_hull > 0.0 { 1.0 } else { 0.0 }),
        or_why(nearest.value(), "no group is there as a whole while the robot is"),
    ]
}

fn members<'s>(scene: &'s Scene<'_>, ids: &[HumanId]) -> Vec<&'s Track> {
    ids.iter().filter_map(|id| scene.tracks.human(*id)).collect()
}

/// Distance of the robot's disc from the o-space over time, negative inside; only while all stand.
fn outside(robot: &Track, group: &[&Track]) -> Series {
    let mut found = Vec::new();
    for (index, r) in robot.samples.iter().enumerate() {
        let now: Vec<&Sample> = group.iter().filter_map(|track| track.samples.get(index)).filter(|s| s.there).collect();
        if now.len() < group.len() {
            continue;
        }
        let radius = group.first().map_or(0.0, |track| track.radius_m);
        let Some(circle) = Circle::of(&now, radius) else { continue };
        found.push((r.t, circle.outside_o(&r.at, robot.radius_m)));
    }
    found.into_iter().collect()
}

/// Distance of the robot's disc from the convex hull of the members over time.
fn beside_hull(robot: &Track, group: &[&Track]) -> Series {
    let each = robot.samples.iter().enumerate().map(|(index, r)| {
        let now: Vec<Point> =
            group.iter().filter_map(|track| track.samples.get(index)).filter(|s| s.there).map(|s| s.at).collect();
        let whole = now.len() == group.len();
        (r.t, whole.then(|| outside_hull_m(&convex_hull(now), &r.at) - robot.radius_m))
    });
    each.collect()
}

fn crossings(robot: &Track, a: &Track, b: &Track) -> usize {
    let steps = robot.samples.iter().zip(robot.samples.iter().skip(1));
    let pairs = a.samples.iter().zip(&b.samples);
    steps
        .zip(pairs)
        .filter(|((_, _), (p, q))| p.there && q.there && (p.at - q.at).norm() < TOGETHER_M)
        .filter(|((r, s), (p, q))| {
            // A sample on the line itself belongs to the step that ends there.
            let side = |point: &Point| (q.at - p.at).perp(&(point - p.at));
            (side(&r.at) > 0.0) != (side(&s.at) > 0.0)
                && socrates_model::geometry::segments_cross(&r.at, &s.at, &p.at, &q.at)
        })
        .count()
}

/// Negative while the robot is beside the line between the two, nearer than the limit.
fn disturbance(robot: &Track, a: &Track, b: &Track) -> Series {
    robot
        .samples
        .iter()
        .zip(a.samples.iter().zip(&b.samples))
        .map(|(r, (p, q))| {
            if !(p.there && q.there) {
                return (r.t, None);
            }
            let line = q.at - p.at;
            let length = line.norm().max(1e-9);
            let along = (r.at - p.at).dot(&line) / length;
            let beyond = (-along).max(along - length);
            let aside = ((r.at - p.at).perp(&line) / length).abs();
            (r.t, Some(beyond.max(aside - RELATION_M)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::cases::{group_of, proposal};
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value_of;

    #[test]
    fn a_robot_through_the_middle_of_four_is_as_deep_as_the_circle_and_itself() {
        let stand = |n: u32, x: f64, y: f64, yaw: f64| Walk::human(n, x, y, 0., 0.).facing(yaw);
        let group = |robot: Walk| {
            vec![
                robot,
                stand(1, 1., 1., -3. * PI / 4.),
                stand(2, -1., 1., -PI / 4.),
                stand(3, -1., -1., PI / 4.),
                stand(4, 1., -1., 3. * PI / 4.),
            ]
        };
        let plan = group_of(proposal(4, vec![]), &[1, 2, 3, 4]);
        let run = recording(&group(Walk::robot(-6., 0., 1., 0.)), 12.0, 0.05);
        let evidence = Evidence { proposal: Some(&plan), ..Evidence::of(&run) };
        // Mean distance √2 m less the radius of a person is the o-space; the robot's disc goes in by its radius more.
        let reach = 2.0_f64.sqrt() - 0.28;
        assert!((value_of(&evidence, "o_space_depth_max").unwrap() - (reach + 0.25)).abs() < 0.01);
        assert!((value_of(&evidence, "o_space_seconds").unwrap() - 2.0 * (reach + 0.25)).abs() < 0.02);
        assert_eq!(value_of(&evidence, "o_space_entries"), Some(1.0));
        assert!((value_of(&evidence, "p_space_seconds").unwrap() - 1.2).abs() < 0.02);
        // The hull is the square of 2 m; 0.45 m and the robot's radius more on both sides.
        assert!((value_of(&evidence, "group_hull_seconds").unwrap() - 2.0 * (1.0 + 0.45 + 0.25)).abs() < 0.02);
        assert_eq!(value_of(&evidence, "group_collision"), Some(1.0));
        assert!(value_of(&evidence, "group_splits").unwrap() >= 2.0);
        let wide = recording(&group(Walk::robot(-6., 3., 1., 0.)), 12.0, 0.05);
        let evidence = Evidence { proposal: Some(&plan), ..Evidence::of(&wide) };
        assert_eq!(value_of(&evidence, "o_space_seconds"), Some(0.0));
        assert_eq!(value_of(&evidence, "group_splits"), Some(0.0));
        assert_eq!(value_of(&evidence, "group_collision"), Some(0.0));
        // The way at y = 3 is 2 m beside the square of 2 m, less the robot's 0.25 m; through the middle it is 0.
        assert!((value_of(&evidence, "group_distance_min").unwrap() - 1.75).abs() < 1e-6);
        let through = Evidence { recording: &run, ..evidence };
        assert_eq!(value_of(&through, "group_distance_min"), Some(0.0));
    }
}
