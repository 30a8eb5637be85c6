//! Where robot and humans meet: G-MEET, G-MEETEND, G-TYPE.

use std::collections::BTreeMap;

use socrates_maps::openings::Enclosures;
use socrates_model::{
    ClauseRole, Encounter, Fault, FaultCode, HumanId, HumanProposal, Location, NodeId, Paths, PlaceClass, Predicate,
    Proposal, Relation, ordinal,
};

use crate::list;
use crate::places::{family, nodes_of};

/// Longest list of candidates in one message.
const LISTED: usize = 24;

/// Two encounters of one person are at least so far apart along the robot's way, m: out of the place of the one (3 m about
/// its node) before the place of the other begins.
const APART_M: f64 = 6.0;

/// Every fault of the encounters.
pub(crate) fn check(paths: &Paths, proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut met: BTreeMap<HumanId, usize> = BTreeMap::new();
    for encounter in &paths.encounters {
        let place = met.entry(encounter.human).and_modify(|place| *place += 1).or_insert(0);
        match proposal.human(encounter.human) {
            None => {
                let message = format!(
                    "has an encounter but is not in the proposal; humans: {}",
                    list(proposal.humans.iter().map(|human| human.id))
                );
                faults.push(Fault::new(FaultCode::GAgents, encounter.human, message));
            }
            Some(human) => {
                let missing = meets(encounter, human, paths, location);
                if missing.is_none() {
                    faults.extend(again(*place, human, paths, location));
                }
                faults.extend(missing);
                faults.extend(ends(encounter, *place, human, paths, location));
            }
        }
    }
    faults.extend(too_few(paths, proposal));
    for human in &proposal.humans {
        let path = paths.humans.get(&human.id);
        // A person who stands where the robot starts is left, not met.
        let left = path.is_some_and(|nodes| nodes.len() == 1 && nodes.first() == paths.robot.first());
        let met =
            matches!(human.relation, Relation::Staying | Relation::Aside) || human.relation == Relation::Static && left;
        if !met && path.is_some() && paths.encounter_of(human.id).is_none() {
            let shared = path.map(|nodes| shared(nodes, &paths.robot)).unwrap_or_default();
            let message = format!("has no encounter; nodes they share with the robot: {}", list(shared));
            faults.push(Fault::new(FaultCode::GMeet, human.id, message));
        }
    }
    faults.extend(types(paths, proposal, location));
    faults
}

/// G-MEET: the node must be on both paths. Who stays inside is met where the robot's way ends.
fn meets(encounter: &Encounter, human: &HumanProposal, paths: &Paths, location: &Location) -> Option<Fault> {
    let own = paths.humans.get(&human.id)?;
    let on_robot = paths.robot.contains(&encounter.node);
    let on_human = own.contains(&encounter.node);
    // People of an elevator or room are met at its door, although they start behind it.
    // A bystander stands beside the way and meets nobody: the node is the one that they watch.
    if on_robot && human.relation == Relation::Aside {
        return None;
    }
    let at_door = matches!(human.relation, Relation::Staying | Relation::Leaving)
        && own.first().is_some_and(|start| near_inside(&encounter.node, start, location));
    if on_robot && (on_human || at_door) {
        return None;
    }
    let where_missing = match (on_robot, on_human) {
        (true, _) => "is not on their own path".to_owned(),
        (false, true) => "is not on the robot's path".to_owned(),
        (false, false) => "is on neither their own nor the robot's path".to_owned(),
    };
    let shared = shared(own, &paths.robot);
    let hint = if shared.is_empty() {
        "the two paths share no node; lead one of them through the other".to_owned()
    } else {
        format!("nodes they share: {}", list(shared))
    };
    let message = format!("meets the robot at `{}`, which {where_missing}; {hint}", encounter.node);
    Some(Fault::new(FaultCode::GMeet, human.id, message))
}

/// G-MEET: the encounters of one person are on both paths one after the other, and apart from each other.
fn again(place: usize, human: &HumanProposal, paths: &Paths, location: &Location) -> Option<Fault> {
    let visits = paths.visits(human.id);
    let (before, visit) = (visits.get(place.checked_sub(1)?)?, visits.get(place)?);
    let nth = ordinal(u32::try_from(place + 1).unwrap_or(u32::MAX));
    let own = paths.humans.get(&human.id)?;
    let after = |path: &[NodeId], step: Option<usize>| path.get(step? + 1..).map(<[NodeId]>::to_vec);
    let later = |whose: &str, path: &[NodeId], step: Option<usize>| {
        let rest = after(path, step).unwrap_or_default();
        let message = format!(
            "meets the robot for the {nth} time at `{}`, but {whose} path does not come there after the encounter before it, at `{}`; it \
             goes on over {}. Give the encounters of one person in order, and lead both paths to each",
            visit.node,
            before.node,
            list(rest)
        );
        Some(Fault::new(FaultCode::GMeet, human.id, message))
    };
    let Some(robot_step) = visit.robot_step else { return later("the robot's", &paths.robot, before.robot_step) };
    if visit.human_step.is_none() {
        return later("their own", own, before.human_step);
    }
    let way_m = location.graph.length_m(paths.robot.get(before.robot_step?..=robot_step)?);
    (way_m < APART_M).then(|| {
        let message = format!(
            "meets the robot for the {nth} time at `{}`, {way_m:.1} m along the robot's way from the encounter before it, at `{}`; at \
             least {APART_M:.0} m are needed. Choose a node further on, or lead the robot's path round",
            visit.node, before.node
        );
        Fault::new(FaultCode::GMeet, human.id, message)
    })
}

