//! The leaves of HuNavSim 2.0 that run over many ticks. The library times them with the wall clock; here time is
//! simulated.

use socrates_model::Action;

use crate::nodes::hunav_2::STEP;
use crate::nodes::{LEAF, world_only};
use crate::sheet::{Arity, Kind, Library, NodeSheet, PortKind, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `IsSpeaking`.
pub(super) const IS_SPEAKING: NodeSheet = NodeSheet {
    tag: "IsSpeaking",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::must("target_id", PortKind::Agent, "who speaks"),
        STEP,
        PortSheet::may("distance_threshold", PortKind::Distance, "5.0", "largest distance"),
        PortSheet::may("duration", PortKind::Span, "10.0", "how long it waits for it"),
    ],
    about: "runs until another agent speaks; fails when the time is over",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `IsAnyoneSpeaking`.
pub(super) const IS_ANYONE_SPEAKING: NodeSheet = NodeSheet {
    tag: "IsAnyoneSpeaking",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        PortSheet::may("distance_threshold", PortKind::Distance, "5.0", "largest distance"),
        PortSheet::may("duration", PortKind::Span, "5.0", "how long it waits for it"),
        PortSheet::may("speaker_id", PortKind::Output, "", "who speaks"),
    ],
    about: "runs until anybody speaks; fails when the time is over",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `IsLookingAtMe`.
pub(super) const IS_LOOKING_AT_ME: NodeSheet = NodeSheet {
    tag: "IsLookingAtMe",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::must("target_id", PortKind::Agent, "who looks"),
        STEP,
        PortSheet::must("distance_threshold", PortKind::Distance, "largest distance"),
        PortSheet::must("angle_threshold", PortKind::Angle, "largest bearing error of the look"),
        PortSheet::must("duration", PortKind::Span, "how long it waits for it"),
    ],
    about: "runs until another agent looks at this one; fails when the time is over",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `IsAnyoneLookingAtMe`.
pub(super) const IS_ANYONE_LOOKING_AT_ME: NodeSheet = NodeSheet {
    tag: "IsAnyoneLookingAtMe",
    kind: Kind::Condition,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        PortSheet::may("distance_threshold", PortKind::Distance, "5.0", "largest distance"),
        PortSheet::may("angle_threshold", PortKind::Angle, "0.3", "largest bearing error of the look"),
        PortSheet::may("duration", PortKind::Span, "5.0", "how long it waits for it"),
        PortSheet::may("observer_id", PortKind::Output, "", "who looks"),
    ],
    about: "runs until anybody looks at this agent, which walks on meanwhile; fails when the time is over",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `StopAndWaitTimerAction`.
pub(super) const STOP_AND_WAIT: NodeSheet = NodeSheet {
    tag: "StopAndWaitTimerAction",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::HunavSim2,
    arity: Arity::NONE,
    ports: &[PortSheet::AGENT, PortSheet::must("wait_duration", PortKind::Span, "how long")],
    about: "stands still and runs until the time is over",
    role: Role::Moves(|_| Some(Action::StandStill)),
    tick: wait,
    halt: wait_halt,
};

/// `GoTo`.
pub(super) const GO_TO: NodeSheet = NodeSheet {
    tag: "GoTo",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        PortSheet::must("goal_id", PortKind::Count(1), "number of a global goal"),
        PortSheet::may("tolerance", PortKind::Distance, "0.1", "declared by the library and not read"),
    ],
    about: "walks to a global goal and runs until it is there; then the goals of before hold again",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `ApproachAgent`.
pub(super) const APPROACH_AGENT: NodeSheet = NodeSheet {
    tag: "ApproachAgent",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::must("target_agent_id", PortKind::Agent, "the other agent"),
        STEP,
        PortSheet::may("closest_dist", PortKind::Distance, "0.5", "where it stops"),
        PortSheet::may("max_vel", PortKind::Speed, "1.0", "largest speed"),
        PortSheet::may("duration", PortKind::Span, "5.0", "longest time"),
    ],
    about: "goes up to another agent",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `ApproachRobot`.
pub(super) const APPROACH_ROBOT: NodeSheet = NodeSheet {
    tag: "ApproachRobot",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        PortSheet::may("closest_dist", PortKind::Distance, "1.5", "where it stops"),
        PortSheet::may("max_vel", PortKind::Speed, "1.8", "largest speed"),
        PortSheet::may("duration", PortKind::Span, "5.0", "longest time"),
    ],
    about: "goes up to the robot",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `BlockRobot`.
pub(super) const BLOCK_ROBOT: NodeSheet = NodeSheet {
    tag: "BlockRobot",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        STEP,
        PortSheet::may("front_dist", PortKind::Distance, "1.0", "distance before the robot"),
        PortSheet::may("duration", PortKind::Span, "5.0", "how long"),
    ],
    about: "goes and stays in front of the robot",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `BlockAgent`.
pub(super) const BLOCK_AGENT: NodeSheet = NodeSheet {
    tag: "BlockAgent",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::must("target_agent_id", PortKind::Agent, "the other agent"),
        STEP,
        PortSheet::may("front_dist", PortKind::Distance, "1.0", "distance before the other agent"),
        PortSheet::may("duration", PortKind::Span, "5.0", "how long"),
    ],
    about: "goes and stays in front of another agent",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `FollowAgent`.
pub(super) const FOLLOW_AGENT: NodeSheet = NodeSheet {
    tag: "FollowAgent",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::must("target_agent_id", PortKind::Agent, "the other agent"),
        STEP,
        PortSheet::may("closest_dist", PortKind::Distance, "1.5", "where it begins to slow down"),
        PortSheet::may("max_vel", PortKind::Speed, "1.5", "largest speed"),
        PortSheet::may("duration", PortKind::Span, "0", "how long; 0 for ever"),
    ],
    about: "follows another agent",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `ConversationFormation`.
pub(super) const CONVERSATION: NodeSheet = NodeSheet {
    tag: "ConversationFormation",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::must("main_agent_id", PortKind::Agent, "who leads"),
        PortSheet::must("non_main_agent_ids", PortKind::Agents, "the others"),
        PortSheet::must("goal_id", PortKind::Count(1), "number of a global goal"),
        STEP,
        PortSheet::may("conversation_duration", PortKind::Span, "10.0", "how long"),
    ],
    about: "gathers agents in a circle around a global goal",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `SetGroupWalk`.
pub(super) const GROUP_WALK: NodeSheet = NodeSheet {
    tag: "SetGroupWalk",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::must("main_agent_id", PortKind::Agent, "who leads"),
        PortSheet::must("non_main_agent_ids", PortKind::Agents, "the others"),
        STEP,
        PortSheet::may("duration", PortKind::Span, "5.0", "how long"),
    ],
    about: "makes agents walk as a group along the goals of the first",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `LookAtAgent`.
pub(super) const LOOK_AT_AGENT: NodeSheet = NodeSheet {
    tag: "LookAtAgent",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::must("observer_id", PortKind::Agent, "who looks"),
        PortSheet::must("target_id", PortKind::Agent, "who is looked at"),
        PortSheet::may("yaw_tolerance", PortKind::Angle, "0.01", "largest bearing error at the end"),
    ],
    about: "turns to another agent and runs until it faces it",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `LookAtRobot`.
pub(super) const LOOK_AT_ROBOT: NodeSheet = NodeSheet {
    tag: "LookAtRobot",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::may("yaw_tolerance", PortKind::Angle, "0.01", "largest bearing error at the end"),
    ],
    about: "turns to the robot and runs until it faces it",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// `LookAtPoint`.
pub(super) const LOOK_AT_POINT: NodeSheet = NodeSheet {
    tag: "LookAtPoint",
    kind: Kind::Action,
    library: Library::HunavSim2,
    ports: &[
        PortSheet::AGENT,
        PortSheet::must("goal_id", PortKind::Count(1), "number of a global goal"),
        PortSheet::may("yaw_tolerance", PortKind::Angle, "0.01", "largest bearing error at the end"),
    ],
    about: "turns to a global goal and runs until it faces it",
    role: Role::World,
    tick: world_only::tick,
    ..LEAF
};

/// Runs from the tick it starts in until its time is over; the tick in which it is over is the first that succeeds.
fn wait(t: &mut Ticker<'_>, node: usize) -> Status {
    let Some(seconds) = t.ports(node).real(1) else { return Status::Failure };
    let now = t.world.now().nanos();
    if t.status(node) != Status::Running {
        t.set_word(node, 0, now);
    }
    let waited = now.saturating_sub(t.word(node, 0));
    if waited >= crate::nodes::time_expired::nanos(seconds) {
        return Status::Success;
    }
    let leaf = t.leaf(node);
    t.world.act(&Action::StandStill, leaf);
    Status::Running
}

/// A wait that is cut short starts anew.
fn wait_halt(t: &mut Ticker<'_>, node: usize) {
    t.set_word(node, 0, 0);
}
