//! `IfThenElse`: a condition, then one of two branches.

use crate::nodes::halt_counting;
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
    halt: halt_counting,
};

/// The condition is not asked again while a branch runs.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    if t.cell(node).index == 0 {
        match t.tick_child(node, 0) {
            Status::Success => t.cell(node).index = 1,
            Status::Failure if t.children(node) == 3 => t.cell(node).index = 2,
            Status::Failure => return Status::Failure,
            outcome @ (Status::Running | Status::Skipped | Status::Idle) => return outcome,
        }
    }
    let place = t.cell(node).index;
    let outcome = t.tick_child(node, place);
    if outcome != Status::Running {
        t.reset_children(node);
        t.cell(node).index = 0;
    }
    outcome
}
