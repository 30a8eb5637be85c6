//! `ReactiveSequence` and `ReactiveFallback`: from the first child on in every tick, until one ends it.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `ReactiveSequence`.
pub(super) const SEQUENCE: NodeSheet = NodeSheet {
    tag: "ReactiveSequence",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[],
    about: "AND, asked anew from the first child in every tick; a running later child is stopped when an earlier one fails",
    role: Role::Flow,
    tick: sequence,
    halt: halt_children,
};
/// `ReactiveFallback`.
pub(super) const FALLBACK: NodeSheet = NodeSheet {
    tag: "ReactiveFallback",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[],
    about: "OR, asked anew from the first child in every tick; a running later child is stopped when an earlier one succeeds",
    role: Role::Flow,
    tick: fallback,
    halt: halt_children,
};

fn sequence(t: &mut Ticker<'_>, node: usize) -> Status {
    reactive(t, node, Status::Failure, Status::Success)
}

fn fallback(t: &mut Ticker<'_>, node: usize) -> Status {
    reactive(t, node, Status::Success, Status::Failure)
}

/// While one child runs, all others are put back, before and after it.
fn reactive(t: &mut Ticker<'_>, node: usize, ending: Status, otherwise: Status) -> Status {
    t.set(node, Status::Running);
    let mut all_skipped = true;
    for (place, child) in t.kids(node).iter().enumerate() {
        let outcome = t.tick(*child as usize);
        if outcome == ending {
            t.reset_children(node);
            return ending;
        }
        match outcome {
            Status::Skipped => t.reset(*child as usize),
            Status::Running | Status::Idle => {
                t.reset_children_from(node, 0, Some(place));
                return Status::Running;
            }
            Status::Success | Status::Failure => all_skipped = false,
        }
    }
    t.reset_children(node);
    if all_skipped { Status::Skipped } else { otherwise }
}
