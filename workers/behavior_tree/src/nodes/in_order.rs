//! `Sequence` and `Fallback`: children one after the other, until one ends it.

use crate::nodes::halt_counting_skips;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Sequence`.
pub(super) const SEQUENCE: NodeSheet = NodeSheet {
    tag: "Sequence",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[],
    about: "AND: ticks its children in order until one fails; succeeds when all did",
    role: Role::Flow,
    tick: sequence,
    halt: halt_counting_skips,
};
/// `Fallback`.
pub(super) const FALLBACK: NodeSheet = NodeSheet {
    tag: "Fallback",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[],
    about: "OR: ticks its children in order until one succeeds; fails when none does",
    role: Role::Flow,
    tick: fallback,
    halt: halt_counting_skips,
};
/// `AsyncSequence`.
pub(super) const ASYNC_SEQUENCE: NodeSheet = NodeSheet {
    tag: "AsyncSequence",
    about: "a Sequence that lets go of the tick between two children that finish at once",
    tick: async_sequence,
    ..SEQUENCE
};
/// `AsyncFallback`.
pub(super) const ASYNC_FALLBACK: NodeSheet = NodeSheet {
    tag: "AsyncFallback",
    about: "a Fallback that lets go of the tick between two children that finish at once",
    tick: async_fallback,
    ..FALLBACK
};

fn sequence(t: &mut Ticker<'_>, node: usize) -> Status {
    in_order::<false>(t, node, Status::Failure, Status::Success)
}

fn fallback(t: &mut Ticker<'_>, node: usize) -> Status {
    in_order::<false>(t, node, Status::Success, Status::Failure)
}

fn async_sequence(t: &mut Ticker<'_>, node: usize) -> Status {
    in_order::<true>(t, node, Status::Failure, Status::Success)
}

fn async_fallback(t: &mut Ticker<'_>, node: usize) -> Status {
    in_order::<true>(t, node, Status::Success, Status::Failure)
}

/// A child with the ending outcome ends it and everything starts anew; a running child is taken up again.
///
/// Word 0 counts the children left out since the node was last idle; that it is not put back when a child ends
/// the node is the way of the original.
fn in_order<const YIELDS: bool>(t: &mut Ticker<'_>, node: usize, ending: Status, otherwise: Status) -> Status {
    let v4 = t.is_v4();
    if v4 && t.status(node) == Status::Idle {
        t.set_word(node, 0, 0);
    }
    t.set(node, Status::Running);
    let kids = t.kids(node);
    let mut place = t.place(node);
    while let Some(child) = kids.get(place) {
        let was_idle = YIELDS && t.status(*child as usize) == Status::Idle;
        let outcome = t.tick(*child as usize);
        if outcome == ending {
            // Children after this one are idle: they were put back when the node last ended or was halted.
            for ticked in kids.iter().take(place + 1) {
                t.reset(*ticked as usize);
            }
            t.set_place(node, 0);
            return ending;
        }
        match outcome {
            Status::Running | Status::Idle => {
                t.set_place(node, place);
                return Status::Running;
            }
            Status::Skipped => t.set_word(node, 0, t.word(node, 0) + 1),
            Status::Success | Status::Failure if was_idle && place + 1 < kids.len() => {
                t.set_place(node, place + 1);
                return Status::Running;
            }
            Status::Success | Status::Failure => {}
        }
        place += 1;
    }
    let all_skipped = v4 && t.word(node, 0) == kids.len() as u64;
    t.reset_children(node);
    t.set_place(node, 0);
    if !v4 {
        return otherwise;
    }
    t.set_word(node, 0, 0);
    if all_skipped { Status::Skipped } else { otherwise }
}
