//! Where and in which order a human meets the robot: from the paths to lengths along the ways, and which meeting is on.

use socrates_model::rule::{RobotDo, RobotWhen};
use socrates_model::{
    Action, AgentId, Clause, Gesture, HumanId, HumanProposal, NodeId, Point, Polyline, Predicate, Relation, Rule,
    Trigger, Visit,
};

use crate::human::{Human, Meeting};
use crate::recorder::Recorder;
use crate::rendezvous::{self, Timing};
use crate::robot::Robot;
use crate::setup::Setup;
use crate::start::HURRY_MPS;

/// Nodes of a path with their length along it, m.
pub(crate) type Marks = [(NodeId, f64)];

/// A node or two around a meeting tells from where and to where the ways lead there, m.
const AROUND_M: f64 = 0.5;
/// Time between two who are to be there one after the other, s.
const APART_S: f64 = 2.2;

/// The meetings of a human in order. With one, the visits of its node are chosen so that nobody is too late; with
/// several they are those of [`socrates_model::Paths::visits`].
pub(crate) fn of(
    setup: &Setup,
    proposal: &HumanProposal,
    (way, marks): (&Polyline, &Marks),
    (robot_way, robot_marks): (&Polyline, &Marks),
) -> Vec<Meeting> {
    let robot_mps = (0.93 * setup.robot.v_max_mps).max(0.1);
    let found = setup.paths.visits(proposal.id);
    let several = found.len() > 1;
    let mut made: Vec<Meeting> = Vec::new();
    for visit in &found {
        let Some(place) = setup.location.graph.node(visit.node) else { continue };
        let at = place.at;
        let chosen =
            if several { steps(visit, marks, robot_marks) } else { in_time(visit.node, marks, robot_marks, robot_mps) };
        let (human_s, robot_s) = chosen.unwrap_or_else(|| {
            let own = marks.iter().find(|(id, _)| id == visit.node).map_or_else(|| way.project(&at).0, |(_, s)| *s);
            (own, robot_way.project(&at).0)
        });
        let lead_s = if made.is_empty() {
            let usual_s = rendezvous::lead_s(proposal.relation, several_toward(setup, proposal, visit.node));
            let stops_s = stops_s(proposal, robot_mps);
            match (ordered_s(setup, proposal.id), stops_s) {
                (None, stops_s) => usual_s + stops_s,
                // A person who lets the robot go first stands short of the place meanwhile.
                (Some(order_s), stops_s) if order_s < 0.0 && stops_s > 0.0 => stops_s - SHORT_M / pace(proposal),
                (Some(order_s), _) => order_s,
            }
        } else {
            let course = |way: &Polyline, s: f64| way.direction((s - AROUND_M).max(0.0));
            rendezvous::lead_by_ways_s(&course(way, human_s), &course(robot_way, robot_s))
        };
        made.push(Meeting { node: visit.node.clone(), at, human_s, robot_s, lead_s });
    }
    made
}

/// Pace of somebody of whom none is stated, m/s.
const PACE_MPS: f64 = 1.2;
/// Somebody from behind who stops at the place has the robot so far behind them there, m.
const PASSES_M: f64 = 3.0;
/// The robot that comes up to somebody ahead is there with them from so much nearer than what they wait for, m: the usual lead.
const NEARS_M: f64 = 0.75;
/// Somebody who lets the robot go first stands so far before the place, m.
const SHORT_M: f64 = 1.8;

fn pace(proposal: &HumanProposal) -> f64 {
    proposal.speed_mps.unwrap_or(PACE_MPS)
}

