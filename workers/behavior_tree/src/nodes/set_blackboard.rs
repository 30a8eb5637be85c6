//! `SetBlackboard`: writes an entry.

use crate::blackboard::Input;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `SetBlackboard`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "SetBlackboard",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("output_key", PortKind::Key, "the entry"),
        PortSheet::must("value", PortKind::Text, "a text, or {entry} for a copy"),
    ],
    about: "writes a blackboard entry",
    role: Role::Quiet,
    tick,
    halt: halt_leaf,
};

/// A copy of an entry that is not set leaves the other one as it is.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let ports = t.ports(node);
    let value = ports.value(1);
    let to = match ports.inputs.first() {
        Some(Input::Slot(slot)) => Some(*slot),
        Some(Input::Fixed(_)) | None => None,
    };
    if let (Some(value), Some(entry)) = (value, to.and_then(|slot| t.state.board.get_mut(slot))) {
        *entry = Some(value);
    }
    Status::Success
}
