//! Which nodes of a location belong to a place class.

use socrates_model::{Location, NodeId, PlaceClass};

/// Nodes of a class, the most telling first, each once.
///
/// Nodes whose own type says so come first, then nodes that are of the class by their degree or by a
/// way that meets them; file order within each.
#[must_use]
pub fn nodes_of(location: &Location, class: PlaceClass) -> Vec<NodeId> {
    let graph = &location.graph;
    let all = || graph.nodes().iter().enumerate();
    let by_type = all().filter(|(at, _)| graph.kind_at(*at) == class);
    let by_ways = all().filter(|(at, _)| graph.kind_at(*at) != class && graph.is_at(*at, class));
    by_type.chain(by_ways).map(|(_, node)| node.id.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped;

    #[test]
    fn a_node_whose_type_says_so_comes_before_one_that_is_so_by_its_ways() {
        let office = shipped::load("office").unwrap();
        let found = nodes_of(&office, PlaceClass::Intersection);
        let typed = |id: &NodeId| office.graph.kind(id) == Some(PlaceClass::Intersection);
        let first_by_ways = found.iter().position(|id| !typed(id)).unwrap_or(found.len());
        assert!(first_by_ways >= 4, "{found:?}");
        assert!(found.iter().skip(first_by_ways).all(|id| !typed(id)));
    }
}
