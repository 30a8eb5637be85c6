//! What is inside a room or a car, and behind which door: everything that the solver asks about openings.

use socrates_maps::openings::Enclosures;
use socrates_model::{Location, NodeId, PlaceClass};

use crate::graph::Net;

/// Nodes inside rooms or cars: of cars where an elevator is wanted, of rooms otherwise; in the order of the graph.
#[must_use]
pub fn inside(location: &Location, class: Option<PlaceClass>) -> Vec<NodeId> {
    let (car, all) = (class == Some(PlaceClass::Elevator), Enclosures::of(location));
    let ids = location.graph.nodes().iter().map(|node| &node.id);
    ids.filter(|id| all.is_inside(id) && all.is_car(id) == car).cloned().collect()
}

/// Whether two nodes lie in one room or car.
pub(crate) fn same_door(net: &Net<'_>, a: usize, b: Option<usize>) -> bool {
    let both = net.id(a).zip(b.and_then(|b| net.id(b)));
    both.is_some_and(|(a, b)| net.enclosures.same(a, b))
}

/// The nodes inside by index.
pub(crate) fn nodes(net: &Net<'_>, class: Option<PlaceClass>) -> Vec<usize> {
    inside(net.location, class).iter().filter_map(|id| net.index(id)).collect()
}

/// The class as prose says it.
#[must_use]
pub fn words(class: PlaceClass) -> String {
    if class == PlaceClass::Plain { "passage".to_owned() } else { class.name().replace('_', " ") }
}

/// The same with its article.
#[must_use]
pub fn an(class: PlaceClass) -> String {
    let name = words(class);
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {name}")
}
