//! `ScriptCondition`, `Precondition` and `UnsetBlackboard` (v4): asking and clearing blackboard entries.

use crate::blackboard::Input;
use crate::nodes::{halt_counting, halt_leaf};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `ScriptCondition`.
pub(super) const CONDITION: NodeSheet = NodeSheet {
    tag: "ScriptCondition",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[PortSheet::must("code", PortKind::Code, "a comparison")],
    about: "holds while a script gives true",
    role: Role::Quiet,
    tick: condition,
    halt: halt_leaf,
};
/// `Precondition`.
pub(super) const PRECONDITION: NodeSheet = NodeSheet {
    tag: "Precondition",
    v3_tag: None,
    kind: Kind::Decorator,
    library: Library::BuiltIn,
    arity: Arity::ONE,
    ports: &[
        PortSheet::must("if", PortKind::Code, "a comparison, asked before the child starts"),
        PortSheet::may("else", PortKind::Text, "FAILURE", "the outcome where it does not hold"),
    ],
    about: "ticks its child if a script gives true when it starts; else it has the outcome of `else`",
    role: Role::Flow,
    tick: precondition,
    halt: halt_counting,
};
/// `UnsetBlackboard`.
pub(super) const UNSET: NodeSheet = NodeSheet {
    tag: "UnsetBlackboard",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[PortSheet::must("key", PortKind::Key, "the entry")],
    about: "takes a blackboard entry away",
    role: Role::Quiet,
    tick: unset,
    halt: halt_leaf,
};

fn holds(t: &mut Ticker<'_>, node: usize) -> bool {
    let script = t.tree.nodes.get(node).and_then(|it| it.script.as_ref());
    script.and_then(|script| script.run(&mut t.state.board).ok()).is_some_and(|value| value.flag())
}

fn condition(t: &mut Ticker<'_>, node: usize) -> Status {
    Status::of(holds(t, node))
}

/// Word 0 says whether the child has started.
fn precondition(t: &mut Ticker<'_>, node: usize) -> Status {
    if t.word(node, 0) == 0 {
        if !holds(t, node) {
            let otherwise = t.ports(node).text(1);
            return match otherwise.as_deref() {
                Some("SUCCESS") => Status::Success,
                Some("SKIPPED") => Status::Skipped,
                Some("RUNNING") => Status::Running,
                Some(_) | None => Status::Failure,
            };
        }
        t.set_word(node, 0, 1);
    }
    t.set(node, Status::Running);
    let outcome = t.tick_child(node, 0);
    if outcome.is_finished() {
        t.reset_child(node, 0);
        t.set_word(node, 0, 0);
    }
    outcome
}

fn unset(t: &mut Ticker<'_>, node: usize) -> Status {
    let slot = match t.ports(node).inputs.first() {
        Some(Input::Slot(slot)) => Some(*slot),
        Some(Input::Fixed(_)) | None => None,
    };
    if let Some(entry) = slot.and_then(|slot| t.state.board.get_mut(slot)) {
        *entry = None;
    }
    Status::Success
}
