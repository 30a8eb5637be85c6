//! `RobotSays`: the robot makes a gesture.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `RobotSays`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "RobotSays",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::must("message", PortKind::Gesture, "the gesture")],
    about: "holds while the robot makes the gesture",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(ports: &Ports<'_>) -> Option<Trigger> {
    ports.said(1).flatten().map(Trigger::RobotSays)
}

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    Status::of(t.ports(node).said(1).is_some_and(|said| t.world.robot_gesture() == said))
}
