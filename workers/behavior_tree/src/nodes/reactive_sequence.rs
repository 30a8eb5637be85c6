//! `ReactiveSequence`: starts at the first child in every tick.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `ReactiveSequence`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "ReactiveSequence",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[],
    about: "AND, asked anew from the first child in every tick; a running later child is stopped when an earlier one fails",
    role: Role::Flow,
    tick,
    halt: halt_children,
};

/// While one child runs, all others are put back, before and after it.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    t.set(node, Status::Running);
    let mut all_skipped = true;
    for place in 0..t.children(node) {
        let outcome = t.tick_child(node, place);
        all_skipped &= outcome == Status::Skipped;
        match outcome {
            Status::Success => {}
            Status::Skipped => t.reset_child(node, place),
            Status::Failure => {
                t.reset_children(node);
                return Status::Failure;
            }
            Status::Running | Status::Idle => {
                t.reset_children_from(node, 0, Some(place));
                return Status::Running;
            }
        }
    }
    t.reset_children(node);
    if all_skipped { Status::Skipped } else { Status::Success }
}
