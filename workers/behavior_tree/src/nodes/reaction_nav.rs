//! The four reactions of HuNavSim 1.x, read as the motions they are. Their own factors and speeds are
//! taken in and not used: the engine has one way of each motion.

use socrates_model::Action;

use crate::nodes::{halt_leaf, motion};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};

/// `SurprisedNav`.
pub(super) const SURPRISED: NodeSheet = NodeSheet {
    tag: "SurprisedNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP],
    about: "stops and turns to the robot (HuNavSim 1.x)",
    role: Role::Moves(|_| Some(Action::LookAtRobot)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `CuriousNav`.
pub(super) const CURIOUS: NodeSheet = NodeSheet {
    tag: "CuriousNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1,
    arity: Arity::NONE,
    ports: &[
        PortSheet::OWN,
        PortSheet::STEP,
        PortSheet::may("stop_distance", PortKind::Number, "", "not used here"),
        PortSheet::may("agent_vel", PortKind::Number, "", "not used here"),
    ],
    about: "goes up to the robot (HuNavSim 1.x)",
    role: Role::Moves(|_| Some(Action::Approach)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `ScaredNav`.
pub(super) const SCARED: NodeSheet = NodeSheet {
    tag: "ScaredNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1,
    arity: Arity::NONE,
    ports: &[
        PortSheet::OWN,
        PortSheet::STEP,
        PortSheet::may("runaway_vel", PortKind::Number, "", "not used here"),
        PortSheet::may("scary_force_factor", PortKind::Number, "", "not used here"),
    ],
    about: "hurries away from the robot (HuNavSim 1.x)",
    role: Role::Moves(|_| Some(Action::RunAway)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `ThreateningNav`.
pub(super) const THREATENING: NodeSheet = NodeSheet {
    tag: "ThreateningNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1,
    arity: Arity::NONE,
    ports: &[PortSheet::OWN, PortSheet::STEP, PortSheet::may("goal_dist", PortKind::Number, "", "not used here")],
    about: "goes in front of the robot (HuNavSim 1.x)",
    role: Role::Moves(|_| Some(Action::Block)),
    tick: motion::tick,
    halt: halt_leaf,
};
