//! The leaves of HuNavSim 2.0 that end in the tick they run in, and the list of all its nodes.
//!
//! Where the meaning is plain in a native world (the robot's distance, the four reactions, waiting) a leaf is
//! ticked natively; the others need global goals, groups, other agents' places or a lot, and are ticked by
//! [`World::leaf`](crate::World::leaf) alone.

use socrates_model::{Action, Trigger};

use crate::blackboard::Ports;
use crate::nodes::hunav_2_stateful as stateful;
use crate::nodes::{LEAF, goal_reached, motion, robot_visible, time_delay, time_expired, update_goal, world_only};
use crate::sheet::{Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `time_step`, as every motion has it.
pub(super) const STEP: PortSheet = PortSheet::may("time_step", PortKind::Span, "0.1", "length of a tick");
/// `beh_duration` of the four reactions.
const DURATION: PortSheet =
    PortSheet::may("beh_duration", PortKind::Span, "5.0", "declared by the library and not read");
/// `only_once` of the four reactions.
const ONCE: PortSheet = PortSheet::may("only_once", PortKind::Flag, "true", "declared by the library and not read");

/// The nodes of HuNavSim 2.0 beside those of BehaviorTree.CPP.
pub(super) const CATALOG: &[&NodeSheet] = &[
    &IS_ROBOT_VISIBLE,
    &IS_GOAL_REACHED,
    &TIME_EXPIRED,
    &UPDATE_GOAL,
    &IS_ROBOT_CLOSE,
    &RANDOM_CHANCE,
    &IS_ROBOT_FACING,
    &IS_AGENT_VISIBLE,
    &IS_AGENT_CLOSE,
    &IS_AT_POSITION,
    &REGULAR_NAV,
    &SURPRISED_NAV,
    &CURIOUS_NAV,
    &SCARED_NAV,
    &THREATENING_NAV,
    &FIND_NEAREST,
    &SAY_SOMETHING,
    &SET_GROUP,
    &SET_GOAL,
    &STOP,
    &RESUME,
    &stateful::IS_SPEAKING,
    &stateful::IS_ANYONE_SPEAKING,
    &stateful::IS_LOOKING_AT_ME,
    &stateful::IS_ANYONE_LOOKING_AT_ME,
    &stateful::STOP_AND_WAIT,
    &stateful::GO_TO,
    &stateful::APPROACH_AGENT,
    &stateful::APPROACH_ROBOT,
    &stateful::BLOCK_ROBOT,
    &stateful::BLOCK_AGENT,
    &stateful::FOLLOW_AGENT,
    &stateful::CONVERSATION,
    &stateful::GROUP_WALK,
    &stateful::LOOK_AT_AGENT,
    &stateful::LOOK_AT_ROBOT,
    &stateful::LOOK_AT_POINT,
    &time_delay::SHEET,
];

/// `IsRobotVisible`.
const IS_ROBOT_VISIBLE: NodeSheet = NodeSheet {
    tag: "IsRobotVisible",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, PortSheet::may("distance", PortKind::Distance, "5.0", "largest distance to the robot")],
    about: "holds while the robot is in the field of view and not farther than this",
    role: Role::Asks(robot_visible::means),
    tick: robot_visible::tick,
    ..LEAF
};

/// `IsGoalReached`.
const IS_GOAL_REACHED: NodeSheet = NodeSheet {
    tag: "IsGoalReached",
    kind: Kind::Condition,
    library: Library::HunavSim2,
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
    library: Library::HunavSim2,
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
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT],
    about: "takes the first goal off the list; a cyclic list gets it back at its end",
    role: Role::Quiet,
    tick: update_goal::tick,
    ..LEAF
};

/// `IsRobotClose`.
const IS_ROBOT_CLOSE: NodeSheet = NodeSheet {
    tag: "IsRobotClose",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, PortSheet::may("threshold", PortKind::Distance, "1.0", "largest distance")],
    about: "holds while the robot is within this distance",
    role: Role::Asks(robot_close),
    tick: robot_close_tick,
    ..LEAF
};

/// `RandomChanceCondition`.
const RANDOM_CHANCE: NodeSheet = NodeSheet {
    tag: "RandomChanceCondition",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, PortSheet::may("probability", PortKind::Share, "0.3", "chance to hold")],
    about: "holds by chance, drawn anew in every tick",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `IsRobotFacingAgent`.
const IS_ROBOT_FACING: NodeSheet = NodeSheet {
    tag: "IsRobotFacingAgent",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT],
    about: "holds while the robot faces the agent to 0.3 rad",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `IsAgentVisible`.
const IS_AGENT_VISIBLE: NodeSheet = NodeSheet {
    tag: "IsAgentVisible",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::must("observer_id", PortKind::Agent, "who looks"),
        PortSheet::must("agent_id", PortKind::Agent, "who is seen"),
        PortSheet::may("distance", PortKind::Distance, "5.0", "largest distance"),
        PortSheet::may("field_of_view", PortKind::Angle, "", "half angle of the field of view"),
    ],
    about: "holds while one agent is in the field of view of another",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `IsAgentClose`.
