//! Everybody's way for one way of the robot: one after the other, each with what the others took.

use std::collections::BTreeMap;

use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{Encounter, FORMAT, HumanId, HumanProposal, NodeId, Paths, Proposal, Relation};

use crate::candidates::Scene;
use crate::graph::Net;
use crate::people::{Taken, Way, boarding, led_past, way};
use crate::robot_way::{LEAST_M, Route, times_shortest};
use crate::{Problem, inside, meant, named_way, second_meeting, spread};

/// Least distance beyond that of the robot's words at which their listener starts, m, and the cost of less.
const SETS_OFF_M: f64 = 1.5;
const EARLY: f64 = 8.0;

/// A way of the robot, and everybody's.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub(crate) route: Route,
    pub(crate) ways: BTreeMap<HumanId, Way>,
    /// Where somebody meets the robot for the second time.
    pub(crate) again: BTreeMap<HumanId, usize>,
    /// What people's ways cost: 0 where each is led as their relation asks, see [`Way::cost`].
    pub(crate) strain: f64,
    pub(crate) score: f64,
}

/// Everybody's ways for one way of the robot: the best of all, and in a wide search the best for each other side from which
/// somebody who crosses may come.
pub(crate) fn everybody(scene: &Scene<'_>, route: &Route) -> Vec<Solution> {
    let Scene { net, proposal, limits, .. } = *scene;
    let mut found: Vec<Solution> = led(scene, route, None).into_iter().collect();
    let (true, Some(best)) = (limits.wide, found.first().cloned()) else { return found };
    let first_of_group = |human: &HumanProposal| {
        let before = proposal.humans.iter().take_while(|other| other.id != human.id);
        human.group.is_none() || before.clone().all(|other| other.group != human.group)
    };
    for human in proposal.humans.iter().filter(|human| human.relation == Relation::Crossing && first_of_group(human)) {
        let Some(way) = best.ways.get(&human.id) else { continue };
        let at = route.nodes.iter().position(|node| *node == way.meet);
        let from = at.and_then(|at| at.checked_sub(1)).and_then(|before| route.nodes.get(before));
        let others = net.near(way.meet).iter().map(|(node, _)| *node);
        for side in others.filter(|node| Some(node) != from && way.entry() != Some(*node)) {
            found.extend(led(scene, route, Some((human.id, side))));
        }
    }
    found
}

/// Distance at which the robot speaks to a person near, m; negative where it does not.
fn says_m(proposal: &Proposal) -> f64 {
    let near = proposal.robot.script.iter().filter(|line| matches!(line.act, RobotDo::Say(_)));
    let at_m = |line: &RobotRule| {
        if let RobotWhen::HumanNear(m) | RobotWhen::Near(_, m) = line.when { Some(m) } else { None }
    };
    near.filter_map(at_m).fold(-SETS_OFF_M, f64::max)
}

