//! One scene in which every metric has a value, recorded ten and a hundred times a second.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use socrates_model::{AgentId, EventKind, Gesture, Recording};

use crate::cases::{group_of, proposal};
use crate::evidence::Evidence;
use crate::fidelity::Signals;
use crate::fixture::{Walk, event, floor, paths, recording};
use crate::metrics::{Scene, measure, sheets};
use crate::tracks::Tracks;

/// Metrics that the scene has no value for, with the reason; the README has the list too.
const NO_VALUE: &[(&str, &str)] = &[
    ("agent_collisions", "recordings hold one robot"),
    ("planner_latency_p50", "recordings hold no computing times of planners"),
    ("planner_latency_p95", "recordings hold no computing times of planners"),
    ("planner_wait", "recordings hold no computing times of planners"),
    ("command_fluency", "recordings hold no commands"),
    ("relative_time", "there is no run of the robot alone to compare with"),
    // Tested at both rates with a door of their own.
    ("entering_order_errors", "the map has no doors"),
    ("flow_throughput", "the map has no doors"),
];

/// The robot stops for a gesture, drives between two who talk, brushes one and meets one who crosses.
fn walks() -> Vec<Walk> {
    vec![
        Walk::through(AgentId::Robot, &[(0., -8., 0.), (10., 0., 0.), (13., 0., 0.), (23., 8., 0.), (25., 8., 0.)]),
        Walk::human(1, 9.5, 0.6, 0., 0.).facing(PI).says(9.0, 11.5, Gesture::Wait).says(12.0, 14.0, Gesture::Proceed),
        Walk::human(2, 4., 0.9, 0., 0.).facing(-PI / 2.),
        Walk::human(3, 4., -0.9, 0., 0.).facing(PI / 2.),
        Walk::human_through(4, &[(0., 1.3, -8.), (7., 1.3, -2.), (9., 1.3, -2.), (18., 1.3, 7.), (25., 1.3, 7.)]),
        Walk::human(5, 6., 0.4, 0., 0.).facing(PI),
    ]
}

fn run(step: f64) -> Recording {
    let mut run = recording(&walks(), 25.0, step);
    event(&mut run, 23.0, EventKind::RobotArrived);
    run
}

fn values(step: f64) -> BTreeMap<String, (Option<f64>, String)> {
    let place = floor(
        &[(-20., 4., -1., 6.), (3., 5., 20., 6.), (-20., -6., -1., -4.)],
        &[("a", "CORRIDOR", -8., 0.), ("b", "JUNCTION", 0., 0.), ("c", "CORRIDOR", 8., 0.), ("d", "ROOM", 1., 9.)],
        &[("a", "b"), ("b", "c"), ("b", "d")],
    );
    let ways = paths(&["a", "b", "c"], &[(&["c"], ""), (&["c"], ""), (&["c"], ""), (&["b", "d"], "b"), (&["c"], "")]);
    let plan = group_of(proposal(5, vec![]), &[2, 3]);
    // Without the robot the one who crosses does not stop.
    let mut alone: Vec<Walk> = walks().into_iter().skip(1).collect();
    alone[3] = Walk::human_through(4, &[(0., 1.3, -8.), (15., 1.3, 7.), (25., 1.3, 7.)]);
    let (run, twin) = (run(step), recording(&alone, 25.0, step));
    let evidence = Evidence {
        location: Some(&place),
        paths: Some(&ways),
        proposal: Some(&plan),
        twin: Some(&twin),
        ..Evidence::of(&run)
    };
    let tracks = Tracks::read(&run).unwrap();
    let signals = Signals::new(&evidence, &tracks);
    measure(&Scene::new(&signals)).into_iter().map(|metric| (metric.id, (metric.value, metric.note))).collect()
}

mod tests {
    use super::*;

    #[test]
    fn every_metric_is_the_same_at_ten_and_at_a_hundred_hertz() {
        let (coarse, fine) = (values(0.1), values(0.01));
        let mut wrong = Vec::new();
        for sheet in sheets().filter(|sheet| !sheet.as_coded_elsewhere()) {
            let why = NO_VALUE.iter().find(|(id, _)| *id == sheet.id).map(|(_, why)| *why);
            match (&coarse[sheet.id], &fine[sheet.id], why) {
                ((None, note), (None, _), Some(why)) if note.contains(why) => {}
                ((Some(a), _), (Some(b), _), None) => {
                    if (a - b).abs() > 0.02 * b.abs() + 1e-3 {
                        wrong.push(format!("{}: {a} at 10 Hz, {b} at 100 Hz", sheet.id));
                    }
                }
                other => wrong.push(format!("{}: {other:?}", sheet.id)),
            }
        }
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
