//! `Repeat` and `RetryUntilSuccessful`: the child again and again, so many times, until it ends otherwise.

use crate::nodes::halt_counting;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Repeat`.
pub(super) const REPEAT: NodeSheet = NodeSheet {
    tag: "Repeat",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[PortSheet::must("num_cycles", PortKind::Count(-1), "repetitions; -1 without end")],
    about: "ticks its child again after every success, so many times",
    role: Role::Flow,
    tick: repeat,
    halt: halt_counting,
};
/// `RetryUntilSuccessful`.
pub(super) const RETRY: NodeSheet = NodeSheet {
    tag: "RetryUntilSuccessful",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[PortSheet::must("num_attempts", PortKind::Count(-1), "attempts; -1 without end")],
    about: "ticks its child again after every failure, so many times",
    role: Role::Flow,
    tick: retry,
    halt: halt_counting,
};

/// Most rounds inside one tick: version 3 would not come back from a child that finishes at once.
const MOST_PER_TICK: usize = 1000;

fn repeat(t: &mut Ticker<'_>, node: usize) -> Status {
    again(t, node, Status::Success)
}

fn retry(t: &mut Ticker<'_>, node: usize) -> Status {
    again(t, node, Status::Failure)
}

/// The child starts again after the outcome `again`; word 0 counts how often it had it.
fn again(t: &mut Ticker<'_>, node: usize, again: Status) -> Status {
    let given = t.ports(node).whole(0).unwrap_or(0);
    let is_due = |count: u64| given == -1 || u64::try_from(given).is_ok_and(|given| count < given);
    let v4 = t.is_v4();
    t.set(node, Status::Running);
    let mut rounds = 0;
    while is_due(t.word(node, 0)) {
        let before = t.child_status(node, 0);
        let outcome = t.tick_child(node, 0);
        if !outcome.is_finished() {
            if outcome == Status::Skipped {
                t.reset_child(node, 0);
                return Status::Skipped;
            }
            return Status::Running;
        }
        t.reset_child(node, 0);
        if outcome != again {
            t.set_word(node, 0, 0);
            return outcome;
        }
        t.set_word(node, 0, t.word(node, 0).saturating_add(1));
        rounds += 1;
        // Version 4 lets go of the tick here, so that others may interrupt it.
        let yields = (v4 && before == Status::Idle) || rounds >= MOST_PER_TICK;
        if yields && is_due(t.word(node, 0)) {
            return Status::Running;
        }
    }
    t.set_word(node, 0, 0);
    again
}
