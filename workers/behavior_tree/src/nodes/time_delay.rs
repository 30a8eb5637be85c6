//! `TimeDelay` (HuNavSim 2.0): keeps its child waiting.

use crate::nodes::{halt_counting, time_expired};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `TimeDelay`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "TimeDelay",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::HunavSim2,
    arity: Arity::ONE,
    ports: &[PortSheet::may("delay", PortKind::Span, "1.0", "seconds from its first tick on")],
    about: "fails until so many seconds have passed since its first tick; then it is its child",
    role: Role::Flow,
    tick,
    halt: halt_counting,
};

/// The library measures from the first tick by the wall clock; here by simulated time. Word 0 says whether
/// the delay has begun, word 1 when.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let delay = time_expired::nanos(t.ports(node).real(0).unwrap_or(0.0));
    let now = t.world.now().nanos();
    if t.word(node, 0) == 0 {
        t.set_word(node, 0, 1);
        t.set_word(node, 1, now);
    }
    if now.saturating_sub(t.word(node, 1)) < delay {
        return Status::Failure;
    }
    t.set(node, Status::Running);
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.set_word(node, 0, 0);
        t.reset_child(node, 0);
    }
    outcome
}
