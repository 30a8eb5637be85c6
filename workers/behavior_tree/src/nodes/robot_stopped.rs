//! `IsRobotStopped`: the robot has moved and stands still.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `IsRobotStopped`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "IsRobotStopped",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "holds while there is a robot that has moved before and stands still",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(_ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::RobotStopped)
}

fn tick(t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::of(t.world.robot_stopped())
}
