//! `HasRobotStoodFor`: the robot has stood for so long.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `HasRobotStoodFor`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "HasRobotStoodFor",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::must("seconds", PortKind::Seconds, "for how long")],
    about: "holds while there is a robot that has moved before and has stood for so many seconds",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::StoppedFor(ports.real(1)?))
}

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let seconds = t.ports(node).real(1);
    Status::of(seconds.is_some_and(|seconds| t.world.robot_stood_s() >= seconds))
}
