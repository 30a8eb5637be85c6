//! Ways of people who meet the robot a second time: round a block, by a side way, or back after it.

use socrates_model::{HumanId, PlaceClass, Predicate, Proposal, Relation};

use crate::fit::tight;
use crate::graph::Net;
use crate::people::{ROBOT_MPS, Way};
use crate::robot_way::Route;

/// Pace at which somebody best comes from the first meeting to the second, m/s, and the limits of what is planned.
const PACE_MPS: f64 = 1.1;
const PACES_MPS: [f64; 2] = [0.8, 1.4];
/// The second meeting is at least so far on along the robot's way, m: 6 m are needed, and some to part and come together.
const BETWEEN_M: f64 = 8.0;
/// Who turns back goes at least so far away first, m.
const AWAY_M: f64 = 3.0;
/// Somebody goes on at least so far after the second meeting, m.
const ONWARD_M: f64 = 3.0;

/// Costs: coming after the robot instead of towards or across its way; over a doorway or through a room.
const AFTER: f64 = 8.0;
const ROOM: f64 = 4.0;
/// Cost of coming by the robot's own edges where somebody is to cross its way.
const ALONG: f64 = 6.0;
/// Cost of not crossing the robot's way at the first meeting where that is asked for.
const TURNS: f64 = 25.0;
/// Cost of crossing it there along the robot's way instead of square to it, twice.
const SLANT: f64 = 8.0;

/// What a solution costs in which somebody does not meet the robot twice as asked: any other is better.
pub(crate) const ONLY_ONCE: f64 = 80.0;
/// Length of the robot's way that is aimed at where somebody meets it twice, m, and the least.
pub(crate) const AIM_M: f64 = 28.0;
pub(crate) const LEAST_M: f64 = 15.0;

/// Who is asked to meet the robot a second time, with the class of the place if one is asked for.
pub(crate) fn asked(proposal: &Proposal) -> Vec<(HumanId, Option<PlaceClass>)> {
    let clauses = &proposal.expected_events;
    clauses
        .iter()
        .filter(|clause| clause.must)
        .filter_map(|clause| {
            let Predicate::MeetsAgain { human, .. } = clause.predicate else { return None };
            let place = clauses.iter().filter(|other| !clause.source.is_empty() && other.source == clause.source);
            let place = place
                .filter_map(
                    |other| if let Predicate::EncounterAt { place, .. } = other.predicate { Some(place) } else { None },
                )
                .next();
            Some((human, place))
        })
        .collect()
}

/// The way of somebody up to its first meeting, led on to a second one, and the node of that; `None` where no way is in time.
pub(crate) fn second(
    net: &Net<'_>,
    route: &Route,
    own: &Way,
    (relation, class): (Relation, Option<PlaceClass>),
) -> Option<(Way, usize)> {
    let meet = route.nodes.iter().position(|node| *node == own.meet)?;
    let head = own.nodes.get(..=own.nodes.iter().position(|node| *node == own.meet)?)?;
    let first_arms = [meet.checked_sub(1).and_then(|before| route.nodes.get(before)), route.nodes.get(meet + 1)];
    let mut best: Option<(f64, Vec<usize>, usize)> = None;
    for end in meet + 1..route.nodes.len().saturating_sub(1) {
        let (Some(node), Some(stretch)) = (route.nodes.get(end).copied(), route.nodes.get(meet..=end)) else {
            continue;
        };
        let robot_m = net.length_m(stretch);
        if robot_m < BETWEEN_M || class.is_some_and(|class| !net.is(node, class)) {
            continue;
        }
        let narrow = if class.is_none() && tight(net, node) { ROOM } else { 0.0 };
        let arms = [route.nodes.get(end - 1), route.nodes.get(end + 1)];
        for between in ways(net, stretch, robot_m / ROBOT_MPS) {
            // Who crosses the robot's way does so again, if there is such a way.
            let from = between.nodes.len().checked_sub(2).and_then(|at| between.nodes.get(at));
            let along = if relation == Relation::Crossing && arms.contains(&from) { ALONG } else { 0.0 };
            // Nor does who crosses turn into the robot's way, or back, at the first meeting.
            let next = between.nodes.get(1);
            let came = head.len().checked_sub(2).and_then(|at| head.get(at));
            let crossed = if relation == Relation::Crossing {
                let turns = first_arms.contains(&next) || next == came;
                let slant = |from: Option<&usize>, to: Option<&usize>| {
                    from.zip(to).map_or(0.0, |(from, to)| net.straight(*from, own.meet, *to).abs())
                };
                let [before, after] = first_arms;
                if turns { TURNS } else { SLANT * (slant(came, after) + slant(before, next)) }
            } else {
                0.0
            };
            let cost = between.cost + narrow + along + crossed;
            if best.as_ref().is_some_and(|(least, ..)| *least <= cost + 1e-9) {
                continue;
            }
            let Some(tail) = onward(net, &between.nodes, route.nodes.get(end + 1).copied()) else { continue };
            let mut nodes = head.to_vec();
            nodes.extend(between.nodes.iter().skip(1));
            nodes.extend(tail);
            best = Some((cost, nodes, node));
        }
    }
    let (cost, nodes, node) = best?;
    Some((Way { nodes, cost: own.cost + cost, ..own.clone() }, node))
}

