//! Ways of people, by how they stand to the robot's way: a file for each relation.

use socrates_model::{Action, HumanProposal, Location, PlaceClass, Relation, Rule, Trigger};

use crate::Ends;
use crate::graph::Net;
use crate::inside;
use crate::robot_way::Route;
use crate::sides;

mod ahead;
mod aside;
mod behind;
pub(crate) mod boarding;
mod crossing;
mod frontal;
mod leaving;
mod standing;
mod staying;

/// Speed of the robot that timings are planned with, m/s.
pub(crate) const ROBOT_MPS: f64 = 0.8;

/// Fastest walk of somebody who is late for the meeting, m/s; what is farther away than that and so much more is too far, m.
const HURRY_MPS: f64 = 1.5;

/// Desired speed of a human without one of its own, m/s.
const HUMAN_MPS: f64 = 1.2;

/// People start at least so far from each other and the robot unless they belong together, m.
const APART_M: f64 = 0.8;

/// Most people who may start at one node where there is no room for all to start apart.
const SHARED: usize = 3;

/// Ways that have to meet where somebody crosses the robot's.
pub(crate) const CROSSED_ARMS: usize = 3;

/// Somebody goes on at least so far after the meeting, m.
const ONWARD_M: f64 = 4.0;

/// Two who end nearer to each other than this are in each other's way, m.
const ENDS_APART_M: f64 = 1.5;

/// One human's way and where it meets the robot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Way {
    pub(crate) nodes: Vec<usize>,
    /// The meeting node.
    pub(crate) meet: usize,
    /// How well it fits; 0 is best.
    pub(crate) cost: f64,
}

impl Way {
    /// The node from which the way comes to the meeting; none where it begins there.
    pub(crate) fn entry(&self) -> Option<usize> {
        let at = self.nodes.iter().position(|node| *node == self.meet)?;
        self.nodes.get(at.checked_sub(1)?).copied()
    }
}

/// What is already taken.
pub(crate) struct Taken<'a> {
    pub(crate) net: &'a Net<'a>,
    pub(crate) starts: Vec<usize>,
    /// Where others end: who ends where somebody stands already does not get there.
    pub(crate) goals: Vec<usize>,
    /// There is no room for everybody to start apart: the checks will say so.
    pub(crate) crowded: bool,
    /// Where on the robot's way those stand who stand.
    pub(crate) ends: Ends,
    /// The class of place where people should meet.
    pub(crate) place: PlaceClass,
    /// The nodes of the place by name, if it has one: who stands stands there, together with others.
    pub(crate) meant: &'a [usize],
    /// Where those stand who have been placed there.
    pub(crate) standing: Vec<usize>,
    /// Whether somebody comes towards the robot.
    pub(crate) toward: bool,
    /// How many stand before a door at first and go in.
    pub(crate) boards: usize,
    /// Whether many different scenarios are wanted.
    pub(crate) wide: bool,
    /// The node from which this one is to come to the meeting; the best one where it is none.
    pub(crate) entry: Option<usize>,
}

/// Cost of a way that does not end at the place by name where it should.
const NO_END: f64 = 30.0;

/// Cost of a way that ends in a doorway or where others end: any other way is better.
const BAD_END: f64 = 8.0;

impl Taken<'_> {
    fn free(&self, node: usize) -> bool {
        let near = |other: &&usize| (self.net.at(**other) - self.net.at(node)).norm() < APART_M;
        let others = self.starts.iter().filter(near).count();
        // The robot's own start, the first of them, is its alone.
        others == 0 || self.crowded && others < SHARED && !self.starts.iter().take(1).any(|robot| near(&robot))
    }

    /// Whether two who stand at these nodes are out of each other's way.
    fn apart(&self, one: usize, other: usize) -> bool {
        (self.net.at(other) - self.net.at(one)).norm() >= ENDS_APART_M
    }

    /// Whether somebody may end there: nobody else does near by, and nobody has to get through.
    fn can_end(&self, node: usize) -> bool {
        self.net.kind(node) != PlaceClass::Doorway && self.goals.iter().all(|other| self.apart(node, *other))
    }

    /// Whether somebody who comes towards the robot may end there: not where it set out either, or their way is its own read
    /// backwards.
    fn can_end_past_robot(&self, node: usize) -> bool {
        self.can_end(node) && self.starts.first().is_none_or(|robot| self.apart(node, *robot))
    }

    /// What it costs to end a way there.
    fn end_cost(&self, nodes: &[usize]) -> f64 {
        if nodes.last().is_some_and(|last| self.can_end(*last)) { 0.0 } else { BAD_END }
    }
}

