//! `SequenceWithMemory` (v3: `SequenceStar`): a sequence that does not go back after a failure.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `SequenceWithMemory`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "SequenceWithMemory",
    v3_tag: Some("SequenceStar"),
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[],
    about: "a Sequence that, after a failure, goes on at the child that failed",
    role: Role::Flow,
    tick,
    halt,
};

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    if t.status(node) == Status::Idle {
        t.cell(node).tally = 0;
    }
    t.set(node, Status::Running);
    let n = t.children(node);
    while t.cell(node).index < n {
        let place = t.cell(node).index;
        let before = t.child_status(node, place);
        match t.tick_child(node, place) {
            Status::Success => {
                t.cell(node).index += 1;
                // Version 4 lets go of the tick here, so that others may interrupt a long list.
                if t.is_v4() && before == Status::Idle && place + 1 < n {
                    return Status::Running;
                }
            }
            Status::Skipped => {
                t.cell(node).index += 1;
                t.cell(node).tally += 1;
            }
            Status::Failure => {
                t.reset_children_from(node, place, None);
                return Status::Failure;
            }
            Status::Running | Status::Idle => return Status::Running,
        }
    }
    let all_skipped = t.cell(node).tally == n;
    t.reset_children(node);
    let cell = t.cell(node);
    cell.index = 0;
    cell.tally = 0;
    if all_skipped { Status::Skipped } else { Status::Success }
}

/// Version 3 forgets its place when it is halted, version 4 does not.
fn halt(t: &mut Ticker<'_>, node: usize) {
    if !t.is_v4() {
        t.cell(node).index = 0;
    }
    halt_children(t, node);
}
