//! Many people on one way of the robot: they meet it one after the other along it, not all at one node.

use std::collections::BTreeMap;

use socrates_model::{HumanId, HumanProposal, PlaceClass, Predicate, Proposal, Relation};

use crate::fit::tight;
use crate::graph::Net;
use crate::people::{Way, follows};
use crate::robot_way::Route;

/// So many are met at one node; more are spread along the way.
const AT_ONE: usize = 5;
/// The robot has gone so far before the first of them, m.
const BEFORE_M: f64 = 4.0;
/// Cosine of the turn at a place up to which the way leads straight over it.
const STRAIGHT: f64 = 0.7;
/// What a doorway or an aisle costs that everybody has to get through.
const TIGHT: f64 = 3.0;
/// More people than this who walk together do not fit through a doorway side by side.
const ABREAST: usize = 2;
/// What a corner costs round which many come.
const CORNER: f64 = 2.0;

/// Whether somebody walks by itself, with or against the robot.
fn passes(human: &HumanProposal) -> bool {
    let walks = matches!(human.relation, Relation::Frontal | Relation::Ahead) && human.group.is_none();
    walks && !follows(human)
}

/// Whether a way leads straight over its node at this place.
pub(crate) fn straight_over(net: &Net<'_>, nodes: &[usize], at: usize) -> bool {
    let around = at.checked_sub(1).and_then(|before| nodes.get(before..at + 2));
    matches!(around, Some([before, node, after]) if net.straight(*before, *node, *after) > STRAIGHT)
}

/// Where each of many is met along a way of the robot, as places in its nodes; nobody where a few are met, or where all have to
/// be at one place.
pub(crate) fn spread(net: &Net<'_>, proposal: &Proposal, route: &Route) -> Vec<(HumanId, usize)> {
    let all_at_once = proposal.expected_events.iter().any(|clause| {
        matches!(
            clause.predicate,
            Predicate::Flow { .. } | Predicate::Density { .. } | Predicate::Converges { .. } | Predicate::Before { .. }
        )
    });
    let many: Vec<HumanId> = proposal.humans.iter().filter(|human| passes(human)).map(|human| human.id).collect();
    if all_at_once || many.len() <= AT_ONE {
        return Vec::new();
    }
    let place = |at: usize| route.nodes.get(at).is_some_and(|node| net.is(*node, proposal.place));
    if proposal.place != PlaceClass::Plain && !place(route.meet) {
        return Vec::new();
    }
    let fits = |at: &usize| {
        let far = net.length_m(route.nodes.get(..=*at).unwrap_or_default()) >= BEFORE_M;
        let Some(node) = route.nodes.get(*at) else { return false };
        // Round a corner nobody comes straight towards it.
        let straight = straight_over(net, &route.nodes, *at);
        let open = !net.inside(*node) && !tight(net, *node);
        far && straight && open && (proposal.place == PlaceClass::Plain || place(*at))
    };
    let places: Vec<usize> = (1..route.nodes.len().saturating_sub(1)).filter(fits).collect();
    if places.len() < 2 {
        return Vec::new();
    }
    // Of each kind the first are met first.
    let mut found = Vec::new();
    for kind in [Relation::Frontal, Relation::Ahead] {
        let of_kind: Vec<HumanId> = proposal
            .humans
            .iter()
            .filter(|human| passes(human) && human.relation == kind)
            .map(|human| human.id)
            .collect();
        for (rank, id) in of_kind.iter().enumerate() {
            found.extend(places.get(rank * places.len() / of_kind.len()).map(|at| (*id, *at)));
        }
    }
    found
}

/// What it costs that people come through doorways and aisles, on average, and that the way of many turns corners.
pub(crate) fn squeezes(net: &Net<'_>, proposal: &Proposal, route: &Route, ways: &BTreeMap<HumanId, Way>) -> f64 {
    let tight = |way: &Way| way.nodes.iter().filter(|node| tight(net, **node)).count() as f64;
    let average = ways.values().map(tight).sum::<f64>() / ways.len().max(1) as f64;
    let many = proposal.humans.iter().filter(|human| passes(human)).count() > AT_ONE;
    let turns = |three: &&[usize]| matches!(three, [a, b, c] if net.straight(*a, *b, *c) <= STRAIGHT);
    let corners = route.nodes.windows(3).filter(turns).count() as f64;
    let abreast = proposal.groups.iter().any(|group| !group.standing && group.members.len() > ABREAST);
    let tight = if many || abreast { TIGHT * average } else { 0.0 };
    tight + if many { CORNER * corners } else { 0.0 }
}
