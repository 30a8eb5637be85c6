//! `MakeGestureTo`: says something to one listener.

use socrates_model::AgentId;

use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `MakeGestureTo`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "MakeGestureTo",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[
        PortSheet::OWN,
        PortSheet::must("message", PortKind::Gesture, "the gesture"),
        PortSheet::must("to", PortKind::Count(0), "to whom: 0 for the robot, 1 for human_1"),
    ],
    about: "makes a gesture to one listener, which lasts until the next MakeGesture; the robot takes it for its own only where it is the listener",
    role: Role::Says,
    tick,
    halt: halt_leaf,
};

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let ports = t.ports(node);
    let to = ports.whole(2).and_then(|number| u32::try_from(number).ok()).map(AgentId::from_number);
    let (Some(gesture), Some(to)) = (ports.said(1).flatten(), to) else { return Status::Failure };
    t.world.gesture_to(gesture, to);
    Status::Success
}
