//! `Inverter`: the opposite outcome.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Inverter`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "Inverter",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[],
    about: "NOT: succeeds where its child fails and the other way round",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    let outcome = t.tick_child(node, 0);
    match outcome {
        Status::Success | Status::Failure => {
            t.reset_child(node, 0);
            Status::of(outcome == Status::Failure)
        }
        Status::Running | Status::Skipped | Status::Idle => outcome,
    }
}
