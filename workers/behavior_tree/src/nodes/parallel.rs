//! `Parallel`: all children in every tick, until enough have finished.

use crate::nodes::halt_counting;
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

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let n = t.children(node);
    let given = t.ports(node).whole(0).unwrap_or(-1);
    let need = threshold(given, n);
    let most_failures = threshold(t.ports(node).whole(1).unwrap_or(1), n);
    let v4 = t.is_v4();
    t.set(node, Status::Running);
    if !v4 {
        // Version 3 counts anew in every tick, finished children included, as it passes them.
        let cell = t.cell(node);
        cell.count = 0;
        cell.tally = 0;
    }
    let mut skipped = 0;
    for place in 0..n {
        let Some(child) = t.child(node, place) else { continue };
        let finished_before = t.cell(child).done;
        let outcome = if finished_before { t.status(child) } else { t.tick(child) };
        if !finished_before || !v4 {
            match outcome {
                Status::Success => {
                    t.cell(child).done = true;
                    t.cell(node).count += 1;
                }
                Status::Failure => {
                    t.cell(child).done = true;
                    t.cell(node).tally += 1;
                }
                Status::Skipped => skipped += 1,
                Status::Running | Status::Idle => {}
            }
        }
        let (successes, failures) = (t.cell(node).count, t.cell(node).tally);
        if successes >= need || (given < 0 && successes + skipped >= need) {
            finish(t, node);
            return Status::Success;
        }
        if n.saturating_sub(failures) < need || failures == most_failures {
            finish(t, node);
            return Status::Failure;
        }
    }
    if skipped == n { Status::Skipped } else { Status::Running }
}

/// Forgets who finished, and puts everybody back.
fn finish(t: &mut Ticker<'_>, node: usize) {
    forget(t, node);
    t.reset_children(node);
}

fn forget(t: &mut Ticker<'_>, node: usize) {
    for place in 0..t.children(node) {
        if let Some(child) = t.child(node, place) {
            t.cell(child).done = false;
        }
    }
    let cell = t.cell(node);
    cell.count = 0;
    cell.tally = 0;
}

fn halt(t: &mut Ticker<'_>, node: usize) {
    forget(t, node);
    halt_counting(t, node);
}
