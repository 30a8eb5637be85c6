//! Legibility and predictability: could somebody who watches tell early where the robot goes?

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use socrates_maps::{DistanceField, Geodesic, Ground, Kept};
use socrates_model::{Cell, Grid, NodeId, Point};

use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::tracks::Sample;

/// Weight of a detour in the belief, 1/m: the belief of a watcher falls with `exp(-beta * detour)` (Dragan, Lee and Srinivasa,
/// Legibility and Predictability of Robot Motion, HRI 2013); they leave beta open, and 1 is what is reported here.
pub(super) const BETA_PER_M: f64 = 1.0;
/// Belief from which a watcher is taken to be sure.
const SURE: f64 = 0.5;
/// Candidate goals are at least this far from each other and from the start, m: nearer ones are one place.
const APART_M: f64 = 3.0;
/// Most candidates beside the true goal, the nearest to the robot's way first.
const MOST: usize = 5;
/// Time between two looks at the robot, s.
const LOOK_SECS: f64 = 0.5;
/// Cells of the map on which beliefs are computed, m.
const COARSE_M: f64 = 0.3;
/// Robots of different sizes whose coarse maps are kept.
const MAX_ROBOTS: usize = 4;
/// Half of a human's field of view, rad (100°).
const HALF_VIEW_RAD: f64 = 100.0 / 180.0 * std::f64::consts::PI;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "goals",
    thresholds: &[("beta_per_m", BETA_PER_M), ("sure", SURE), ("apart_m", APART_M), ("half_view_rad", HALF_VIEW_RAD)],
    measure: Measure::Whole { measure, why: "the goals and the weights T - t are known at the end" },
};

/// The robot's goal and the other place that somebody who watches is most likely to take for it; `None` where one of the two is
/// not known.
#[must_use]
pub fn rival_goals(scene: &Scene<'_>) -> Option<[Point; 2]> {
    let goal = scene.goal?;
    let start = scene.even.first()?.at;
    candidates(scene, &goal, &start).first().map(|other| [goal, *other])
}

/// Other places the robot might be going to: ends of the graph's ways, and places off the way at its junctions.
fn candidates(scene: &Scene<'_>, goal: &Point, start: &Point) -> Vec<Point> {
    let Some(place) = scene.signals.evidence.location else { return Vec::new() };
    let graph = &place.graph;
    let on_way: Vec<&NodeId> =
        scene.signals.evidence.paths.map(|paths| paths.robot.iter().collect()).unwrap_or_default();
    let mut found: Vec<(f64, &NodeId, Point)> = Vec::new();
    let far = |a: &Point, b: &Point| (a - b).norm() >= APART_M;
    for node in graph.nodes() {
        let ends = graph.neighbors(&node.id).len() <= 1;
        let beside = !on_way.contains(&&node.id) && graph.neighbors(&node.id).iter().any(|id| on_way.contains(&id));
        if !(ends || beside) || !far(&node.at, goal) || !far(&node.at, start) {
            continue;
        }
        let near = scene.even.iter().map(|sample| (sample.at - node.at).norm()).fold(f64::INFINITY, f64::min);
        found.push((near, &node.id, node.at));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)));
    let mut kept: Vec<Point> = Vec::new();
    for (_, _, at) in found {
        if kept.len() < MOST && kept.iter().all(|other| far(other, &at)) {
            kept.push(at);
        }
    }
    kept
}

/// The map in cells of about 0.3 m that are free where the robot's disc fits: beliefs need differences of ways, and
/// those are as good on it at a tenth of the work.
fn coarse(grid: &Grid, field: &DistanceField, radius_m: f64) -> Grid {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
    let factor = libm::round(COARSE_M / grid.resolution_m).clamp(1.0, 32.0) as usize;
    let mut rough = Grid {
        width: grid.width.div_ceil(factor),
        height: grid.height.div_ceil(factor),
        resolution_m: grid.resolution_m * count(factor),
        origin: grid.origin,
        cells: Vec::new(),
    };
    rough.cells = (0..rough.height)
        .flat_map(|row| (0..rough.width).map(move |column| (column, row)))
        .map(|(column, row)| {
            let fits = field.clearance(&rough.center_of(column, row)) >= radius_m;
            if fits { Cell::Free } else { Cell::Occupied }
        })
        .collect();
    rough
}

/// Coarse maps of one grid by the bits of the radius.
type Rough = Mutex<VecDeque<(u64, Arc<Ground>)>>;

