//! `SubTree` and `SubTreePlus` (v3): another tree of the document, with a blackboard of its own.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `SubTree`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "SubTree",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[PortSheet::must("ID", PortKind::Text, "the tree")],
    about: "runs another tree; other attributes hand over blackboard entries",
    role: Role::Flow,
    tick,
    halt: halt_children,
};
/// `SubTreePlus`.
pub(super) const PLUS: NodeSheet = NodeSheet {
    tag: "SubTreePlus",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[PortSheet::must("ID", PortKind::Text, "the tree")],
    about: "runs another tree (v3); braces hand over an entry, other text is a constant",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

/// The only child is the root of the other tree.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    if t.status(node) == Status::Idle {
        t.set(node, Status::Running);
    }
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.reset_child(node, 0);
    }
    outcome
}
