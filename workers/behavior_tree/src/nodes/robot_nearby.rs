//! `IsRobotNearby`: the robot is near, seen or not.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `IsRobotNearby`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "IsRobotNearby",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::DISTANCE],
    about: "holds while the robot is within the distance, seen or not",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(ports: &Ports<'_>) -> Option<Trigger> {
    ports.real(1).map(Trigger::RobotNear)
}

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let within = t.ports(node).real(1);
    Status::of(match (t.world.robot_distance_m(), within) {
        (Some(distance_m), Some(within_m)) => distance_m <= within_m,
        (Some(_) | None, _) => false,
    })
}
