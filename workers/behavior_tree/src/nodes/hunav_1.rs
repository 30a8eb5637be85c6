//! The leaves of HuNavSim 1.0 and 1.1: every one ends in the tick it runs in.
//!
//! Natively the reactions are the motions they are; their own factors and speeds are read and left unused, since
//! the native engine has one way of each motion. A world that keeps upstream's meaning reads them through
//! [`World::leaf`](crate::World::leaf).

use socrates_model::Action;

use crate::nodes::{LEAF, goal_reached, motion, robot_visible, time_expired, update_goal};
use crate::sheet::{Kind, Library, NodeSheet, PortKind, PortSheet, Role};

/// `time_step`, which every motion must be given.
const STEP: PortSheet = PortSheet::must("time_step", PortKind::Span, "length of a tick");

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
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT, PortSheet::must("distance", PortKind::Distance, "largest distance to the robot")],
    about: "holds while the robot is in the field of view and not farther than this",
    role: Role::Asks(robot_visible::means),
    tick: robot_visible::tick,
    ..LEAF
};

/// `IsGoalReached`.
const IS_GOAL_REACHED: NodeSheet = NodeSheet {
    tag: "IsGoalReached",
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT],
    about: "holds while the agent is at its first goal: within the radius of the goal and 0.1 m",
    role: Role::Asks(goal_reached::means),
    tick: goal_reached::tick,
    ..LEAF
};

/// `TimeExpiredCondition`.
const TIME_EXPIRED: NodeSheet = NodeSheet {
    tag: "TimeExpiredCondition",
    kind: Kind::Condition,
    library: Library::HunavSim1_0,
    ports: &[
        PortSheet::may("seconds", PortKind::Span, "1.0", "length of the timer"),
        PortSheet::may("ts", PortKind::Span, "0.01", "added at every tick"),
        PortSheet::may("only_once", PortKind::Flag, "false", "whether it stays expired, or starts again"),
    ],
    about: "fails until it has been ticked for so many seconds, then holds",
    role: Role::Timer,
    tick: time_expired::tick,
    ..LEAF
};

/// `UpdateGoal`.
const UPDATE_GOAL: NodeSheet = NodeSheet {
    tag: "UpdateGoal",
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT],
    about: "takes the first goal off the list; a cyclic list gets it back at its end",
    role: Role::Quiet,
    tick: update_goal::tick,
    ..LEAF
};

/// `RegularNav`.
const REGULAR_NAV: NodeSheet = NodeSheet {
    tag: "RegularNav",
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT, STEP],
    about: "walks to its first goal",
    role: Role::Moves(|_| Some(Action::Navigate)),
    tick: motion::tick,
    ..LEAF
};

/// `SurprisedNav`.
const SURPRISED_NAV: NodeSheet = NodeSheet {
    tag: "SurprisedNav",
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT, STEP],
    about: "stops and turns to the robot",
    role: Role::Moves(|_| Some(Action::LookAtRobot)),
    tick: motion::tick,
    ..LEAF
};

/// `CuriousNav`.
const CURIOUS_NAV_1_0: NodeSheet = NodeSheet {
    tag: "CuriousNav",
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT, STEP],
    about: "goes up to the robot and stops before it",
    role: Role::Moves(|_| Some(Action::Approach)),
    tick: motion::tick,
    ..LEAF
};

/// `ScaredNav`.
const SCARED_NAV_1_0: NodeSheet = NodeSheet {
    tag: "ScaredNav",
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT, STEP],
    about: "walks on, pushed away from the robot",
    role: Role::Moves(|_| Some(Action::RunAway)),
    tick: motion::tick,
    ..LEAF
};

/// `ThreateningNav`.
const THREATENING_NAV_1_0: NodeSheet = NodeSheet {
    tag: "ThreateningNav",
    kind: Kind::Action,
    library: Library::HunavSim1_0,
    ports: &[PortSheet::AGENT, STEP],
    about: "goes in front of the robot and faces it",
    role: Role::Moves(|_| Some(Action::Block)),
    tick: motion::tick,
    ..LEAF
};

/// `CuriousNav`.
const CURIOUS_NAV_1_1: NodeSheet = NodeSheet {
    tag: "CuriousNav",
    kind: Kind::Action,
    library: Library::HunavSim1_1,
    ports: &[
        PortSheet::AGENT,
        STEP,
        PortSheet::may("stop_distance", PortKind::Distance, "", "where it stops before the robot"),
        PortSheet::may("agent_vel", PortKind::Speed, "", "largest speed of the approach"),
    ],
    about: "goes up to the robot and stops before it",
    role: Role::Moves(|_| Some(Action::Approach)),
    tick: motion::tick,
    ..LEAF
};

/// `ScaredNav`.
const SCARED_NAV_1_1: NodeSheet = NodeSheet {
    tag: "ScaredNav",
    kind: Kind::Action,
    library: Library::HunavSim1_1,
    ports: &[
        PortSheet::AGENT,
        STEP,
        PortSheet::may("runaway_vel", PortKind::Speed, "", "speed"),
        PortSheet::may("scary_force_factor", PortKind::Number, "", "factor of the force away from the robot"),
    ],
    about: "walks on, pushed away from the robot",
    role: Role::Moves(|_| Some(Action::RunAway)),
    tick: motion::tick,
    ..LEAF
};

/// `ThreateningNav`.
const THREATENING_NAV_1_1: NodeSheet = NodeSheet {
    tag: "ThreateningNav",
    kind: Kind::Action,
    library: Library::HunavSim1_1,
    ports: &[PortSheet::AGENT, STEP, PortSheet::may("goal_dist", PortKind::Distance, "", "distance before the robot")],
    about: "goes in front of the robot and faces it",
    role: Role::Moves(|_| Some(Action::Block)),
    tick: motion::tick,
    ..LEAF
};