/// The way of a human, if the robot's way has room for it.
pub(crate) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>, along: bool) -> Option<Way> {
    if sides::walks_along(human.relation) && !sides::has_floor(taken.net, route, human, route.meet) {
        return None;
    }
    let way = match human.relation {
        Relation::Frontal => frontal::way(human, route, taken),
        Relation::Crossing => crossing::way(human, route, taken),
        Relation::Behind => behind::way(human, route, taken, along),
        Relation::Ahead | Relation::Abreast => ahead::way(human, route, taken),
        Relation::Static if boarding::boards(human) => {
            boarding::way(human, route, taken).or_else(|| standing::way(human, route, taken))
        }
        Relation::Static if walks_later(human) => {
            standing::way(human, route, taken).map(|way| standing::walking_on(way, route, taken))
        }
        Relation::Static => standing::way(human, route, taken),
        Relation::Leaving => leaving::way(human, route, taken),
        Relation::Staying => staying::way(human, route, taken),
        Relation::Aside => aside::way(human, route, taken),
    };
    way.map(|way| to_end(way, human, taken))
}

/// The way led on to the place by name where it ends, from the node after the meeting on and never back over its own nodes; dear where there
/// is none, or where it begins there.
fn to_end(way: Way, human: &HumanProposal, taken: &Taken<'_>) -> Way {
    let (net, ends) = (taken.net, taken.net.ends_of(human.id));
    let met = way.nodes.iter().position(|node| *node == way.meet);
    let Some(met) = met.filter(|_| !ends.is_empty() && way.nodes.len() > 1) else { return way };
    let head: Vec<usize> = way.nodes.iter().copied().take(met + 2).collect();
    let (Some(first), Some(last)) = (head.first().copied(), head.last().copied()) else { return way };
    let tree = net.tree(last, &|node| head.contains(&node));
    let reached = ends.iter().copied().filter(|node| tree.length_m(*node).is_finite());
    let cost = |node: usize| tree.length_m(node) + if taken.can_end(node) { 0.0 } else { BAD_END };
    let end = reached.min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    let away = |end: &usize| (net.at(*end) - net.at(first)).norm() >= ONWARD_M;
    let Some(end) = end.filter(away) else { return Way { cost: way.cost + NO_END, ..way } };
    let nodes: Vec<usize> = head.iter().copied().chain(tree.way(end).into_iter().skip(1)).collect();
    Way { nodes, cost: way.cost + 0.1 * tree.length_m(end), ..way }
}

fn before_m(net: &Net<'_>, route: &Route) -> f64 {
    net.length_m(route.nodes.get(..=route.meet).unwrap_or_default())
}

/// How far a human walks until the robot is at the meeting node, m.
fn ideal_m(human: &HumanProposal, net: &Net<'_>, route: &Route) -> f64 {
    let in_time_m = before_m(net, route) / ROBOT_MPS * human.speed_mps.unwrap_or(HUMAN_MPS);
    waits_m(human).map_or(in_time_m, |near_m| in_time_m.min(near_m))
}

/// Distance to the meeting at which people wait for others at first, m; for the robot it is the distance at which they set off, less a margin.
const WAITS_M: f64 = 6.0;
const SOONER_M: f64 = 1.5;
const LEAST_WAIT_M: f64 = 3.0;

