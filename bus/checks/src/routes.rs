//! The paths themselves: G-AGENTS, G-EMPTY, G-UNKNOWN, G-DISC, G-SHORT, G-LOOP.

use std::collections::BTreeSet;

use socrates_model::paths::ROBOT_WAY_M;
use socrates_model::{
    AgentId, Fault, FaultCode, HumanId, Location, NodeId, Paths, Proposal, Relation, SceneGraph, Where,
};

use crate::nearest::nodes_like;
use crate::places::nodes_of;
use crate::{encounters, free, groups, list, relations, timing};

/// Fewest nodes of the robot's path.
const ROBOT_NODES: usize = 4;
/// Shortest path of a human who moves, m.
const HUMAN_M: f64 = 3.0;
/// Shortest path of a human who only has to get out of a room or car, m.
const LEAVER_M: f64 = 2.0;
/// Longest list of ids in one message.
const LISTED: usize = 24;

/// Every fault of the paths: against the scene graph, against the proposal, against each other.
#[must_use]
pub fn check_paths(paths: &Paths, proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let mut faults = agents(paths, proposal);
    let mut sound = true;
    for (agent, nodes) in walks(paths) {
        let broken = steps(agent, nodes, proposal.place, &location.graph);
        sound &= broken.is_empty();
        faults.extend(broken);
        // A person who meets the robot twice comes back for it.
        let again = |human: HumanId| paths.encounters_of(human).count() > 1;
        let twice = match agent {
            AgentId::Robot => paths.comes_back() || paths.humans.keys().copied().any(again),
            AgentId::Human(human) => again(human),
        };
        if !twice {
            faults.extend(loops(agent, nodes));
        }
    }
    faults.extend(encounters::check(paths, proposal, location));
    // Lengths, directions and distances of a path with a hole say nothing.
    if sound {
        faults.extend(lengths(paths, proposal, &location.graph));
        faults.extend(relations::check(paths, proposal, location));
        faults.extend(groups::check(paths, proposal, location));
        faults.extend(timing::check(paths, proposal, &location.graph));
        faults.extend(free::check(paths, location));
    }
    faults
}

/// Everybody's path, the robot's first.
pub(crate) fn walks(paths: &Paths) -> impl Iterator<Item = (AgentId, &[NodeId])> {
    let robot = std::iter::once((AgentId::Robot, paths.robot.as_slice()));
    robot.chain(paths.humans.iter().map(|(id, nodes)| (AgentId::Human(*id), nodes.as_slice())))
}

fn agents(paths: &Paths, proposal: &Proposal) -> Vec<Fault> {
    let wanted: BTreeSet<HumanId> = proposal.humans.iter().map(|human| human.id).collect();
    let found: BTreeSet<HumanId> = paths.humans.keys().copied().collect();
    let mut faults = Vec::new();
    if wanted != found {
        let message = format!(
            "paths are missing for {}, surplus for {}; give exactly one for each of {}",
            list(wanted.difference(&found)),
            list(found.difference(&wanted)),
            list(&wanted)
        );
        faults.push(Fault::new(FaultCode::GAgents, "humans", message));
    }
    faults
}

/// G-EMPTY, G-UNKNOWN and G-DISC of one path.
fn steps(agent: AgentId, nodes: &[NodeId], place: socrates_model::PlaceClass, graph: &SceneGraph) -> Vec<Fault> {
    if nodes.is_empty() {
        let message = "has a path without a node; give one node for somebody who stands, more for somebody who walks";
        return vec![Fault::new(FaultCode::GEmpty, agent, message)];
    }
    let mut faults = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
        if graph.node(node).is_none() {
            let of_place = nodes_of(graph, place);
            let candidates =
                if of_place.is_empty() { graph.nodes().iter().map(|node| node.id.clone()).collect() } else { of_place };
            let message = format!(
                "names `{node}`, which the map does not have; nearest: {}; nodes of class `{place}`: {}",
                list(nodes_like(graph, node, 3)),
                list(candidates.iter().take(LISTED))
            );
            faults.push(Fault::new(FaultCode::GUnknown, Where::agent(agent).step(index + 1), message));
        }
    }
    for (index, pair) in nodes.windows(2).enumerate() {
        let [from, to] = pair else { continue };
        if graph.node(from).is_none() || graph.node(to).is_none() || graph.edge(from, to).is_some() {
            continue;
        }
        let at = Where::agent(agent).step(index + 2);
        let message = if from == to {
            format!("names `{from}` twice in a row; name it once")
        } else {
            let way = graph.shortest(from, to).map_or_else(
                || "no way joins them".to_owned(),
                |way| format!("shortest way between them: {}", list(way)),
            );
            format!(
                "jumps from `{from}` to `{to}`: the scene graph has no such edge. Neighbors of `{from}`: {}; of `{to}`: {}; {way}",
                list(graph.neighbors(from)),
                list(graph.neighbors(to))
            )
        };
        faults.push(Fault::new(FaultCode::GDisc, at, message));
    }
    faults
}

