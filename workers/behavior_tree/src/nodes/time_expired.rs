//! `TimeExpiredCondition`: a timer that counts only while it is ticked.

use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `TimeExpiredCondition`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "TimeExpiredCondition",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("seconds", PortKind::Seconds, "length of the timer"),
        PortSheet::must("ts", PortKind::Step, "length of a tick"),
        PortSheet::must("only_once", PortKind::Flag, "whether it stays expired, or starts again"),
    ],
    about: "fails until it has been ticked for so many seconds, then holds; put it under an Inverter to limit an action",
    role: Role::Timer,
    tick,
    halt: halt_leaf,
};

/// Counted in whole nanoseconds, so that five seconds are five hundred steps of 0.01 s and not one more.
pub(super) fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let ports = t.ports(node);
    let (Some(seconds), only_once) = (ports.real(0), ports.flag(2).unwrap_or(false)) else {
        return Status::Failure;
    };
    let step_s = ports.real(1).unwrap_or_else(|| t.world.step_s());
    let limit = nanos(seconds);
    let counted = t.word(node, 0).saturating_add(nanos(step_s));
    if counted < limit {
        t.set_word(node, 0, counted);
        return Status::Failure;
    }
    t.set_word(node, 0, if only_once { limit } else { 0 });
    Status::Success
}

/// Whole nanoseconds; negative and unreadable spans are 0.
pub(super) fn nanos(seconds: f64) -> u64 {
    (seconds * 1e9 + 0.5) as u64
}
