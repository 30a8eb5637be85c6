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

/// Word 0 counts the children left out since the node was last idle.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let v4 = t.is_v4();
    if v4 && t.status(node) == Status::Idle {
        t.set_word(node, 0, 0);
    }
    t.set(node, Status::Running);
    let n = t.children(node);
    while t.place(node) < n {
        let place = t.place(node);
        let before = t.child_status(node, place);
        match t.tick_child(node, place) {
            Status::Success => {
                t.set_place(node, place + 1);
                // Version 4 lets go of the tick here, so that others may interrupt a long list.
                if v4 && before == Status::Idle && place + 1 < n {
                    return Status::Running;
                }
            }
            Status::Skipped => {
                t.set_place(node, place + 1);
                t.set_word(node, 0, t.word(node, 0) + 1);
            }
            Status::Failure => {
                t.reset_children_from(node, place, None);
                return Status::Failure;
            }
            Status::Running | Status::Idle => return Status::Running,
        }
    }
    let all_skipped = v4 && t.word(node, 0) == n as u64;
    t.reset_children(node);
    t.set_place(node, 0);
    if v4 {
        t.set_word(node, 0, 0);
    }
    if all_skipped { Status::Skipped } else { Status::Success }
}

/// Version 3 forgets its place when it is halted, version 4 does not.
fn halt(t: &mut Ticker<'_>, node: usize) {
    if !t.is_v4() {
        t.set_place(node, 0);
    }
    halt_children(t, node);
}