/// The coarse map of a grid for a disc, kept for the last few grids and robots.
fn rough(grid: &Grid, field: &DistanceField, radius_m: f64) -> Arc<Ground> {
    static ROUGH: Kept<Rough> = Kept::new();
    let kept = ROUGH.of(grid, |_| Mutex::default());
    let mut shelf = kept.lock().unwrap_or_else(PoisonError::into_inner);
    let known = shelf.iter().find(|(radius, _)| *radius == radius_m.to_bits()).map(|(_, ground)| Arc::clone(ground));
    known.unwrap_or_else(|| {
        let made = Arc::new(Ground::new(Arc::new(coarse(grid, field, radius_m))));
        if shelf.len() >= MAX_ROBOTS {
            shelf.pop_front();
        }
        shelf.push_back((radius_m.to_bits(), Arc::clone(&made)));
        made
    })
}

/// Belief in the true goal over time, with whether somebody watches: `(t, belief, watched)`.
fn beliefs(scene: &Scene<'_>) -> Result<Vec<(f64, f64, bool)>, String> {
    let (Some(goal), Some(field)) = (scene.goal, &scene.signals.field) else {
        return Err("there is no map with a goal".to_owned());
    };
    let Some(start) = scene.even.first().map(|sample| sample.at) else {
        return Err("the recording is empty".to_owned());
    };
    let radius = scene.robot().map_or(0.0, |robot| robot.radius_m);
    let Some(place) = scene.signals.evidence.location else {
        return Err("there is no map with a goal".to_owned());
    };
    let rough = rough(&place.grid, field, (radius - 0.05).max(0.05));
    let to = |at: &Point| rough.geodesic(at, 0.0);
    let mine = to(&goal);
    let others: Vec<Arc<Geodesic>> = candidates(scene, &goal, &start).iter().map(to).collect();
    let others: Vec<(&Arc<Geodesic>, f64)> =
        others.iter().filter_map(|geodesic| Some((geodesic, geodesic.distance(&start)?))).collect();
    if others.is_empty() {
        return Err("the scene graph has no other place the robot might go to".to_owned());
    }
    let Some(own) = mine.distance(&start) else {
        return Err("the map has no way to the goal for the robot's disc".to_owned());
    };
    let mut way = 0.0;
    let mut before: Option<&Sample> = None;
    let mut next = f64::NEG_INFINITY;
    let mut found = Vec::new();
    for sample in &scene.even {
        way += before.map_or(0.0, |last| (sample.at - last.at).norm());
        before = Some(sample);
        if sample.t < next - 1e-9 {
            continue;
        }
        next = sample.t + LOOK_SECS;
        let Some(left) = mine.distance(&sample.at) else { continue };
        // The length of the way so far is the same for all goals and cancels; it is kept out of the exponent.
        let extra = own - left;
        let rivals = others
            .iter()
            .filter_map(|(geodesic, whole)| Some(whole - geodesic.distance(&sample.at)?))
            .map(|gained| libm::exp((BETA_PER_M * (gained - extra)).clamp(-50.0, 50.0)));
        let belief = 1.0 / (1.0 + rivals.sum::<f64>());
        found.push((sample.t, belief, watched(scene, sample)));
    }
    if found.len() < 2 {
        return Err(format!("the trip of {way:.1} m is shorter than two looks"));
    }
    Ok(found)
}

/// Whether a human has the robot in view.
fn watched(scene: &Scene<'_>, robot: &Sample) -> bool {
    scene.signals.moments.values().any(|moments| {
        let index = moments.partition_point(|moment| moment.t < robot.t - 1e-9);
        moments.get(index).is_some_and(|moment| {
            moment.t - robot.t < 1.0
                && moment.sight != Some(false)
                && moment.human.bearing(&moment.robot.at).abs() <= HALF_VIEW_RAD
        })
    })
}

