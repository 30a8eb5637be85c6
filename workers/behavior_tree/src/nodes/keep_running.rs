//! `KeepRunningUntilFailure`: never succeeds.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `KeepRunningUntilFailure`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "KeepRunningUntilFailure",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[],
    about: "ticks its child again and again until it fails",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    match t.tick_child(node, 0) {
        Status::Failure => {
            t.reset_child(node, 0);
            Status::Failure
        }
        Status::Success => {
            t.reset_child(node, 0);
            Status::Running
        }
        Status::Skipped => Status::Skipped,
        Status::Running | Status::Idle => Status::Running,
    }
}