/// G-MEET: as many encounters as the proposal has somebody meet the robot.
fn too_few(paths: &Paths, proposal: &Proposal) -> Vec<Fault> {
    let mut wanted: BTreeMap<HumanId, u32> = BTreeMap::new();
    for clause in proposal.expected_events.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup) {
        if let Predicate::MeetsAgain { human, nth, .. } = clause.predicate {
            wanted.entry(human).and_modify(|most| *most = nth.max(*most)).or_insert(nth);
        }
    }
    let few = |(human, times): (HumanId, u32)| {
        let nodes: Vec<&NodeId> = paths.encounters_of(human).collect();
        let found = u32::try_from(nodes.len()).unwrap_or(u32::MAX);
        (found > 0 && found < times && paths.humans.contains_key(&human)).then(|| {
            let message = format!(
                "has {found} encounter{} ({}) where the proposal has it meet the robot {times} times; name it once for each meeting, in \
                 order, and lead both paths to each",
                if found == 1 { "" } else { "s" },
                list(nodes)
            );
            Fault::new(FaultCode::GMeet, human, message)
        })
    };
    wanted.into_iter().filter_map(few).collect()
}

/// Whether a node is in the same room or car as the start, or next to it.
fn near_inside(node: &NodeId, start: &NodeId, location: &Location) -> bool {
    Enclosures::of(location).same(start, node) || location.graph.shortest(start, node).is_some_and(|way| way.len() <= 4)
}

/// G-MEETEND: not at the ends of the robot's path, and the human goes on behind it.
fn ends(
    encounter: &Encounter,
    place: usize,
    human: &HumanProposal,
    paths: &Paths,
    location: &Location,
) -> Option<Fault> {
    let own = paths.humans.get(&human.id)?;
    // With several encounters the ends of a path may be visited before; with one, any visit might be meant.
    let visits = paths.visits(human.id);
    let visit = visits.get(place).filter(|_| visits.len() > 1);
    let (robot_step, human_step) = visit.map_or((None, None), |visit| (visit.robot_step, visit.human_step));
    let is_end = |path: &[NodeId], step: Option<usize>| {
        path.last() == Some(&encounter.node) && step.is_none_or(|step| step + 1 == path.len())
    };
    let is_start = paths.robot.first() == Some(&encounter.node) && robot_step.is_none();
    let all = Enclosures::of(location);
    let at_car = all.is_inside(&encounter.node)
        || location.graph.neighbors(&encounter.node).iter().any(|node| all.is_inside(node));
    let indoors = matches!(human.relation, Relation::Leaving | Relation::Staying);
    let stands = own.len() == 1;
    let last = is_end(&paths.robot, robot_step);
    // A person who stands may be where the robot's way ends: it comes up to them, or joins their group.
    let joined = stands;
    if is_start || last && !((indoors || stands) && at_car || joined) {
        let which = if last { "last" } else { "first" };
        let message = format!(
            "meets the robot at `{}`, the robot's {which} node; the encounter needs a robot node before and after it. Choose \
             one of {}, or make the robot's path longer",
            encounter.node,
            list(inner(&paths.robot).iter().filter(|node| own.contains(node)))
        );
        return Some(Fault::new(FaultCode::GMeetEnd, human.id, message));
    }
    if !stands && !indoors && is_end(own, human_step) {
        let message = format!(
            "ends at the encounter `{}`; a human who walks needs at least one node after it, such as one of {}",
            encounter.node,
            list(location.graph.neighbors(&encounter.node))
        );
        return Some(Fault::new(FaultCode::GMeetEnd, human.id, message));
    }
    None
}