/// How much sooner than they would walk there somebody has to aim at being at the meeting whose first steps have them stand while
/// the robot is still farther away, s: so that the robot finds them there, and not as far before it.
fn stops_s(proposal: &HumanProposal, robot_mps: f64) -> f64 {
    let mut steps: Vec<_> = proposal.rules.iter().filter(|rule| rule.step.is_some()).collect();
    steps.sort_by_key(|rule| rule.step);
    let stands = |rule: &&&Rule| rule.act.stands();
    if proposal.relation == Relation::Ahead {
        return nears_s(steps.first().copied(), robot_mps);
    }
    // To get past the robot they have to be there well before it, where they stop.
    let stops_there = steps.first().filter(stands).is_some_and(|first| first.when == [Trigger::AtEncounter]);
    if proposal.relation == Relation::Behind && stops_there {
        return PASSES_M / robot_mps;
    }
    let at_m = steps.first().filter(stands).and_then(|first| {
        let [Trigger::RobotVisible(m) | Trigger::RobotNear(m)] = first.when.as_slice() else { return None };
        Some(*m)
    });
    let Some(apart_m) = at_m.filter(|_| proposal.relation == Relation::Frontal) else { return 0.0 };
    let goes_on =
        |rule: &&&Rule| rule.when.iter().all(|when| matches!(when, Trigger::Did(..) | Trigger::RobotVisible(_)));
    let rest = steps.iter().skip(1).take_while(stands).take_while(goes_on);
    let stands_s: f64 = steps.iter().take(1).chain(rest).map(|rule| rule.for_s.unwrap_or(f64::INFINITY)).sum();
    // The robot comes on meanwhile; what is left of the way both walk.
    let left_m = (apart_m - robot_mps * stands_s).max(0.0);
    let walks_s = left_m / (robot_mps + pace(proposal));
    let own_m = walks_s * pace(proposal);
    (apart_m - own_m) / robot_mps - walks_s
}

/// The same of somebody ahead who begins something when the robot has come up to them: that is to be where they meet.
fn nears_s(first: Option<&Rule>, robot_mps: f64) -> f64 {
    let begins = first.filter(|rule| rule.act != Action::Navigate).map(|rule| rule.when.as_slice());
    let Some([Trigger::RobotNear(m)]) = begins else { return 0.0 };
    (m - NEARS_M).max(0.0) / robot_mps
}

/// Whether somebody else, or the robot, waits for something that this one does.
pub(crate) fn is_awaited(setup: &Setup, proposal: &HumanProposal) -> bool {
    let waits = |when: &Trigger| when.names() == Some(&proposal.id);
    let others = setup.proposal.humans.iter().filter(|other| other.id != proposal.id);
    let by_people = others.flat_map(|other| &other.rules).any(|rule| rule.when.iter().chain(&rule.until).any(waits));
    let makes = |sign: Gesture| proposal.rules.iter().any(|rule| rule.gesture == Some(sign));
    let says = |when: &RobotWhen| {
        let ends = matches!(when, RobotWhen::Did(..) | RobotWhen::Done(_)) && when.names() == Some(&proposal.id);
        ends || if let RobotWhen::HumanSays(sign) = when { makes(*sign) } else { false }
    };
    let by_robot =
        setup.proposal.robot.script.iter().any(|line| {
            says(&line.when) || if let RobotDo::HoldUntil(until) = &line.act { says(until) } else { false }
        });
    by_people || by_robot
}

/// Every two of whom the one is to be first, there or through a door.
pub(crate) fn orders(setup: &Setup) -> impl Iterator<Item = (AgentId, AgentId)> + '_ {
    setup.proposal.expected_events.iter().filter_map(|clause| {
        if let Predicate::Before { first, then, .. } = &clause.predicate { Some((*first, *then)) } else { None }
    })
}

/// How long before the robot somebody aims at being there of whom an order tells, s; nothing where none does.
///
/// Those of one order come `APART_S` after each other, the robot in their middle or in its own place among them.
fn ordered_s(setup: &Setup, human: HumanId) -> Option<f64> {
    let order: Vec<(AgentId, AgentId)> = orders(setup).collect();
    let own = AgentId::Human(human);
    if !order.iter().any(|(first, then)| [*first, *then].contains(&own)) {
        return None;
    }
    // Everybody whom a chain of such clauses ties to this one, in their order.
    let mut tied = vec![own];
    let mut at = 0;
    while let Some(one) = tied.get(at).copied() {
        for (first, then) in &order {
            for (here, there) in [(first, then), (then, first)] {
                if *here == one && !tied.contains(there) {
                    tied.push(*there);
                }
            }
        }
        at += 1;
    }
    // How many come before one; a circle has no order, and its length bounds the search.
    let rank = |one: AgentId| {
        let mut ahead = vec![one];
        let mut at = 0;
        while let Some(here) = ahead.get(at).copied().filter(|_| ahead.len() <= tied.len()) {
            let before = order.iter().filter(|(_, then)| *then == here).map(|(first, _)| *first);
            let more: Vec<AgentId> = before.filter(|first| !ahead.contains(first)).collect();
            ahead.extend(more);
            at += 1;
        }
        ahead.len() as f64 - 1.0
    };
    let middle = if tied.contains(&AgentId::Robot) { rank(AgentId::Robot) } else { (tied.len() as f64 - 1.0) / 2.0 };
    Some((middle - rank(own)) * APART_S)
}