/// Everybody's way for one way of the robot; `from` has somebody come to the meeting from a node.
fn led(scene: &Scene<'_>, route: &Route, from: Option<(HumanId, usize)>) -> Option<Solution> {
    let Scene { net, proposal, layout, crowded, limits } = *scene;
    let starts = route.nodes.first().copied().into_iter().collect();
    let goals = route.nodes.last().copied().into_iter().collect();
    let meant = meant::indices(net, proposal);
    let mut taken = Taken {
        net,
        starts,
        goals,
        crowded,
        ends: layout.ends,
        place: proposal.place,
        meant: &meant,
        standing: Vec::new(),
        toward: proposal.humans.iter().any(|human| human.relation == Relation::Frontal),
        boards: boarding::count(proposal),
        wide: limits.wide,
        entry: None,
    };
    let mut ways: BTreeMap<HumanId, Way> = BTreeMap::new();
    let spread = spread::spread(net, proposal, route);
    let beside = |relation: Relation| matches!(relation, Relation::Behind | Relation::Ahead | Relation::Abreast);
    let along = proposal.humans.iter().any(|human| !beside(human.relation));
    let mut cost = 0.0;
    let says_m = says_m(proposal);
    let twice = second_meeting::asked(proposal);
    let mut again: BTreeMap<HumanId, usize> = BTreeMap::new();
    for human in &proposal.humans {
        // Members of a group go together; people of one room leave it one after the other.
        let mate = proposal
            .humans
            .iter()
            .filter(|other| other.group.is_some() && other.group == human.group)
            .find_map(|other| ways.get(&other.id).filter(|_| other.relation == human.relation));
        taken.entry = from.filter(|(id, _)| *id == human.id).map(|(_, node)| node);
        let led = human.rules.iter().find_map(|rule| {
            if let socrates_model::Action::FollowHuman(leader) = rule.act { ways.get(&leader) } else { None }
        });
        let led = led.filter(|way| way.nodes.len() > 1);
        let shared = mate.or_else(|| led.filter(|_| matches!(human.relation, Relation::Frontal | Relation::Ahead)));
        let own = match shared {
            Some(way) if mate.is_some() || human.relation == Relation::Ahead => way.clone(),
            Some(leader) => after(net, leader, &taken)?,
            None => {
                let at = spread.iter().find(|(id, _)| *id == human.id).map_or(route.meet, |(_, meet)| *meet);
                let own = net.elsewhere.get(&human.id);
                taken.meant = own.map_or(&meant, Vec::as_slice);
                let at = own.map_or_else(|| vec![at], |place| met_on(route, place, human));
                let ways = at.into_iter().filter_map(|meet| way_at(human, route, meet, (&taken, along)));
                let best = ways.min_by(|a, b| a.cost.total_cmp(&b.cost));
                taken.meant = &meant;
                best?
            }
        };
        let own = match twice.iter().find(|(id, _)| *id == human.id) {
            // A member of a group goes the way of the one before it, its second meeting included.
            Some(_) if mate.is_some() => {
                let of = proposal.humans.iter().filter(|other| other.group == human.group);
                again.extend(of.filter_map(|other| again.get(&other.id)).next().copied().map(|node| (human.id, node)));
                own
            }
            Some((_, class)) => match second_meeting::second(net, route, &own, (human.relation, *class)) {
                Some((own, node)) => {
                    again.insert(human.id, node);
                    own
                }
                None => Way { cost: own.cost + second_meeting::ONLY_ONCE, ..own },
            },
            None => own,
        };
        let start_m =
            own.nodes.first().zip(route.nodes.first()).map(|(own, robot)| (net.at(*own) - net.at(*robot)).norm());
        // What the robot says to somebody near is said on the way, not before it sets off.
        if start_m.is_some_and(|m| m < says_m + SETS_OFF_M) && !beside(human.relation) {
            cost += EARLY;
        }
        let followed = proposal.robot.script.iter().any(|line| line.act == RobotDo::Follow(human.id));
        // Of many who walk ahead nobody ends where the robot does.
        let ahead = human.relation == Relation::Ahead && spread.iter().any(|(id, _)| *id == human.id);
        let own = if followed || ahead { led_past(own, &taken) } else { own };
        cost += own.cost;
        if !matches!(human.relation, Relation::Leaving | Relation::Staying | Relation::Aside) && mate.is_none() {
            taken.starts.extend(own.nodes.first());
        }
        if human.relation == Relation::Static {
            taken.standing.extend(own.nodes.first());
        }
        if own.nodes.len() > 1 && mate.is_none() {
            taken.goals.extend(own.nodes.last());
        }
        ways.insert(human.id, own);
    }
    let score = route.score - cost;
    Some(Solution { route: route.clone(), ways, again, strain: cost, score })
}

