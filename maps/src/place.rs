//! Which nodes of a location belong to a place class.

use socrates_model::{Location, NodeId, PlaceClass};

/// Nodes of a class, the most telling first, each once.
///
/// Nodes whose own type says so come first, then nodes that are of the class by their degree or by a
/// way that meets them; file order within each.
#[must_use]
pub fn nodes_of(location: &Location, class: PlaceClass) -> Vec<NodeId> {
    let graph = &location.graph;
    let by_type = graph.nodes.iter().filter(|node| PlaceClass::of_type(&node.kind) == class);
    let by_ways =
        graph.nodes.iter().filter(|node| PlaceClass::of_type(&node.kind) != class && graph.node_is(&node.id, class));
    by_type.chain(by_ways).map(|node| node.id.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped;

    #[test]
    fn a_node_whose_type_says_so_comes_before_one_that_is_so_by_its_ways() {
        let office = shipped::load("office").unwrap();
        let found = nodes_of(&office, PlaceClass::Intersection);
        let typed = |id: &NodeId| PlaceClass::of_type(&office.graph.node(id).unwrap().kind) == PlaceClass::Intersection;
        let first_by_ways = found.iter().position(|id| !typed(id)).unwrap_or(found.len());
        assert!(first_by_ways >= 4, "{found:?}");
        assert!(found.iter().skip(first_by_ways).all(|id| !typed(id)));
    }
}