/// G-TYPE: the meeting stretch (the node, and the robot's nodes next to it) is the proposed place.
fn types(paths: &Paths, proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let graph = &location.graph;
    let wanted = proposal.place;
    if wanted == PlaceClass::Plain || nodes_of(graph, wanted).is_empty() {
        return Vec::new();
    }
    // The one place that is meant, where the proposal names it: `the kitchen` is not any room.
    let named: Vec<NodeId> = proposal
        .expected_events
        .iter()
        .filter(|clause| clause.must && clause.role == ClauseRole::Setup)
        .filter_map(|clause| {
            if let Predicate::EncounterAt { place, nodes, human: None } = &clause.predicate {
                Some(nodes).filter(|_| *place == wanted)
            } else {
                None
            }
        })
        .flatten()
        .cloned()
        .collect();
    let of_class = |node: &NodeId| family(wanted).iter().any(|class| graph.node_is(node, *class));
    let is_wanted = |human: HumanId, node: &NodeId| match proposal.own_place(human) {
        Some(nodes) => nodes.contains(node),
        None if named.is_empty() => of_class(node),
        None => named.contains(node),
    };
    let candidates = |human: HumanId| match proposal.own_place(human) {
        Some(nodes) => nodes.to_vec(),
        None if named.is_empty() => nodes_of(graph, wanted),
        None => named.clone(),
    };
    let fits = |encounter: &Encounter| {
        let is_wanted = |node: &NodeId| is_wanted(encounter.human, node);
        is_wanted(&encounter.node)
            || paths.robot.iter().position(|node| *node == encounter.node).is_some_and(|at| {
                let before = at.checked_sub(1).and_then(|before| paths.robot.get(before));
                before.into_iter().chain(paths.robot.get(at + 1)).any(is_wanted)
            })
    };
    if paths.encounters.iter().any(|encounter| graph.node(&encounter.node).is_none()) {
        return Vec::new();
    }
    // A person who walks with the robot meets it along the way; one meeting at the place is enough for them.
    let along = |encounter: &Encounter| {
        proposal
            .human(encounter.human)
            .is_some_and(|human| matches!(human.relation, Relation::Behind | Relation::Ahead | Relation::Abreast))
    };
    let somewhere = paths.encounters.iter().any(fits);
    // Of somebody who meets the robot several times one meeting is at the place.
    let once = |encounter: &Encounter| {
        paths.encounters_of(encounter.human).count() > 1
            && paths.encounters.iter().any(|other| other.human == encounter.human && fits(other))
    };
    paths
        .encounters
        .iter()
        .filter(|encounter| !(fits(encounter) || once(encounter) || somewhere && along(encounter)))
        .map(|encounter| {
            let message = format!(
                "meets the robot at `{}` ({}), but the proposal wants {}; candidates: {}",
                encounter.node,
                list(graph.classes(&encounter.node)),
                proposal
                    .own_place(encounter.human)
                    .map_or_else(|| format!("`{wanted}`"), |_| "another place".to_owned()),
                list(candidates(encounter.human).iter().take(LISTED))
            );
            Fault::new(FaultCode::GType, encounter.human, message)
        })
        .collect()
}

fn shared(own: &[NodeId], robot: &[NodeId]) -> Vec<NodeId> {
    let mut found: Vec<NodeId> = Vec::new();
    for node in own.iter().filter(|node| robot.contains(node)) {
        if !found.contains(node) {
            found.push(node.clone());
        }
    }
    found
}

