//! `HasArrived`: at the end of the way that a step has taken.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `HasArrived`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "HasArrived",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "holds once this human is at the end of the way that TurnBack or GoToPlace has taken",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(_ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::GoalReached)
}

fn tick(t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::of(t.world.has_arrived())
}
