//! Whether the paths make the relation that was proposed: G-REL.

use socrates_maps::openings::Enclosures;
use socrates_model::{
    Action, Fault, FaultCode, HumanProposal, Location, NodeId, Paths, Proposal, Relation, SceneGraph, Vector,
};

use crate::list;

/// So many nodes are listed at most.
const LISTED: usize = 24;

/// Two ways count as opposite when the cosine between them is below this (135°).
const OPPOSITE: f64 = -0.7;

/// A fault per human whose path does not stand to the robot's as proposed.
pub(crate) fn check(paths: &Paths, proposal: &Proposal, location: &Location) -> Vec<Fault> {
    proposal
        .humans
        .iter()
        .filter_map(|human| {
            let nodes = paths.humans.get(&human.id)?;
            let why = wrong(human, nodes, paths, location)?;
            Some(Fault::new(
                FaultCode::GRel,
                human.id,
                format!("is `{}` in the proposal, but {why}", human.relation.name()),
            ))
        })
        .collect()
}

/// What is wrong with the path, or nothing.
fn wrong(human: &HumanProposal, nodes: &[NodeId], paths: &Paths, location: &Location) -> Option<String> {
    let graph = &location.graph;
    let robot = paths.robot.as_slice();
    let meeting = paths.encounter_of(human.id);
    match human.relation {
        // Who stands at first and goes on later has a way for that.
        Relation::Static => (nodes.len() != 1 && !sets_off(human)).then(|| {
            format!("their path has {} nodes; who stands has one, the encounter {}", nodes.len(), list(meeting))
        }),
        Relation::Aside => {
            (nodes.len() != 1).then(|| format!("their path has {} nodes; who stands aside has one", nodes.len()))
        }
        Relation::Staying => {
            let start = nodes.first()?;
            if nodes.len() != 1 {
                Some(format!("their path has {} nodes; who stays inside has one", nodes.len()))
            } else {
                let all = Enclosures::of(location);
                (!all.is_inside(start)).then(|| format!("`{start}` {}", not_inside(start, &all, location)))
            }
        }
        Relation::Leaving => {
            let start = nodes.first()?;
            let all = Enclosures::of(location);
            match all.of_node(start) {
                None => Some(format!("they start at `{start}`, which {}", not_inside(start, &all, location))),
                Some(place) if nodes.iter().all(|node| place.holds(node)) => {
                    Some("their path never leaves through the door".to_owned())
                }
                Some(_) => None,
            }
        }
        Relation::Frontal => {
            let meeting = meeting?;
            (!opposite(nodes, robot, meeting, graph)).then(|| {
                format!(
                    "does not come towards the robot at `{meeting}`: robot {}, human {}. It should walk the robot's edges at the \
                     encounter the other way round",
                    list(around(robot, meeting)),
                    list(around(nodes, meeting))
                )
            })
        }
        Relation::Crossing => {
            let meeting = meeting?;
            let robot_arms = arms(robot, meeting);
            let crosses = arms(nodes, meeting).iter().any(|arm| !robot_arms.contains(arm));
            (!crosses).then(|| {
                let free = graph.neighbors(meeting).iter().filter(|node| !robot_arms.contains(node));
                format!(
                    "uses at `{meeting}` only the robot's own edges; they should come from or go to one of {}",
                    list(free)
                )
            })
        }
        Relation::Behind | Relation::Ahead | Relation::Abreast => same_way(human.relation, nodes, robot, meeting),
    }
}

/// Whether somebody who stands goes somewhere later: in through a door, or on by a rule.
fn sets_off(human: &HumanProposal) -> bool {
    human.goal.is_some() || human.rules.iter().any(|rule| rule.act == Action::Navigate)
}

/// Follower, leader and companion share a stretch with the robot in the same direction.
fn same_way(relation: Relation, nodes: &[NodeId], robot: &[NodeId], meeting: Option<&NodeId>) -> Option<String> {
    let shares = nodes.windows(2).any(|step| robot.windows(2).any(|other| other == step));
    if !shares {
        return Some(format!("shares no edge with the robot in the same direction; the robot's path: {}", list(robot)));
    }
    let place = |node: Option<&NodeId>| node.and_then(|node| robot.iter().position(|other| other == node));
    let (start, met) = (place(nodes.first()), place(meeting));
    match relation {
        Relation::Behind if start.zip(met).is_some_and(|(start, met)| start >= met && start > 0) => Some(format!(
            "starts at {}, at or after the encounter {}; they should start behind the robot",
            list(nodes.first()),
            list(meeting)
        )),
        Relation::Ahead if start == Some(0) => {
            Some(format!("starts at {}, where the robot starts; they should start further on", list(nodes.first())))
        }
        Relation::Frontal
        | Relation::Behind
        | Relation::Ahead
        | Relation::Crossing
        | Relation::Static
        | Relation::Leaving
        | Relation::Staying
        | Relation::Abreast
        | Relation::Aside => None,
    }
}

