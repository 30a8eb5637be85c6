//! `HumanSays`: another human makes a gesture.

use socrates_model::{HumanId, Trigger};

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `HumanSays`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "HumanSays",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[
        PortSheet::OWN,
        PortSheet::must("target_id", PortKind::Human, "who speaks"),
        PortSheet::must("message", PortKind::Gesture, "the gesture"),
    ],
    about: "holds while another human makes the gesture",
    role: Role::Asks(means),
    tick,
    halt: halt_leaf,
};

fn means(ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::HumanSays(human(ports, 1)?, ports.said(2).flatten()?))
}

fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let asked = human(&t.ports(node), 1).zip(t.ports(node).said(2));
    Status::of(asked.is_some_and(|(id, said)| t.world.human_gesture(id) == said))
}

/// The human of a port.
pub(super) fn human(ports: &Ports<'_>, port: usize) -> Option<HumanId> {
    u32::try_from(ports.whole(port)?).ok().filter(|number| *number > 0).map(HumanId::new)
}
