//! Wrong paths.

use serde_json::{Value, json};
use socrates_model::{HumanId, NodeId, PlaceClass, Relation};
use socrates_prompts::Question;

use super::{list, pick, rename};
use crate::fault_model::FaultKind;

#[expect(clippy::wildcard_enum_match_arm, reason = "a kind of another stage has no place in this answer")]
pub(super) fn put(kind: FaultKind, answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    let meeting = answer.pointer("/encounters/0/node").and_then(Value::as_str).map(str::to_owned);
    match kind {
        FaultKind::Gdisc => gap(answer, question, draw)?,
        FaultKind::Gunknown => {
            let robot = list(answer, "robot")?;
            let last = robot.last_mut()?;
            *last = json!(format!("{}_x", last.as_str()?));
        }
        FaultKind::Gempty => list(answer, "robot")?.clear(),
        FaultKind::Gshort => {
            let meeting = meeting?;
            let robot = list(answer, "robot")?;
            let at = robot.iter().position(|node| node.as_str() == Some(&meeting))?;
            robot.truncate(at + 2);
            robot.drain(..at.checked_sub(1)?);
        }
        FaultKind::Gmeet => {
            let robot: Vec<Value> = answer["robot"].as_array()?.clone();
            let stray = answer["humans"]
                .as_object()?
                .values()
                .filter_map(Value::as_array)
                .flatten()
                .find(|node| !robot.contains(node))?
                .clone();
            *answer.get_mut("encounters")?.get_mut(0)?.get_mut("node")? = stray;
        }
        FaultKind::Gmeetend => ends_there(answer, question)?,
        FaultKind::Gagents => {
            let humans = answer.get_mut("humans")?.as_object_mut()?;
            let path = humans.values().next()?.clone();
            humans.insert("human_99".to_owned(), path);
        }
        FaultKind::Gcoll => start_where_the_robot_does(answer, question, draw)?,
        FaultKind::Gtype => elsewhere(answer, question)?,
        FaultKind::Grel => other_relation(answer, question, draw)?,
        FaultKind::Ggrp => apart(answer, question)?,
        FaultKind::Schema => rename(answer, "robot", "Robot")?,
        _ => return None,
    }
    Some(())
}

/// Takes a node out of the robot's path that is no encounter and whose neighbors are none of each other, so that the hole is
/// the only fault.
fn gap(answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    let met: Vec<Value> = answer["encounters"].as_array()?.iter().map(|encounter| encounter["node"].clone()).collect();
    let robot = list(answer, "robot")?;
    let node = |index: usize| robot.get(index).and_then(id);
    let joined = |index: usize| {
        let ends = index.checked_sub(1).and_then(node).zip(node(index + 1));
        ends.is_none_or(|(a, b)| a == b || question.location.graph.edge(&a, &b).is_some())
    };
    let inner: Vec<usize> = (1..robot.len().saturating_sub(1))
        .filter(|index| robot.get(*index).is_some_and(|node| !met.contains(node)) && !joined(*index))
        .collect();
    let index = *inner.get(pick(draw, inner.len())?)?;
    robot.remove(index);
    Some(())
}

/// The robot's path ends where it meets somebody who walks: only at a room, a car or a standing group may it end.
fn ends_there(answer: &mut Value, question: &Question) -> Option<()> {
    let graph = &question.location.graph;
    let indoors = |node: &NodeId| socrates_checks::is_inside(&question.location, node);
    let walkers: Vec<String> = answer["humans"]
        .as_object()?
        .iter()
        .filter(|(_, path)| path.as_array().is_some_and(|path| path.len() > 1))
        .map(|(name, _)| name.clone())
        .collect();
    let robot: Vec<NodeId> = answer["robot"].as_array()?.iter().filter_map(id).collect();
    let at = answer["encounters"].as_array()?.iter().find_map(|encounter| {
        let node = id(encounter.get("node")?)?;
        let walks = walkers.iter().any(|name| encounter["human"].as_str() == Some(name));
        let car = indoors(&node) || graph.neighbors(&node).iter().any(indoors);
        let at = robot.iter().position(|other| *other == node)?;
        (walks && !car && at + 1 < robot.len()).then_some(at)
    })?;
    list(answer, "robot")?.truncate(at + 1);
    Some(())
}