fn inner(nodes: &[NodeId]) -> &[NodeId] {
    nodes.get(1..nodes.len().saturating_sub(1)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{crossing_paths, crossing_proposal, hard_codes, node, nodes, plus_map};

    fn codes(change: impl FnOnce(&mut Paths, &mut Proposal)) -> Vec<String> {
        let (mut paths, mut proposal) = (crossing_paths(), crossing_proposal());
        change(&mut paths, &mut proposal);
        hard_codes(&check(&paths, &proposal, &plus_map()))
    }

    #[test]
    fn a_meeting_off_one_of_the_paths_is_refused() {
        assert_eq!(codes(|paths, _| paths.encounters[0].node = node("n_1")), ["G-MEET", "G-TYPE"]);
        assert_eq!(codes(|paths, _| paths.encounters.truncate(1)), ["G-MEET"]);
    }

    #[test]
    fn a_meeting_at_the_robots_end_is_refused() {
        let end = |paths: &mut Paths, _: &mut Proposal| paths.robot = nodes(&["w_3", "w_2", "w_1", "n_center"]);
        assert_eq!(codes(end), ["G-MEETEND", "G-MEETEND"]);
    }

    #[test]
    fn a_standing_group_may_be_joined_at_the_end_and_left_at_the_start() {
        let with = |paths: &mut Paths, proposal: &mut Proposal, group: bool| {
            for human in &mut proposal.humans {
                human.relation = Relation::Static;
                human.group = group.then_some(socrates_model::GroupId(1));
                paths.humans.insert(human.id, nodes(&["n_center"]));
            }
        };
        let end = nodes(&["w_3", "w_2", "w_1", "n_center"]);
        let joins = |paths: &mut Paths, proposal: &mut Proposal, group: bool| {
            with(paths, proposal, group);
            paths.robot = end.clone();
        };
        assert!(codes(|paths, proposal| joins(paths, proposal, true)).is_empty());
        // The robot may come up to a person who stands alone as well; it meets nobody who walks where it stops.
        assert!(codes(|paths, proposal| joins(paths, proposal, false)).is_empty());
        let leaves = |paths: &mut Paths, proposal: &mut Proposal| {
            with(paths, proposal, true);
            paths.robot = end.iter().rev().cloned().collect();
            paths.encounters.clear();
        };
        assert!(codes(leaves).is_empty());
    }

    fn meets_at(paths: &mut Paths, names: &[&str]) {
        let human = HumanId::new(1);
        paths.encounters.retain(|encounter| encounter.human != human);
        paths.encounters.extend(names.iter().map(|name| Encounter { human, node: node(name) }));
    }

    #[test]
    fn a_person_may_meet_the_robot_twice_where_both_paths_come_twice() {
        // The robot goes by the center to the north and back, then on to the east.
        let twice = |paths: &mut Paths, meets: &[&str]| {
            paths.robot = nodes(&["w_2", "w_1", "n_center", "n_1", "n_2", "n_1", "n_center", "e_1", "e_2"]);
            paths.humans.insert(HumanId::new(1), nodes(&["s_1", "n_center", "s_1", "n_center", "w_1", "w_2"]));
            meets_at(paths, meets);
        };
        let found = |meets: &[&str]| {
            let (mut paths, proposal) = (crossing_paths(), crossing_proposal());
            twice(&mut paths, meets);
            check(&paths, &proposal, &plus_map())
        };
        assert!(found(&["n_center", "n_center"]).is_empty(), "{:?}", found(&["n_center", "n_center"]));
        let thrice = found(&["n_center", "n_center", "n_center"]);
        assert_eq!(hard_codes(&thrice), ["G-MEET"]);
        assert!(thrice[0].message.to_string().contains("third time at `n_center`"), "{}", thrice[0].message);
    }

    #[test]
    fn encounters_of_one_person_are_in_order_and_apart() {
        let found = |robot: &[&str], human: &[&str], meets: &[&str]| {
            let (mut paths, proposal) = (crossing_paths(), crossing_proposal());
            paths.robot = nodes(robot);
            paths.humans.insert(HumanId::new(1), nodes(human));
            meets_at(&mut paths, meets);
            check(&paths, &proposal, &plus_map())
        };
        let west_to_east = ["w_2", "w_1", "n_center", "e_1", "e_2"];
        let order = found(&west_to_east, &["n_1", "n_center", "e_1", "e_2"], &["e_1", "n_center"]);
        assert_eq!(hard_codes(&order), ["G-MEET"]);
        assert!(order[0].message.to_string().contains("does not come there after"), "{}", order[0].message);
        let near = found(&west_to_east, &["n_1", "n_center", "e_1", "e_2"], &["n_center", "e_1"]);
        assert_eq!(hard_codes(&near), ["G-MEET"]);
        assert!(near[0].message.to_string().contains("along the robot's way"), "{}", near[0].message);
    }

    #[test]
    fn a_demanded_second_encounter_that_is_missing_is_asked_for() {
        let (paths, mut proposal) = (crossing_paths(), crossing_proposal());
        let again = Predicate::MeetsAgain { human: HumanId::new(1), nth: 2, within_m: 3.0 };
        proposal.expected_events[0].predicate = again;
        let faults = check(&paths, &proposal, &plus_map());
        assert_eq!(hard_codes(&faults), ["G-MEET"]);
        assert!(faults[0].message.to_string().contains("2 times"), "{}", faults[0].message);
    }

    #[test]
    fn who_walks_goes_on_after_the_meeting() {
        let stop = |paths: &mut Paths, _: &mut Proposal| {
            paths.humans.insert(HumanId::new(1), nodes(&["n_2", "n_1", "n_center"]));
        };
        assert_eq!(codes(stop), ["G-MEETEND"]);
    }

    #[test]
    fn a_place_that_is_named_is_no_other_of_its_class() {
        let at = |name: &str| {
            codes(|_, proposal| {
                for clause in &mut proposal.expected_events {
                    if let Predicate::EncounterAt { nodes: named, .. } = &mut clause.predicate {
                        *named = nodes(&[name]);
                    }
                }
            })
        };
        assert!(at("n_center").is_empty());
        assert_eq!(at("n_2"), ["G-TYPE", "G-TYPE"]);
    }

    #[test]
    fn the_meeting_is_at_the_proposed_place_or_next_to_it() {
        assert_eq!(codes(|_, proposal| proposal.place = PlaceClass::Exit), ["G-TYPE", "G-TYPE"]);
        assert!(codes(|_, proposal| proposal.place = PlaceClass::Corridor).is_empty());
    }
}
