//! `RetryUntilSuccessful`: ticks its child again after every failure, so many times.

use crate::nodes::halt_counting;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `RetryUntilSuccessful`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "RetryUntilSuccessful",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[PortSheet::must("num_attempts", PortKind::Count(-1), "attempts; -1 without end")],
    about: "ticks its child again after every failure, so many times",
    role: Role::Flow,
    tick,
    halt: halt_counting,
};

/// Most repetitions inside one tick: version 3 would not come back from a child that finishes at once.
const MOST_PER_TICK: usize = 1000;

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let given = t.ports(node).whole(0).unwrap_or(0);
    let is_due = |count: usize| given == -1 || i64::try_from(count).is_ok_and(|count| count < given);
    t.set(node, Status::Running);
    let mut rounds = 0;
    while is_due(t.cell(node).count) {
        let before = t.child_status(node, 0);
        match t.tick_child(node, 0) {
            Status::Failure => {
                t.cell(node).count += 1;
                rounds += 1;
                t.reset_child(node, 0);
                let yields = (t.is_v4() && before == Status::Idle) || rounds >= MOST_PER_TICK;
                if yields && is_due(t.cell(node).count) {
                    return Status::Running;
                }
            }
            Status::Success => {
                t.cell(node).count = 0;
                t.reset_child(node, 0);
                return Status::Success;
            }
            Status::Skipped => {
                t.reset_child(node, 0);
                return Status::Skipped;
            }
            Status::Running | Status::Idle => return Status::Running,
        }
    }
    t.cell(node).count = 0;
    Status::Failure
}
