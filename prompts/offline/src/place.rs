//! What places the map has.

use socrates_maps::openings::Enclosures;
use socrates_model::{DoorKind, Location, NodeId, PlaceClass};
pub(crate) use socrates_solver::inside::{an, inside, words};

/// Whether the map has a place of the class; everything is plain.
pub(crate) fn has(location: &Location, class: PlaceClass) -> bool {
    class == PlaceClass::Plain || location.graph.nodes().iter().any(|node| location.graph.node_is(&node.id, class))
}

/// The classes that the map has, in words, for messages.
pub(crate) fn listed(location: &Location) -> String {
    let there: Vec<String> = PlaceClass::ALL
        .iter()
        .filter(|class| **class != PlaceClass::Plain && has(location, **class))
        .map(|class| words(*class))
        .collect();
    there.join(", ")
}

/// `corridor, exit or open area`, without articles.
pub(crate) fn either(classes: &[PlaceClass]) -> String {
    let mut names: Vec<String> = classes.iter().map(|class| words(*class)).collect();
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last } else { format!("{} or {last}", names.join(", ")) }
}

/// Whether the node is in a room or an elevator.
pub(crate) fn is_inside(location: &Location, node: &NodeId) -> bool {
    Enclosures::of(location).is_inside(node)
}

/// The first place that is inside by its name alone, and why it is not: `; not inside: …`. Empty where there is none.
pub(crate) fn open_plan(location: &Location) -> String {
    let all = Enclosures::of(location);
    let first = all.open_plan().iter().find_map(|(nodes, why)| Some((location.graph.node(nodes.first()?)?, why)));
    first.map_or_else(String::new, |(node, why)| {
        format!("; not inside: `{}` at ({:.2}, {:.2}), because {why}", node.id, node.at.x, node.at.y)
    })
}

/// The most places that one room has.
pub(crate) fn most_places(location: &Location) -> usize {
    let all = Enclosures::of(location);
    all.all().iter().filter(|place| place.kind == DoorKind::Room).map(|place| place.nodes.len()).max().unwrap_or(0)
}

/// Cosine of the turn up to which a way leads straight on.
const STRAIGHT: f64 = 0.7;

/// The most ways that meet in a node outside; for somebody who comes out of a place, right outside its door, where a way leads straight
/// on over them.
pub(crate) fn most_arms(location: &Location, from: Option<PlaceClass>) -> usize {
    let graph = &location.graph;
    let arms = |id: &NodeId| graph.neighbors(id).len();
    let doorway = |id: &NodeId| graph.kind(id) == Some(PlaceClass::Doorway);
    let all = Enclosures::of(location);
    let outside = |id: &NodeId| !all.is_inside(id) && !doorway(id);
    let Some(class) = from else {
        return graph.nodes().iter().filter(|node| outside(&node.id)).map(|node| arms(&node.id)).max().unwrap_or(0);
    };
    // Where no way out leads straight on, the robot turns into one of the others: so many are left to cross it.
    let at = |id: &NodeId| graph.node(id).map(|node| node.at);
    let straight_on = |from: &NodeId, over: &NodeId| {
        let (Some(a), Some(b)) = (at(from), at(over)) else { return false };
        let on = |id: &&NodeId| at(id).is_some_and(|c| (b - a).normalize().dot(&(c - b).normalize()) > STRAIGHT);
        graph.neighbors(over).iter().filter(|id| *id != from && outside(id)).any(|id| on(&id))
    };
    let crossed =
        |(from, over): (&NodeId, &NodeId)| if straight_on(from, over) { arms(over) } else { arms(over).min(3) };
    let starts = inside(location, Some(class));
    let beyond = starts.iter().flat_map(|start| {
        let next = graph.neighbors(start);
        let behind = next.iter().filter(|id| doorway(id));
        let behind = behind.flat_map(|door| graph.neighbors(door).iter().map(move |id| (door, id)));
        let all = next.iter().map(|id| (start, id)).chain(behind);
        all.filter(|(_, over)| outside(over)).map(crossed).collect::<Vec<usize>>()
    });
    beyond.max().unwrap_or(0)
}
