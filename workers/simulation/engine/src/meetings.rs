//! Where and in which order a human meets the robot: from the paths to lengths along the ways, and which meeting is on.

use socrates_model::{AgentId, Clause, HumanId, HumanProposal, NodeId, Point, Polyline, Predicate, Relation, Visit};

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
/// Who is to be there after another comes so much later, s.
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
            ordered_s(setup, proposal.id).unwrap_or(usual_s)
        } else {
            let course = |way: &Polyline, s: f64| way.direction((s - AROUND_M).max(0.0));
            rendezvous::lead_by_ways_s(&course(way, human_s), &course(robot_way, robot_s))
        };
        made.push(Meeting { node: visit.node.clone(), at, human_s, robot_s, lead_s });
    }
    made
}

/// Who is to be there before or after somebody else, or the robot: how long before the robot it aims at being there, s.
///
/// Those of one order come `APART_S` after each other, the robot in their middle or in its own place among them.
fn ordered_s(setup: &Setup, human: HumanId) -> Option<f64> {
    let order: Vec<(AgentId, AgentId)> = setup
        .proposal
        .expected_events
        .iter()
        .filter_map(|clause| {
            if let Predicate::Before { first, then, at_door: false } = &clause.predicate {
                Some((*first, *then))
            } else {
                None
            }
        })
        .collect();
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
        // Who stands there from the start goes away before the robot comes, unless it stays.
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
