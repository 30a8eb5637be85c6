//! The points of a way that whoever drives it is given.

use socrates_model::request::Waypoints;
use socrates_model::{NodeId, Point, SceneGraph};

/// The points through which a way over these nodes leads: start first, goal last.
pub(crate) fn waypoints(graph: &SceneGraph, nodes: &[NodeId], which: Waypoints) -> Vec<Point> {
    let last = nodes.len().saturating_sub(1);
    let kept: Vec<usize> = match which {
        Waypoints::Ends => vec![0, last],
        Waypoints::All => (0..nodes.len()).collect(),
        Waypoints::Via => {
            // As few nodes as make the shortest way through them the intended one.
            let mut kept = vec![0];
            let mut from = 0;
            while from < last {
                let straight = |to: &usize| match (nodes.get(from), nodes.get(*to), nodes.get(from..=*to)) {
                    (Some(a), Some(b), Some(way)) => graph.shortest(a, b).is_some_and(|short| short == way),
                    _ => false,
                };
                from = (from + 2..=last).rev().find(straight).unwrap_or(from + 1);
                kept.push(from);
            }
            kept
        }
    };
    let mut points: Vec<Point> = kept
        .into_iter()
        .filter_map(|place| nodes.get(place))
        .filter_map(|id| graph.node(id))
        .map(|node| node.at)
        .collect();
    points.dedup();
    points
}
