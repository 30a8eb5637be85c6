//! What the author probably meant: nearest names by edit distance.

use socrates_model::{NodeId, SceneGraph};

/// The `count` node ids of the graph that are spelled most like `wrong`, nearest first.
pub(crate) fn nodes_like(graph: &SceneGraph, wrong: &NodeId, count: usize) -> Vec<NodeId> {
    let spelled = wrong.as_str().to_lowercase();
    let mut ranked: Vec<(usize, &NodeId)> = graph
        .nodes()
        .iter()
        .map(|node| (strsim::damerau_levenshtein(&spelled, &node.id.as_str().to_lowercase()), &node.id))
        .collect();
    ranked.sort();
    ranked.into_iter().take(count).map(|(_, id)| id.clone()).collect()
}
