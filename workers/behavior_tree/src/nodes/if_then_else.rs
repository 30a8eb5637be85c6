//! `IfThenElse`: a condition, then one of two branches.

use crate::nodes::halt_placed;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `IfThenElse`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "IfThenElse",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity { least: 2, most: 3 },
    ports: &[],
    about: "the first child decides once whether the second or the third runs",
    role: Role::Flow,
    tick,
    halt: halt_placed,
};

/// The condition is not asked again while a branch runs.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    if t.place(node) == 0 {
        match t.tick_child(node, 0) {
            Status::Success => t.set_place(node, 1),
            Status::Failure if t.children(node) == 3 => t.set_place(node, 2),
            Status::Failure => return Status::Failure,
            outcome @ (Status::Running | Status::Skipped | Status::Idle) => return outcome,
        }
    }
    let place = t.place(node);
    let outcome = t.tick_child(node, place);
    if outcome != Status::Running {
        t.reset_children(node);
        t.set_place(node, 0);
    }
    outcome
}