/// Mean belief with weights that fall to 0 at the end.
fn legibility(beliefs: &[(f64, f64, bool)], seen_only: bool) -> Option<f64> {
    let end = beliefs.last()?.0;
    let (mut sum, mut weights) = (0.0, 0.0);
    for (t, belief, _) in beliefs.iter().filter(|(.., watched)| *watched || !seen_only) {
        let weight = end - t;
        sum += weight * belief;
        weights += weight;
    }
    (weights > 0.0).then(|| sum / weights)
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let length = scene.path_length_m();
    let shortest = scene.even.first().and_then(|sample| scene.to_goal_m(&sample.at));
    let predictability = match (scene.arrived_s, shortest) {
        (None, _) => Err("the robot never arrives".to_owned()),
        (Some(_), None) => Err("the map has no way to the goal for the robot's disc".to_owned()),
        (Some(_), Some(shortest)) => Ok(libm::exp(-BETA_PER_M * (length - shortest).max(0.0))),
    };
    let beliefs = match beliefs(scene) {
        Ok(beliefs) => beliefs,
        Err(why) => {
            let none = || Err(why.clone());
            return vec![none(), predictability, none(), none(), none(), none()];
        }
    };
    let end = beliefs.last().map_or(0.0, |last| last.0);
    let sure_from = beliefs.iter().rev().take_while(|(_, belief, _)| *belief >= SURE).last().map(|(t, ..)| *t);
    let drops = beliefs.iter().zip(beliefs.iter().skip(1)).filter(|(a, b)| a.1 >= SURE && b.1 < SURE).count();
    let area: f64 = beliefs.iter().zip(beliefs.iter().skip(1)).map(|(a, b)| (b.0 - a.0) * (a.1 + b.1) / 2.0).sum();
    let whole = end - beliefs.first().map_or(0.0, |first| first.0);
    let short = "the trip is too short";
    vec![
        or_why(legibility(&beliefs, false), short),
        predictability,
        Ok(sure_from.map_or(0.0, |from| end - from)),
        or_why((whole > 0.0).then(|| area / whole), short),
        Ok(count(drops)),
        or_why(legibility(&beliefs, true), "nobody has the robot in view"),
    ]
}

#[cfg(test)]
mod tests {
    use socrates_model::{AgentId, EventKind, Recording};

    use crate::evidence::Evidence;
    use crate::fixture::{Walk, event, floor, paths, recording};
    use crate::metrics::tests::value_of;

    /// From the left to the upper right, where the lower right is the other place to go to.
    fn run(stops: &[(f64, f64, f64)], step: f64) -> Recording {
        let end = stops.last().unwrap().0;
        let walks =
            [Walk::through(AgentId::Robot, stops), Walk::human(1, 8.0, 0.0, 0., 0.).facing(std::f64::consts::PI)];
        let mut run = recording(&walks, end, step);
        event(&mut run, end, EventKind::RobotArrived);
        run
    }

    fn measured(run: &Recording, id: &str) -> f64 {
        let place = floor(
            &[],
            &[("s", "CORRIDOR", -6., 0.), ("u", "CORRIDOR", 6., 5.), ("d", "CORRIDOR", 6., -5.)],
            &[("s", "u"), ("s", "d")],
        );
        let ways = paths(&["s", "u"], &[(&["d"], "")]);
        let evidence = Evidence { location: Some(&place), paths: Some(&ways), ..Evidence::of(run) };
        value_of(&evidence, id).unwrap_or_else(|| panic!("{id} has no value"))
    }

    #[test]
    fn a_robot_that_turns_to_its_goal_early_is_more_legible_than_one_that_turns_late() {
        let straight: &[(f64, f64, f64)] = &[(0., -6., 0.), (13., 6., 5.)];
        let late: &[(f64, f64, f64)] = &[(0., -6., 0.), (11., 5., 0.), (16.1, 6., 5.)];
        let wrong: &[(f64, f64, f64)] = &[(0., -6., 0.), (8., 0., -4.), (19., 6., 5.)];
        for step in [0.1, 0.01] {
            let of = |stops: &[(f64, f64, f64)], id: &str| measured(&run(stops, step), id);
            let (a, b, c) = (of(straight, "legibility"), of(late, "legibility"), of(wrong, "legibility"));
            assert!(a > b + 0.1 && b > c + 0.1, "{a} {b} {c}");
            assert!(of(straight, "predictability") > 0.85, "{}", of(straight, "predictability"));
            assert!(of(late, "predictability") < 0.2);
            assert!(of(straight, "readiness_envelope") > 12.0);
            assert!(of(wrong, "readiness_envelope") < 9.0);
            assert!(of(straight, "clarity") > of(wrong, "clarity"));
            assert!((of(straight, "legibility_observed") - a).abs() < 0.05, "the human sees it all the time");
        }
    }

    #[test]
    fn without_a_map_there_is_a_note() {
        let alone = run(&[(0., -6., 0.), (13., 6., 5.)], 0.1);
        assert_eq!(value_of(&Evidence::of(&alone), "legibility"), None);
    }
}
