//! Leaves that the catalog does not know: ticked through [`World::foreign`](crate::World).

use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// A foreign action; may run over many ticks.
pub(crate) const FOREIGN_ACTION: NodeSheet = NodeSheet {
    tag: "(foreign action)",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[],
    about: "a leaf of another library, ticked by the caller",
    role: Role::Foreign,
    tick,
    halt,
};
/// A foreign condition.
pub(crate) const FOREIGN_CONDITION: NodeSheet = NodeSheet {
    tag: "(foreign condition)",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[],
    about: "a condition of another library, asked through the caller",
    role: Role::Foreign,
    tick,
    halt,
};

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let leaf = t.leaf(node);
    t.world.foreign(leaf)
}

fn halt(t: &mut Ticker<'_>, node: usize) {
    let leaf = t.leaf(node);
    t.world.foreign_halted(leaf);
}