/// G-SHORT.
fn lengths(paths: &Paths, proposal: &Proposal, graph: &SceneGraph) -> Vec<Fault> {
    let mut faults = Vec::new();
    let robot_m = graph.length_m(&paths.robot);
    if paths.robot.len() < ROBOT_NODES || robot_m < ROBOT_WAY_M {
        let message = format!(
            "has a path of {} nodes and {robot_m:.1} m; at least {ROBOT_NODES} nodes and {ROBOT_WAY_M} m are needed",
            paths.robot.len()
        );
        faults.push(Fault::new(FaultCode::GShort, AgentId::Robot, message));
    }
    for human in &proposal.humans {
        let Some(nodes) = paths.humans.get(&human.id) else { continue };
        let least_m = match human.relation {
            // One node is right for those who stand; the relation check says so if it is not.
            Relation::Static | Relation::Staying | Relation::Aside => continue,
            Relation::Leaving => LEAVER_M,
            Relation::Frontal | Relation::Behind | Relation::Ahead | Relation::Crossing | Relation::Abreast => HUMAN_M,
        };
        let length_m = graph.length_m(nodes);
        if nodes.len() < 2 || length_m < least_m {
            let message = format!(
                "has a path of {} nodes and {length_m:.1} m, but they move (`{}`); at least 2 nodes and {least_m} m are needed",
                nodes.len(),
                human.relation.name()
            );
            faults.push(Fault::new(FaultCode::GShort, human.id, message));
        }
    }
    faults
}

/// G-LOOP (warning): there and back at once, or a node visited again.
fn loops(agent: AgentId, nodes: &[NodeId]) -> Vec<Fault> {
    let mut found = Vec::new();
    for (index, triple) in nodes.windows(3).enumerate() {
        if let [a, b, c] = triple
            && a == c
            && a != b
        {
            found.push(format!("turns back at step {} (`{a}`, `{b}`, `{c}`)", index + 2));
        }
    }
    let mut seen = BTreeSet::new();
    for (index, node) in nodes.iter().enumerate() {
        let again = !seen.insert(node);
        let repeated = index.checked_sub(1).and_then(|before| nodes.get(before)) == Some(node);
        if again && !repeated && found.is_empty() {
            found.push(format!("comes to `{node}` again at step {}", index + 1));
        }
    }
    found
        .into_iter()
        .map(|message| {
            Fault::new(FaultCode::GLoop, agent, format!("{message}; go there once unless the task needs it"))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_paths, crossing_proposal, hard_codes, node, nodes, plus_map};

    fn faults(change: impl FnOnce(&mut Paths)) -> Vec<Fault> {
        let mut paths = crossing_paths();
        change(&mut paths);
        check_paths(&paths, &crossing_proposal(), &plus_map())
    }

    #[test]
    fn good_paths_have_no_fault() {
        assert_eq!(faults(|_| {}), []);
    }

    #[test]
    fn a_path_may_not_skip_an_edge() {
        let faults = faults(|paths| paths.robot = nodes(&["w_2", "w_1", "e_1", "e_2"]));
        let jump = faults.iter().find(|fault| fault.code == FaultCode::GDisc).unwrap();
        assert_eq!(jump.at, Where::agent(AgentId::Robot).step(3));
        assert!(
            jump.message.to_string().contains("shortest way between them: `w_1`, `n_center`, `e_1`"),
            "{}",
            jump.message
        );
    }

    #[test]
    fn every_jump_of_everybody_is_named_at_once() {
        let faults = faults(|paths| {
            paths.robot = nodes(&["w_2", "n_center", "e_1", "e_2"]);
            paths.humans.insert(HumanId::new(1), nodes(&["n_2", "n_center", "s_2"]));
        });
        assert_eq!(codes(&faults).iter().filter(|code| *code == "G-DISC").count(), 3);
    }

    #[test]
    fn an_unknown_node_is_no_missing_edge_and_the_nearest_is_named() {
        let faults = faults(|paths| paths.robot[1] = node("w_11"));
        assert!(!codes(&faults).contains(&"G-DISC".to_owned()));
        let unknown = faults.iter().find(|fault| fault.code == FaultCode::GUnknown).unwrap();
        assert!(unknown.message.to_string().contains("nearest: `w_1`"), "{}", unknown.message);
    }

    #[test]
    fn short_paths_say_how_long_they_are_and_must_be() {
        let faults = faults(|paths| {
            paths.robot = nodes(&["w_1", "n_center", "e_1"]);
            paths.humans.insert(HumanId::new(1), nodes(&["n_1", "n_center"]));
        });
        let codes = hard_codes(&faults);
        assert!(codes.contains(&"G-SHORT".to_owned()), "{codes:?}");
        assert!(faults.iter().any(|fault| fault.message.to_string().contains("3 nodes and 6.0 m")), "{faults:?}");
    }

    #[test]
    fn missing_and_surplus_humans_are_named() {
        let faults = faults(|paths| {
            let path = paths.humans.remove(&HumanId::new(2)).unwrap();
            paths.humans.insert(HumanId::new(9), path);
        });
        let agents = faults.iter().find(|fault| fault.code == FaultCode::GAgents).unwrap();
        assert!(
            agents.message.to_string().contains("missing for `human_2`, surplus for `human_9`"),
            "{}",
            agents.message
        );
    }

    #[test]
    fn an_empty_path_and_a_turn_back_are_told_apart() {
        let faults = faults(|paths| {
            paths.humans.insert(HumanId::new(1), Vec::new());
            paths.robot = nodes(&["w_2", "w_1", "n_center", "w_1", "n_center", "e_1", "e_2"]);
        });
        let codes = codes(&faults);
        assert!(codes.contains(&"G-EMPTY".to_owned()) && codes.contains(&"G-LOOP".to_owned()), "{codes:?}");
    }
}
