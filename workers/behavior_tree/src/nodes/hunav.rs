//! The nodes of HuNavSim 1.0, 1.1 and 2.0 beside those of BehaviorTree.CPP, in one table.
//!
//! Those of 1.0 and 1.1 end in the tick they run in; the parameters of a reaction are ports since 1.1. Natively the
//! reactions are the motions they are; their own factors and speeds are read and left unused, since the native engine
//! has one way of each motion. Where the meaning of a leaf of 2.0 is plain in a native world (the robot's distance, the
//! four reactions, waiting) it is ticked natively; the others need global goals, groups, other agents' places or a lot,
//! and are ticked by [`World::leaf`](crate::World::leaf) alone. A world that keeps upstream's meaning reads the ports
//! there too. The library times leaves that run over many ticks with the wall clock; here time is simulated.

use std::sync::LazyLock;

use socrates_model::{Action, Trigger};

use crate::blackboard::Ports;
use crate::nodes::{LEAF, goal_reached, robot_visible, time_delay, time_expired, update_goal, world_only};
use crate::sheet::PortKind::{
    self, Agent, Agents, Angle, Count, Distance, Flag, Number, Output, Share, Span, Speed, Text,
};
use crate::sheet::{Kind, Library, NodeSheet, PortSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// The sheets as other libraries declare them, where they differ from [`CATALOG`](super::CATALOG): other ports, defaults
/// and ranges, or nodes that we do not have. No library here knows more of that list than its built-in part.
pub static DIALECTS: LazyLock<[(Library, Vec<NodeSheet>); 3]> = LazyLock::new(|| {
    [Library::HunavSim1_0, Library::HunavSim1_1, Library::HunavSim2].map(|library| {
        let theirs = TABLE.iter().filter(|(libraries, _)| libraries.contains(&library));
        (library, theirs.map(|(_, sheet)| NodeSheet { library, ..*sheet }).collect())
    })
});

const ALL: &[Library] = &[Library::HunavSim1_0, Library::HunavSim1_1, Library::HunavSim2];
const V1: &[Library] = &[Library::HunavSim1_0, Library::HunavSim1_1];
const V1_0: &[Library] = &[Library::HunavSim1_0];
const V1_1: &[Library] = &[Library::HunavSim1_1];
const V2: &[Library] = &[Library::HunavSim2];

const fn must(name: &'static str, kind: PortKind, about: &'static str) -> PortSheet {
    PortSheet::must(name, kind, about)
}

const fn may(name: &'static str, kind: PortKind, default: &'static str, about: &'static str) -> PortSheet {
    PortSheet::may(name, kind, default, about)
}

const AGENT: PortSheet = PortSheet::AGENT;
/// `time_step`, which every motion of 1.0 and 1.1 must be given.
const STEP_1: PortSheet = must("time_step", Span, "length of a tick");
/// `time_step`, as motions of 2.0 have it.
const STEP: PortSheet = may("time_step", Span, "0.1", "length of a tick");
/// `beh_duration` of the four reactions of 2.0.
const UNREAD: PortSheet = may("beh_duration", Span, "5.0", "declared by the library and not read");
/// `only_once` of the four reactions of 2.0.
const ONCE: PortSheet = may("only_once", Flag, "true", "declared by the library and not read");
const OTHER: PortSheet = must("target_agent_id", Agent, "the other agent");
const OBSERVER: PortSheet = must("observer_id", Agent, "who looks");
const GOAL: PortSheet = must("goal_id", Count(1), "number of a global goal");
const LEADER: PortSheet = must("main_agent_id", Agent, "who leads");
const OTHERS: PortSheet = must("non_main_agent_ids", Agents, "the others");
const HEARING: PortSheet = may("distance_threshold", Distance, "5.0", "largest distance");
const WAITS_5: PortSheet = may("duration", Span, "5.0", "how long it waits for it");
const AT_MOST_5: PortSheet = may("duration", Span, "5.0", "longest time");
const LASTS_5: PortSheet = may("duration", Span, "5.0", "how long");
const FACING: PortSheet = may("yaw_tolerance", Angle, "0.01", "largest bearing error at the end");

/// A condition.
const ASKS: NodeSheet = NodeSheet { kind: Kind::Condition, ..LEAF };
/// A condition that only the world can answer.
const WORLD_ASKS: NodeSheet = NodeSheet { kind: Kind::Condition, ..WORLD_ACTS };
/// An action that only the world can tick.
const WORLD_ACTS: NodeSheet = NodeSheet { role: Role::World, tick: world_only::tick, ..LEAF };

// Leaves whose ports differ by library.
const VISIBLE: NodeSheet = NodeSheet {
    tag: "IsRobotVisible",
    about: "holds while the robot is in the field of view and not farther than this",
    role: Role::Asks(robot_visible::means),
    tick: robot_visible::tick,
    ..ASKS
};
const REGULAR: NodeSheet = moves("RegularNav", "walks to its first goal", Role::Moves(|_| Some(Action::Navigate)));
const SURPRISED: NodeSheet =
    moves("SurprisedNav", "stops and turns to the robot", Role::Moves(|_| Some(Action::LookAtRobot)));
const CURIOUS: NodeSheet =
    moves("CuriousNav", "goes up to the robot and stops before it", Role::Moves(|_| Some(Action::Approach)));
const SCARED: NodeSheet =
    moves("ScaredNav", "walks on, pushed away from the robot", Role::Moves(|_| Some(Action::RunAway)));
const THREATENING: NodeSheet =
    moves("ThreateningNav", "goes in front of the robot and faces it", Role::Moves(|_| Some(Action::Block)));

const fn moves(tag: &'static str, about: &'static str, role: Role) -> NodeSheet {
    NodeSheet { tag, about, role, ..LEAF }
}

/// Every node with the libraries that have it, in their order.
#[rustfmt::skip]
const TABLE: &[(&[Library], NodeSheet)] = &[
    (V1, NodeSheet { ports: &[AGENT, must("distance", Distance, "largest distance to the robot")], ..VISIBLE }),
    (V2, NodeSheet { ports: &[AGENT, may("distance", Distance, "5.0", "largest distance to the robot")], ..VISIBLE }),
    (ALL, NodeSheet { tag: "IsGoalReached", ports: &[AGENT], role: Role::Asks(goal_reached::means), tick: goal_reached::tick,
        about: "holds while the agent is at its first goal: within the radius of the goal and 0.1 m", ..ASKS }),
    (ALL, NodeSheet { tag: "TimeExpiredCondition", ports: &[
            may("seconds", Span, "1.0", "length of the timer"),
            may("ts", Span, "0.01", "added at every tick"),
            may("only_once", Flag, "false", "whether it stays expired, or starts again"),
        ], role: Role::Timer, tick: time_expired::tick,
        about: "fails until it has been ticked for so many seconds, then holds", ..ASKS }),
    (ALL, NodeSheet { tag: "UpdateGoal", ports: &[AGENT], tick: update_goal::tick,
        about: "takes the first goal off the list; a cyclic list gets it back at its end", ..LEAF }),
    (V2, NodeSheet { tag: "IsRobotClose", ports: &[AGENT, may("threshold", Distance, "1.0", "largest distance")],
        role: Role::Asks(robot_close), tick: robot_close_tick,
        about: "holds while the robot is within this distance", ..ASKS }),
    (V2, NodeSheet { tag: "RandomChanceCondition", ports: &[AGENT, may("probability", Share, "0.3", "chance to hold")],
        about: "holds by chance, drawn anew in every tick", ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "IsRobotFacingAgent", ports: &[AGENT],
        about: "holds while the robot faces the agent to 0.3 rad", ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "IsAgentVisible", ports: &[OBSERVER, must("agent_id", Agent, "who is seen"),
            may("distance", Distance, "5.0", "largest distance"),
            may("field_of_view", Angle, "", "half angle of the field of view"),
        ], about: "holds while one agent is in the field of view of another", ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "IsAgentClose", ports: &[OBSERVER, OTHER, may("threshold", Distance, "1.0", "largest distance")],
        about: "holds while two agents are within this distance", ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "IsAtPosition", ports: &[AGENT, may("goal_id", Count(1), "", "number of a global goal"),
            may("tolerance", Distance, "0.1", "largest distance"),
            may("target_x", Number, "", "place instead of a goal, m"),
            may("target_y", Number, "", "place instead of a goal, m"),
        ], about: "holds while the agent is at a global goal", ..WORLD_ASKS }),
    (V1, NodeSheet { ports: &[AGENT, STEP_1], ..REGULAR }),
    (V2, NodeSheet { ports: &[AGENT, STEP], ..REGULAR }),
    (V1, NodeSheet { ports: &[AGENT, STEP_1], ..SURPRISED }),
    (V2, NodeSheet { ports: &[AGENT, STEP, UNREAD, ONCE], ..SURPRISED }),
    (V1_0, NodeSheet { ports: &[AGENT, STEP_1], ..CURIOUS }),
    (V1_1, NodeSheet { ports: &[AGENT, STEP_1,
            may("stop_distance", Distance, "", "where it stops before the robot"),
            may("agent_vel", Speed, "", "largest speed of the approach"),
        ], ..CURIOUS }),
    (V2, NodeSheet { ports: &[AGENT, STEP, UNREAD, ONCE,
            may("agent_vel", Speed, "1.0", "largest speed of the approach"),
            may("stop_distance", Distance, "0.5", "where it stops before the robot"),
        ], ..CURIOUS }),
    (V1_0, NodeSheet { ports: &[AGENT, STEP_1], ..SCARED }),
    (V1_1, NodeSheet { ports: &[AGENT, STEP_1, may("runaway_vel", Speed, "", "speed"),
            may("scary_force_factor", Number, "", "factor of the force away from the robot"),
        ], ..SCARED }),
    (V2, NodeSheet { ports: &[AGENT, STEP, UNREAD, ONCE, may("runaway_vel", Speed, "1.5", "speed"),
            may("scary_force_factor", Number, "1.0", "factor of the force away from the robot"),
        ], ..SCARED }),
    (V1_0, NodeSheet { ports: &[AGENT, STEP_1], ..THREATENING }),
    (V1_1, NodeSheet { ports: &[AGENT, STEP_1, may("goal_dist", Distance, "", "distance before the robot")],
        ..THREATENING }),
    (V2, NodeSheet { ports: &[AGENT, STEP, UNREAD, ONCE, may("goal_dist", Distance, "1.0", "distance before the robot")],
        ..THREATENING }),
    (V2, NodeSheet { tag: "FindNearestAgent", ports: &[AGENT, may("target_agent_id", Output, "", "who was found")],
        about: "finds the agent nearest to this one", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "SaySomething", ports: &[AGENT, must("message", Text, "what is said")], tick: say,
        about: "says a text, which nobody can ask about; natively it is passed over", ..LEAF }),
    (V2, NodeSheet { tag: "SetGroupId", ports: &[AGENT, must("group_id", Count(-1), "number of the group, -1 for none")],
        about: "puts the agent into a group", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "SetGoal", ports: &[AGENT, GOAL],
        about: "puts a global goal before all others, so that a list of them is walked backwards", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "StopMovement", ports: &[AGENT],
        about: "sets the desired speed to 0 until ResumeMovement", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "ResumeMovement", ports: &[AGENT],
        about: "gives the desired speed back that StopMovement took", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "IsSpeaking", ports: &[AGENT, must("target_id", Agent, "who speaks"), STEP, HEARING,
            may("duration", Span, "10.0", "how long it waits for it"),
        ], about: "runs until another agent speaks; fails when the time is over", ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "IsAnyoneSpeaking", ports: &[AGENT, STEP, HEARING, WAITS_5,
            may("speaker_id", Output, "", "who speaks"),
        ], about: "runs until anybody speaks; fails when the time is over", ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "IsLookingAtMe", ports: &[AGENT, must("target_id", Agent, "who looks"), STEP,
            must("distance_threshold", Distance, "largest distance"),
            must("angle_threshold", Angle, "largest bearing error of the look"),
            must("duration", Span, "how long it waits for it"),
        ], about: "runs until another agent looks at this one; fails when the time is over", ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "IsAnyoneLookingAtMe", ports: &[AGENT, STEP, HEARING,
            may("angle_threshold", Angle, "0.3", "largest bearing error of the look"), WAITS_5,
            may("observer_id", Output, "", "who looks"),
        ], about: "runs until anybody looks at this agent, which walks on meanwhile; fails when the time is over",
        ..WORLD_ASKS }),
    (V2, NodeSheet { tag: "StopAndWaitTimerAction", ports: &[AGENT, must("wait_duration", Span, "how long")],
        role: Role::Moves(|_| Some(Action::StandStill)), tick: wait, halt: wait_halt,
        about: "stands still and runs until the time is over", ..LEAF }),
    (V2, NodeSheet { tag: "GoTo", ports: &[AGENT, STEP, GOAL,
            may("tolerance", Distance, "0.1", "declared by the library and not read"),
        ], about: "walks to a global goal and runs until it is there; then the goals of before hold again", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "ApproachAgent", ports: &[AGENT, OTHER, STEP,
            may("closest_dist", Distance, "0.5", "where it stops"),
            may("max_vel", Speed, "1.0", "largest speed"), AT_MOST_5,
        ], about: "goes up to another agent", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "ApproachRobot", ports: &[AGENT, STEP,
            may("closest_dist", Distance, "1.5", "where it stops"),
            may("max_vel", Speed, "1.8", "largest speed"), AT_MOST_5,
        ], about: "goes up to the robot", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "BlockRobot", ports: &[AGENT, STEP,
            may("front_dist", Distance, "1.0", "distance before the robot"), LASTS_5,
        ], about: "goes and stays in front of the robot", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "BlockAgent", ports: &[AGENT, OTHER, STEP,
            may("front_dist", Distance, "1.0", "distance before the other agent"), LASTS_5,
        ], about: "goes and stays in front of another agent", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "FollowAgent", ports: &[AGENT, OTHER, STEP,
            may("closest_dist", Distance, "1.5", "where it begins to slow down"),
            may("max_vel", Speed, "1.5", "largest speed"),
            may("duration", Span, "0", "how long; 0 for ever"),
        ], about: "follows another agent", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "ConversationFormation", ports: &[LEADER, OTHERS, GOAL, STEP,
            may("conversation_duration", Span, "10.0", "how long"),
        ], about: "gathers agents in a circle around a global goal", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "SetGroupWalk", ports: &[LEADER, OTHERS, STEP, LASTS_5],
        about: "makes agents walk as a group along the goals of the first", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "LookAtAgent", ports: &[OBSERVER, must("target_id", Agent, "who is looked at"), FACING],
        about: "turns to another agent and runs until it faces it", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "LookAtRobot", ports: &[AGENT, FACING],
        about: "turns to the robot and runs until it faces it", ..WORLD_ACTS }),
    (V2, NodeSheet { tag: "LookAtPoint", ports: &[AGENT, GOAL, FACING],
        about: "turns to a global goal and runs until it faces it", ..WORLD_ACTS }),
    (V2, time_delay::SHEET),
];

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

/// Runs from the tick it starts in until its time is over; the tick in which it is over is the first that succeeds.
fn wait(t: &mut Ticker<'_>, node: usize) -> Status {
    let Some(seconds) = t.ports(node).real(1) else { return Status::Failure };
    let now = t.world.now().nanos();
    if t.status(node) != Status::Running {
        t.set_word(node, 0, now);
    }
    let waited = now.saturating_sub(t.word(node, 0));
    if waited >= time_expired::nanos(seconds) {
        return Status::Success;
    }
    let leaf = t.leaf(node);
    t.world.act(&Action::StandStill, leaf);
    Status::Running
}

/// A wait that is cut short starts over.
fn wait_halt(t: &mut Ticker<'_>, node: usize) {
    t.set_word(node, 0, 0);
}
