//! `Parallel`: all children in every tick, until enough have finished.

use crate::nodes::halt_children;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Parallel`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "Parallel",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity::SOME,
    ports: &[
        PortSheet::may("success_threshold", PortKind::Count(-64), "-1", "successes needed; -1 for all")
            .in_v4("success_count"),
        PortSheet::may("failure_threshold", PortKind::Count(-64), "1", "failures that end it; -1 for all")
            .in_v4("failure_count"),
    ],
    about: "ticks all its children in every tick until enough of them succeeded or failed",
    role: Role::Flow,
    tick,
    halt,
};

/// A threshold of -1 means all children, -2 all but one, and so on.
fn threshold(given: i64, n: usize) -> usize {
    let n_signed = i64::try_from(n).unwrap_or(i64::MAX);
    let wanted = if given < 0 { n_signed + given + 1 } else { given };
    usize::try_from(wanted).unwrap_or(0)
}

/// Word 0 counts successes, word 1 failures.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let kids = t.kids(node);
    let n = kids.len();
    let given = t.ports(node).whole(0).unwrap_or(-1);
    let need = threshold(given, n);
    let most_failures = threshold(t.ports(node).whole(1).unwrap_or(1), n);
    let v4 = t.is_v4();
    t.set(node, Status::Running);
    // Version 3 counts anew in every tick, finished children included, as it passes them.
    let (mut successes, mut failures) = if v4 { (t.word(node, 0) as usize, t.word(node, 1) as usize) } else { (0, 0) };
    let mut skipped = 0;
    for child in kids.iter().map(|child| *child as usize) {
        let finished_before = t.is_done(child);
        let outcome = if finished_before { t.status(child) } else { t.tick(child) };
        if !finished_before || !v4 {
            match outcome {
                Status::Success => {
                    t.set_done(child, true);
                    successes += 1;
                }
                Status::Failure => {
                    t.set_done(child, true);
                    failures += 1;
                }
                Status::Skipped => skipped += 1,
                Status::Running | Status::Idle => {}
            }
        }
        if successes >= need || (given < 0 && successes + skipped >= need) {
            finish(t, node);
            return Status::Success;
        }
        if n.saturating_sub(failures) < need || failures == most_failures {
            finish(t, node);
            return Status::Failure;
        }
    }
    t.set_word(node, 0, successes as u64);
    t.set_word(node, 1, failures as u64);
    if skipped == n { Status::Skipped } else { Status::Running }
}

/// Forgets who finished, and puts everybody back.
fn finish(t: &mut Ticker<'_>, node: usize) {
    forget(t, node);
    t.reset_children(node);
}

fn forget(t: &mut Ticker<'_>, node: usize) {
    for child in t.kids(node) {
        t.set_done(*child as usize, false);
    }
    t.set_word(node, 0, 0);
    t.set_word(node, 1, 0);
}

fn halt(t: &mut Ticker<'_>, node: usize) {
    forget(t, node);
    halt_children(t, node);
}
