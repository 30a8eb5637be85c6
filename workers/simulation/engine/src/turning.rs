//! What changes somebody's way or pace for good: they turn back, or walk at another speed from then on.

use socrates_model::{Action, NodeId, Point, Polyline};

use crate::floor::Floor;
use crate::human::{DoorOnWay, Human, Meeting};
use crate::setup::Setup;
use crate::start;

/// Nearer than this to where they are, the way back has no point of its own, m.
const NEAR_M: f64 = 0.3;
/// Room that a way has beside somebody's body, m; in an aisle as narrow as the body the way is still a way.
const WIDE_M: f64 = 0.04;
const NARROW_M: f64 = 0.06;
/// Most nodes of a place that are tried, the nearest first.
const MOST_TRIED: usize = 6;
/// What lies behind somebody is so far along their way, m: before its beginning.
const BEHIND_M: f64 = -1.0;

/// Begins the present act, where it changes the way or the pace.
pub(crate) fn begin(human: &mut Human, setup: &Setup, floor: &Floor) {
    match &human.action {
        Action::TurnBack if !human.diverted => turn(human),
        Action::GoTo { nodes, .. } => {
            if let Some((node, way)) = nearest(human, nodes, setup, floor) {
                go(human, node, way, setup);
            }
        }
        Action::ChangePace(mps) => {
            (human.pace_mps, human.speed_mps) = (Some(*mps), *mps);
        }
        Action::TurnBack
        | Action::Navigate
        | Action::FollowRobot
        | Action::FollowHuman(_)
        | Action::RunAway
        | Action::GiveWay
        | Action::MakeRoom
        | Action::ApproachTo(_)
        | Action::Block
        | Action::LookAtRobot
        | Action::Approach
        | Action::StandStill
        | Action::LookAt(_) => {}
    }
}

/// From here on the way leads back along where it came from.
fn turn(human: &mut Human) {
    let gone = human.s;
    let marks = human.route.points().iter().zip(human.route.marks_m());
    let behind: Vec<Point> = marks.filter(|(_, mark)| **mark < gone - NEAR_M).map(|(at, _)| *at).collect();
    let points: Vec<Point> = std::iter::once(human.at).chain(behind.into_iter().rev()).collect();
    let nodes = std::mem::take(&mut human.nodes);
    human.nodes =
        nodes.into_iter().rev().filter(|(_, mark)| *mark < gone).map(|(node, mark)| (node, gone - mark)).collect();
    let doors = std::mem::take(&mut human.doors);
    let doors = doors.into_iter().rev().filter(|on_way| on_way.s < gone);
    human.doors = doors.map(|on_way| DoorOnWay { door: on_way.door, s: gone - on_way.s }).collect();
    // A robot that they have not met by now they meet nowhere else.
    let meetings = std::mem::take(&mut human.meetings);
    human.meetings = meetings.into_iter().map(|meeting| Meeting { human_s: BEHIND_M, ..meeting }).collect();
    human.lane_m = -human.lane_m;
    take(human, Polyline::new(&points));
}

/// The way to the nearest of some nodes; of two as near, the first.
fn nearest(human: &Human, nodes: &[NodeId], setup: &Setup, floor: &Floor) -> Option<(NodeId, Polyline)> {
    let at = human.at;
    let mut all: Vec<(f64, &NodeId, Point)> = nodes
        .iter()
        .filter_map(|id| setup.location.graph.node(id).map(|node| ((node.at - at).norm(), id, node.at)))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let way = |goal: &Point| {
        let way = |room: f64| floor.way(&at, goal, room);
        way(human.radius_m + WIDE_M).or_else(|| way(human.radius_m - NARROW_M))
    };
    let ways = all.into_iter().take(MOST_TRIED).filter_map(|(_, id, goal)| Some((id.clone(), way(&goal)?)));
    ways.min_by(|a, b| a.1.length_m().total_cmp(&b.1.length_m()))
}

/// From here on the way leads to another place.
fn go(human: &mut Human, node: NodeId, way: Polyline, setup: &Setup) {
    human.nodes = vec![(node, way.length_m())];
    human.doors = start::doors_on(setup, &way);
    for meeting in &mut human.meetings {
        meeting.human_s = BEHIND_M;
    }
    take(human, way);
}

fn take(human: &mut Human, way: Polyline) {
    (human.route, human.s, human.next_node) = (way, 0.0, 0);
    (human.diverted, human.lined_up, human.aside_m) = (true, false, 0.0);
}
