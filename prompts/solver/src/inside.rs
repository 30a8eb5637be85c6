//! What is inside a room or a car, and behind which door: everything that the solver asks about openings.

use socrates_model::{DoorKind, Location, NodeId, PlaceClass};

use crate::graph::Net;

/// Whether the node is in a room or an elevator: behind a door, or by its type.
#[must_use]
pub fn is_inside(location: &Location, node: &NodeId) -> bool {
    location.door_of(node).is_some()
        || matches!(location.graph.kind(node), Some(PlaceClass::Elevator | PlaceClass::Room))
}

/// Whether the node is in an elevator.
fn is_car(location: &Location, node: &NodeId) -> bool {
    let by_door = location.door_of(node).is_some_and(|door| door.kind == DoorKind::Elevator);
    by_door || location.graph.kind(node) == Some(PlaceClass::Elevator)
}

/// Nodes inside rooms or cars: of cars where an elevator is wanted, of rooms otherwise; in the order of the graph.
#[must_use]
pub fn inside(location: &Location, class: Option<PlaceClass>) -> Vec<NodeId> {
    let car = class == Some(PlaceClass::Elevator);
    let ids = location.graph.nodes().iter().map(|node| &node.id);
    ids.filter(|id| is_inside(location, id) && is_car(location, id) == car).cloned().collect()
}

/// Whether two nodes are behind the same door; without doors, whether they are the same or next to each other.
pub(crate) fn same_door(net: &Net<'_>, a: usize, b: Option<usize>) -> bool {
    let door = |node: usize| net.id(node).and_then(|id| net.location.door_of(id)).map(|door| door.id.as_str());
    let Some(b) = b else { return false };
    match (door(a), door(b)) {
        (Some(one), Some(other)) => one == other,
        (None, None) => a == b || net.near(a).iter().any(|(node, _)| *node == b),
        (Some(_), None) | (None, Some(_)) => false,
    }
}

/// The nodes inside by index.
pub(crate) fn nodes(net: &Net<'_>, class: Option<PlaceClass>) -> Vec<usize> {
    inside(net.location, class).iter().filter_map(|id| net.index(id)).collect()
}

/// The class with its article, as prose says it.
pub(crate) fn an(class: PlaceClass) -> String {
    let name = if class == PlaceClass::Plain { "passage".to_owned() } else { class.name().replace('_', " ") };
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {name}")
}