/// Whether the two walk against each other over the meeting: along the same edge, or by their headings.
fn opposite(own: &[NodeId], robot: &[NodeId], meeting: &NodeId, graph: &SceneGraph) -> bool {
    let (own_before, own_after) = beside(own, meeting);
    let (robot_before, robot_after) = beside(robot, meeting);
    let same = |a: Option<&NodeId>, b: Option<&NodeId>| a.is_some() && a == b;
    if same(own_after, robot_before) || same(own_before, robot_after) {
        return true;
    }
    let heading = |before: Option<&NodeId>, after: Option<&NodeId>| -> Option<Vector> {
        let from = graph.node(before.unwrap_or(meeting))?.at;
        let to = graph.node(after.unwrap_or(meeting))?.at;
        (to - from).try_normalize(1e-9)
    };
    heading(own_before, own_after)
        .zip(heading(robot_before, robot_after))
        .is_some_and(|(human, robot)| human.dot(&robot) < OPPOSITE)
}

/// Nodes before and after the first visit of a node.
fn beside<'a>(nodes: &'a [NodeId], node: &NodeId) -> (Option<&'a NodeId>, Option<&'a NodeId>) {
    let Some(at) = nodes.iter().position(|other| other == node) else { return (None, None) };
    (at.checked_sub(1).and_then(|before| nodes.get(before)), nodes.get(at + 1))
}

/// The neighbors by which a path comes to a node and leaves it.
fn arms<'a>(nodes: &'a [NodeId], node: &NodeId) -> Vec<&'a NodeId> {
    let (before, after) = beside(nodes, node);
    before.into_iter().chain(after).collect()
}

/// The node with what comes before and after it, for messages.
fn around<'a>(nodes: &'a [NodeId], node: &'a NodeId) -> Vec<&'a NodeId> {
    let (before, after) = beside(nodes, node);
    before.into_iter().chain(std::iter::once(node)).chain(after).collect()
}

/// Why a node is not inside, and which nodes are.
fn not_inside(node: &NodeId, all: &Enclosures, location: &Location) -> String {
    let open = all.open_plan().iter().find(|(nodes, _)| nodes.contains(node));
    let why = open.map_or_else(String::new, |(_, why)| format!(": {why}"));
    let ids = location.graph.nodes().iter().map(|node| &node.id);
    let inside = list(ids.filter(|id| all.is_inside(id)).take(LISTED));
    format!("is not inside a room or elevator{why}; inside are {inside}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{crossing_paths, crossing_proposal, hard_codes, node, nodes, plus_map, room_map};
    use socrates_model::{Encounter, HumanId};

    fn codes(relation: Relation, path: &[&str]) -> Vec<String> {
        let (mut paths, mut proposal) = (crossing_paths(), crossing_proposal());
        proposal.humans[0].relation = relation;
        paths.humans.insert(HumanId::new(1), nodes(path));
        hard_codes(&check(&paths, &proposal, &plus_map()))
    }

    #[test]
    fn frontal_is_the_robots_edge_the_other_way_round() {
        assert!(codes(Relation::Frontal, &["e_2", "e_1", "n_center", "w_1"]).is_empty());
        assert_eq!(codes(Relation::Frontal, &["w_2", "w_1", "n_center", "e_1"]), ["G-REL"]);
        assert_eq!(codes(Relation::Frontal, &["n_1", "n_center", "s_1"]), ["G-REL"]);
    }

    #[test]
    fn crossing_needs_an_edge_of_its_own() {
        assert!(codes(Relation::Crossing, &["n_1", "n_center", "e_1"]).is_empty());
        assert_eq!(codes(Relation::Crossing, &["e_1", "n_center", "w_1"]), ["G-REL"]);
    }

    #[test]
    fn followers_start_behind_and_leaders_ahead() {
        assert!(codes(Relation::Behind, &["w_3", "w_2", "w_1", "n_center", "e_1"]).is_empty());
        assert_eq!(codes(Relation::Behind, &["n_center", "e_1", "e_2"]), ["G-REL"]);
        assert!(codes(Relation::Ahead, &["w_1", "n_center", "e_1"]).is_empty());
        assert_eq!(codes(Relation::Ahead, &["w_2", "w_1", "n_center"]), ["G-REL"]);
        assert_eq!(codes(Relation::Abreast, &["n_1", "n_center", "s_1"]), ["G-REL"]);
    }

    #[test]
    fn who_stands_has_one_node() {
        assert!(codes(Relation::Static, &["n_center"]).is_empty());
        assert_eq!(codes(Relation::Static, &["n_center", "n_1"]), ["G-REL"]);
        let (mut paths, mut proposal) = (crossing_paths(), crossing_proposal());
        proposal.humans[0].relation = Relation::Static;
        proposal.humans[0].goal = Some(socrates_model::PlaceClass::Elevator);
        paths.humans.insert(HumanId::new(1), nodes(&["n_center", "n_1"]));
        assert!(check(&paths, &proposal, &plus_map()).is_empty(), "who goes in later");
    }

    #[test]
    fn leaving_starts_inside_and_gets_out() {
        let location = room_map();
        let mut proposal = crossing_proposal();
        let mut paths = crossing_paths();
        proposal.humans.truncate(1);
        proposal.humans[0].relation = Relation::Leaving;
        paths.encounters = vec![Encounter { human: HumanId::new(1), node: node("n_center") }];
        for (path, good) in [
            (vec!["room_a", "room_b", "n_1", "n_center", "s_1"], true),
            (vec!["room_a", "room_b"], false),
            (vec!["n_1", "n_center"], false),
        ] {
            paths.humans = [(HumanId::new(1), nodes(&path))].into();
            assert_eq!(check(&paths, &proposal, &location).is_empty(), good, "{path:?}");
        }
    }
}
