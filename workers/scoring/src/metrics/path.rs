//! The robot's path against the shortest one.

use socrates_model::Point;
use socrates_model::geometry::wrap_angle;

use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, or_why, success};

/// Steps shorter than this have no direction, m.
const STEP_M: f64 = 0.02;

const ROBOT: &[Need] = &[Need::Robot];
const GOAL: &[Need] = &[Need::Robot, Need::Goal];
const MAP: &[Need] = &[Need::Robot, Need::Goal, Need::Map];

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[
        Sheet {
            id: "path_length",
            unit: "m",
            direction: Direction::Down,
            needs: ROBOT,
            source: "Francis et al. 2023, table 1 (PL)",
            about: "length of the robot's path on an even 0.1 s grid",
        },
        Sheet {
            id: "spl",
            unit: "share",
            direction: Direction::Up,
            needs: MAP,
            source: "Anderson et al. 2018 (SPL)",
            about: "success times L* / max(L, L*), L* the shortest way for the robot's disc on the map",
        },
        Sheet {
            id: "stl",
            unit: "share",
            direction: Direction::Up,
            needs: MAP,
            source: "Francis et al. 2021 (STL)",
            about: "success times T* / max(T, T*), T* the shortest way at the robot's nominal speed",
        },
        Sheet {
            id: "path_efficiency",
            unit: "share",
            direction: Direction::Up,
            needs: MAP,
            source: "SEAN 2.0, path_efficiency",
            about: "L* / L of a robot that arrived",
        },
        Sheet {
            id: "path_length_ratio",
            unit: "ratio",
            direction: Direction::Down,
            needs: GOAL,
            source: "SocNavBench, path_length_ratio as documented",
            about: "path length over the straight distance from start to goal",
        },
        Sheet {
            id: "path_irregularity",
            unit: "rad/m",
            direction: Direction::Down,
            needs: ROBOT,
            source: "SocNavBench, path_irregularity, without its dependence on the origin",
            about: "turning of the direction of travel, less the turn from the first to the last direction, over the path length",
        },
        Sheet {
            id: "cumulative_heading_change",
            unit: "rad",
            direction: Direction::Down,
            needs: ROBOT,
            source: "Francis et al. 2023; HuNavSim, cumulative_heading_changes",
            about: "sum of the absolute changes of heading on an even 0.1 s grid",
        },
        Sheet {
            id: "curvature_mean",
            unit: "1/m",
            direction: Direction::Down,
            needs: ROBOT,
            source: "Menger curvature, as in Arena",
            about: "mean Menger curvature 4 A / (a b c) of points half a metre of way apart",
        },
    ],
    measure,
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let length = scene.path_length_m();
    let start = scene.even.first().map(|sample| sample.at);
    let shortest = start.and_then(|start| scene.to_goal_m(&start)).filter(|way| *way > 0.0);
    let speed = scene.robot().map_or(0.0, |robot| robot.speed_mps);
    let succeeded = if success::succeeded(scene) { 1.0 } else { 0.0 };
    let no_way = "the map has no way to the goal for the robot's disc";
    let straight = start.zip(scene.goal).map(|(start, goal)| (goal - start).norm()).filter(|way| *way > 1e-6);
    let arrived = scene.arrived_s.is_some();
    let heading: f64 =
        scene.even.iter().zip(scene.even.iter().skip(1)).map(|(a, b)| wrap_angle(b.yaw - a.yaw).abs()).sum();
    vec![
        Ok(length),
        or_why(shortest.map(|way| succeeded * way / length.max(way)), no_way),
        match (shortest, scene.trip_s()) {
            (Some(_), None) => Ok(0.0),
            (Some(way), Some(time)) if speed > 0.0 => Ok(succeeded * (way / speed) / time.max(way / speed)),
            (Some(_), Some(_)) => Err("the robot's nominal speed is not known".to_owned()),
            (None, _) => Err(no_way.to_owned()),
        },
        match shortest {
            None => Err(no_way.to_owned()),
            Some(_) if !arrived => Err("the robot never arrives".to_owned()),
            Some(way) => or_why((length > 0.0).then(|| (way / length).min(1.0)), "the robot does not move"),
        },
        or_why(straight.map(|straight| length / straight), "start and goal are one place"),
        irregularity(scene, length),
        Ok(heading),
        curvature(scene),
    ]
}

