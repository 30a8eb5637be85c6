//! Edits of paths: longer, shorter, the other way round, from and to somewhere, round a place, met elsewhere.

use socrates_model::{AgentId, Encounter, Fault, FaultCode, HumanId, Location, NodeId, Paths, PlaceClass, Relation};
use socrates_prompts::Question;
use socrates_reader::Edit;
use socrates_solver::Ends;
use socrates_solver::edit::{Change, changed, joined};

use crate::card::card;
use crate::desk::Desk;
use crate::edit_whom::{Crowd, Whom};
use crate::edit_wish::Wish;
use crate::{place, solve, spot};

/// A path gets longer or shorter by so much where the edit does not say, m.
const STEP_M: f64 = 3.0;
/// Other places of the meeting that are tried.
const TRIES: usize = 8;

/// Does what an edit of paths asks for.
pub(crate) fn grant(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    let Some(paths) = desk.draft.paths.clone() else {
        return desk.refuse(&wish.quote, "speaks of paths, and there are none yet");
    };
    if wish.edit == Edit::Move {
        return moved(desk, wish, &paths);
    }
    let location = desk.question.location.clone();
    if wish.edit == Edit::Reverse {
        return reverse(desk, wish, &paths);
    }
    let people = match crowd.whom(wish) {
        Whom::Robot | Whom::Unsaid => Vec::new(),
        Whom::People(people) => people,
    };
    let mut new = paths.clone();
    let mut done = Vec::new();
    // Without anybody named it is the robot's path.
    let whose: Vec<Option<usize>> = if people.is_empty() { vec![None] } else { people.into_iter().map(Some).collect() };
    for who in whose {
        let id = who.and_then(|who| desk.draft.proposal.humans.get(who)).map(|human| human.id);
        let agent = id.map_or(AgentId::Robot, AgentId::Human);
        let name = id.map_or_else(|| "the robot".to_owned(), |id| id.to_string());
        if new.of(agent).is_none_or(|nodes| nodes.len() < 2) {
            desk.refuse(&wish.quote, &format!("speaks of {name}, who stands and has no way"));
            continue;
        }
        match change(wish, &location).and_then(|change| changed(&location, &new, agent, &change)) {
            Ok(found) => {
                let [before, after] = [&new, &found].map(|paths| paths.of(agent).unwrap_or_default());
                let [before_m, after_m] = [before, after].map(|nodes| location.graph.length_m(nodes));
                done.push(format!("the way of {name} is {after_m:.1} m instead of {before_m:.1} m: {}", listed(after)));
                new = found;
            }
            Err(why) => desk.refuse(&wish.quote, &format!("cannot be done for {name}: {why}")),
        }
    }
    if new == paths {
        return;
    }
    socrates_solver::edit::sort(&mut new);
    if let (Edit::Start | Edit::End, Some(class)) = (wish.edit, wish.place)
        && new.robot != paths.robot
    {
        let robot = &mut desk.draft.proposal.robot;
        *(if wish.edit == Edit::Start { &mut robot.start } else { &mut robot.goal }) = Some(class);
    }
    desk.draft.paths = Some(new);
    desk.done.extend(done);
}

fn listed(nodes: &[NodeId]) -> String {
    nodes.iter().map(NodeId::to_string).collect::<Vec<_>>().join(" ")
}

/// What becomes of one way.
fn change(wish: &Wish, location: &Location) -> Result<Change, String> {
    let by = wish.meters.unwrap_or(STEP_M);
    match wish.edit {
        Edit::Longer => Ok(Change::Longer(by)),
        Edit::Shorter => Ok(Change::Shorter(by)),
        Edit::Avoid => targets(wish, location).map(Change::Avoid),
        Edit::Start => targets(wish, location).map(Change::Start),
        Edit::End => targets(wish, location).map(Change::End),
        Edit::Reverse
        | Edit::Move
        | Edit::Remove
        | Edit::Slower
        | Edit::Faster
        | Edit::NoGestures
        | Edit::Ungroup
        | Edit::Group
        | Edit::Swap
        | Edit::Gesture
        | Edit::Story => Err("it is no change of one way".to_owned()),
    }
}

