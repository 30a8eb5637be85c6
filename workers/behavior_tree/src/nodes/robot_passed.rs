//! `HasRobotPassed`: the robot was near and is farther away again.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `HasRobotPassed`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "HasRobotPassed",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "holds once the robot was near this human and is 1 m farther away again",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(_ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::RobotPassed)
}

fn tick(t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::of(t.world.robot_passed())
}
