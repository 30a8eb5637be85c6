//! What the robot's way has to keep to by name: where it begins and ends, what it leads past, what it keeps out of.

use socrates_model::proposal::WayPart;
use socrates_model::{ClauseRole, NodeId, Predicate, Proposal};

use crate::graph::Net;
use crate::{Miss, Problem, search};

/// One of those demands: the part of the way, and the nodes that count for it.
type Demand<'a> = (WayPart, &'a [NodeId]);

/// The demands of a proposal: its clauses that decide.
fn demands(proposal: &Proposal) -> impl Iterator<Item = Demand<'_>> {
    let own = proposal.expected_events.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup);
    own.filter_map(|clause| {
        if let Predicate::RobotWay { part, nodes } = &clause.predicate { Some((*part, nodes.as_slice())) } else { None }
    })
}

/// Whether a proposal demands anything of the way by name.
pub(crate) fn is_asked(proposal: &Proposal) -> bool {
    demands(proposal).next().is_some()
}

/// The nodes that no way of the robot may touch.
pub(crate) fn avoided(proposal: &Proposal) -> Vec<NodeId> {
    demands(proposal).filter(|(part, _)| *part == WayPart::Avoid).flat_map(|(_, nodes)| nodes.to_vec()).collect()
}

/// The nodes of which a way has to lead over one; the first demand counts for the choice of ends, [`keeps`] for all.
pub(crate) fn via(proposal: &Proposal) -> Vec<NodeId> {
    demands(proposal).find(|(part, _)| *part == WayPart::Via).map(|(_, nodes)| nodes.to_vec()).unwrap_or_default()
}

/// The nodes at which the way has to begin or end.
pub(crate) fn ends(proposal: &Proposal, end: WayPart) -> Vec<NodeId> {
    demands(proposal).find(|(part, _)| *part == end).map(|(_, nodes)| nodes.to_vec()).unwrap_or_default()
}

/// Whether the robot comes back from its goal by the way that it came.
pub(crate) fn returns(proposal: &Proposal) -> bool {
    demands(proposal).any(|(part, _)| part == WayPart::Back)
}

/// Whether a way of the robot does all that is demanded of it.
pub(crate) fn keeps(net: &Net<'_>, proposal: &Proposal, way: &[usize]) -> bool {
    demands(proposal).all(|(part, nodes)| {
        let own = |node: &usize| net.id(*node).is_some_and(|id| nodes.contains(id));
        match part {
            WayPart::Start => way.first().is_some_and(own),
            WayPart::Goal => way.last().is_some_and(own),
            // A way that begins or ends there does not lead past it.
            WayPart::Via => way.iter().any(own) && ![way.first(), way.last()].into_iter().flatten().any(own),
            WayPart::Avoid => !way.iter().any(own),
            // The way back is the same again: see `returns`.
            WayPart::Back => true,
        }
    })
}

/// The demands that no way of the map does, where there would be ways without them.
pub(crate) fn missing(problem: &Problem<'_>) -> Option<Miss> {
    let all: Vec<Demand<'_>> = demands(problem.proposal).collect();
    if all.is_empty() {
        return None;
    }
    let has_ways = |dropped: &dyn Fn(&Demand<'_>) -> bool| {
        let mut proposal = problem.proposal.clone();
        proposal.expected_events.retain(|clause| {
            !matches!(&clause.predicate, Predicate::RobotWay { part, nodes } if dropped(&(*part, nodes.as_slice())))
        });
        let problem = Problem { proposal: &proposal, ..problem.clone() };
        !search::solutions(&problem, &Net::of(&problem)).is_empty()
    };
    if has_ways(&|_| false) || !has_ways(&|_| true) {
        return None;
    }
    let alone = |demand: &&Demand<'_>| has_ways(&|other| other == *demand);
    let named = |(part, nodes): &Demand<'_>| (*part, nodes.to_vec());
    let mut parts: Vec<(WayPart, Vec<NodeId>)> = all.iter().filter(alone).map(named).collect();
    if parts.is_empty() {
        parts = all.iter().map(named).collect();
    }
    Some(Miss::Way { parts })
}
