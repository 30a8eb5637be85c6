//! The places that a proposal means by name.

use std::collections::BTreeMap;

use socrates_model::{ClauseRole, Encounter, HumanId, HumanProposal, NodeId, Paths, Predicate, Proposal, Relation};

use crate::graph::Net;

/// The nodes that a proposal names for its place; none where any of the class will do.
#[must_use]
pub fn of_proposal(proposal: &Proposal) -> Vec<NodeId> {
    let own = proposal.expected_events.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup);
    let named = own.filter_map(|clause| {
        if let Predicate::EncounterAt { place, nodes, human: None } = &clause.predicate {
            Some(nodes.clone()).filter(|_| *place == proposal.place)
        } else {
            None
        }
    });
    named.flatten().collect()
}

/// The same by index.
pub(crate) fn indices(net: &Net<'_>, proposal: &Proposal) -> Vec<usize> {
    of_proposal(proposal).iter().filter_map(|id| net.index(id)).collect()
}

/// The places of people with a place of their own, as nodes by index.
pub(crate) fn elsewhere(net: &Net<'_>, proposal: &Proposal) -> BTreeMap<HumanId, Vec<usize>> {
    let own = |human: &HumanProposal| {
        let nodes = proposal.own_place(human.id)?;
        Some((human.id, nodes.iter().filter_map(|id| net.index(id)).collect()))
    };
    proposal.humans.iter().filter_map(own).collect()
}

/// Whether somebody is met at one of these nodes, and everybody else at most next to it; who walks with the robot is met anywhere.
#[must_use]
pub fn met_at(meant: &[NodeId], paths: &Paths, proposal: &Proposal) -> bool {
    let along = |encounter: &&Encounter| {
        let human = proposal.human(encounter.human);
        human.is_some_and(|human| matches!(human.relation, Relation::Behind | Relation::Ahead | Relation::Abreast))
    };
    let beside = |encounter: &Encounter| {
        let at = paths.robot.iter().position(|node| *node == encounter.node);
        let around = at.map_or(0..0, |at| at.saturating_sub(1)..(at + 2).min(paths.robot.len()));
        paths.robot.get(around).unwrap_or_default().iter().any(|node| meant.contains(node))
    };
    let here = |encounter: &&Encounter| !along(encounter) && proposal.own_place(encounter.human).is_none();
    paths.encounters.iter().any(|encounter| meant.contains(&encounter.node))
        && paths.encounters.iter().filter(here).all(beside)
}
