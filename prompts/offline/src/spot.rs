//! Which place of a class is meant, where the text names it: `the kitchen`, `in front of the meeting room`, `the doorway`.

use std::collections::BTreeMap;
use std::ops::Range;

use socrates_model::{FactKind, HumanId, HumanProposal, Location, NodeId, PlaceClass, Reading, Relation};

use socrates_prompts::Question;
use socrates_reader::Reader;

use crate::task::{self, End};
use crate::{named, place};

/// A place by its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Meant {
    /// As the text says it.
    pub(crate) name: String,
    /// The nodes of that name; none where the map knows no such place.
    pub(crate) nodes: Vec<NodeId>,
}

/// The place of the class that a quote names; `None` where any place of the class is meant.
pub(crate) fn named_in(location: &Location, quote: &str, class: PlaceClass) -> Option<Meant> {
    // Cars and their lobbies are told apart by who uses them.
    if matches!(class, PlaceClass::Elevator | PlaceClass::ElevatorLobby | PlaceClass::Plain) {
        return None;
    }
    let all = Reader::shipped().places(quote);
    if class == PlaceClass::Doorway {
        return doorways(location, quote, &all);
    }
    let said = |at: &Range<usize>| quote.get(at.clone()).unwrap_or_default().to_owned();
    let mut unknown = None;
    for place in all.iter().filter(|place| place.class == class) {
        let (own, whole) = (said(&place.own), said(&place.whole));
        if named::telling(&own).is_empty() && named::find(location, &whole).is_none() {
            continue;
        }
        let Some(known) = named::find(location, &whole) else {
            unknown.get_or_insert(Meant { name: own, nodes: Vec::new() });
            continue;
        };
        let outside = class == PlaceClass::Room && place.outside;
        let nodes = if outside { before_doors(location, &known.nodes) } else { known.nodes };
        return Some(Meant { name: own, nodes });
    }
    unknown
}

fn is_door(location: &Location, id: &NodeId) -> bool {
    location.graph.kind(id) == Some(PlaceClass::Doorway)
}

/// The nodes right outside the doors of these.
pub(crate) fn before_doors(location: &Location, rooms: &[NodeId]) -> Vec<NodeId> {
    let graph = &location.graph;
    let mut from: Vec<&NodeId> =
        rooms.iter().flat_map(|room| graph.neighbors(room)).filter(|id| is_door(location, id)).collect();
    if from.is_empty() {
        from = rooms.iter().collect();
    }
    let mut found: Vec<NodeId> = Vec::new();
    for node in from.into_iter().flat_map(|id| graph.neighbors(id)) {
        if !place::is_inside(location, node) && !is_door(location, node) && !found.contains(node) {
            found.push(node.clone());
        }
    }
    found
}

/// A node that only has a way through a door is no doorway: those are that the map calls so, and of them those of a room by name.
fn doorways(location: &Location, quote: &str, places: &[socrates_reader::Named]) -> Option<Meant> {
    let graph = &location.graph;
    let mut nodes: Vec<NodeId> =
        graph.nodes().iter().map(|node| node.id.clone()).filter(|id| is_door(location, id)).collect();
    let said = |at: &Range<usize>| quote.get(at.clone()).unwrap_or_default();
    // `the doorway of the ward` is one place, and `the ward` another one in it.
    let rooms = places.iter().flat_map(|place| [&place.own, &place.whole]);
    let of = rooms.filter_map(|at| named::find(location, said(at))).find(|found| found.class == PlaceClass::Room);
    let own = |id: &NodeId| of.as_ref().is_none_or(|of| graph.neighbors(id).iter().any(|next| of.nodes.contains(next)));
    let narrow = |id: &NodeId| graph.node(id).is_some_and(|node| node.kind.to_lowercase().contains("narrow"));
    if nodes.iter().any(own) {
        nodes.retain(own);
    }
    if quote.to_lowercase().contains("narrow") && nodes.iter().any(narrow) {
        nodes.retain(narrow);
    }
    (!nodes.is_empty()).then(|| Meant { name: "doorway".to_owned(), nodes })
}

/// The nodes that count for a place of the text, in a clause; none where every node of the class does.
pub(crate) fn nodes(location: &Location, quote: &str, class: PlaceClass, humans: &[HumanProposal]) -> Vec<NodeId> {
    let meant = named_in(location, quote, class).map(|meant| meant.nodes).unwrap_or_default();
    counted(location, meant, class, humans)
}

