//! `WhileDoElse`: a condition asked in every tick, and a branch for each answer.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `WhileDoElse`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "WhileDoElse",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity { least: 2, most: 3 },
    ports: &[],
    about: "the first child decides in every tick whether the second or the third runs",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    let (chosen, other) = match t.tick_child(node, 0) {
        Status::Success => (1, 2),
        Status::Failure => (2, 1),
        outcome @ (Status::Running | Status::Skipped | Status::Idle) => return outcome,
    };
    let outcome = if chosen < t.children(node) {
        t.reset_child(node, other);
        t.tick_child(node, chosen)
    } else {
        Status::Failure
    };
    if outcome != Status::Running {
        t.reset_children(node);
    }
    outcome
}
