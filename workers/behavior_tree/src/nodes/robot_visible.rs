//! `IsRobotVisible`: the robot is seen.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `IsRobotVisible`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "IsRobotVisible",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::DISTANCE],
    about: "holds while the robot is in the field of view, in line of sight and within the distance",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

pub(super) fn means(ports: &Ports<'_>) -> Option<Trigger> {
    ports.real(1).map(Trigger::RobotVisible)
}

pub(super) fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    Status::of(t.ports(node).real(1).is_some_and(|within_m| t.world.robot_visible(within_m)))
}
