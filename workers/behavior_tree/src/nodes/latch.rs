//! `Latch`: once true, true for ever. A rule that goes on when its trigger has passed needs it.
//!
//! Latches of one tree over the same conditions remember together: `when the robot says EXCUSE_ME it looks for 4 s and then
//! gives way` is two rules that wait for one gesture, which is over when the first has run.

use crate::nodes::{halt_children, memory, remembered};
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Latch`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "Latch",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::Native,
    arity: Arity::ONE,
    ports: &[],
    about: "fails until its child first succeeds; from then on succeeds without asking again, as do others over the same child",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

/// Word 0 is the memory: see [`remembered`].
pub(super) fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    if remembered(t.word(node, 0)) == Some(Status::Success) {
        return Status::Success;
    }
    t.set(node, Status::Running);
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.set_word(node, 0, memory(outcome));
        t.reset_child(node, 0);
    }
    outcome
}
