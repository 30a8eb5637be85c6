//! `Switch2` to `Switch6`: a branch per value of a blackboard entry, and one for the rest.

use crate::blackboard::Value;
use crate::nodes::halt_placed;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Switch2`.
pub(super) const SWITCH_2: NodeSheet = NodeSheet {
    tag: "Switch2",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity { least: 3, most: 3 },
    ports: &[
        PortSheet::must("variable", PortKind::Text, "the entry to compare, such as {mode}"),
        PortSheet::must("case_1", PortKind::Text, "value of branch 1"),
        PortSheet::must("case_2", PortKind::Text, "value of branch 2"),
    ],
    about: "picks one of 2 branches by the value of an entry, else the last branch",
    role: Role::Flow,
    tick,
    halt: halt_placed,
};
/// `Switch3`.
pub(super) const SWITCH_3: NodeSheet = NodeSheet {
    tag: "Switch3",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity { least: 4, most: 4 },
    ports: &[
        PortSheet::must("variable", PortKind::Text, "the entry to compare, such as {mode}"),
        PortSheet::must("case_1", PortKind::Text, "value of branch 1"),
        PortSheet::must("case_2", PortKind::Text, "value of branch 2"),
        PortSheet::must("case_3", PortKind::Text, "value of branch 3"),
    ],
    about: "picks one of 3 branches by the value of an entry, else the last branch",
    role: Role::Flow,
    tick,
    halt: halt_placed,
};
/// `Switch4`.
pub(super) const SWITCH_4: NodeSheet = NodeSheet {
    tag: "Switch4",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity { least: 5, most: 5 },
    ports: &[
        PortSheet::must("variable", PortKind::Text, "the entry to compare, such as {mode}"),
        PortSheet::must("case_1", PortKind::Text, "value of branch 1"),
        PortSheet::must("case_2", PortKind::Text, "value of branch 2"),
        PortSheet::must("case_3", PortKind::Text, "value of branch 3"),
        PortSheet::must("case_4", PortKind::Text, "value of branch 4"),
    ],
    about: "picks one of 4 branches by the value of an entry, else the last branch",
    role: Role::Flow,
    tick,
    halt: halt_placed,
};
/// `Switch5`.
pub(super) const SWITCH_5: NodeSheet = NodeSheet {
    tag: "Switch5",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity { least: 6, most: 6 },
    ports: &[
        PortSheet::must("variable", PortKind::Text, "the entry to compare, such as {mode}"),
        PortSheet::must("case_1", PortKind::Text, "value of branch 1"),
        PortSheet::must("case_2", PortKind::Text, "value of branch 2"),
        PortSheet::must("case_3", PortKind::Text, "value of branch 3"),
        PortSheet::must("case_4", PortKind::Text, "value of branch 4"),
        PortSheet::must("case_5", PortKind::Text, "value of branch 5"),
    ],
    about: "picks one of 5 branches by the value of an entry, else the last branch",
    role: Role::Flow,
    tick,
    halt: halt_placed,
};
/// `Switch6`.
pub(super) const SWITCH_6: NodeSheet = NodeSheet {
    tag: "Switch6",
    v3_tag: None,
    kind: Kind::Control,
    library: Library::BuiltIn,
    arity: Arity { least: 7, most: 7 },
    ports: &[
        PortSheet::must("variable", PortKind::Text, "the entry to compare, such as {mode}"),
        PortSheet::must("case_1", PortKind::Text, "value of branch 1"),
        PortSheet::must("case_2", PortKind::Text, "value of branch 2"),
        PortSheet::must("case_3", PortKind::Text, "value of branch 3"),
        PortSheet::must("case_4", PortKind::Text, "value of branch 4"),
        PortSheet::must("case_5", PortKind::Text, "value of branch 5"),
        PortSheet::must("case_6", PortKind::Text, "value of branch 6"),
    ],
    about: "picks one of 6 branches by the value of an entry, else the last branch",
    role: Role::Flow,
    tick,
    halt: halt_placed,
};

/// The branch that runs is kept as the place, counted from 1.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let n_cases = t.children(node).saturating_sub(1);
    let v4 = t.is_v4();
    let ports = t.ports(node);
    let chosen = match ports.value(0) {
        Some(value) => (0..n_cases)
            .find(|case| ports.value(case + 1).is_some_and(|wanted| equal(&value, &wanted, v4)))
            .unwrap_or(n_cases),
        None => n_cases,
    };
    let running = t.place(node);
    if running > 0 && running != chosen + 1 {
        t.reset_child(node, running - 1);
    }
    let outcome = t.tick_child(node, chosen);
    match outcome {
        Status::Running => t.set_place(node, chosen + 1),
        Status::Skipped => t.set_place(node, 0),
        Status::Success | Status::Failure | Status::Idle => {
            t.reset_children(node);
            t.set_place(node, 0);
        }
    }
    outcome
}

/// Version 3 compares texts; version 4 then whole numbers, then reals to single precision.
fn equal(value: &Value, wanted: &Value, v4: bool) -> bool {
    if value.same_text(wanted) {
        return true;
    }
    if !v4 || value.is_padded() || wanted.is_padded() {
        return false;
    }
    if let (Some(a), Some(b)) = (value.whole(), wanted.whole()) {
        return a == b;
    }
    match (value.number(), wanted.number()) {
        (Some(a), Some(b)) => (a - b).abs() <= f64::from(f32::EPSILON),
        (Some(_) | None, _) => false,
    }
}
