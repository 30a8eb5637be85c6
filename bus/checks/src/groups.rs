//! Who starts where: groups together (G-GRP), everybody else apart (G-COLL).

use socrates_model::{AgentId, Fault, FaultCode, HumanId, Location, NodeId, Paths, Proposal, Relation, Where};

use crate::list;
use crate::routes::walks;

/// Members of a group are at most so far apart at the start or at the end, m.
const TOGETHER_M: f64 = 2.0;
/// Agents start at least so far apart unless they belong together, m.
const APART_M: f64 = 0.8;
/// So many humans may start at one node: the engine places them next to each other.
const SHARED: usize = 3;

/// Every fault of groups and starts.
pub(crate) fn check(paths: &Paths, proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let mut faults = groups(paths, proposal, location);
    faults.extend(starts(paths, proposal, location));
    faults
}

fn groups(paths: &Paths, proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let mut faults = Vec::new();
    for group in &proposal.groups {
        let walks: Vec<(HumanId, &[NodeId])> = group
            .members
            .iter()
            .filter_map(|member| paths.humans.get(member).map(|nodes| (*member, nodes.as_slice())))
            .filter(|(_, nodes)| !nodes.is_empty())
            .collect();
        let Some(((first, way), others)) = walks.split_first() else { continue };
        for (member, nodes) in others {
            let start_m = apart(way.first(), nodes.first(), location);
            let end_m = apart(way.last(), nodes.last(), location);
            let joined = way.iter().filter(|node| nodes.contains(node)).count() >= 2;
            let together = start_m <= TOGETHER_M && (group.standing || end_m <= TOGETHER_M || joined);
            if !together {
                let message = format!(
                    "{first} and {member} start {start_m:.1} m and end {end_m:.1} m apart; members of a group start within \
                     {TOGETHER_M} m of each other and go the same way: {}",
                    list(*way)
                );
                faults.push(Fault::new(FaultCode::GGrp, group.id, message));
            }
        }
    }
    faults
}

fn starts(paths: &Paths, proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let everybody: Vec<(AgentId, &NodeId)> =
        walks(paths).filter_map(|(agent, nodes)| nodes.first().map(|start| (agent, start))).collect();
    let mut faults = Vec::new();
    for (index, (one, here)) in everybody.iter().enumerate() {
        for (other, there) in everybody.iter().skip(index + 1) {
            let distance_m = apart(Some(here), Some(there), location);
            let human = |agent: &AgentId| matches!(agent, AgentId::Human(_));
            let few = everybody.iter().filter(|(_, start)| start == here).count() <= SHARED;
            let shared = here == there && few && human(one) && human(other);
            if distance_m < APART_M && !shared && !belong(*one, *other, proposal) {
                let message = format!(
                    "{one} and {other} start at `{here}` and `{there}`, {distance_m:.1} m apart; at least {APART_M} m are needed \
                     unless they are one group, share a room, or start as two or three at one node"
                );
                faults.push(Fault::new(FaultCode::GColl, Where::agents([*one, *other]), message));
            }
        }
    }
    faults
}

/// Whether two may start at one node: the engine spreads groups, the people of a car, who stands at one place, and who walks with the robot.
fn belong(one: AgentId, other: AgentId, proposal: &Proposal) -> bool {
    let human = |agent: AgentId| match agent {
        AgentId::Robot => None,
        AgentId::Human(id) => proposal.human(id),
    };
    match (human(one), human(other)) {
        (Some(a), Some(b)) => {
            let indoors = |relation: Relation| matches!(relation, Relation::Leaving | Relation::Staying);
            let along = |relation: Relation| matches!(relation, Relation::Behind | Relation::Abreast);
            let stands = |relation: Relation| relation == Relation::Static;
            a.group.is_some() && a.group == b.group
                || indoors(a.relation) && indoors(b.relation)
                || along(a.relation) && along(b.relation)
                || stands(a.relation) && stands(b.relation)
                || a.relation == Relation::Aside
                || b.relation == Relation::Aside
        }
        (None, Some(human)) | (Some(human), None) => {
            // A standing group with which the robot starts is placed round it.
            let with = human.relation == Relation::Static && human.group.is_some();
            with || matches!(human.relation, Relation::Behind | Relation::Abreast | Relation::Ahead)
        }
        (None, None) => false,
    }
}

fn apart(a: Option<&NodeId>, b: Option<&NodeId>, location: &Location) -> f64 {
    let at = |node: Option<&NodeId>| node.and_then(|id| location.graph.node(id)).map(|node| node.at);
    at(a).zip(at(b)).map_or(f64::INFINITY, |(a, b)| (b - a).norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{crossing_paths, crossing_proposal, hard_codes, nodes, plus_map};
    use socrates_model::{GroupId, GroupProposal, HumanProposal};

    fn grouped(second: &[&str]) -> Vec<String> {
        let (mut paths, mut proposal) = (crossing_paths(), crossing_proposal());
        let members = vec![HumanId::new(1), HumanId::new(2)];
        proposal.groups = vec![GroupProposal { id: GroupId(1), members, standing: false }];
        for human in &mut proposal.humans {
            human.group = Some(GroupId(1));
        }
        paths.humans.insert(HumanId::new(1), nodes(&["n_2", "n_1", "n_center", "s_1"]));
        paths.humans.insert(HumanId::new(2), nodes(second));
        hard_codes(&check(&paths, &proposal, &plus_map()))
    }

    #[test]
    fn a_group_walks_the_same_way() {
        assert!(grouped(&["n_2", "n_1", "n_center", "s_1"]).is_empty());
        assert_eq!(grouped(&["s_2", "s_1", "n_center", "n_1"]), ["G-GRP"]);
    }

    #[test]
    fn a_crowd_does_not_start_at_one_node_but_two_or_three_may() {
        let (mut paths, proposal) = (crossing_paths(), crossing_proposal());
        let way = paths.humans[&HumanId::new(1)].clone();
        for human in 2..=3 {
            paths.humans.insert(HumanId::new(human), way.clone());
            assert!(hard_codes(&check(&paths, &proposal, &plus_map())).is_empty(), "{human}");
        }
        paths.humans.insert(HumanId::new(4), way.clone());
        let found = hard_codes(&check(&paths, &proposal, &plus_map()));
        assert!(!found.is_empty() && found.iter().all(|code| code == "G-COLL"), "{found:?}");
        // Nobody starts where the robot does.
        paths.humans.retain(|human, _| human.number() == 1);
        paths.humans.get_mut(&HumanId::new(1)).unwrap()[0] = paths.robot[0].clone();
        assert_eq!(hard_codes(&check(&paths, &proposal, &plus_map())), ["G-COLL"]);
    }

    #[test]
    fn who_stands_may_stand_at_one_place_with_others() {
        let (mut paths, mut proposal) = (crossing_paths(), crossing_proposal());
        let template = proposal.humans[0].clone();
        proposal.humans = (1..=5)
            .map(|human| HumanProposal { id: HumanId::new(human), relation: Relation::Static, ..template.clone() })
            .collect();
        paths.humans = (1..=5).map(|human| (HumanId::new(human), nodes(&["n_center"]))).collect();
        assert!(hard_codes(&check(&paths, &proposal, &plus_map())).is_empty());
        proposal.humans[0].relation = Relation::Frontal;
        assert!(!hard_codes(&check(&paths, &proposal, &plus_map())).is_empty());
    }
}
