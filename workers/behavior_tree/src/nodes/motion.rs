//! Motions that need no further word than the robot. Each succeeds in the tick it is done in.

use socrates_model::Action;

use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `RegularNav`.
pub(super) const REGULAR_NAV: NodeSheet = NodeSheet {
    tag: "RegularNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP],
    about: "walks along their path",
    role: Role::Moves(|_| Some(Action::Navigate)),
    tick,
    halt: halt_leaf,
};

/// `LookAtRobot`.
pub(super) const LOOK_AT_ROBOT: NodeSheet = NodeSheet {
    tag: "LookAtRobot",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "stops and turns to the robot",
    role: Role::Moves(|_| Some(Action::LookAtRobot)),
    tick,
    halt: halt_leaf,
};

/// `FollowRobot`.
pub(super) const FOLLOW_ROBOT: NodeSheet = NodeSheet {
    tag: "FollowRobot",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP],
    about: "follows the robot at 1 to 2 m",
    role: Role::Moves(|_| Some(Action::FollowRobot)),
    tick,
    halt: halt_leaf,
};

/// `RunAwayFromRobot`.
pub(super) const RUN_AWAY: NodeSheet = NodeSheet {
    tag: "RunAwayFromRobot",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP],
    about: "hurries away from the robot",
    role: Role::Moves(|_| Some(Action::RunAway)),
    tick,
    halt: halt_leaf,
};

/// `GiveWaytoRobot`.
pub(super) const GIVE_WAY: NodeSheet = NodeSheet {
    tag: "GiveWaytoRobot",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP],
    about: "steps out of the robot's way and waits there",
    role: Role::Moves(|_| Some(Action::GiveWay)),
    tick,
    halt: halt_leaf,
};

/// `BlockRobot`.
pub(super) const BLOCK: NodeSheet = NodeSheet {
    tag: "BlockRobot",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::SocratesFork,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP],
    about: "goes and stays in front of the robot",
    role: Role::Moves(|_| Some(Action::Block)),
    tick,
    halt: halt_leaf,
};

/// `ApproachRobot`.
pub(super) const APPROACH: NodeSheet = NodeSheet {
    tag: "ApproachRobot",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP],
    about: "goes up to the robot, out of curiosity, and stops before it",
    role: Role::Moves(|_| Some(Action::Approach)),
    tick,
    halt: halt_leaf,
};

/// `StandStill`.
pub(super) const STAND_STILL: NodeSheet = NodeSheet {
    tag: "StandStill",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN],
    about: "stands still on purpose",
    role: Role::Moves(|_| Some(Action::StandStill)),
    tick,
    halt: halt_leaf,
};

/// Does what the sheet of the node says, for this tick.
pub(super) fn tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let tree = t.tree;
    let Some(Role::Moves(means)) = tree.nodes.get(node).map(|it| it.sheet.role) else { return Status::Failure };
    let Some(action) = means(&t.ports(node)) else { return Status::Failure };
    let leaf = t.leaf(node);
    t.world.act(&action, leaf);
    Status::Success
}
