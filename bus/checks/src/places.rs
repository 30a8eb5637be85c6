//! Places of the map by class.

use socrates_model::{NodeId, PlaceClass, SceneGraph};

/// Every node of the class, in file order.
pub(crate) fn nodes_of(graph: &SceneGraph, class: PlaceClass) -> Vec<NodeId> {
    graph
        .nodes()
        .iter()
        .enumerate()
        .filter(|(at, _)| graph.is_at(*at, class))
        .map(|(_, node)| node.id.clone())
        .collect()
}

/// The classes that the map has, in order, `plain` left out.
pub(crate) fn classes_of(graph: &SceneGraph) -> Vec<PlaceClass> {
    PlaceClass::ALL
        .into_iter()
        .filter(|class| *class != PlaceClass::Plain && (0..graph.nodes().len()).any(|at| graph.is_at(at, *class)))
        .collect()
}

/// Classes that a meeting counts for when the proposal says `wanted`.
///
/// Who meets at an elevator meets in the car, at its door or in front of it; who meets at a room meets
/// at its door too.
pub(crate) fn family(wanted: PlaceClass) -> &'static [PlaceClass] {
    use PlaceClass as C;
    match wanted {
        C::Elevator | C::ElevatorLobby => &[C::Elevator, C::ElevatorLobby, C::Doorway],
        C::Room => &[C::Room, C::Doorway],
        C::Doorway => &[C::Doorway, C::Elevator, C::ElevatorLobby, C::Room],
        C::Corridor => &[C::Corridor, C::NarrowPassage],
        C::NarrowPassage => &[C::NarrowPassage],
        C::Intersection => &[C::Intersection],
        C::BlindCorner => &[C::BlindCorner],
        C::OpenArea => &[C::OpenArea],
        C::Exit => &[C::Exit],
        C::Plain => &C::ALL,
    }
}
