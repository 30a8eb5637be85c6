//! `EndStep`: the end of a step of this human's sequence, once and for all.

use crate::nodes::{halt_children, memory, remembered};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `EndStep`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "EndStep",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::Native,
    arity: Arity::ONE,
    ports: &[PortSheet::OWN, PortSheet::must("step", PortKind::Count(1), "number of the step that ends")],
    about: "fails until its child first succeeds: then the step has ended, which HasStepEnded tells everybody, and it succeeds for good",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

/// Word 0 is the memory: see [`remembered`].
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    if remembered(t.word(node, 0)) == Some(Status::Success) {
        return Status::Success;
    }
    t.set(node, Status::Running);
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.set_word(node, 0, memory(outcome));
        t.reset_child(node, 0);
    }
    if outcome == Status::Success
        && let Some(step) = t.ports(node).whole(1).and_then(|step| u32::try_from(step).ok())
    {
        t.world.end_step(step);
    }
    outcome
}
