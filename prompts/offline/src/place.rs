//! What places the map has.

use socrates_maps::openings::Enclosures;
use socrates_model::{DoorKind, Location, NodeId, PlaceClass};

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

/// The class as prose says it.
pub(crate) fn words(class: PlaceClass) -> String {
    if class == PlaceClass::Plain { "passage".to_owned() } else { class.name().replace('_', " ") }
}

/// The class with its article.
pub(crate) fn an(class: PlaceClass) -> String {
    let name = words(class);
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {name}")
}

/// Whether the node is in a room or an elevator.
pub(crate) fn is_inside(location: &Location, node: &NodeId) -> bool {
    Enclosures::of(location).is_inside(node)
}

/// Nodes inside rooms or cars: of cars where an elevator is wanted, of rooms otherwise.
pub(crate) fn inside(location: &Location, class: Option<PlaceClass>) -> Vec<NodeId> {
    let (car, all) = (class == Some(PlaceClass::Elevator), Enclosures::of(location));
    let ids = location.graph.nodes().iter().map(|node| &node.id);
    ids.filter(|id| all.is_inside(id) && all.is_car(id) == car).cloned().collect()
}

/// Whether a room has places for the robot and for somebody else.
pub(crate) fn is_roomy(location: &Location) -> bool {
    Enclosures::of(location).all().iter().any(|place| place.kind == DoorKind::Room && place.nodes.len() > 1)
}

/// Whether so many ways meet somewhere outside; for somebody who comes out of a place, right outside its door.
pub(crate) fn meets_arms(location: &Location, from: Option<PlaceClass>, least: usize) -> bool {
    let graph = &location.graph;
    let arms = |id: &NodeId| graph.neighbors(id).len();
    let doorway = |id: &NodeId| graph.kind(id) == Some(PlaceClass::Doorway);
    let all = Enclosures::of(location);
    let outside = |id: &NodeId| !all.is_inside(id) && !doorway(id);
    let Some(class) = from else {
        return graph.nodes().iter().any(|node| outside(&node.id) && arms(&node.id) >= least);
    };
    inside(location, Some(class)).iter().any(|start| {
        let next = graph.neighbors(start);
        let beyond = next.iter().filter(|id| doorway(id)).flat_map(|id| graph.neighbors(id));
        next.iter().chain(beyond).any(|id| outside(id) && arms(id) >= least)
    })
}
