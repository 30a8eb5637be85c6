//! `HasStepEnded` and `IsDone`: how far somebody is with their steps.

use socrates_model::Trigger;

use crate::blackboard::Ports;
use crate::nodes::halt_leaf;
use crate::nodes::human_says::human;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `HasStepEnded`.
pub(super) const STEP: NodeSheet = NodeSheet {
    tag: "HasStepEnded",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[
        PortSheet::OWN,
        PortSheet::must("target_id", PortKind::Human, "whose step it is, 1 for human_1; this human too"),
        PortSheet::must("step", PortKind::Count(1), "number of the step"),
    ],
    about: "holds once a step of somebody's sequence has ended (see EndStep)",
    role: Role::Asks(did),
    tick: has_ended,
    halt: halt_leaf,
};
/// `IsDone`.
pub(super) const ALL: NodeSheet = NodeSheet {
    tag: "IsDone",
    ports: &[PortSheet::OWN, PortSheet::must("target_id", PortKind::Human, "who")],
    about: "holds once all steps of another human have ended, or their walk has led past the robot where they have none",
    role: Role::Asks(done),
    tick: is_done,
    ..STEP
};

fn did(ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::Did(human(ports, 1)?, u32::try_from(ports.whole(2)?).ok()?))
}

fn done(ports: &Ports<'_>) -> Option<Trigger> {
    Some(Trigger::Done(human(ports, 1)?))
}

fn has_ended(t: &mut Ticker<'_>, node: usize) -> Status {
    let asked = human(&t.ports(node), 1).zip(t.ports(node).whole(2));
    Status::of(asked.is_some_and(|(id, step)| i64::from(t.world.steps_ended(id)) >= step))
}

fn is_done(t: &mut Ticker<'_>, node: usize) -> Status {
    let asked = human(&t.ports(node), 1);
    Status::of(asked.is_some_and(|id| t.world.is_done(id)))
}
