//! `FollowHuman`: goes after another human.

use socrates_model::Action;

use crate::blackboard::Ports;
use crate::nodes::human_says::human;
use crate::nodes::{halt_leaf, motion};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};

/// `FollowHuman`.
pub(super) const SHEET: NodeSheet = NodeSheet {
    tag: "FollowHuman",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::must("target_id", PortKind::Human, "who is followed"), PortSheet::STEP],
    about: "follows another human at 1 to 2 m",
    role: Role::Moves(means),
    tick: motion::tick,
    halt: halt_leaf,
};

fn means(ports: &Ports<'_>) -> Option<Action> {
    human(ports, 1).map(Action::FollowHuman)
}