/// Nodes that the wish names, by id or by class of place.
fn targets(wish: &Wish, location: &Location) -> Result<Vec<NodeId>, String> {
    let graph = &location.graph;
    let known = |name: &str| graph.nodes().iter().find(|node| node.id.as_str() == name);
    let named: Vec<NodeId> = wish.names().filter_map(known).map(|node| node.id.clone()).collect();
    if !named.is_empty() {
        return Ok(named);
    }
    let Some(class) = wish.place else { return Err("it does not say where".to_owned()) };
    // `at the kitchen` is the kitchen, not any room.
    if let Some(meant) = spot::named_in(location, &wish.quote, class) {
        if meant.nodes.is_empty() {
            let has = place::listed(location);
            return Err(format!("the map has no place called `{}`; it has: {has}", meant.name));
        }
        return Ok(meant.nodes);
    }
    let all = graph.nodes().iter().map(|node| &node.id);
    let found: Vec<NodeId> = all.filter(|id| graph.node_is(id, class)).cloned().collect();
    if found.is_empty() {
        return Err(format!("the map has no {}; it has: {}", place::words(class), place::listed(location)));
    }
    // A class that is a node's own type before one that only an edge gives it.
    let own: Vec<NodeId> = found.iter().filter(|id| graph.kind(id) == Some(class)).cloned().collect();
    Ok(if own.is_empty() { found } else { own })
}

/// Everybody who goes the robot's way, or against it, turns with it.
fn reverse(desk: &mut Desk, wish: &Wish, paths: &Paths) {
    let mut new = paths.clone();
    new.robot.reverse();
    let mut turned = Vec::new();
    for human in &desk.draft.proposal.humans {
        let along =
            matches!(human.relation, Relation::Frontal | Relation::Behind | Relation::Ahead | Relation::Abreast);
        if let Some(nodes) = new.humans.get_mut(&human.id).filter(|nodes| along && nodes.len() > 1) {
            nodes.reverse();
            turned.push(human.id.to_string());
        }
    }
    let inside = |node: Option<&NodeId>| node.is_some_and(|node| place::is_inside(&desk.question.location, node));
    if inside(paths.robot.last()) != inside(paths.robot.first()) {
        return desk.refuse(&wish.quote, "would turn the way into a room or an elevator into one out of it");
    }
    socrates_solver::edit::sort(&mut new);
    let robot = &mut desk.draft.proposal.robot;
    std::mem::swap(&mut robot.start, &mut robot.goal);
    let with = if turned.is_empty() { String::new() } else { format!(", and with it {}", turned.join(" and ")) };
    desk.done.push(format!("the robot goes its way the other way round{with}"));
    desk.draft.paths = Some(new);
}

