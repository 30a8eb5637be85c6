//! `HasTimePassed`: so much of the run is over.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `HasTimePassed`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "HasTimePassed",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::must("seconds", PortKind::Seconds, "time since the start of the run")],
    about: "holds from so many seconds after the start of the run on",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(ports: &Ports<'_>) -> Option<Trigger> {
    ports.real(0).map(Trigger::AfterSecs)
}

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    Status::of(t.ports(node).real(0).is_some_and(|seconds| t.world.now().secs() >= seconds))
}