fn irregularity(scene: &Scene<'_>, length: f64) -> Measured {
    let mut directions: Vec<f64> = Vec::new();
    let mut from = match scene.even.first() {
        Some(sample) => sample.at,
        None => return Err("the recording is empty".to_owned()),
    };
    for sample in &scene.even {
        let step = sample.at - from;
        if step.norm() >= STEP_M {
            directions.push(libm::atan2(step.y, step.x));
            from = sample.at;
        }
    }
    let (Some(first), Some(last)) = (directions.first(), directions.last()) else {
        return Err("the robot does not move".to_owned());
    };
    let turned: f64 = directions.iter().zip(directions.iter().skip(1)).map(|(a, b)| wrap_angle(b - a).abs()).sum();
    Ok((turned - wrap_angle(last - first).abs()).max(0.0) / length.max(STEP_M))
}

/// Points of the path, half a metre of way apart.
pub(super) fn spaced(scene: &Scene<'_>) -> Vec<Point> {
    let mut points = Vec::new();
    let (mut way, mut next) = (0.0, 0.0);
    let mut before: Option<Point> = None;
    for sample in &scene.even {
        // The point at the very length, not the sample after it: else the spacing would follow the grid.
        if let Some(last) = before {
            let step = (sample.at - last).norm();
            while way + step >= next && step > 0.0 {
                points.push(last + (sample.at - last) * ((next - way) / step));
                next += 0.5;
            }
            way += step;
        }
        before = Some(sample.at);
    }
    points
}

fn curvature(scene: &Scene<'_>) -> Measured {
    let mut total = 0.0;
    let mut triples = 0_usize;
    for triple in spaced(scene).windows(3) {
        let [p, q, r] = triple else { continue };
        let (a, b, c) = ((q - p).norm(), (r - q).norm(), (r - p).norm());
        if a * b * c > 1e-9 {
            total += 2.0 * (q - p).perp(&(r - p)).abs() / (a * b * c);
            triples += 1;
        }
    }
    or_why((triples > 0).then(|| total / crate::metrics::count(triples)), "the path is shorter than 1 m")
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use socrates_model::{AgentId, EventKind};

    use crate::evidence::Evidence;
    use crate::fixture::{Walk, event, floor, recording};
    use crate::metrics::tests::{at_both_rates, value, value_of};

    #[test]
    fn a_circle_has_the_curvature_of_its_radius_and_turns_once_round() {
        let circle = || vec![Walk::circle(2.0, 20.0)];
        at_both_rates(&circle, 19.9, "curvature_mean", 0.5, 0.01);
        at_both_rates(&circle, 19.9, "path_length", 2.0 * TAU * 19.9 / 20.0, 0.02);
        at_both_rates(&circle, 19.9, "cumulative_heading_change", TAU * 19.9 / 20.0, 0.06);
    }

    #[test]
    fn a_straight_path_is_not_irregular_wherever_it_lies() {
        for (x, y) in [(0., 0.), (30., -7.)] {
            let run = recording(&[Walk::robot(x, y, 0.5, 0.1)], 10.0, 0.1);
            assert!(value(&run, "path_irregularity").unwrap() < 1e-9);
        }
    }

    #[test]
    fn a_detour_costs_its_share_of_spl() {
        let place = floor(&[], &[], &[]);
        // 3 m and 4 m instead of 5 m.
        let walk = Walk::through(AgentId::Robot, &[(0., 0., 0.), (3., 3., 0.), (7., 3., 4.)]);
        let mut run = recording(&[walk], 7.0, 0.1);
        event(&mut run, 7.0, EventKind::RobotArrived);
        let evidence = Evidence { location: Some(&place), ..Evidence::of(&run) };
        let spl = value_of(&evidence, "spl").unwrap();
        assert!((spl - 5.0 / 7.0).abs() < 0.05, "{spl}");
        assert_eq!(value(&run, "spl"), None);
        assert!((value(&run, "path_length_ratio").unwrap() - 1.4).abs() < 1e-6);
    }
}