/// A human who may not walk with the robot starts at its start.
fn start_where_the_robot_does(answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    let start = id(answer["robot"].as_array()?.first()?)?;
    let proposal = question.proposal.as_ref()?;
    let walkers: Vec<HumanId> = proposal
        .humans
        .iter()
        .filter(|human| matches!(human.relation, Relation::Frontal | Relation::Crossing))
        .map(|human| human.id)
        .collect();
    let human = walkers.get(pick(draw, walkers.len())?)?;
    let path = answer.get_mut("humans")?.get_mut(human.to_string())?;
    let first = id(path.as_array()?.first()?)?;
    let way = question.location.graph.shortest(&start, &first)?;
    let rest = path.as_array()?.clone();
    *path = json!(way.iter().map(|node| json!(node)).chain(rest.into_iter().skip(1)).collect::<Vec<_>>());
    Some(())
}

/// Moves every encounter to a node of the robot's path that is not, and has beside it no, place of the proposal's class.
fn elsewhere(answer: &mut Value, question: &Question) -> Option<()> {
    let wanted = question.proposal.as_ref()?.place;
    let graph = &question.location.graph;
    let robot: Vec<NodeId> = answer["robot"].as_array()?.iter().filter_map(id).collect();
    // Some classes stand for others too: who meets at a room meets at its door. These stand for themselves.
    let own: &[PlaceClass] = match wanted {
        PlaceClass::Intersection | PlaceClass::BlindCorner | PlaceClass::OpenArea | PlaceClass::Exit => &[wanted],
        PlaceClass::Corridor | PlaceClass::NarrowPassage => &[PlaceClass::Corridor, PlaceClass::NarrowPassage],
        PlaceClass::Elevator
        | PlaceClass::ElevatorLobby
        | PlaceClass::Room
        | PlaceClass::Doorway
        | PlaceClass::Plain => return None,
    };
    let other = |node: &NodeId| !own.iter().any(|class| graph.node_is(node, *class));
    let free = robot.windows(3).find_map(|three| match three {
        [before, node, after] if [before, node, after].iter().all(|node| other(node)) => Some(node.clone()),
        _ => None,
    })?;
    for encounter in list(answer, "encounters")? {
        *encounter.get_mut("node")? = json!(free);
    }
    Some(())
}

/// A path that stands otherwise to the robot's than was proposed.
fn other_relation(answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    let proposal = question.proposal.as_ref()?;
    let robot: Vec<Value> = answer["robot"].as_array()?.clone();
    let chosen = proposal.humans.get(pick(draw, proposal.humans.len())?)?;
    let path = answer.get_mut("humans")?.get_mut(chosen.id.to_string())?;
    *path = match chosen.relation {
        // With the robot in place of towards or across it; a walk in place of standing.
        Relation::Frontal
        | Relation::Crossing
        | Relation::Static
        | Relation::Staying
        | Relation::Leaving
        | Relation::Aside => {
            json!(robot)
        }
        Relation::Behind | Relation::Ahead | Relation::Abreast => json!(robot.into_iter().rev().collect::<Vec<_>>()),
    };
    Some(())
}

/// A member of a group starts and ends somewhere else.
fn apart(answer: &mut Value, question: &Question) -> Option<()> {
    let group = question.proposal.as_ref()?.groups.first()?;
    let member = group.members.last()?.to_string();
    let graph = &question.location.graph;
    let humans = answer.get_mut("humans")?;
    let start = graph.node(&id(humans.get(&member)?.as_array()?.first()?)?)?.at;
    let far = |node: &socrates_model::GraphNode| (node.at.x - start.x).hypot(node.at.y - start.y);
    let furthest = graph.nodes().iter().max_by(|a, b| far(a).total_cmp(&far(b)))?;
    *humans.get_mut(&member)? = json!([furthest.id]);
    Some(())
}

fn id(value: &Value) -> Option<NodeId> {
    NodeId::new(value.as_str()?).ok()
}
