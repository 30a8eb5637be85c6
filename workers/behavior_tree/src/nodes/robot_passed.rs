//! `HasRobotPassed`, `DoesRobotPass`: the robot was near and is farther away again, at any time or since it is asked.

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

/// `DoesRobotPass`.
pub(super) const SINCE: NodeSheet = NodeSheet {
    tag: "DoesRobotPass",
    about: "holds once the robot was near this human since it was first asked, and is 1 m farther away again",
    tick: tick_since,
    ..SHEET
};

/// Word 0 is the nearest that the robot has been, m, as the bits of its number; 0 before it is asked.
fn tick_since(t: &mut Ticker<'_>, node: usize) -> Status {
    let Some(distance_m) = t.world.robot_distance_m() else { return Status::Failure };
    let before = t.word(node, 0);
    let before_m = if before == 0 { f64::INFINITY } else { f64::from_bits(before) };
    let nearest_m = before_m.min(distance_m);
    t.set_word(node, 0, nearest_m.to_bits());
    Status::of(t.world.robot_passes(nearest_m))
}