/// The meeting somewhere else: all ways are laid anew.
fn moved(desk: &mut Desk, wish: &Wish, paths: &Paths) {
    let location = desk.question.location.clone();
    let class = wish.place.unwrap_or(desk.draft.proposal.place);
    if !place::has(&location, class) {
        return desk.no_place(&wish.quote, &format!("asks for {}, which the map does not have", place::an(class)));
    }
    let node = |paths: &Paths| paths.encounters.first().map(|encounter| encounter.node.clone());
    let before = node(paths);
    let mut named: Vec<NodeId> = location
        .graph
        .nodes()
        .iter()
        .filter(|node| wish.names().any(|name| name == node.id.as_str()))
        .map(|node| node.id.clone())
        .collect();
    if let Some(meant) = spot::named_in(&location, &wish.quote, class).filter(|_| named.is_empty()) {
        if meant.nodes.is_empty() {
            return desk.no_place(&wish.quote, &format!("asks for `{}`, which the map does not have", meant.name));
        }
        // Nobody walks on beyond a dead end: they meet before it.
        named = spot::nodes(&location, &wish.quote, class, &desk.draft.proposal.humans);
    }
    let same = class == desk.draft.proposal.place && named.is_empty();
    if same && !wish.other && wish.place.is_some() {
        return desk.refuse(&wish.quote, "is so already; say `the other …` for another place of this kind");
    }
    let proposal = socrates_model::Proposal { place: class, ..desk.draft.proposal.clone() };
    let far = |other: &NodeId| {
        let at = |node: &NodeId| location.graph.node(node).map(|node| node.at);
        before.as_ref().and_then(at).zip(at(other)).map_or(0.0, |(a, b)| (a - b).norm())
    };
    let mut best: Option<(f64, Paths)> = None;
    for moves in 0..TRIES {
        // Every refusal moves the solver on to its next meeting node.
        let feedback = vec![Fault::new(FaultCode::GMeet, "edit", ""); moves];
        let ask = Question { feedback, ..desk.question.clone() };
        let Ok(found) = solve::solve(&ask, &proposal) else { break };
        let Some(there) = node(&found).filter(|there| Some(there) != before.as_ref()) else { continue };
        let fits = if named.is_empty() { location.graph.node_is(&there, class) } else { named.contains(&there) };
        // Another corridor is not the next node of the same one.
        let score = if wish.other { far(&there).min(8.0) } else { 0.0 };
        if fits && best.as_ref().is_none_or(|(top, _)| score > *top + 1e-9) {
            best = Some((score, found));
        }
    }
    let Some((_, found)) = best else {
        return desk.refuse(&wish.quote, "finds no other place of the meeting that has room for all ways");
    };
    let there = node(&found).map_or_else(String::new, |node| node.to_string());
    desk.done.push(format!("they meet at {} (`{there}`); all ways are new", place::an(class)));
    if class != desk.draft.proposal.place {
        desk.draft.proposal.place = class;
        for clause in &mut desk.draft.proposal.expected_events {
            if let socrates_model::Predicate::EncounterAt { place: old, nodes, human: None } = &mut clause.predicate {
                *old = class;
                nodes.clear();
                clause.text = format!("it happens at {}", place::an(class));
            }
        }
        for who in 0..desk.draft.proposal.humans.len() {
            desk.touch(who);
        }
    }
    desk.draft.paths = Some(found);
}

/// A way for somebody new.
pub(crate) fn join(desk: &mut Desk, who: usize, at: Option<PlaceClass>) -> bool {
    let proposal = &desk.draft.proposal;
    let (Some(human), Some(paths)) = (proposal.humans.get(who), &desk.draft.paths) else { return false };
    let ends = card(&proposal.pattern).map_or(Ends::Past, |card| card.ends);
    let Some(new) = joined(&desk.question.location, proposal, paths, (human, at), ends) else { return false };
    desk.draft.paths = Some(new);
    true
}

/// Another way for somebody who stands to the robot's way otherwise than before.
pub(crate) fn anew(desk: &mut Desk, who: usize) -> bool {
    join(desk, who, None)
}

/// Members of a group go the way of the first of them.
pub(crate) fn together(desk: &mut Desk, members: &[usize]) {
    let ids: Vec<HumanId> =
        members.iter().filter_map(|i| desk.draft.proposal.humans.get(*i)).map(|human| human.id).collect();
    let Some(paths) = &mut desk.draft.paths else { return };
    let Some(first) = ids.first().and_then(|id| paths.humans.get(id)).cloned() else { return };
    let met: Vec<NodeId> = ids.first().map(|id| paths.encounters_of(*id).cloned().collect()).unwrap_or_default();
    for id in ids.iter().skip(1) {
        paths.humans.insert(*id, first.clone());
        if met.is_empty() || paths.encounter_of(*id).is_none() {
            continue;
        }
        paths.encounters.retain(|encounter| encounter.human != *id);
        paths.encounters.extend(met.iter().map(|node| Encounter { human: *id, node: node.clone() }));
    }
    socrates_solver::edit::sort(paths);
}
