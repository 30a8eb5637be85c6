//! `RunOnce`: one run, ever.

use crate::nodes::{halt_children, memory, remembered};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `RunOnce`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "RunOnce",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[PortSheet::may(
        "then_skip",
        PortKind::Flag,
        "true",
        "whether it is left out afterwards, or repeats its outcome",
    )],
    about: "runs its child to its end once; afterwards it is left out, or repeats the outcome",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

/// Being halted does not clear the memory of the run.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    if let Some(first) = remembered(t.word(node, 0)) {
        let skips = t.ports(node).flag(0).unwrap_or(true);
        return if skips { Status::Skipped } else { first };
    }
    t.set(node, Status::Running);
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.set_word(node, 0, memory(outcome));
        t.reset_child(node, 0);
    }
    outcome
}
