//! The leaves of HuNavSim 1.0 and 1.1: every one ends in the tick it runs in.
//!
//! Natively the reactions are the motions they are; their own factors and speeds are read and left unused, since
//! the native engine has one way of each motion. A world that keeps upstream's meaning reads them through
//! [`World::leaf`](crate::World::leaf).

use socrates_model::Action;

use crate::nodes::{goal_reached, halt_leaf, motion, robot_visible, time_expired, update_goal};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};

/// The leaves of HuNavSim 1.0.
pub(super) const CATALOG_1_0: &[&NodeSheet] = &[
    &IS_ROBOT_VISIBLE,
    &IS_GOAL_REACHED,
    &TIME_EXPIRED,
    &UPDATE_GOAL,
    &REGULAR_NAV,
    &SURPRISED_NAV,
    &CURIOUS_NAV_1_0,
    &SCARED_NAV_1_0,
    &THREATENING_NAV_1_0,
];

/// The leaves of HuNavSim 1.1. The parameters of a reaction come in by ports there.
pub(super) const CATALOG_1_1: &[&NodeSheet] = &[
    &IS_ROBOT_VISIBLE,
    &IS_GOAL_REACHED,
    &TIME_EXPIRED,
    &UPDATE_GOAL,
    &REGULAR_NAV,
    &SURPRISED_NAV,
    &CURIOUS_NAV_1_1,
    &SCARED_NAV_1_1,
    &THREATENING_NAV_1_1,
];

/// `IsRobotVisible`.
const IS_ROBOT_VISIBLE: NodeSheet = NodeSheet {
    tag: "IsRobotVisible",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("distance", PortKind::Distance, "largest distance to the robot"),
    ],
    about: "holds while the robot is in the field of view and not farther than this",
    role: Role::Asks(robot_visible::means),
    tick: robot_visible::tick,
    halt: halt_leaf,
};

/// `IsGoalReached`.
const IS_GOAL_REACHED: NodeSheet = NodeSheet {
    tag: "IsGoalReached",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is")],
    about: "holds while the agent is at its first goal: within the radius of the goal and 0.1 m",
    role: Role::Asks(goal_reached::means),
    tick: goal_reached::tick,
    halt: halt_leaf,
};

/// `TimeExpiredCondition`.
const TIME_EXPIRED: NodeSheet = NodeSheet {
    tag: "TimeExpiredCondition",
    v3_tag: None,
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::may("seconds", PortKind::Span, "1.0", "length of the timer"),
        PortSheet::may("ts", PortKind::Span, "0.01", "added at every tick"),
        PortSheet::may("only_once", PortKind::Flag, "false", "whether it stays expired, or starts again"),
    ],
    about: "fails until it has been ticked for so many seconds, then holds",
    role: Role::Timer,
    tick: time_expired::tick,
    halt: halt_leaf,
};

/// `UpdateGoal`.
const UPDATE_GOAL: NodeSheet = NodeSheet {
    tag: "UpdateGoal",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is")],
    about: "takes the first goal off the list; a cyclic list gets it back at its end",
    role: Role::Quiet,
    tick: update_goal::tick,
    halt: halt_leaf,
};

/// `RegularNav`.
const REGULAR_NAV: NodeSheet = NodeSheet {
    tag: "RegularNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
    ],
    about: "walks to its first goal",
    role: Role::Moves(|_| Some(Action::Navigate)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `SurprisedNav`.
const SURPRISED_NAV: NodeSheet = NodeSheet {
    tag: "SurprisedNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
    ],
    about: "stops and turns to the robot",
    role: Role::Moves(|_| Some(Action::LookAtRobot)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `CuriousNav`.
const CURIOUS_NAV_1_0: NodeSheet = NodeSheet {
    tag: "CuriousNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
    ],
    about: "goes up to the robot and stops before it",
    role: Role::Moves(|_| Some(Action::Approach)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `ScaredNav`.
const SCARED_NAV_1_0: NodeSheet = NodeSheet {
    tag: "ScaredNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
    ],
    about: "walks on, pushed away from the robot",
    role: Role::Moves(|_| Some(Action::RunAway)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `ThreateningNav`.
const THREATENING_NAV_1_0: NodeSheet = NodeSheet {
    tag: "ThreateningNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
    ],
    about: "goes in front of the robot and faces it",
    role: Role::Moves(|_| Some(Action::Block)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `CuriousNav`.
const CURIOUS_NAV_1_1: NodeSheet = NodeSheet {
    tag: "CuriousNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_1,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
        PortSheet::may("stop_distance", PortKind::Distance, "", "where it stops before the robot"),
        PortSheet::may("agent_vel", PortKind::Speed, "", "largest speed of the approach"),
    ],
    about: "goes up to the robot and stops before it",
    role: Role::Moves(|_| Some(Action::Approach)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `ScaredNav`.
const SCARED_NAV_1_1: NodeSheet = NodeSheet {
    tag: "ScaredNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_1,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
        PortSheet::may("runaway_vel", PortKind::Speed, "", "speed"),
        PortSheet::may("scary_force_factor", PortKind::Number, "", "factor of the force away from the robot"),
    ],
    about: "walks on, pushed away from the robot",
    role: Role::Moves(|_| Some(Action::RunAway)),
    tick: motion::tick,
    halt: halt_leaf,
};

/// `ThreateningNav`.
const THREATENING_NAV_1_1: NodeSheet = NodeSheet {
    tag: "ThreateningNav",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim1_1,
    arity: Arity::NONE,
    ports: &[
        PortSheet::must("agent_id", PortKind::Agent, "whose leaf it is"),
        PortSheet::must("time_step", PortKind::Span, "length of a tick"),
        PortSheet::may("goal_dist", PortKind::Distance, "", "distance before the robot"),
    ],
    about: "goes in front of the robot and faces it",
    role: Role::Moves(|_| Some(Action::Block)),
    tick: motion::tick,
    halt: halt_leaf,
};