const IS_AGENT_CLOSE: NodeSheet = NodeSheet {
    tag: "IsAgentClose",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::must("observer_id", PortKind::Agent, "who looks"),
        PortSheet::must("target_agent_id", PortKind::Agent, "the other agent"),
        PortSheet::may("threshold", PortKind::Distance, "1.0", "largest distance"),
    ],
    about: "holds while two agents are within this distance",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `IsAtPosition`.
const IS_AT_POSITION: NodeSheet = NodeSheet {
    tag: "IsAtPosition",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::may("goal_id", PortKind::Count(1), "", "number of a global goal"),
        PortSheet::may("tolerance", PortKind::Distance, "0.1", "largest distance"),
        PortSheet::may("target_x", PortKind::Number, "", "place instead of a goal, m"),
        PortSheet::may("target_y", PortKind::Number, "", "place instead of a goal, m"),
    ],
    about: "holds while the agent is at a global goal",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `RegularNav`.
const REGULAR_NAV: NodeSheet = NodeSheet {
    tag: "RegularNav",
    kind: Kind::Action,
    library: Library::HunavSim2,
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
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, STEP, DURATION, ONCE],
    about: "stops and turns to the robot",
    role: Role::Moves(|_| Some(Action::LookAtRobot)),
    tick: motion::tick,
    ..LEAF
};

/// `CuriousNav`.
const CURIOUS_NAV: NodeSheet = NodeSheet {
    tag: "CuriousNav",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        DURATION,
        ONCE,
        PortSheet::may("agent_vel", PortKind::Speed, "1.0", "largest speed of the approach"),
        PortSheet::may("stop_distance", PortKind::Distance, "0.5", "where it stops before the robot"),
    ],
    about: "goes up to the robot and stops before it",
    role: Role::Moves(|_| Some(Action::Approach)),
    tick: motion::tick,
    ..LEAF
};

/// `ScaredNav`.
const SCARED_NAV: NodeSheet = NodeSheet {
    tag: "ScaredNav",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        DURATION,
        ONCE,
        PortSheet::may("runaway_vel", PortKind::Speed, "1.5", "speed"),
        PortSheet::may("scary_force_factor", PortKind::Number, "1.0", "factor of the force away from the robot"),
    ],
    about: "walks on, pushed away from the robot",
    role: Role::Moves(|_| Some(Action::RunAway)),
    tick: motion::tick,
    ..LEAF
};

/// `ThreateningNav`.
const THREATENING_NAV: NodeSheet = NodeSheet {
    tag: "ThreateningNav",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        DURATION,
        ONCE,
        PortSheet::may("goal_dist", PortKind::Distance, "1.0", "distance before the robot"),
    ],
    about: "goes in front of the robot and faces it",
    role: Role::Moves(|_| Some(Action::Block)),
    tick: motion::tick,
    ..LEAF
};

/// `FindNearestAgent`.
const FIND_NEAREST: NodeSheet = NodeSheet {
    tag: "FindNearestAgent",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, PortSheet::may("target_agent_id", PortKind::Output, "", "who was found")],
    about: "finds the agent nearest to this one",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `SaySomething`.
const SAY_SOMETHING: NodeSheet = NodeSheet {
    tag: "SaySomething",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, PortSheet::must("message", PortKind::Text, "what is said")],
    about: "says a text, which nobody can ask about; natively it is passed over",
    role: Role::Quiet,
    tick: say,
    ..LEAF
};

/// `SetGroupId`.
const SET_GROUP: NodeSheet = NodeSheet {
    tag: "SetGroupId",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, PortSheet::must("group_id", PortKind::Count(-1), "number of the group, -1 for none")],
    about: "puts the agent into a group",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `SetGoal`.
const SET_GOAL: NodeSheet = NodeSheet {
    tag: "SetGoal",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT, PortSheet::must("goal_id", PortKind::Count(1), "number of a global goal")],
    about: "puts a global goal before all others, so that a list of them is walked backwards",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `StopMovement`.
const STOP: NodeSheet = NodeSheet {
    tag: "StopMovement",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT],
    about: "sets the desired speed to 0 until ResumeMovement",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `ResumeMovement`.
const RESUME: NodeSheet = NodeSheet {
    tag: "ResumeMovement",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[PortSheet::AGENT],
    about: "gives the desired speed back that StopMovement took",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

fn robot_close(ports: &Ports<'_>) -> Option<Trigger> {
    ports.real(1).map(Trigger::RobotNear)
}

fn robot_close_tick(t: &mut Ticker<'_>, node: usize) -> Status {
    let within_m = t.ports(node).real(1);
    Status::of(t.world.robot_distance_m().zip(within_m).is_some_and(|(m, within_m)| m <= within_m))
}

fn say(_t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::Success
}
