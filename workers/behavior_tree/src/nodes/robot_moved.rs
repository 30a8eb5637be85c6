//! `RobotMoved`: the robot moves. The fork overlooks motion to negative x and y; we do not.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `RobotMoved`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "RobotMoved",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "holds while the robot moves, in any direction",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(_ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::RobotMoving)
}

fn tick(t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::of(t.world.robot_moving())
}
