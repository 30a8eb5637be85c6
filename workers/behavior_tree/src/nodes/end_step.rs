//! `EndStep`: the end of a step of this human's sequence, once and for all.

use crate::nodes::{halt_children, latch, remembered};
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

/// Remembers as a [`latch`] does; the step ends in the tick in which its child first succeeds.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let has_ended = remembered(t.word(node, 0)) == Some(Status::Success);
    let outcome = latch::tick(t, node);
    if outcome == Status::Success
        && !has_ended
        && let Some(step) = t.ports(node).whole(1).and_then(|step| u32::try_from(step).ok())
    {
        t.world.end_step(step);
    }
    outcome
}
