//! `Delay`, `Timeout` and `Sleep`: milliseconds of simulated time, counted from the tick a node starts in.

use crate::nodes::{halt_counting, halt_leaf};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Delay`.
pub(super) const DELAY: NodeSheet = NodeSheet {
    tag: "Delay",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[PortSheet::must("delay_msec", PortKind::Count(0), "how long it waits, ms")],
    about: "runs until its time is over, then ticks its child",
    role: Role::Flow,
    tick: delay,
    halt: halt_counting,
};
/// `Timeout`.
pub(super) const TIMEOUT: NodeSheet = NodeSheet {
    tag: "Timeout",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[PortSheet::must("msec", PortKind::Count(0), "longest time, ms")],
    about: "halts its child and fails when it runs for too long",
    role: Role::Flow,
    tick: timeout,
    halt: halt_counting,
};
/// `Sleep`.
pub(super) const SLEEP: NodeSheet = NodeSheet {
    tag: "Sleep",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[PortSheet::must("msec", PortKind::Count(0), "how long, ms")],
    about: "runs until its time is over, and moves nobody",
    role: Role::Quiet,
    tick: sleep,
    halt: halt_leaf,
};

/// Nanoseconds of a millisecond.
const NANOS: u64 = 1_000_000;

/// Whether the time of port 0 is over. Word 0 says whether it has begun, word 1 when.
fn is_over(t: &mut Ticker<'_>, node: usize) -> bool {
    let now = t.world.now().nanos();
    if t.word(node, 0) == 0 {
        t.set_word(node, 0, 1);
        t.set_word(node, 1, now);
    }
    let wait = t.ports(node).whole(0).and_then(|msec| u64::try_from(msec).ok()).unwrap_or(0).saturating_mul(NANOS);
    now.saturating_sub(t.word(node, 1)) >= wait
}

fn delay(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    if !is_over(t, node) {
        return Status::Running;
    }
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.set_word(node, 0, 0);
        t.reset_child(node, 0);
    }
    outcome
}

/// A time limit of 0 is none.
fn timeout(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    let has_limit = t.ports(node).whole(0).is_some_and(|msec| msec > 0);
    if is_over(t, node) && has_limit {
        t.set_word(node, 0, 0);
        t.reset_child(node, 0);
        return Status::Failure;
    }
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.set_word(node, 0, 0);
        t.reset_child(node, 0);
    }
    outcome
}

fn sleep(t: &mut Ticker<'_>, node: usize) -> Status {
    if t.status(node) != Status::Running {
        t.set_word(node, 0, 0);
    }
    if is_over(t, node) { Status::Success } else { Status::Running }
}
