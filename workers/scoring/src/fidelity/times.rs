//! Which part of a run is whose: the encounters of somebody who meets the robot several times.

use std::collections::BTreeMap;

use socrates_model::{HumanId, NodeId, Paths, Point, Polyline, SceneGraph};

use crate::evidence::Evidence;
use crate::tracks::Track;

/// How far back and ahead along its way the robot is looked for from one sample to the next, m.
const REACH_M: (f64, f64) = (0.3, 3.0);
/// Farther from its way than this the robot's place along it says little, m.
const ASIDE_M: f64 = 3.0;

/// One of several encounters of a human: from where the robot is half-way to it from the one before, to where it is
/// half-way to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Meeting {
    /// Where, if both paths come there in this order.
    pub node: NodeId,
    /// Position of the node.
    pub at: Point,
    /// From when, s; infinite where the robot never gets so far.
    pub from_s: f64,
    /// Until when, s; infinite for the last.
    pub to_s: f64,
}

/// The encounters of every human who has several.
pub(super) fn meetings_of(evidence: &Evidence<'_>, robot: Option<&Track>) -> BTreeMap<HumanId, Vec<Meeting>> {
    let (Some(paths), Some(location), Some(robot)) = (evidence.paths, evidence.location, robot) else {
        return BTreeMap::new();
    };
    let several: Vec<HumanId> =
        paths.humans.keys().copied().filter(|human| paths.encounters_of(*human).count() > 1).collect();
    if several.is_empty() {
        return BTreeMap::new();
    }
    let progress = progress(&Polyline::new(&location.graph.polyline(&paths.robot)), robot);
    several.into_iter().map(|human| (human, of_human(human, paths, &location.graph, &progress))).collect()
}

fn of_human(human: HumanId, paths: &Paths, graph: &SceneGraph, progress: &[(f64, f64)]) -> Vec<Meeting> {
    let mut found: Vec<Meeting> = Vec::new();
    let mut last_m = 0.0;
    for visit in paths.visits(human) {
        let Some(node) = graph.node(visit.node) else { continue };
        // Where the robot does not come in this order there is nothing to see.
        let way = visit.robot_step.and_then(|step| paths.robot.get(..=step));
        let way_m = way.map_or(f64::INFINITY, |way| graph.length_m(way));
        let half_m = 0.5 * (last_m + way_m);
        let half_s = progress.iter().find(|(_, s)| *s >= half_m).map_or(f64::INFINITY, |(t, _)| *t);
        let from_s = if found.is_empty() && way_m.is_finite() { 0.0 } else { half_s };
        if let Some(before) = found.last_mut() {
            before.to_s = from_s;
        }
        found.push(Meeting { node: visit.node.clone(), at: node.at, from_s, to_s: f64::INFINITY });
        last_m = if way_m.is_finite() { way_m } else { last_m };
    }
    found
}

/// Times and how far along its way the robot is by then, m; never less than before.
fn progress(way: &Polyline, robot: &Track) -> Vec<(f64, f64)> {
    let (mut s, mut most) = (0.0, 0.0_f64);
    robot
        .present()
        .map(|sample| {
            let (place, aside) = way.project_within(&sample.at, s - REACH_M.0, s + REACH_M.1);
            if aside < ASIDE_M {
                s = place;
            }
            most = most.max(s);
            (sample.t, most)
        })
        .collect()
}
