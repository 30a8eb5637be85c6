//! Leaves that only the world can tick.

use crate::status::Status;
use crate::tick::Ticker;

/// Comes here only where [`World::leaf`](crate::World::leaf) gave no answer to a leaf that has no other meaning:
/// it fails, and the state says so (see [`TreeState::unanswered`](crate::TreeState::unanswered)).
pub(super) fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let leaf = t.leaf(node);
    t.state.unanswered.get_or_insert(leaf);
    Status::Failure
}
