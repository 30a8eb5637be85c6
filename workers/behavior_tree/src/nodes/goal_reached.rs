//! `IsGoalReached`: this human is at the present goal of its path.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `IsGoalReached`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "IsGoalReached",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "holds while this human is at the present goal of its path; used inside RegularNavTree",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

/// No trigger of a rule: rules speak of the end of the path.
pub(super) fn means(_ports: &Ports<'_>) -> Option<Trigger> {
    None
}

pub(super) fn tick(t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::of(t.world.goal_reached())
}
