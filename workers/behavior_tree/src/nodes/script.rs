//! `Script` (v4): computes blackboard entries.

use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `Script`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "Script",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[PortSheet::must("code", PortKind::Code, "assignments, separated by ;")],
    about: "computes blackboard entries, such as x := 1",
    role: Role::Quiet,
    tick,
    halt: halt_leaf,
};

/// Fails where the script cannot be computed.
fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let tree = t.tree;
    let script = tree.nodes.get(node).and_then(|it| it.script.as_ref());
    Status::of(script.is_some_and(|script| script.run(&mut t.state.board).is_ok()))
}
