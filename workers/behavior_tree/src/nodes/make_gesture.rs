//! `MakeGesture`: says something, or takes it back.

use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `MakeGesture`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "MakeGesture",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::must("message", PortKind::Gesture, "the gesture; 0 takes it back")],
    about: "makes a gesture that lasts until the next MakeGesture; message 0 takes it back",
    role: Role::Says,
    tick,
    halt: halt_leaf,
};

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let Some(said) = t.ports(node).said(1) else { return Status::Failure };
    t.world.gesture(said);
    Status::Success
}