/// A way between the two meetings.
struct Between {
    nodes: Vec<usize>,
    cost: f64,
}

/// Ways from the first node of the robot's stretch to its last that take about as long as the robot.
fn ways(net: &Net<'_>, stretch: &[usize], robot_s: f64) -> Vec<Between> {
    let (Some(from), Some(to)) = (stretch.first().copied(), stretch.last().copied()) else { return Vec::new() };
    let inner = stretch.get(1..stretch.len() - 1).unwrap_or_default();
    let [slowest, fastest] = PACES_MPS.map(|pace| pace * robot_s);
    let barred = |end: usize| move |node: usize| node == end || inner.contains(&node);
    let out = net.tree(from, &barred(to));
    let back = net.tree(to, &barred(from));
    let stretch_m = net.length_m(stretch);
    let mut found = Vec::new();
    let mut add = |nodes: Vec<usize>, cost: f64| {
        let length_m = net.length_m(&nodes);
        if length_m < slowest || length_m > fastest {
            return;
        }
        let indoors = nodes.iter().filter(|node| net.inside(**node) || tight(net, **node)).count() as f64;
        found.push(Between { nodes, cost: cost + ROOM * indoors + 0.25 * (length_m - PACE_MPS * robot_s).abs() });
    };
    for by in (0..net.len()).filter(|by| *by != from && *by != to) {
        let away_m = out.length_m(by);
        if !away_m.is_finite() || away_m > fastest {
            continue;
        }
        // Round the block, or by a place further off.
        if (away_m + back.length_m(by)) <= fastest {
            let mut nodes = out.way(by);
            nodes.extend(back.way(by).into_iter().rev().skip(1));
            add(nodes, 0.0);
        }
        // Away, back, and after the robot.
        if away_m >= AWAY_M && 2.0 * away_m + stretch_m <= fastest {
            let mut nodes = out.way(by);
            nodes.extend(out.way(by).into_iter().rev().skip(1));
            nodes.extend(stretch.iter().skip(1));
            add(nodes, AFTER);
        }
    }
    found
}

/// Where somebody goes on to after its way: as straight as it goes, rather not where the robot goes.
fn onward(net: &Net<'_>, way: &[usize], robots: Option<usize>) -> Option<Vec<usize>> {
    let [.., before, last] = way else { return None };
    let (mut before, mut last) = (*before, *last);
    let mut tail: Vec<usize> = Vec::new();
    let mut length_m = 0.0;
    while length_m < ONWARD_M && tail.len() < 6 {
        let value = |node: usize| {
            let taken = if Some(node) == robots { 0.8 } else { 0.0 };
            let inside = if net.inside(node) || net.kind(node) == PlaceClass::Doorway { 3.0 } else { 0.0 };
            net.straight(before, last, node) - taken - inside
        };
        let free = net.near(last).iter().filter(|(node, _)| *node != before && !tail.contains(node));
        let Some((next, step_m)) = free.max_by(|a, b| value(a.0).total_cmp(&value(b.0))).copied() else { break };
        length_m += step_m;
        tail.push(next);
        (before, last) = (last, next);
    }
    (!tail.is_empty()).then_some(tail)
}
