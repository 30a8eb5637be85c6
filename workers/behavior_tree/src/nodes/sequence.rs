//! `Sequence`: all children, one after the other.

use crate::nodes::halt_counting;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Sequence`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "Sequence",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[],
    about: "AND: ticks its children in order until one fails; succeeds when all did",
    role: Role::Flow,
    tick,
    halt: halt_counting,
};

/// A failing child ends it and everything starts anew; a running child is taken up again.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    if t.status(node) == Status::Idle {
        t.cell(node).tally = 0;
    }
    t.set(node, Status::Running);
    let n = t.children(node);
    while t.cell(node).index < n {
        let place = t.cell(node).index;
        match t.tick_child(node, place) {
            Status::Success => t.cell(node).index += 1,
            Status::Skipped => {
                t.cell(node).index += 1;
                t.cell(node).tally += 1;
            }
            Status::Failure => {
                t.reset_children(node);
                t.cell(node).index = 0;
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
