//! `ForceSuccess` and `ForceFailure`: an outcome whatever the child says.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `ForceSuccess`.
pub(super) const SUCCESS: NodeSheet = NodeSheet {
    tag: "ForceSuccess",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[],
    about: "succeeds as soon as its child has finished",
    role: Role::Flow,
    tick: tick_success,
    halt: halt_children,
};
/// `ForceFailure`.
pub(super) const FAILURE: NodeSheet = NodeSheet {
    tag: "ForceFailure",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[],
    about: "fails as soon as its child has finished",
    role: Role::Flow,
    tick: tick_failure,
    halt: halt_children,
};

fn tick_success(t: &mut Ticker<'_>, node: usize) -> Status {
    force(t, node, Status::Success)
}

fn tick_failure(t: &mut Ticker<'_>, node: usize) -> Status {
    force(t, node, Status::Failure)
}

fn force(t: &mut Ticker<'_>, node: usize, forced: Status) -> Status {
    t.set(node, Status::Running);
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.reset_child(node, 0);
        forced
    } else {
        outcome
    }
}