/// Whether more than one comes towards the robot at this node and just passes it, or does so in a group; but no crowd: that has
/// to be there when the robot comes.
fn several_toward(setup: &Setup, proposal: &HumanProposal, node: &NodeId) -> bool {
    if proposal.relation != Relation::Frontal {
        return false;
    }
    let crowd = |clause: &Clause| {
        matches!(clause.predicate, Predicate::Flow { .. } | Predicate::Density { .. } | Predicate::Converges { .. })
    };
    if setup.proposal.expected_events.iter().any(crowd) {
        return false;
    }
    let toward = |human: &&HumanProposal| {
        let along = human.group.is_some() && human.group == proposal.group;
        human.relation == Relation::Frontal
            && (along || proposal.rules.is_empty() && human.rules.is_empty())
            && setup.paths.encounters_of(human.id).next() == Some(node)
    };
    setup.proposal.humans.iter().filter(toward).count() > 1
}

fn steps(visit: &Visit<'_>, own: &Marks, robot: &Marks) -> Option<(f64, f64)> {
    let mark = |marks: &Marks, step: Option<usize>| marks.get(step?).map(|(_, s)| *s);
    mark(own, visit.human_step).zip(mark(robot, visit.robot_step))
}

/// Which of the visits of a node is that of the only meeting, along the human's way and the robot's, m: one for which
/// nobody is too late if there is one, the robot's earliest of those.
fn in_time(node: &NodeId, own: &Marks, robot: &Marks, robot_mps: f64) -> Option<(f64, f64)> {
    let of = |marks: &Marks| -> Vec<f64> { marks.iter().filter(|(id, _)| id == node).map(|(_, s)| *s).collect() };
    let (mine, robots) = (of(own), of(robot));
    let pairs = mine.iter().flat_map(|human_s| robots.iter().map(move |robot_s| (*human_s, *robot_s)));
    let cost = |(human_s, robot_s): &(f64, f64)| {
        let due_s = robot_s / robot_mps;
        // Somebody who stands there from the start goes away before the robot comes, unless it stays.
        let starts = if *human_s < 1.0 && mine.len() > 1 { 1000.0 } else { 0.0 };
        starts + 10.0 * (human_s / HURRY_MPS - due_s).max(0.0) + due_s
    };
    pairs.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// Looks at the meeting that is on. The next one is on from where the robot is half-way to it: what of the one before
/// did not happen by then does not happen any more. Gives back how many of this human's have happened.
pub(crate) fn watch(human: &Human, timing: &mut Timing, robot: &Robot, recorder: &mut Recorder) -> usize {
    let at = |place: usize| human.meetings.get(place);
    while let (Some(now), Some(next)) = (at(timing.meeting), at(timing.meeting + 1)) {
        if robot.s < 0.5 * (now.robot_s + next.robot_s) {
            break;
        }
        timing.happened += usize::from(timing.over);
        (timing.meeting, timing.over) = (timing.meeting + 1, false);
    }
    if let Some(meeting) = at(timing.meeting) {
        let nth = u32::try_from(timing.meeting + 1).unwrap_or(u32::MAX);
        let spot: (&NodeId, &Point) = (&meeting.node, &meeting.at);
        timing.over |= recorder.meet((human.id, nth), spot, &robot.at(), &human.at, human.stays());
    }
    timing.happened + usize::from(timing.over)
}