/// The nodes that count for a place: the meant ones, and where people cannot meet there those right before it; none where every node
/// of the class does.
pub(crate) fn counted(
    location: &Location,
    meant: Vec<NodeId>,
    class: PlaceClass,
    humans: &[HumanProposal],
) -> Vec<NodeId> {
    let relation = |wanted: &[Relation]| humans.iter().any(|human| wanted.contains(&human.relation));
    // Somebody who comes out of a room or car is met before it.
    if matches!(class, PlaceClass::Room | PlaceClass::Doorway) && relation(&[Relation::Leaving, Relation::Staying]) {
        return Vec::new();
    }
    let graph = &location.graph;
    let walks = relation(&[
        Relation::Frontal,
        Relation::Crossing,
        Relation::Behind,
        Relation::Ahead,
        Relation::Abreast,
        Relation::Leaving,
    ]);
    let all = if meant.is_empty() { socrates_maps::place::nodes_of(location, class) } else { meant.clone() };
    // Nobody walks on beyond a dead end, and nobody crosses in a doorway: they meet right before it.
    let dead = all.iter().all(|id| graph.degree(id) < 2) && walks;
    let crossed = class == PlaceClass::Doorway && relation(&[Relation::Crossing]);
    if !dead && !crossed {
        return meant;
    }
    let mut found = all.clone();
    let beside = |id: &NodeId| {
        let next = graph.neighbors(id);
        let through = next.iter().filter(|id| is_door(location, id)).flat_map(|door| graph.neighbors(door));
        next.iter().chain(through).collect::<Vec<_>>()
    };
    for node in all.iter().flat_map(beside) {
        if !found.contains(node) {
            found.push(node.clone());
        }
    }
    found
}

/// Where the robot's way begins or ends, where the story says so by name.
fn robot_end(location: &Location, reading: &Reading, goal: bool) -> Vec<NodeId> {
    let wanted = |kind: &FactKind| {
        if let FactKind::RobotGoal(class) = kind {
            Some(*class).filter(|_| goal)
        } else if let FactKind::RobotStart(class) = kind {
            Some(*class).filter(|_| !goal)
        } else {
            None
        }
    };
    let said = reading.facts.iter().filter_map(|fact| wanted(&fact.kind).map(|class| (class, fact.quote.as_str())));
    said.filter_map(|(class, quote)| named_in(location, quote, class))
        .next()
        .map(|meant| meant.nodes)
        .unwrap_or_default()
}

/// The places where the way begins or ends by name: those of the scenario, or those of the task unless the scenario has it
/// begin or end elsewhere.
pub(crate) fn ends(question: &Question, named: &[End], class: Option<PlaceClass>, goal: bool) -> Vec<NodeId> {
    let said = robot_end(&question.location, &question.reading, goal);
    let nodes = if said.is_empty() { task::nodes(named).to_vec() } else { said };
    let suits = |class: PlaceClass| nodes.iter().any(|node| question.location.graph.node_is(node, class));
    if class.is_none_or(suits) { nodes } else { Vec::new() }
}

/// Words before the name of a room that somebody comes out of.
const OUT_OF: &[&str] = &["out of ", "leave ", "leaves ", "exit ", "exits ", "from ", "leaving ", "exiting "];

/// The rooms that people come out of, where the text names them: `out of the kitchen`.
pub(crate) fn rooms(question: &Question) -> BTreeMap<HumanId, Vec<NodeId>> {
    let mut found = BTreeMap::new();
    for fact in &question.reading.facts {
        let FactKind::Relates { human, relation: Relation::Leaving | Relation::Staying | Relation::Crossing } =
            fact.kind
        else {
            continue;
        };
        let Some((_, from)) = OUT_OF.iter().find_map(|word| fact.quote.split_once(word)) else { continue };
        let words: Vec<&str> = from.split_whitespace().take(5).collect();
        let name = words.join(" ");
        let name = name.split([',', ';', '.']).next().unwrap_or_default();
        if let Some(room) = named::find(&question.location, name) {
            found.insert(human, room.nodes);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::map;

    fn ids(on: &str, quote: &str, class: PlaceClass) -> Option<Vec<String>> {
        let meant = named_in(&map(on), quote, class)?;
        Some(meant.nodes.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn a_place_is_the_one_that_the_map_calls_so() {
        for (on, quote, class, wanted) in [
            ("hospital", "Two patients stand in the waiting area", PlaceClass::OpenArea, &["wa1", "wa2"][..]),
            ("hospital", "A nurse stands at the nurse station", PlaceClass::OpenArea, &["ns"]),
            ("hospital", "A nurse stops at ward 2", PlaceClass::Room, &["p2"]),
            ("office", "Four people queue in front of the counter in the kitchen", PlaceClass::Room, &["kt"]),
            ("office", "They queue in front of the meeting room door", PlaceClass::Room, &["ib", "h3"]),
            ("office", "A woman and the robot meet at the narrow doorway", PlaceClass::Doorway, &["nd"]),
            ("hospital", "They stand in the doorway of the ward", PlaceClass::Doorway, &["d1", "d2"]),
            ("warehouse", "A worker waits at the loading dock", PlaceClass::Exit, &["kx"]),
            ("hospital", "Two people talk in the cafeteria", PlaceClass::Room, &[]),
        ] {
            let found = ids(on, quote, class).unwrap_or_else(|| panic!("{quote}"));
            assert_eq!(found, wanted, "{quote}");
        }
        for (on, quote, class) in [
            ("hospital", "A nurse waits in the busy corridor", PlaceClass::Corridor),
            ("office", "They talk in a room", PlaceClass::Room),
            ("office", "A guard stops the robot at the exit", PlaceClass::Exit),
        ] {
            assert_eq!(ids(on, quote, class), None, "{quote}");
        }
    }
}
