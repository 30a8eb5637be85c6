//! Aside: beside the robot's way, as near to where people meet as there is floor, and never in it.

use socrates_maps::Ground;
use socrates_model::{HumanProposal, Point, Side, Vector};

use super::{Taken, Way};
use crate::graph::Net;
use crate::robot_way::Route;
use crate::sides;

/// Free floor round somebody who stands, m: their body and a little.
const STANDS_M: f64 = 0.36;
/// The floor about a node is searched up to so far, in steps of so much, m, and in so many directions.
const REACH_M: f64 = 2.7;
const STEP_M: f64 = 0.3;
const TURNS: u32 = 16;
/// A node farther from the meeting is none for a bystander of it, m: a sign is noticed up to 8 m away.
const FAR_M: f64 = 8.0;
/// Cost of each meter between them and the meeting.
const PER_M: f64 = 0.1;

/// One node off the robot's way, or on it with floor beside it; the meeting is that of the others.
pub(super) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let meet = *route.nodes.get(route.meet)?;
    let far = |node: usize| (net.at(node) - net.at(meet)).norm();
    let start = route.nodes.first().copied();
    let mut near: Vec<(f64, usize)> = (0..net.len())
        .filter(|node| Some(*node) != start && !net.inside(*node) && far(*node) <= FAR_M)
        .map(|node| (far(node), node))
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (far_m, at) = near.into_iter().find(|(_, node)| has_room(net, route, human, *node))?;
    Some(Way { nodes: vec![at], meet, cost: PER_M * far_m })
}

/// Whether there is floor about a node that is far enough beside the robot's way, on the side that the proposal names.
fn has_room(net: &Net<'_>, route: &Route, human: &HumanProposal, node: usize) -> bool {
    let ground = Ground::of(&net.location.grid);
    let free = |at: &Point| ground.field().clearance(at) >= STANDS_M;
    let home = net.at(node);
    let rings = (0..).map(|ring| STEP_M * f64::from(ring)).take_while(|m| *m <= REACH_M);
    let spots = rings.flat_map(|m| {
        (0..TURNS).map(move |turn| {
            let angle = f64::from(turn) / f64::from(TURNS) * std::f64::consts::TAU;
            home + Vector::new(libm::cos(angle), libm::sin(angle)) * m
        })
    });
    let mut spots = spots.filter(|at| free(at) && open(&home, at, &free));
    spots.any(|at| {
        let (off_m, left_m) = sides::beside(net, route, &at);
        off_m >= Side::ASIDE_M && human.side.is_none_or(|side| side.sign() * left_m > 0.0)
    })
}

/// Whether nothing stands between two points for a body.
fn open(from: &Point, to: &Point, free: &dyn Fn(&Point) -> bool) -> bool {
    let length = (to - from).norm();
    let steps = (0..).map(|step| STEP_M * f64::from(step)).take_while(|m| *m < length);
    steps.map(|m| from + (to - from) * (m / length)).all(|at| (at - from).norm() < STEP_M || free(&at))
}
