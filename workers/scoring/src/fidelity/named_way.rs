//! The monitor of the robot's way by name: where it begins and ends, what it leads past, what it keeps out of.

use socrates_model::proposal::WayPart;
use socrates_model::{NodeId, Point};

use crate::fidelity::finding::Finding;
use crate::fidelity::signals::Signals;

/// The robot starts so near to a node, m: what a free place beside it may take.
const START_M: f64 = 1.5;
/// And has been at a node from so near, m.
const AT_M: f64 = 1.5;
/// So far it stays from a node without a room that it should keep away from, m.
const OFF_M: f64 = 1.0;

/// The intended way does so, and the reference robot drives so.
pub(super) fn robot_way(signals: &Signals<'_>, part: WayPart, nodes: &[NodeId]) -> Finding {
    let (Some(paths), Some(location)) = (signals.evidence.paths, signals.evidence.location) else {
        return Finding::not_applicable("there is no map or no paths to tell where the robot's way leads");
    };
    let way = &paths.robot;
    let own = |node: &NodeId| nodes.contains(node);
    let list = nodes.iter().map(|node| format!("`{node}`")).collect::<Vec<_>>().join(", ");
    let ends = || [way.first(), paths.robot_goal()].into_iter().flatten();
    let planned = match part {
        WayPart::Start => way.first().is_some_and(own),
        WayPart::Goal => paths.robot_goal().is_some_and(own),
        WayPart::Via => way.iter().any(own) && !ends().any(own),
        WayPart::Avoid => !way.iter().any(own),
        WayPart::Back => paths.comes_back(),
    };
    let told = format!("the robot's way as planned {} {list}", if planned { part.does() } else { part.does_not() });
    if !planned {
        return Finding::fails(-1.0, vec![], told);
    }
    let Some(robot) = &signals.tracks.robot else {
        return Finding::not_applicable("there is no robot in the recording");
    };
    // Where another planner drives is its own result.
    if !signals.evidence.recording.header.planner.is_reference() {
        return Finding::holds(1.0, vec![0.0], told);
    }
    let places: Vec<(&NodeId, Point)> = nodes.iter().filter_map(|id| Some((id, location.graph.node(id)?.at))).collect();
    let off = |at: &Point| places.iter().map(|(_, node)| (at - node).norm()).fold(f64::INFINITY, f64::min);
    let nearest = |samples: &mut dyn Iterator<Item = &crate::tracks::Sample>| {
        samples.map(|sample| (off(&sample.at), sample.t)).min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let (margin, t, drives) = match part {
        WayPart::Start => {
            let Some(first) = robot.samples.first() else { return Finding::not_applicable("the recording is empty") };
            (START_M - off(&first.at), first.t, format!("starts {:.2} m from it", off(&first.at)))
        }
        WayPart::Goal | WayPart::Via => {
            let Some((m, t)) = nearest(&mut robot.present()) else {
                return Finding::not_applicable("the recording is empty");
            };
            (AT_M - m, t, format!("comes within {m:.2} m of it at {t:.1} s"))
        }
        WayPart::Back => {
            let start = way.first().and_then(|id| location.graph.node(id)).map(|node| node.at);
            let turn = paths.robot_goal().and_then(|id| location.graph.node(id)).map(|node| node.at);
            let (Some(start), Some(turn), Some(last)) = (start, turn, robot.present().last()) else {
                return Finding::not_applicable("the recording is empty");
            };
            let reached = robot.present().map(|sample| (sample.at - turn).norm()).fold(f64::INFINITY, f64::min);
            let home = (last.at - start).norm();
            let drives = format!("comes within {reached:.2} m of its goal and ends {home:.2} m from where it began");
            ((AT_M - reached).min(AT_M - home), last.t, drives)
        }
        WayPart::Avoid => {
            let rooms = signals.enclosures.as_ref();
            let room = |id: &NodeId| rooms.and_then(|rooms| Some((rooms, rooms.of_node(id)?)));
            let inside =
                |at: &Point| places.iter().any(|(id, _)| room(id).is_some_and(|(rooms, place)| rooms.holds(place, at)));
            let entered = robot.present().find(|sample| inside(&sample.at));
            if let Some(sample) = entered {
                return Finding::fails(
                    -1.0,
                    vec![sample.t],
                    format!("the robot is inside {list} at {:.1} s", sample.t),
                );
            }
            let Some((m, t)) = nearest(&mut robot.present()) else {
                return Finding::not_applicable("the recording is empty");
            };
            (m - OFF_M, t, format!("stays {m:.2} m away from it, and never enters it"))
        }
    };
    Finding::by_margin(margin, vec![t], format!("{told}; the robot {drives}"))
}