/// The way of a person whom the robot meets at a position on its own.
fn way_at(human: &HumanProposal, route: &Route, meet: usize, (taken, along): (&Taken<'_>, bool)) -> Option<Way> {
    let at = Route { meet, ..route.clone() };
    let at = if human.relation.stands() { at } else { without_loops(&at) };
    let way = way(human, &at, taken, along)?;
    let more = if taken.net.elsewhere.is_empty() { 0.0 } else { aslant(taken.net, route, human, &way) };
    Some(Way { cost: way.cost + more, ..way })
}

/// The way without what leads back to a node before the meeting, and after it: people who walk it do not go into dead ends beside it.
fn without_loops(route: &Route) -> Route {
    let erased = |nodes: &[usize]| {
        let mut kept: Vec<usize> = Vec::new();
        for node in nodes {
            match kept.iter().position(|known| known == node) {
                Some(at) => kept.truncate(at + 1),
                None => kept.push(*node),
            }
        }
        kept
    };
    let mut nodes = erased(route.nodes.get(..=route.meet).unwrap_or_default());
    let meet = nodes.len().saturating_sub(1);
    nodes.extend(erased(route.nodes.get(route.meet..).unwrap_or_default()).into_iter().skip(1));
    Route { nodes, meet, ..*route }
}

/// Positions on the robot's way at which it can meet a person at a place of theirs; at its end it meets only those who stand.
fn met_on(route: &Route, place: &[usize], human: &HumanProposal) -> Vec<usize> {
    let Some(last) = route.nodes.len().checked_sub(1) else { return Vec::new() };
    let between = |at: &usize| human.relation.stands() && *at > 0 || (1..last).contains(at);
    let at = |at: &usize| route.nodes.get(*at).is_some_and(|node| place.contains(node));
    (0..=last).filter(between).filter(at).collect()
}

/// Cosine of the angle between two ways above which the one does not cross the other, and the cost of such a way.
const ALONG: f64 = 0.75;
const NO_CROSSING: f64 = 20.0;

/// Cost of a way that is to cross the robot's and comes to it along that, or turns into it where it goes straight on.
fn aslant(net: &Net<'_>, route: &Route, human: &HumanProposal, way: &Way) -> f64 {
    let beside = |nodes: &[usize]| {
        let at = nodes.iter().position(|node| *node == way.meet)?;
        Some((*nodes.get(at.checked_sub(1)?)?, *nodes.get(at + 1)?))
    };
    let (Some((before, after)), Some((entry, exit))) = (beside(&route.nodes), beside(&way.nodes)) else { return 0.0 };
    let along = net.straight(before, way.meet, entry).abs() > ALONG;
    let turns_in = [before, after].contains(&exit) && net.straight(before, way.meet, after) > ALONG;
    if human.relation == Relation::Crossing && (along || turns_in) { NO_CROSSING } else { 0.0 }
}

/// The way of somebody who follows another human: the same, from the node before or after its start.
fn after(net: &Net<'_>, leader: &Way, taken: &Taken<'_>) -> Option<Way> {
    let first = *leader.nodes.first()?;
    let back = net
        .near(first)
        .iter()
        .map(|(node, _)| *node)
        .find(|node| !leader.nodes.contains(node) && !taken.starts.contains(node));
    let mut nodes: Vec<usize> = back.into_iter().collect();
    nodes.extend(leader.nodes.iter().skip(usize::from(back.is_none())));
    if nodes.len() < 2 || nodes.first() == Some(&leader.meet) {
        return None;
    }
    Some(Way { nodes, meet: leader.meet, cost: 0.5 })
}

/// The paths of a solution, as they are written.
pub(crate) fn written(net: &Net<'_>, solution: &Solution, problem: &Problem<'_>) -> Paths {
    let order = |node: &usize| solution.route.nodes.iter().position(|other| other == node).unwrap_or(usize::MAX);
    let mut meetings: Vec<(HumanId, usize)> = solution.ways.iter().map(|(id, way)| (*id, way.meet)).collect();
    meetings.extend(solution.again.iter().map(|(id, node)| (*id, *node)));
    meetings.sort_by_key(|(id, node)| (order(node), *id));
    let encounters: Vec<Encounter> = meetings
        .into_iter()
        .filter_map(|(human, node)| net.id(node).map(|node| Encounter { human, node: node.clone() }))
        .collect();
    let humans: BTreeMap<HumanId, Vec<NodeId>> =
        solution.ways.iter().map(|(id, way)| (*id, net.named(&way.nodes))).collect();
    let mut robot = solution.route.nodes.clone();
    if named_way::returns(problem.proposal) {
        robot.extend(solution.route.nodes.iter().rev().skip(1));
    }
    let length = libm::round(net.length_m(&robot) * 10.0) / 10.0;
    let mut at: Vec<String> = Vec::new();
    for encounter in &encounters {
        let node = format!("`{}`", encounter.node);
        if !at.contains(&node) {
            at.push(node);
        }
    }
    let reasoning = format!(
        "The robot goes {length} m{} over a meeting place that is {} ({}); {} encounters lie on its way in this order.",
        reason(net, &solution.route, problem),
        inside::an(problem.proposal.place),
        at.join(", "),
        encounters.len()
    );
    Paths { format: FORMAT, robot: net.named(&robot), humans, encounters, reasoning, author: problem.author.clone() }
}

/// A way this much longer than the shortest is told with its reason, as a share.
const TOLD: f64 = 0.02;

/// Why the robot does not go the shortest way; empty where it does.
fn reason(net: &Net<'_>, route: &Route, problem: &Problem<'_>) -> String {
    let more = times_shortest(net, &route.nodes, problem.via) - 1.0;
    let (Some(first), Some(last)) = (route.nodes.first(), route.nodes.last()) else { return String::new() };
    if !more.is_finite() || more <= TOLD {
        return String::new();
    }
    let direct = net.ways_from(*first);
    let shortest_m = direct.length_m(*last);
    let place = inside::an(problem.proposal.place);
    let passes = direct.way(*last).iter().any(|node| net.is(*node, problem.proposal.place));
    let why = if shortest_m < LEAST_M {
        format!("which is too short for a meeting: it takes {LEAST_M} m")
    } else if passes {
        format!("where nobody can do at {place} what they have to")
    } else {
        format!("which does not lead over {place}")
    };
    format!(" ({:.0} % more than the {shortest_m:.1} m of the shortest way, {why})", more * 100.0)
}
