//! `UpdateGoal`: on to the next node of the path.

use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `UpdateGoal`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "UpdateGoal",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "takes the next goal of the path; used inside RegularNavTree",
    role: Role::Quiet,
    tick,
    halt: halt_leaf,
};

pub(super) fn tick(t: &mut Ticker<'_>, _node: usize) -> Status {
    t.world.next_goal();
    Status::Success
}