/// Distance to the meeting, m, of a person whose first step is to wait; none where it is not.
fn waits_m(human: &HumanProposal) -> Option<f64> {
    let first = human.rules.iter().find(|rule| rule.step == Some(1))?;
    if !first.act.stands() || first.when != [Trigger::Always] {
        return None;
    }
    let near = first.until.iter().filter_map(|trigger| {
        if let Trigger::RobotNear(m) | Trigger::RobotVisible(m) = trigger { Some(m - SOONER_M) } else { None }
    });
    Some(near.fold(WAITS_M, f64::min).max(LEAST_WAIT_M))
}

/// Lengthens a way that ends where it may not, straight on, to the next node where it may.
fn onward<'a>(nodes: &mut Vec<usize>, taken: &Taken<'a>, may_end: impl Fn(&Taken<'a>, usize) -> bool) {
    let net = taken.net;
    for _ in 0..4 {
        let (Some(last), Some(previous)) =
            (nodes.last().copied(), nodes.len().checked_sub(2).and_then(|i| nodes.get(i)).copied())
        else {
            return;
        };
        if may_end(taken, last) {
            return;
        }
        let next = net.near(last).iter().map(|(node, _)| *node);
        let next = next.filter(|node| !nodes.contains(node) && !net.inside(*node));
        let turn = |node: usize| net.straight(previous, last, node) - if may_end(taken, node) { 0.0 } else { 0.5 };
        let Some(next) = next.max_by(|a, b| turn(*a).total_cmp(&turn(*b))) else { return };
        nodes.push(next);
    }
}

/// A person whom the robot follows goes on past its goal, so that both get to where they go.
pub(crate) fn led_past(mut way: Way, taken: &Taken<'_>) -> Way {
    onward(&mut way.nodes, taken, Taken::can_end);
    way.cost += taken.end_cost(&way.nodes);
    way
}

fn onward_m(net: &Net<'_>, from: usize, nodes: &[usize]) -> f64 {
    let mut all = vec![from];
    all.extend(nodes);
    net.length_m(&all)
}

/// Lengthens a way, as straight as it goes, until it leads far enough from the meeting node.
fn extend(net: &Net<'_>, nodes: &mut Vec<usize>, meet: usize, barred: &dyn Fn(usize) -> bool) {
    while let Some(from) = nodes.iter().position(|node| *node == meet) {
        if net.length_m(nodes.get(from..).unwrap_or_default()) >= ONWARD_M {
            return;
        }
        let (Some(last), Some(previous)) =
            (nodes.last().copied(), nodes.len().checked_sub(2).and_then(|i| nodes.get(i)).copied())
        else {
            return;
        };
        let next = net
            .near(last)
            .iter()
            .map(|(node, _)| *node)
            .filter(|node| !nodes.contains(node) && !barred(*node))
            // Into a room only through its doorway, once that is entered.
            .filter(|node| !net.inside(*node) || net.kind(last) == PlaceClass::Doorway);
        let Some(next) =
            next.max_by(|a, b| net.straight(previous, last, *a).total_cmp(&net.straight(previous, last, *b)))
        else {
            return;
        };
        nodes.push(next);
    }
}

/// Whether somebody stands at first and walks on later, by a rule.
#[must_use]
pub fn walks_later(human: &HumanProposal) -> bool {
    let later =
        |rule: &Rule| rule.act == Action::Navigate && rule.for_s.is_none() && !rule.when.contains(&Trigger::Always);
    human.relation == Relation::Static && human.group.is_none() && human.goal.is_none() && human.rules.iter().any(later)
}

/// Whether somebody follows the robot or another human.
pub(crate) fn follows(human: &HumanProposal) -> bool {
    human.rules.iter().any(|rule| matches!(rule.act, Action::FollowRobot | Action::FollowHuman(_)))
}

fn sources(human: &HumanProposal, location: &Location) -> Option<PlaceClass> {
    human.start.filter(|class| !inside::inside(location, Some(*class)).is_empty())
}
