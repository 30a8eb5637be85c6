//! `IsPathDone`: this human is at the end of its path.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `IsPathDone`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "IsPathDone",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "holds while this human is at the end of its path",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(_ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::GoalReached)
}

fn tick(t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::of(t.world.path_done())
}
